#include "surface/mesh/mirror.hpp"

#include <cmath>
#include <utility>

namespace treacle::surface {

void add_image(std::vector<double>& rows, std::size_t axis, double twice_position) {
    const auto size = rows.size();
    add_image(rows);
    for (auto i = size + axis; i < rows.size(); i += 3) rows[i] = twice_position - rows[i];
}

void add_images(Mesh& mesh, const std::vector<scene::MirrorPlane>& planes) {
    for (const auto& plane : planes) {
        const int vertices = int(mesh.size());
        add_image(mesh.vertices, plane.axis, 2 * plane.position);
        add_image(mesh.normals, plane.axis, 0);
        add_image(mesh.velocity, plane.axis, 0);
        add_image(mesh.pressure);
        add_image(mesh.liquid);
        for (auto& values : mesh.scalars) add_image(values);
        const auto count = mesh.triangles.size();
        add_image(mesh.triangles);
        for (auto i = count; i < mesh.triangles.size(); ++i) {
            auto& triangle = mesh.triangles[i];
            for (int k = 0; k < mesh.dimensions; ++k) triangle[std::size_t(k)] += vertices;
            std::swap(triangle[0], triangle[1]); // seen from the other side
        }
    }
}

Vec3 folded(Vec3 x, const scene::Domain& domain) {
    for (std::size_t k = 0; k < 3; ++k) {
        if (domain.faces[2 * k].mirror) x[k] = domain.min[k] + std::abs(x[k] - domain.min[k]);
        if (domain.faces[2 * k + 1].mirror) x[k] = domain.max[k] - std::abs(x[k] - domain.max[k]);
    }
    return x;
}

} // namespace treacle::surface
