#include "identify/experiment/sheet.hpp"

#include "base/options/options.hpp"
#include "scene/shape_options.hpp"

#include <cmath>

namespace treacle::identify {

void OutlierTests::declare(Declaration& d) {
    d.number("median", median, unit::none, range_at_least(0),
        "Threshold of the normalised median test (Westerweel & Scarano 2005), each vector against its eight "
        "neighbours; 0: none.");
    d.number("alpha", alpha, unit::none, range_at_least(0),
        "Of the dissertation's (E.3) [1/s2]: vectors whose second difference in time is larger than alpha times their "
        "speed are dropped; 0: none.");
    d.number("floor", floor, unit::acceleration, range_at_least(0),
        "Added to it, so that slow vectors are not all dropped.");
}

void Ball::declare(Declaration& d) {
    d.text("track", track,
        "Its path: a CSV with columns time, x, y and plus_minus, with units, in the axes of the fields.");
    d.text("body", body, "Name of the body; by default the scene's only one that moves.");
    d.choice<BallMotion>("motion", motion, {{"prescribed", BallMotion::prescribed}, {"free", BallMotion::free}},
        "prescribed: the body follows the path, smoothed by a spline; free: it moves as the scene says, and the path "
        "only tells "
        "which vectors touch it. A prescribed path at low Reynolds number does not tell a viscosity.");
    d.check(motion == BallMotion::prescribed || !track.empty(), "track",
        {"must be given", "without one the body is free", "leave out `ball`"});
}

void Sheet::declare(Declaration& d) {
    if (d.parsing()) where = d.location();
    d.texts("files", files,
        "Names or patterns of the fields' files, in their order: [\"fields/*.txt\"]. OpenPIV, TSI Insight, LaVision "
        "DaVis, PIVlab "
        "(-v7.3) and CSV are read.");
    d.required("files");
    d.text("times", times, "CSV with a column time [s], a row a field; or first and interval.");
    d.number("first", first, unit::time, range_any(), "Time of the first field.");
    d.number("interval", interval, unit::time, range_at_least(0), "Time from one field to the next.");
    d.number("pixel", pixel, unit::length, range_at_least(0), "Length of a pixel in the sheet, for fields in pixels.");
    d.number("pair_interval", pair_interval, unit::time, range_at_least(0),
        "Time between the two pictures of a pair, for displacements in pixels.");
    d.vec3("origin", origin, unit::length, "Point of the scene where x and y of the fields are 0.");
    d.direction("right", right, "Direction in the scene in which x of the fields grows.", VectorKind::in_plane);
    d.direction("up", up, "The sheet's other direction in the scene.", VectorKind::in_plane);
    d.choice<Upward>("y", y, {{"up", Upward::up}, {"down", Upward::down}},
        "Whether y of the fields grows along `up` or against it: of pictures it is down.");
    d.choice<Upward>("v", v, {{"up", Upward::up}, {"down", Upward::down}},
        "Likewise of v, which some programs turn round and others do not; by default as y.");
    d.number("window", window, unit::length, range_above(0),
        "Side of an interrogation window, over which velocities are averaged.");
    d.number("noise", noise, unit::velocity, range_above(0),
        "Standard deviation of a vector's component: a tenth of a pixel over pair_interval, if nothing better is "
        "known.");
    for (const char* key : {"origin", "right", "up", "y", "window", "noise"}) d.required(key);
    d.list("mask", mask, "Shapes in the scene's places where vectors are left out: walls, reflections.");
    d.block("outliers", outliers, "Tests of vectors against their neighbours; what fails is dropped and counted.");
    d.block("ball", ball, "The body whose motion drives the flow. Without it, bodies move as the scene says.", "track");
    if (!d.parsing()) return;
    if (!d.given("v")) v = y;
    d.check(!files.empty(), "files",
        {"must not be empty", "there would be nothing to compare", "name the files of the fields"});
    const bool given = d.given("times");
    d.check(given != (interval > 0), "interval",
        {"must be given, or times, and not both", "fields do not say their times",
            "write for instance interval: 20 ms"});
    const double r = std::hypot(right[0], right[1], right[2]), u = std::hypot(up[0], up[1], up[2]);
    if (r > 0 && u > 0) {
        for (std::size_t k = 0; k < 3; ++k) {
            right[k] /= r;
            up[k] /= u;
        }
        const double cosine = right[0] * up[0] + right[1] * up[1] + right[2] * up[2];
        d.check(std::abs(cosine) < 1e-3, "up",
            {"must be across `right`", "they are the axes of the sheet",
                "write for instance right: [1, 0, 0], up: [0, 0, 1]"});
    }
}

Vec3 Sheet::point(double along_right, double along_up) const {
    Vec3 out = origin;
    for (std::size_t k = 0; k < 3; ++k) out[k] += along_right * right[k] + along_up * up[k];
    return out;
}

} // namespace treacle::identify
