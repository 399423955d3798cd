#include "sample.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>

// Gears on hinges, whose teeth mesh (inputs/gears).
namespace treacle::rigid::gears_test {
namespace {

using std::numbers::pi;

// Outline of a gear of ten teeth in the plane of x and z.
std::vector<Vec3> outline() {
    constexpr std::pair<double, double> corners[] = {
        {0.085, -0.56}, {0.12, -0.3}, {0.12, 0}, {0.12, 0.3}, {0.085, 0.56}};
    std::vector<Vec3> out;
    for (int k = 0; k < 10; ++k) {
        for (const auto& [radius, fraction] : corners) {
            const double angle = 2 * pi * (k + 0.5 * fraction) / 10;
            out.push_back({radius * std::cos(angle), 0, -radius * std::sin(angle)});
        }
    }
    return out;
}

// 0.16 long, about y.
void write_gear(const std::filesystem::path& file) {
    std::ofstream out(file);
    out.precision(17);
    const auto ring = outline();
    const int n = static_cast<int>(ring.size());
    for (const double y : {-0.08, 0.08}) {
        out << "v 0 " << y << " 0\n";
        for (const auto& x : ring) out << "v " << x[0] << ' ' << y << ' ' << x[2] << '\n';
    }
    for (int k = 0; k < n; ++k) {
        const int a = 2 + k, b = 2 + (k + 1) % n, up = n + 1;
        out << "f 1 " << b << ' ' << a << "\nf " << 1 + up << ' ' << a + up << ' ' << b + up << '\n';
        out << "f " << a << ' ' << b << ' ' << b + up << "\nf " << a << ' ' << b + up << ' ' << a + up << '\n';
    }
}

// Signed distance of a point to a polygon in the plane of x and z.
double distance_to(const std::vector<Vec3>& polygon, const Vec3& x) {
    double least = 1e300;
    bool inside = false;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const Vec3 &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
        const Vec3 side = b - a;
        const double along = std::clamp(dot(x - a, side) / dot(side, side), 0.0, 1.0);
        least = std::min(least, length(x - a - along * side));
        if ((a[2] > x[2]) != (b[2] > x[2]) && x[0] < a[0] + (x[2] - a[2]) * side[0] / side[2]) inside = !inside;
    }
    return inside ? -least : least;
}

const Vec3 axles[] = {{0.2, 0, 0.66}, {0.3819, 0, 0.555}};
constexpr double angles[] = {30, -24}; // at the start [degrees]

BodiesSetup train(double spacing) {
    const auto file = std::filesystem::temp_directory_path() / "treacle_rigid_gear.obj";
    write_gear(file);
    BodiesSetup setup;
    setup.spacing = spacing;
    for (std::size_t b = 0; b < 2; ++b) {
        scene::Shape shape;
        shape.kind = scene::ShapeKind::mesh;
        shape.file = file.string();
        shape.rotation_axis = {0, 1, 0};
        shape.rotation_angle = angles[b] * pi / 180;
        shape.translation = axles[b];
        auto body = make_body(shape);
        body.probes.clear();
        for (const auto& x : scene::sample_surface(body.region.front(), {spacing, 0, {}}).positions)
            body.probes.push_back({x, 0});
        setup.bodies.push_back(body);
        JointSetup axle;
        axle.body = b;
        axle.point = axles[b];
        axle.axis = {0, 1, 0};
        axle.length_scale = 0.12;
        setup.joints.push_back(axle);
    }
    std::filesystem::remove(file);
    return setup;
}

std::vector<Vec3> moved_points(const RigidBodies& bodies, std::size_t b) {
    auto out = outline();
    const auto turn = to_matrix(bodies.pose(b).turn), first = to_matrix(rotation_by(Vec3{0, angles[b] * pi / 180, 0}));
    for (auto& x : out) x = axles[b] + turn * (first * x);
    return out;
}

// Between two gears, negative where they overlap [m].
double gap_between(const RigidBodies& bodies, std::size_t a, std::size_t b) {
    const auto one = moved_points(bodies, a), other = moved_points(bodies, b);
    double least = 1e300;
    for (const auto& x : one) least = std::min(least, distance_to(other, x));
    for (const auto& x : other) least = std::min(least, distance_to(one, x));
    return least;
}

// Both flanks of a tooth may meet the others' in turns, within a step in which they turn by more than the angle between them.
TEST(Gears, TeethThatMeshDoNotOverlap) {
    constexpr double spacing = 0.02, dt = 0.01; // [m], [s]
    RigidBodies bodies(train(spacing));
    double least = 1, most_gained = 0;
    for (int k = 0; k < std::lround(0.6 / dt); ++k) {
        std::vector<double> loads(12);
        loads[4] = 0.6;
        loads[10] = -0.2 * bodies.spin(1)[1];
        bodies.begin(dt);
        bodies.push(loads, dt);
        const double before = bodies.energy()[0];
        bodies.move(dt);
        most_gained = std::max(most_gained, bodies.energy()[0] - before);
        least = std::min(least, gap_between(bodies, 0, 1));
    }
    EXPECT_LT(bodies.spin(1)[1], -1) << "the first gear drives the second";
    // Gaps are those along straight lines, off by (turn of a step)^2 / 2 times 0.12 m: 0.004 spacings; 0.028 where only the nearest
    // of two ends of a flank counted.
    EXPECT_GT(least, -0.005 * spacing);
    EXPECT_LT(most_gained, 1e-12) << "contacts give no energy [J]";
}

} // namespace
} // namespace treacle::rigid::gears_test
