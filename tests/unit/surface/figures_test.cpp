// Figures of tools/claims seeing: more cases than the suite has time for.
#include "shapes.hpp"
#include "surface/silhouette.hpp"

#include <chrono>
#include <cstdlib>
#include <ctime>
#include <gtest/gtest.h>

namespace treacle::surface::figures_test {
namespace {

using namespace test;

struct Figures {
    double volume = 0, drift = 0; // largest relative error; largest distance of the centres in spacings
    bool closed = true;
    std::int64_t components = 1;
};

Figures measure(const Cloud& cloud) {
    const auto comm = Comm::world();
    Options options;
    options.spacing = 1;
    Mesher mesher(comm, {}, options);
    const auto part = cloud.part(comm);
    const auto& mesh = mesher.build(part.rows());
    Figures out;
    out.volume = std::abs(mesher.summary().volume / cloud.count() - 1);
    const auto centre = centroid(comm, mesh), expected = cloud.centre();
    out.drift = std::hypot(centre[0] - expected[0], centre[1] - expected[1], centre[2] - expected[2]);
    out.closed = closed(comm, mesh);
    out.components = mesher.summary().components;
    return out;
}

TEST(SurfaceFigures, DISABLED_BallsFrom3To20) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> uniform(-0.5, 0.5);
    const bool quick = std::getenv("TREACLE_QUICK") != nullptr;
    double volume = 0, drift = 0;
    int cases = 0;
    for (const double radius : {3.0, 3.5, 4.0, 5.0, 6.5, 8.0, 12.0, 16.0, 20.0}) {
        if (quick && radius > 6) continue;
        for (int repeat = 0; repeat < (quick ? 1 : 4); ++repeat) {
            for (const bool two : {false, true}) {
                if (two && radius > 8) continue;
                const auto turn = random_rotation(random);
                const double apart = two ? radius : 0;
                const auto shape = [&](const Vec3& x) {
                    return std::hypot(x[0] - apart, x[1], x[2]) < radius ||
                           std::hypot(x[0] + apart, x[1], x[2]) < radius;
                };
                const auto figures = measure(fill(shape, static_cast<int>(radius + apart + 2),
                    {uniform(random), uniform(random), uniform(random)}, 0, &turn));
                EXPECT_LE(figures.volume, 0.01) << radius << (two ? " two" : "");
                EXPECT_LE(figures.drift, 0.02) << radius;
                EXPECT_TRUE(figures.closed) << radius;
                volume = std::max(volume, figures.volume);
                drift = std::max(drift, figures.drift);
                ++cases;
            }
        }
    }
    RecordProperty("cases", std::to_string(cases));
    RecordProperty("volume_error_percent", std::to_string(100 * volume));
    RecordProperty("drift_spacings", std::to_string(drift));
}

TEST(SurfaceFigures, DISABLED_SheetsAndThreads) {
    std::mt19937 random(12);
    const bool quick = std::getenv("TREACLE_QUICK") != nullptr;
    double sheets = 0, threads = 0;
    for (int repeat = 0; repeat < (quick ? 2 : 10); ++repeat) {
        const auto turn = random_rotation(random);
        const auto sheet = measure(fill([](const Vec3& x) { return x[2] == 0; }, 20, {0, 0, 0}, 0, &turn));
        const auto thread = measure(fill(
            [](const Vec3& x) { return x[0] >= 0 && x[0] < 2 && x[1] >= 0 && x[1] < 2; }, 30, {0, 0, 0}, 0, &turn));
        for (const auto& one : {sheet, thread}) {
            EXPECT_EQ(one.components, 1);
            EXPECT_TRUE(one.closed);
            EXPECT_LE(one.volume, 0.1);
        }
        sheets = std::max(sheets, sheet.volume);
        threads = std::max(threads, thread.volume);
    }
    RecordProperty("sheet_volume_error_percent", std::to_string(100 * sheets));
    RecordProperty("thread_volume_error_percent", std::to_string(100 * threads));
}

// What the choice of the surface's value does to the area of liquid in a container in the plane, and of a heap on its floor:
// relative change for a shift by 0.1 spacings either way.
TEST(SurfaceFigures, DISABLED_IsoShift) {
    const auto comm = Comm::world();
    Domain plane;
    plane.dimensions = 2;
    plane.max = {50, 100, 0};
    plane.sides[0] = plane.sides[1] = plane.sides[2] = Side::wall;
    const auto change = [&](const Shape& shape, double iso) {
        const auto cloud = fill(shape, 100, {0.5, 0.5, 0}, 0.1, nullptr, 2).part(comm);
        double area[2];
        for (const int k : {0, 1}) {
            Options options;
            options.spacing = 1;
            options.iso = k * iso;
            Mesher mesher(comm, plane, options);
            mesher.build(cloud.rows());
            area[k] = mesher.summary().volume;
        }
        return 100 * (area[1] / area[0] - 1);
    };
    const Shape container = [](const Vec3& x) { return x[0] > 0 && x[0] < 50 && x[1] > 0 && x[1] < 75; };
    const Shape heap = [](const Vec3& x) { return x[1] > 0 && std::hypot(x[0] - 25, x[1]) < 12; };
    for (const double iso : {-0.1, 0.1}) {
        const std::string which = iso < 0 ? "outwards" : "inwards";
        const double full = change(container, iso), small = change(heap, iso);
        EXPECT_NEAR(full, -100 * iso / 75, 0.03);
        EXPECT_NEAR(small, -100 * iso * 2 / 12, 0.4);
        RecordProperty("container_percent_" + which, std::to_string(full));
        RecordProperty("heap_percent_" + which, std::to_string(small));
    }
}

// Seconds of a surface and a silhouette of TREACLE_EDGE^3 particles, a block in the corner of a box, disordered.
TEST(SurfaceFigures, DISABLED_Cost) {
    const char* text = std::getenv("TREACLE_EDGE");
    const int edge = text != nullptr ? std::atoi(text) : 32;
    const double n = edge;
    const auto cloud =
        fill([=](const Vec3& x) { return x[0] > 0 && x[0] < n && x[1] > 0 && x[1] < n && x[2] > 0 && x[2] < n; }, edge,
            {0.5, 0.5, 0.5}, 0.2);
    const auto comm = Comm::world();
    const auto part = cloud.part(comm);
    Options options;
    options.spacing = 1;
    Domain domain;
    domain.max = {2 * n, n, 2 * n};
    domain.sides.fill(Side::wall);
    Mesher mesher(comm, domain, options);
    scene::Lens lens;
    lens.width = 1280;
    lens.height = 720;
    lens.fx = lens.fy = 900;
    lens.cx = 640;
    lens.cy = 360;
    scene::CameraPose pose;
    pose.translation = {-n, -n / 2, 2.5 * n};
    const scene::CameraModel camera("cost", lens, pose);
    // Wall time, and the processor's on this rank, which other work on the machine does not lengthen as much.
    double surface = 1e300, silhouette = 1e300, work = 1e300;
    using Clock = std::chrono::steady_clock;
    for (int repeat = 0; repeat < 4; ++repeat) {
        comm.barrier();
        const auto begin = Clock::now();
        const auto work_before = std::clock();
        const auto& mesh = mesher.build(part.rows());
        work = std::min(work, static_cast<double>(std::clock() - work_before) / CLOCKS_PER_SEC);
        const auto middle = Clock::now();
        EXPECT_GT(draw_silhouette(comm, mesh, camera).count(), 1000);
        const auto end = Clock::now();
        surface = std::min(surface, std::chrono::duration<double>(middle - begin).count());
        silhouette = std::min(silhouette, std::chrono::duration<double>(end - middle).count());
    }
    RecordProperty("particles", std::to_string(static_cast<std::int64_t>(cloud.id.size())));
    RecordProperty("surface_seconds", std::to_string(comm.max(surface)));
    RecordProperty("surface_processor_seconds", std::to_string(comm.max(work)));
    RecordProperty("silhouette_seconds", std::to_string(comm.max(silhouette)));
}

} // namespace
} // namespace treacle::surface::figures_test
