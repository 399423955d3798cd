#include "../surface/shapes.hpp"
#include "surface/silhouette.hpp"
#include "video/film/film_raster.hpp"

#include <gtest/gtest.h>

namespace treacle {
namespace {

scene::CameraModel camera() {
    scene::Lens lens;
    lens.width = 320;
    lens.height = 240;
    lens.fx = 300;
    lens.fy = 305;
    lens.cx = 161.3;
    lens.cy = 116.8;
    lens.distortion = {-0.15, 0.015, 1e-3, -5e-4, 0, 0, 0, 0};
    scene::CameraPose pose;
    pose.rotation = scene::rotation_matrix({0.2, -0.3, 0.1});
    pose.translation = {0.5, -0.3, 24};
    return {"test", lens, pose};
}

// The mask of a search and the true mask of a film are equal: with a bent lens, motion and a rolling shutter.
TEST(FilmMask, IsTheSilhouetteBitForBit) {
    surface::Options options;
    options.spacing = 1;
    const auto cloud = surface::test::fill(
        [](const Vec3& x) { return std::hypot(x[0] - 2, x[1], x[2]) < 4 || std::hypot(x[0] + 5, x[1] - 1, x[2]) < 3; },
        9, {0.2, 0.3, 0.1});
    surface::Mesher mesher(Comm::self(), {}, options);
    const auto& mesh = mesher.build(cloud.rows());
    const auto seen_by = camera();
    video::FilmShot shot;
    shot.offset = 0.02;
    shot.readout = 0.05;
    const auto film =
        video::draw_liquid({3, mesh.vertices, mesh.normals, mesh.velocity, mesh.triangles}, seen_by, shot, {});
    const auto silhouette =
        surface::draw_silhouette(Comm::self(), mesh, seen_by, {shot.offset, shot.readout / (240 - 1)});
    ASSERT_GT(silhouette.count(), 5000);
    std::int64_t differ = 0;
    for (std::size_t i = 0; i < silhouette.mask.size(); ++i)
        differ += (film.mask.pixels[i] == video::mask_liquid) != (silhouette.mask[i] == 1) ? 1 : 0;
    EXPECT_EQ(differ, 0);
    shot.readout = 0;
    const auto other =
        video::draw_liquid({3, mesh.vertices, mesh.normals, mesh.velocity, mesh.triangles}, seen_by, shot, {});
    EXPECT_NE(other.mask.pixels, film.mask.pixels); // the shutter does something here
}

} // namespace
} // namespace treacle
