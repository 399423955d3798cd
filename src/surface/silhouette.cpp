#include "surface/silhouette.hpp"

#include "base/text/error.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::surface {

namespace {
constexpr double nothing = 1e300;

// The nearest depth of each pixel.
struct Drawing {
    scene::TriangleRaster raster;
    std::vector<double> depth;

    Drawing(const scene::Projection& projection, double straightness)
        : raster(projection, 1, straightness),
          depth(static_cast<std::size_t>(raster.width()) * static_cast<std::size_t>(raster.height()), nothing) {}

    void add(const scene::Seen& a, const scene::Seen& b, const scene::Seen& c) {
        raster.draw(a, b, c, [&](const scene::RasterSample& sample) {
            auto& nearest = depth[static_cast<std::size_t>(sample.row * raster.width() + sample.column)];
            nearest = std::min(nearest, sample.depth);
        });
    }
};
} // namespace

std::int64_t Silhouette::count() const { return std::count(mask.begin(), mask.end(), std::uint8_t{1}); }

Silhouette draw_silhouette(const Comm& comm, const Mesh& mesh, const scene::CameraModel& camera,
    const Exposure& exposure, const HidingTriangles* solids, double straightness) {
    if (mesh.dimensions != 3)
        throw InputError(
            {"silhouette", "the surface is two-dimensional", "a camera sees surfaces in space", "use a scene in 3D"});
    const scene::Projection projection(camera, exposure);
    Drawing drawing(projection, straightness);
    std::vector<scene::Seen> seen(static_cast<std::size_t>(mesh.size()));
    for (std::size_t v = 0; v < seen.size(); ++v) {
        seen[v] = projection.see(
            mesh.vertices.data() + 3 * v, mesh.velocity.empty() ? nullptr : mesh.velocity.data() + 3 * v);
    }
    for (const auto& t : mesh.triangles) {
        drawing.add(seen[static_cast<std::size_t>(t[0])], seen[static_cast<std::size_t>(t[1])],
            seen[static_cast<std::size_t>(t[2])]);
    }
    for (double& depth : drawing.depth) depth = -depth;
    comm.max(std::span<double>(drawing.depth));
    Silhouette out{camera.lens().width, camera.lens().height, {}, std::move(drawing.depth)};
    for (double& depth : out.depth) depth = -depth;
    if (solids != nullptr) {
        const scene::Projection at_rest(camera, {});
        Drawing before(at_rest, straightness);
        for (const auto& t : solids->triangles) {
            scene::Seen corner[3];
            for (std::size_t k = 0; k < 3; ++k)
                corner[k] = at_rest.see(solids->vertices.data() + 3 * static_cast<std::size_t>(t[k]), nullptr);
            before.add(corner[0], corner[1], corner[2]);
        }
        for (std::size_t k = 0; k < out.depth.size(); ++k) {
            if (before.depth[k] < out.depth[k]) out.depth[k] = nothing;
        }
    }
    out.mask.resize(out.depth.size());
    for (std::size_t k = 0; k < out.depth.size(); ++k) out.mask[k] = out.depth[k] < nothing ? 1 : 0;
    return out;
}

std::int64_t mismatches(const Silhouette& a, const Silhouette& b) {
    std::int64_t out = 0;
    for (std::size_t k = 0; k < a.mask.size(); ++k) out += a.mask[k] != b.mask[k] ? 1 : 0;
    return out;
}

} // namespace treacle::surface
