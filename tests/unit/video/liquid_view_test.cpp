#include "ball_mesh.hpp"
#include "base/text/error.hpp"
#include "video/drawing/rasteriser.hpp"
#include "video/picture/vector.hpp"

#include <gtest/gtest.h>
#include <numbers>

using namespace treacle;
using namespace treacle::video;
using treacle::video::test::make_ball;

namespace {
constexpr double radius = 0.4, distance = 3, spacing = 0.05;

// Looks along +y at the origin.
View front_view() {
    View view;
    view.position = {0, -distance, 0};
    view.width = 320;
    view.height = 240;
    return view;
}

LiquidScene scene_of(const std::optional<CutPlane>& cut = {}) {
    return {front_view(), {{-1, -1, -1}, {1, 1, 1}, 3}, spacing, {-1, 1}, cut};
}

// A ball of liquid with the value z / radius.
struct LiquidBall {
    test::Ball ball = make_ball({0, 0, 0}, radius, 5);
    std::vector<double> values, positions, point_values;
    std::vector<int> liquid;
    std::vector<std::int64_t> point_liquid;

    LiquidBall() {
        for (std::size_t v = 0; v < ball.position.size() / 3; ++v) {
            values.push_back(ball.position[3 * v + 2] / radius);
            liquid.push_back(1);
        }
        const int half = int(radius / spacing) + 1;
        for (int x = -half; x <= half; ++x)
            for (int y = -half; y <= half; ++y)
                for (int z = -half; z <= half; ++z) {
                    const Vec3 p{x * spacing, y * spacing, z * spacing};
                    if (length(p) > radius) continue;
                    positions.insert(positions.end(), p.begin(), p.end());
                    point_values.push_back(p[2] / radius);
                    point_liquid.push_back(1);
                }
    }
    LiquidMesh mesh() const { return {ball.position, ball.normal, liquid, values, ball.triangles}; }
    LiquidPoints points() const { return {positions, point_liquid, point_values}; }
};

RenderRequest bare(const LiquidView& view) {
    RenderRequest request;
    request.domain = scene_of().domain;
    request.view = front_view();
    request.lighting = Lighting::flat;
    request.scenery = Scenery::none;
    request.cut = view.cut();
    request.liquid = LiquidLayer{.view = &view, .has_values = true, .title = "z", .range = {-1, 1}, .spacing = spacing};
    return request;
}

Rgb8 pixel(const Image& image, int column, int row) {
    const auto* p = image.at(column, row);
    return {p[0], p[1], p[2]};
}

// Largest difference of a colour from the map's at t.
int off_map(const Rgb8& colour, double t) {
    const auto there = colour_of(ColourMap::viridis, t);
    int most = 0;
    for (std::size_t k = 0; k < 3; ++k) most = std::max(most, std::abs(int(colour[k]) - int(there[k])));
    return most;
}
} // namespace

TEST(LiquidView, BallHasItsOutlineItsNormalsAndItsThickness) {
    const LiquidBall ball;
    LiquidView view(scene_of());
    view.add(ball.mesh());
    double area = 0;
    for (int row = 0; row < view.fine().height(); ++row)
        for (int column = 0; column < view.fine().width(); ++column)
            area += view.at(column, row).depth < far_away ? 1 : 0;
    const double half = view.fine().scale() * radius / std::sqrt(distance * distance - radius * radius);
    EXPECT_NEAR(area / (std::numbers::pi * half * half), 1, 0.003); // that of a ball of triangles
    const auto middle = view.at(320, 240);
    EXPECT_NEAR(middle.depth, distance - radius, 1e-3 * radius);
    EXPECT_NEAR(middle.thickness, 2 * radius, 2e-3 * radius);
    EXPECT_NEAR(middle.normal[2], -1, 1e-3);
    EXPECT_NEAR(middle.value, 0.5, 0.01);
    EXPECT_EQ(middle.liquid, 1);
    EXPECT_FALSE(middle.section);
}

// The nearer half is gone: a filled disc in the plane, in the colours of the particles' values.
TEST(LiquidView, CutBallIsADiscInTheFieldsColours) {
    const LiquidBall ball;
    LiquidView view(scene_of(CutPlane{{0, 0, 0}, {0, 1, 0}}));
    view.add(ball.mesh());
    view.add(ball.points());
    double area = 0;
    for (int row = 0; row < view.fine().height(); ++row)
        for (int column = 0; column < view.fine().width(); ++column) {
            const auto seen = view.at(column, row);
            if (!seen.section) continue;
            ++area;
            EXPECT_NEAR(seen.depth, distance, 1e-4);
        }
    // Behind the disc the ball's far half stays within its outline.
    const double half = view.fine().scale() * radius / distance;
    EXPECT_NEAR(area / (std::numbers::pi * half * half), 1, 0.005);

    const auto image = render_frame(bare(view));
    const Camera& camera = view.camera();
    for (const double z : {-0.8, -0.4, 0.0, 0.4, 0.8})
        for (const double x : {-0.5, 0.0, 0.5}) {
            const auto p = camera.project({radius * x, 0, radius * z});
            // A spline's mean of a linear field, near the rim of particles on one side: 6 % of the radius at most.
            if (x * x + z * z < 0.9) {
                EXPECT_LE(off_map(pixel(image, int(p.x), int(p.y)), 0.5 + 0.5 * z), 14) << x << " " << z;
            }
        }
}

// Cut behind its middle, the picture has a smaller disc; in front of it nothing is left out.
TEST(LiquidView, CutFollowsItsPlane) {
    const LiquidBall ball;
    const auto section = [&](double y) {
        LiquidView view(scene_of(CutPlane{{0, y, 0}, {0, -3, 0}}));
        view.add(ball.mesh());
        double area = 0;
        for (int row = 0; row < view.fine().height(); ++row)
            for (int column = 0; column < view.fine().width(); ++column) area += view.at(column, row).section ? 1 : 0;
        return area;
    };
    const double f = Camera(front_view()).enlarged(LiquidView::samples).scale() / (distance + 0.2);
    EXPECT_NEAR(section(0.2) / (std::numbers::pi * f * f * (radius * radius - 0.04)), 1, 0.005);
    EXPECT_EQ(section(-0.5), 0);
    EXPECT_EQ(section(0.5), 0);
}

TEST(LiquidView, PartsDrawnApartAreOnePicture) {
    const LiquidBall ball;
    for (const auto& cut : {std::optional<CutPlane>{}, std::optional<CutPlane>{{{0, 0.1, 0}, {0, 1, 1}}}}) {
        LiquidView whole(scene_of(cut)), first(scene_of(cut)), second(scene_of(cut));
        whole.add(ball.mesh());
        whole.add(ball.points());
        auto part = ball.mesh();
        part.triangles = part.triangles.first(5000);
        first.add(part);
        part.triangles = ball.mesh().triangles.subspan(5000);
        second.add(part);
        second.add(ball.points());
        first.merge(second.pack());
        for (const auto lighting : {Lighting::flat, Lighting::shaded}) {
            auto a = bare(whole), b = bare(first);
            a.lighting = b.lighting = lighting;
            EXPECT_EQ(render_frame(a).pixels, render_frame(b).pixels);
        }
    }
}

TEST(LiquidView, LiquidsWithoutValuesHaveColoursOfTheirOwn) {
    const LiquidBall ball;
    LiquidView view(scene_of());
    view.add(ball.mesh());
    auto request = bare(view);
    request.liquid->has_values = false;
    EXPECT_EQ(pixel(render_frame(request), 160, 120), colour_of_liquid(1));
    EXPECT_NE(colour_of_liquid(0), colour_of_liquid(1));
}

// In the plane: a square with a hole, its values those of the particles.
TEST(LiquidView, PlaneLiquidIsFilledBetweenItsSegments) {
    const std::vector<double> points = {
        -0.4, -0.4, 0, 0.4, -0.4, 0, 0.4, 0.4, 0, -0.4, 0.4, 0, -0.1, -0.1, 0, -0.1, 0.1, 0, 0.1, 0.1, 0, 0.1, -0.1, 0};
    const std::vector<std::array<int, 3>> segments = {
        {0, 1, -1}, {1, 2, -1}, {2, 3, -1}, {3, 0, -1}, {4, 5, -1}, {5, 6, -1}, {6, 7, -1}, {7, 4, -1}};
    const DomainBox domain{{-0.5, -0.5, 0}, {0.5, 0.5, 0}, 2};
    const auto flat = automatic_view(domain, 320, 240);
    LiquidView view({flat, domain, 0.1, {-0.4, 0.4}, {}});
    std::vector<double> positions, values;
    for (int i = -4; i < 4; ++i)
        for (int j = -4; j < 4; ++j) {
            positions.insert(positions.end(), {0.1 * i + 0.05, 0.1 * j + 0.05, 0});
            values.push_back(0.1 * i + 0.05);
        }
    view.add(LiquidMesh{points, {}, {}, {}, segments});
    view.add(LiquidPoints{positions, {}, values});
    double area = 0;
    for (int row = 0; row < view.fine().height(); ++row)
        for (int column = 0; column < view.fine().width(); ++column) area += view.at(column, row).section ? 1 : 0;
    const double scale = view.fine().scale();
    EXPECT_NEAR(area, (0.64 - 0.04) * scale * scale, 4 * 1.6 * scale); // a column or row at each side
    const auto at = [&](double x, double y) {
        const auto p = view.fine().project({x, y, 0});
        return view.at(int(p.x), int(p.y));
    };
    EXPECT_EQ(at(0, 0).depth, far_away);
    EXPECT_NEAR(at(0.2, 0.2).value, 0.75, 0.02);
    EXPECT_NEAR(at(-0.2, 0.3).value, 0.25, 0.02);
}

TEST(LiquidView, PlanesThatCannotBeSeenAreRefused) {
    EXPECT_THROW(LiquidView(scene_of(CutPlane{{0, 0, 0}, {0, 0, 0}})), InputError);
    EXPECT_THROW(LiquidView(scene_of(CutPlane{{0, 0, 0}, {1, 0, 0}})), InputError); // the camera stands in it
}

// Particles and solids are cut with the liquid: a shell of particles opens, and the solid's section fills it.
TEST(Rasteriser, CutShowsTheSectionOfSolids) {
    const LiquidBall ball;
    RenderRequest request;
    request.domain = scene_of().domain;
    request.view = front_view();
    request.lighting = Lighting::flat;
    request.scenery = Scenery::none;
    const std::vector<double> near_and_far{0, -0.5, 0, 0.5, 0.5, 0};
    request.layers = {{.positions = near_and_far, .radius = 0.1, .colour = Rgb8{200, 30, 30}}};
    request.cut = CutPlane{{0, 0, 0}, {0, 1, 0}};
    const Camera camera(front_view());
    const auto near = camera.project({0, -0.5, 0}), far = camera.project({0.5, 0.5, 0});
    const auto cut = render_frame(request);
    EXPECT_NE(pixel(cut, int(near.x), int(near.y)), (Rgb8{200, 30, 30}));
    EXPECT_EQ(pixel(cut, int(far.x), int(far.y)), (Rgb8{200, 30, 30}));
    const auto empty = pixel(cut, 160, 120);
    request.solid_distance = [](const Vec3& x) { return length(x) - radius; };
    const auto solid = render_frame(request);
    double area = 0;
    for (int row = 0; row < 240; ++row)
        for (int column = 0; column < 320; ++column)
            area += pixel(solid, column, row) != pixel(cut, column, row) ? 1 : 0;
    EXPECT_NE(pixel(solid, 160, 120), empty);
    const double half = camera.scale() * radius / distance;
    EXPECT_NEAR(area / (std::numbers::pi * half * half), 1, 0.03); // the rim's pixels are mixed
}
