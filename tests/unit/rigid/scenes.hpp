#pragma once
#include "sample.hpp"

#include <filesystem>
#include <fstream>
#include <functional>

// Floors of all kinds, level and tilted.
namespace treacle::rigid {

// Scenes are made level, their up direction the last axis, and turned as a whole by an angle about y, in the plane about z.
struct Tilt {
    int dimensions = 3;
    double angle = 0;

    std::size_t up() const { return static_cast<std::size_t>(dimensions - 1); }
    Vec3 axis() const { return dimensions == 2 ? Vec3{0, 0, -1} : Vec3{0, 1, 0}; } // positive: x points down
    Vec3 turned(const Vec3& v) const { return to_matrix(rotation_by(angle * axis())) * v; }
    Vec3 along() const { return turned({1, 0, 0}); }
    Vec3 upwards() const {
        Vec3 v{0, 0, 0};
        v[up()] = 1;
        return turned(v);
    }
    // The box from x0 to x1 and from h0 to h1 upwards, 0.4 wide.
    scene::Shape box(double x0, double x1, double h0, double h1) const {
        Vec3 centre{0.5 * (x0 + x1), 0, 0}, half{0.5 * (x1 - x0), 0.2, 0.2};
        centre[up()] = 0.5 * (h0 + h1);
        half[up()] = 0.5 * (h1 - h0);
        if (dimensions == 2) half[2] = 1;
        centre = turned(centre);
        auto shape = rigid::box(centre - half, centre + half);
        shape.centre = centre;
        shape.rotation_axis = axis();
        shape.rotation_angle = angle;
        return shape;
    }
    scene::Shape plane() const {
        scene::Shape shape;
        shape.kind = scene::ShapeKind::plane;
        shape.axis = upwards();
        return shape;
    }
};

inline BodySetup make_static(const scene::Shape& shape, int dimensions) {
    BodySetup out;
    out.kind = scene::BodyKind::fixed;
    const scene::SolidRegion region(shape, dimensions);
    out.region = {region};
    const double far = 2;
    scene::SurfaceSampling sampling{0.05, 0, {}};
    if (!region.closed())
        sampling.clip = {{-far, -far, -far}, {far, far, far}};
    else
        out.centre = region.moments().centre;
    for (const auto& x : scene::sample_surface(region, sampling).positions) out.probes.push_back({x, 0});
    for (const auto& probe : out.probes)
        out.bounding_radius = std::max(out.bounding_radius, length(probe.point - out.centre));
    return out;
}

// A slab of n x m squares of two triangles each on top and bottom, from -1 to 2 along x, 0.1 thick, 0.4 wide.
inline scene::Shape mesh_slab(const std::filesystem::path& file, const Tilt& tilt, int n, int m) {
    std::ofstream out(file);
    out.precision(17);
    for (const double height : {0.0, -0.1}) {
        for (int j = 0; j <= m; ++j) {
            for (int i = 0; i <= n; ++i) {
                const Vec3 x = tilt.turned({-1 + 3.0 * i / n, -0.2 + 0.4 * j / m, height});
                out << "v " << x[0] << ' ' << x[1] << ' ' << x[2] << '\n';
            }
        }
    }
    const int lower = (n + 1) * (m + 1);
    const auto square = [&](int a, int b, int c, int d) {
        out << "f " << a << ' ' << b << ' ' << c << '\n' << "f " << a << ' ' << c << ' ' << d << '\n';
    };
    const auto at = [&](int i, int j) { return 1 + i + (n + 1) * j; };
    for (int j = 0; j < m; ++j) {
        for (int i = 0; i < n; ++i) {
            const int a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
            square(a, b, c, d);
            square(lower + a, lower + d, lower + c, lower + b);
        }
    }
    for (int i = 0; i < n; ++i) {
        square(lower + at(i, 0), lower + at(i + 1, 0), at(i + 1, 0), at(i, 0));
        square(at(i, m), at(i + 1, m), lower + at(i + 1, m), lower + at(i, m));
    }
    for (int j = 0; j < m; ++j) {
        square(at(0, j), at(0, j + 1), lower + at(0, j + 1), lower + at(0, j));
        square(lower + at(n, j), lower + at(n, j + 1), at(n, j + 1), at(n, j));
    }
    out.close();
    scene::Shape shape;
    shape.kind = scene::ShapeKind::mesh;
    shape.file = file.string();
    return shape;
}

struct Floor {
    std::string name;
    std::vector<BodySetup> parts;
};

// A plane; a box; six boxes side by side; a mesh of many triangles. Their top is at 0, from -1 to 2.
inline std::vector<Floor> floors(const Tilt& tilt) {
    const auto part = [&](const scene::Shape& shape) { return make_static(shape, tilt.dimensions); };
    std::vector<Floor> out{{"plane", {part(tilt.plane())}}, {"box", {part(tilt.box(-1, 2, -0.2, 0))}}, {"seams", {}}};
    for (int k = 0; k < 6; ++k) out[2].parts.push_back(part(tilt.box(-1 + 0.5 * k, -0.5 + 0.5 * k, -0.2, 0)));
    if (tilt.dimensions == 3) {
        const auto file = std::filesystem::temp_directory_path() / "treacle_rigid_slab.obj";
        out.push_back({"mesh", {part(mesh_slab(file, tilt, 37, 5))}});
        std::filesystem::remove(file);
    }
    return out;
}

} // namespace treacle::rigid
