#include "scene/scene.hpp"

#include "base/options/options.hpp"
#include "scene/names.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

namespace treacle::scene {

namespace {

const Range interval_range =
    range_at_least(0).because("it is a length of time; 0 switches it off", "write for instance 10 ms");

std::string standard_name(const Measurement& measurement) {
    switch (measurement.kind) {
    case MeasurementKind::front: return "front";
    case MeasurementKind::height: return "height";
    case MeasurementKind::flow: return "flow";
    }
    return "measurement";
}

void check_partners(Declaration& d, const std::vector<Joint>& joints, const std::vector<Body>& bodies) {
    for (const auto& joint : joints) {
        const auto known = [&](const std::string& name) {
            return std::ranges::find(bodies, name, &Body::name) != bodies.end();
        };
        for (const auto& name : {joint.body, joint.to}) {
            d.check(name.empty() || known(name), "joints",
                {"the body " + name + " of " + joint.name + " is not among `bodies`", "there would be nothing to link",
                    "give the name of one of them; `to` may be left out, for the world"});
        }
        const auto body = std::ranges::find(bodies, joint.body, &Body::name);
        d.check(body == bodies.end() || body->kind == BodyKind::dynamic, "joints",
            {"the body " + joint.body + " of " + joint.name + " is not dynamic", "no force moves it",
                "give the dynamic one as `body` and the other as `to`, or write kind: dynamic"});
        d.check(joint.body.empty() || joint.body != joint.to, "joints",
            {joint.name + " links " + joint.body + " to itself", "a joint has two sides",
                "give another body as `to`, or leave it out, for the world"});
    }
}

// Liquids of the inlets, and shapes of the liquids that no inlet pours.
void check_pouring(Declaration& d, std::vector<Inlet>& inlets, const std::vector<Liquid>& liquids) {
    for (auto& inlet : inlets) {
        if (inlet.liquid.empty() && liquids.size() == 1 && d.parsing()) inlet.liquid = liquids.front().name;
        d.check(!inlet.liquid.empty(), "inlets",
            {inlet.name + " does not say which liquid it pours", "there are several",
                "give the name of one of them as `liquid`"});
        const bool known = std::ranges::find(liquids, inlet.liquid, &Liquid::name) != liquids.end();
        d.check(known || inlet.liquid.empty(), "inlets",
            {"the liquid " + inlet.liquid + " of " + inlet.name + " is not among `liquids`",
                "there would be nothing to pour", "give the name of one of them"});
    }
    for (const auto& liquid : liquids) {
        const bool poured = std::ranges::find(inlets, liquid.name, &Inlet::liquid) != inlets.end();
        d.check(poured || !liquid.shapes.empty(), "liquids",
            {"the shapes of " + liquid.name + " are missing", "the liquid would have no particles",
                "add a shape, for instance - box: {min: [0, 0, 0], max: [1, 1, 1]}, or an inlet that pours it"});
    }
}

} // namespace

const std::vector<std::string>& frame_fields() {
    static const std::vector<std::string> names{
        "id", "velocity", "pressure", "liquid", "density", "blended_density", "role", "viscosity"};
    return names;
}

void Time::declare(Declaration& d) {
    if (d.parsing()) where = d.location_of(d.given("step") ? "step" : "min_step");
    d.number("end", end, unit::time, range_above(0).because("the run starts at 0", "write for instance 2 s"),
        "When the run ends.");
    d.choice<StepRule>("rule", rule, {{"cfl", StepRule::cfl}, {"fixed", StepRule::fixed}},
        "Steps that follow the largest velocity, or all the same.");
    d.number("step", step, unit::time, range_at_least(0),
        "With rule: fixed the time step; with rule: cfl the largest one, 0 for no such limit.");
    d.number("cfl", cfl, unit::none,
        range_between(0, 10).because(
            "beyond 1 a particle of method sph would jump over its neighbours", "0.3 is usual"),
        "Largest move of a particle per step, in spacings; 0 for the method's own: 0.2 of sph, 3 of grid.");
    d.number("min_step", min_step, unit::time, range_above(0),
        "When the rule asks for a smaller step, the run ends with exit code 3.");
    d.check(rule != StepRule::fixed || step > 0, "step",
        {"must be > 0 with rule: fixed", "it is the time step", "write for instance 1 ms"});
    d.check(step == 0 || step >= min_step, "step", {"must be at least min_step", "the run would end at once", ""});
}

void Output::declare(Declaration& d) {
    d.text("name", name, "Start of the names of the frames' files.");
    const auto fits = [](unsigned char c) { return c < 0x80 && (std::isalnum(c) || c == '_' || c == '-'); };
    d.check(!name.empty() && std::ranges::all_of(name, fits), "name",
        {"must have letters, digits, _ and - only", "it is the start of a file name", ""});
    d.check(
        name != "solid", "name", {"must not be solid", "the frames of the solids are called so", "take another name"});
    d.number("interval", interval, unit::time, interval_range, "Simulated time between frames; 0 for none.");
    d.numbers("times", times, unit::time, range_at_least(0),
        "Times of frames besides those of the interval: [0.12 s, 0.153 s].");
    d.texts("fields", fields, "Values per particle in the frames, besides its id.", frame_fields());
    d.boolean("double_precision", double_precision, "Frames in 64 bits a number instead of 32.");
    d.number("checkpoint_interval", checkpoint_interval, unit::time, interval_range,
        "Simulated time between checkpoints; 0 for none.");
    d.number("checkpoint_wall_interval", checkpoint_wall_interval, unit::time, interval_range,
        "Time of the clock between checkpoints; 0 for none.");
    d.integer("checkpoints_kept", checkpoints_kept, range_at_least(1), "How many of the newest are kept.");
    d.number("log_interval", log_interval, unit::time, interval_range,
        "Simulated time between lines on the terminal; 0 for one per frame.");
}

double Output::next_frame(double time) const {
    double next = interval > 0 ? interval * (std::floor(time / interval) + 1) : std::numeric_limits<double>::infinity();
    for (const double one : times) {
        if (one > time) next = std::min(next, one);
    }
    return next;
}

void Measurement::declare(Declaration& d) {
    declare_name(d, name, "Name of the column; by default its kind.");
    d.choice<MeasurementKind>("kind", kind,
        {{"front", MeasurementKind::front}, {"height", MeasurementKind::height}, {"flow", MeasurementKind::flow}},
        "The largest coordinate of the liquid along an axis; its height over a point, up to where half of the "
        "surroundings, a support radius wide, is liquid; or the volume flow through a plane.");
    d.required("kind");
    d.choice<int>("axis", axis, {{"x", 0}, {"y", 1}, {"z", 2}}, "Axis of the front, normal of the plane.");
    d.check(axis < 2 || !d.plane_vectors(), "axis", {"must be x or y", "the scene is plane", ""});
    d.vec3("position", position, unit::length, "The point of the height, a point of the plane.");
    d.text("liquid", liquid, "Name of the one liquid that is looked at; without it all of them.");
    d.number("interval", interval, unit::time, interval_range, "Simulated time between values; 0 for every step.");
}

void Scene::declare(Declaration& d) {
    d.integer("schema_version", schema_version, range_any(), "Version of the layout of this file.");
    d.required("schema_version");
    d.check(schema_version == 1, "schema_version",
        {"must be 1", "it is the only version that this program knows", "`treacle schema` shows its keys"});
    d.text("title", title, "One line for people.");
    d.block("domain", domain, "The region of the simulation, its sides and its resolution.");
    d.list("liquids", liquids, "The liquids.");
    d.required("liquids");
    d.check(!liquids.empty(), "liquids", {"must not be empty", "there would be nothing to simulate", "add a liquid"});
    settle_names(d, "liquids", liquids,
        [](const Liquid& liquid) { return liquid.material == "none" ? std::string("liquid") : liquid.material; });
    d.list("inlets", inlets, "Where liquid flows in.");
    settle_names(d, "inlets", inlets, [](const Inlet&) { return std::string("inlet"); });
    check_pouring(d, inlets, liquids);
    d.list("outlets", outlets, "Where liquid is taken out, besides open sides of the domain.");
    settle_names(d, "outlets", outlets, [](const Outlet&) { return std::string("outlet"); });
    d.list("bodies", bodies, "The solids besides the sides of the domain.");
    settle_names(d, "bodies", bodies, [](const Body&) { return std::string("body"); });
    d.list("joints", joints, "What links dynamic bodies to each other, to other bodies or to the world.");
    settle_names(d, "joints", joints, [](const Joint&) { return std::string("joint"); });
    check_partners(d, joints, bodies);
    d.block("time", time, "How long the run is and its steps.");
    d.block("output", output, "Frames, checkpoints and lines on the terminal.");
    d.list("cameras", cameras, "Views for `treacle render`; without one a view of the whole domain.");
    settle_names(d, "cameras", cameras, [](const Camera&) { return std::string("main"); });
    d.list("measurements", measurements, "Values that become columns of measurements.csv.");
    settle_names(d, "measurements", measurements, standard_name);
    for (const auto& one : measurements) {
        const bool known = one.liquid.empty() || std::ranges::find(liquids, one.liquid, &Liquid::name) != liquids.end();
        d.check(known, "measurements",
            {"the liquid " + one.liquid + " of " + one.name + " is not among `liquids`",
                "there would be nothing to measure", "give the name of one of them"});
    }
    d.number("max_lost_fraction", max_lost_fraction, unit::none, range_between(0, 1),
        "Share of the particles that may be lost, through walls, open sides or as values that are not finite, before "
        "the run ends with exit code 3.");
}

} // namespace treacle::scene
