#include "base/text/error.hpp"
#include "video/drawing/rasteriser.hpp"
#include "video/picture/vector.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>

using namespace treacle;
using namespace treacle::video;

namespace {
constexpr Rgb8 red{200, 30, 30}, blue{30, 30, 200};

// Looks along +y at the origin from `distance` [m].
View front_view(double distance) {
    View view;
    view.position = {0, -distance, 0};
    view.width = 320;
    view.height = 240;
    return view;
}

RenderRequest bare(const View& view) {
    RenderRequest request;
    request.domain = {{-1, -1, -1}, {1, 1, 1}, 3};
    request.view = view;
    request.lighting = Lighting::flat;
    request.scenery = Scenery::none;
    return request;
}

Rgb8 pixel(const Image& image, int column, int row) {
    const auto* p = image.at(column, row);
    return {p[0], p[1], p[2]};
}

struct Blob {
    double area = 0, x = 0, y = 0; // [pixels]
};

// Area and centre of what is more red than the background.
Blob measure(const Image& image) {
    Blob blob;
    for (int row = 0; row < image.height; ++row)
        for (int column = 0; column < image.width; ++column)
            if (image.at(column, row)[1] < 140) {
                ++blob.area;
                blob.x += column + 0.5;
                blob.y += row + 0.5;
            }
    blob.x /= blob.area;
    blob.y /= blob.area;
    return blob;
}

int differences(const Image& a, const Image& b, int from_column, int to_column) {
    int count = 0;
    for (int row = 0; row < a.height; ++row)
        for (int column = from_column; column < to_column; ++column)
            if (pixel(a, column, row) != pixel(b, column, row)) ++count;
    return count;
}

ParticleLayer red_ball(const std::vector<double>& positions, double radius) {
    return {.positions = positions, .radius = radius, .colour = red};
}
} // namespace

TEST(View, AutomaticViewsSeeTheWholeDomain) {
    const DomainBox boxes[] = {{{0, 0, 0}, {1, 1, 1}, 3}, {{-3, 2, 0}, {5, 2.5, 1}, 3}, {{0, 0, -9}, {0.1, 0.1, 0}, 3},
        {{0, 0, 0}, {4, 1, 0}, 2}, {{-1, 5, 0}, {0, 9, 0}, 2}};
    for (const auto& box : boxes)
        for (const auto& [width, height] : {std::pair{1280, 720}, {480, 640}}) {
            const Camera camera(automatic_view(box, width, height));
            for (int i = 0; i < 8; ++i) {
                const Vec3 corner{(i & 1) ? box.max[0] : box.min[0], (i & 2) ? box.max[1] : box.min[1],
                    (i & 4) ? box.max[2] : box.min[2]};
                const auto p = camera.project(corner);
                EXPECT_GT(p.depth, 0);
                EXPECT_GT(p.x, 0);
                EXPECT_LT(p.x, width);
                EXPECT_GT(p.y, 0);
                EXPECT_LT(p.y, height);
            }
        }
}

TEST(View, AutomaticViewsKeepUpwardsUp) {
    const Camera space(automatic_view({{0, 0, 0}, {1, 1, 1}, 3}, 640, 480));
    EXPECT_LT(space.project({0.5, 0.5, 1}).y, space.project({0.5, 0.5, 0}).y);
    EXPECT_LT(space.project({0, 0, 0}).x, space.project({1, 0, 0}).x);
    const Camera plane(automatic_view({{0, 0, 0}, {1, 1, 0}, 2}, 640, 480));
    EXPECT_LT(plane.project({0.5, 1, 0}).y, plane.project({0.5, 0, 0}).y);
    EXPECT_LT(plane.project({0, 0, 0}).x, plane.project({1, 0, 0}).x);
}

TEST(View, ImpossibleViewsAreRefused) {
    EXPECT_THROW(automatic_view({{0, 0, 0}, {1, 0, 1}, 3}, 640, 480), InputError);
    EXPECT_THROW(automatic_view({{0, 0, 0}, {1, 1, 1}, 3}, 0, 480), InputError);
    View view = front_view(1);
    view.target = view.position;
    EXPECT_THROW(Camera{view}, InputError);
    view = front_view(1);
    view.up = {0, 2, 0};
    EXPECT_THROW(Camera{view}, InputError);
    view = front_view(1);
    view.vertical_field_of_view = 4;
    EXPECT_THROW(Camera{view}, InputError);
    view = front_view(std::numeric_limits<double>::quiet_NaN());
    EXPECT_THROW(Camera{view}, InputError);
}

TEST(Rasteriser, BallHasThePlaceAndTheSizeOfItsPerspectiveImage) {
    const double distance = 3, radius = 0.4;
    const View view = front_view(distance);
    auto request = bare(view);
    const std::vector<double> centre{0, 0, 0};
    request.layers = {red_ball(centre, radius)};
    const Blob blob = measure(render_frame(request));
    const double f = Camera(view).scale();
    const double expected = f * radius / std::sqrt(distance * distance - radius * radius);
    EXPECT_NEAR(std::sqrt(blob.area / std::numbers::pi), expected, 1); // one pixel: the edge is averaged
    EXPECT_NEAR(blob.x, 160, 0.5);
    EXPECT_NEAR(blob.y, 120, 0.5);
}

TEST(Rasteriser, BallBesideTheAxisLiesAtItsProjection) {
    const View view = front_view(3);
    auto request = bare(view);
    const std::vector<double> centre{0.8, 0.3, 0.5};
    request.layers = {red_ball(centre, 0.05)};
    const Blob blob = measure(render_frame(request));
    const auto expected = Camera(view).project({0.8, 0.3, 0.5});
    EXPECT_NEAR(blob.x, expected.x, 1); // the ellipse of a small ball is off its centre by less than a pixel
    EXPECT_NEAR(blob.y, expected.y, 1);
    EXPECT_GT(blob.x, 160);
    EXPECT_LT(blob.y, 120);
}

TEST(Rasteriser, OrthographicBallHasItsRadiusAtAnyDepth) {
    View view = front_view(3);
    view.projection = Projection::orthographic;
    const double scale = Camera(view).scale();
    for (const double y : {-1.0, 0.0, 4.0}) {
        auto request = bare(view);
        const std::vector<double> centre{0.2, y, 0};
        request.layers = {red_ball(centre, 0.3)};
        const Blob blob = measure(render_frame(request));
        EXPECT_NEAR(std::sqrt(blob.area / std::numbers::pi), 0.3 * scale, 1);
        EXPECT_NEAR(blob.x, 160 + 0.2 * scale, 0.5);
    }
}

TEST(Rasteriser, TinyDistantBallsKeepTheirShape) {
    // A ball of 6 pixels seen from 2000 radii: the discriminant of the usual formula has no digits left.
    View view = front_view(100);
    view.vertical_field_of_view = 0.02;
    auto request = bare(view);
    const std::vector<double> centre{0.4, 0, 0.3};
    request.layers = {red_ball(centre, 0.05)};
    const Blob blob = measure(render_frame(request));
    EXPECT_NEAR(std::sqrt(blob.area / std::numbers::pi), Camera(view).scale() * 0.05 / 100, 0.5);
}

TEST(Rasteriser, NearerParticleHidesTheFartherInAnyOrder) {
    const std::vector<double> near{0, -0.5, 0}, far{0, 0.5, 0};
    for (const bool near_first : {true, false}) {
        auto request = bare(front_view(3));
        const ParticleLayer a{.positions = near, .radius = 0.2, .colour = red};
        const ParticleLayer b{.positions = far, .radius = 0.2, .colour = blue};
        request.layers = near_first ? std::vector{a, b} : std::vector{b, a};
        EXPECT_EQ(pixel(render_frame(request), 160, 120), red);
    }
    auto request = bare(front_view(3));
    const std::vector<double> both{0, 0.5, 0, 0, -0.5, 0}, values{0, 1};
    request.layers = {{.positions = both, .radius = 0.2, .values = values, .range = ValueRange{0, 1}}};
    EXPECT_EQ(pixel(render_frame(request), 160, 120), colour_of(ColourMap::viridis, 1));
}

TEST(Rasteriser, TranslucentLayersLetTheOthersShineThrough) {
    const std::vector<double> near{0, -0.5, 0}, far{0, 0.5, 0};
    auto request = bare(front_view(3));
    request.layers = {{.positions = near, .radius = 0.2, .colour = red, .opacity = 0.5},
        {.positions = far, .radius = 0.2, .colour = blue}};
    const auto seen = pixel(render_frame(request), 160, 120);
    EXPECT_GT(seen[0], blue[0]);
    EXPECT_LT(seen[0], red[0]);
    EXPECT_GT(seen[2], red[2]);
    EXPECT_LT(seen[2], blue[2]);
}

TEST(Rasteriser, ColourOfAValueIsTheMaps) {
    const std::vector<double> positions{-0.5, 0, 0, 0.5, 0, 0}, values{-2, 6};
    for (const auto map : {ColourMap::viridis, ColourMap::diverging}) {
        auto request = bare(front_view(3));
        request.layers = {
            {.positions = positions, .radius = 0.2, .values = values, .map = map, .range = ValueRange{-2, 6}}};
        const auto image = render_frame(request);
        const Camera camera(*request.view);
        const auto low = camera.project({-0.5, 0, 0}), high = camera.project({0.5, 0, 0});
        EXPECT_EQ(pixel(image, int(low.x), int(low.y)), colour_of(map, 0));
        EXPECT_EQ(pixel(image, int(high.x), int(high.y)), colour_of(map, 1));
    }
}

TEST(Rasteriser, ColourBarStandsAtTheRightWhenThereAreValues) {
    auto request = bare(front_view(3));
    const std::vector<double> positions{0, 0, 0}, values{1};
    request.layers = {{.positions = positions, .radius = 0.2, .title = "speed [m/s]", .range = ValueRange{0, 2}}};
    const auto without = render_frame(request);
    request.layers[0].values = values;
    const auto with = render_frame(request);
    EXPECT_GT(differences(without, with, 280, 320), 500); // the bar alone has 6 x 100 pixels at this size
    const int column = 320 - 92 / 3 + 3;                  // inside the bar
    // The bar's 100 rows take the map at their middles.
    EXPECT_EQ(pixel(with, column, 120 + 49), colour_of(ColourMap::viridis, 0.005));
    EXPECT_EQ(pixel(with, column, 120 - 50), colour_of(ColourMap::viridis, 0.995));
}

TEST(Rasteriser, CaptionStandsAtTheBottomLeft) {
    auto request = bare(front_view(3));
    const auto without = render_frame(request);
    request.caption = caption_of("dam", 0.5, 12345);
    EXPECT_EQ(request.caption, "dam    t = 0.500 s    12 345 particles");
    const auto with = render_frame(request);
    EXPECT_GT(differences(without, with, 0, 160), 50);
    EXPECT_EQ(differences(without, with, 250, 320), 0);
}

TEST(Rasteriser, WallsBetweenCameraAndInsideAreLeftOut) {
    auto request = bare(front_view(6));
    const std::vector<double> front{0, -1.05, 0}, back{0, 1.05, 0};
    const auto empty = render_frame(request);
    request.layers = {{.kind = LayerKind::wall, .positions = front, .radius = 0.1, .colour = red}};
    EXPECT_EQ(render_frame(request).pixels, empty.pixels);
    request.layers[0].positions = back;
    EXPECT_NE(render_frame(request).pixels, empty.pixels);
}

TEST(Rasteriser, NoParticlesAreAnEmptyDomain) {
    for (const int dimensions : {2, 3}) {
        RenderRequest request;
        request.domain.dimensions = dimensions;
        request.view = automatic_view(request.domain, 160, 90);
        const std::vector<double> none;
        request.layers = {{.positions = none, .radius = 0.05, .title = "speed [m/s]"}};
        const auto image = render_frame(request);
        EXPECT_EQ(image.pixels.size(), 3u * 160 * 90);
        const LiquidView view({*request.view, request.domain, 0.1, {}, {}});
        request.liquid = LiquidLayer{.view = &view, .spacing = 0.1};
        EXPECT_EQ(render_frame(request).pixels, image.pixels);
    }
}

TEST(Rasteriser, ParticlesBehindTheCameraAreNotSeen) {
    auto request = bare(front_view(3));
    const auto empty = render_frame(request);
    const std::vector<double> behind{0, -4, 0, 0, -3, 0, 0.1, -3.01, 0};
    request.layers = {red_ball(behind, 0.2)};
    EXPECT_EQ(render_frame(request).pixels, empty.pixels);
}

TEST(Rasteriser, TheSameRequestGivesTheSameBytes) {
    std::vector<double> positions, values;
    for (int k = 0; k < 600; ++k) {
        positions.insert(positions.end(), {0.1 * (k % 10), 0.1 * (k / 10 % 10), 0.1 * (k / 100)});
        values.push_back(k);
    }
    RenderRequest request;
    request.view = automatic_view(request.domain, 320, 180);
    request.layers = {{.positions = positions, .radius = 0.05, .values = values, .title = "id"}};
    EXPECT_EQ(render_frame(request).pixels, render_frame(request).pixels);
}

TEST(Rasteriser, LampLightsTheTopMoreThanTheBottom) {
    auto request = bare(front_view(3));
    request.lighting = Lighting::shaded;
    const std::vector<double> centre{0, 0, 0};
    request.layers = {red_ball(centre, 0.4)};
    const auto image = render_frame(request);
    EXPECT_GT(pixel(image, 160, 95)[0], pixel(image, 160, 145)[0] + 20);
}

TEST(Rasteriser, PositionsThatAreNotFiniteAreRefused) {
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        auto request = bare(front_view(3));
        const std::vector<double> positions{0, 0, 0, 0, bad, 0};
        request.layers = {red_ball(positions, 0.1)};
        try {
            render_frame(request);
            FAIL() << "drawn";
        } catch (const SimulationError& error) {
            EXPECT_NE(std::string(error.what()).find("particle 1"), std::string::npos) << error.what();
        }
    }
}

TEST(Rasteriser, LayersThatDoNotFitTogetherAreRefused) {
    const std::vector<double> positions{0, 0, 0, 1, 0, 0}, five{0, 0, 0, 1, 0}, one{1}, two{1, 2};
    const std::vector<double> bad{1, std::numeric_limits<double>::infinity()};
    const auto draw = [](const ParticleLayer& layer) {
        auto request = bare(front_view(3));
        request.layers = {layer};
        return render_frame(request);
    };
    EXPECT_THROW(draw({.positions = five, .radius = 0.1}), InputError);
    EXPECT_THROW(draw({.positions = positions, .radius = 0.1, .values = one}), InputError);
    EXPECT_THROW(draw({.positions = positions, .radius = 0}), InputError);
    EXPECT_THROW(draw({.positions = positions, .radius = 0.1, .opacity = 0}), InputError);
    EXPECT_THROW(draw({.positions = positions, .radius = 0.1, .values = two, .range = ValueRange{1, 1}}), InputError);
    EXPECT_THROW(draw({.positions = positions, .radius = 0.1, .values = bad}), SimulationError);
    EXPECT_NO_THROW(draw({.positions = positions, .radius = 0.1, .values = two}));
}

// A lens without distortion and with its centre in the middle is a pinhole.
TEST(LensRendering, UndistortedLensDrawsAsAPinhole) {
    View pinhole = front_view(4);
    View measured = pinhole;
    const double f = 120 / std::tan(0.5 * pinhole.vertical_field_of_view);
    // Looks along +y: x right, z up.
    measured.model = scene::CameraModel(
        "c", {320, 240, f, f, 159.5, 119.5, {}}, {{Vec3{1, 0, 0}, Vec3{0, 0, -1}, Vec3{0, 1, 0}}, {0, 0, 4}});
    const std::vector<double> balls{0, 0, 0, 0.9, 0.3, -0.5, -0.8, -0.2, 0.6};
    auto a = bare(pinhole), b = bare(measured);
    a.layers = b.layers = {{.positions = balls, .radius = 0.3, .colour = red}};
    EXPECT_LE(differences(render_frame(a), render_frame(b), 0, 320), 12); // round-off at edges
}

// Area and centre of a ball through a distorted lens against its outline, projected point by point.
TEST(LensRendering, BallsHaveTheOutlineThatTheLensMakes) {
    const scene::CameraModel lens("c", {320, 240, 280, 284, 165, 116, {-0.3, 0.1, 0.002, -0.001, 0, 0, 0, 0}},
        {{Vec3{1, 0, 0}, Vec3{0, 0, -1}, Vec3{0, 1, 0}}, {0, 0, 4}});
    View view = front_view(4);
    view.model = lens;
    const double radius = 0.35;
    for (const Vec3& centre : {Vec3{0, 0, 0}, Vec3{1.7, 0, 1.1}, Vec3{-1.8, 0.3, -1.2}}) {
        auto request = bare(view);
        const std::vector<double> position(centre.begin(), centre.end());
        request.layers = {{.positions = position, .radius = radius, .colour = red}};
        const Blob blob = measure(render_frame(request));
        // The outline: where rays from the camera touch the ball.
        const Vec3 c = lens.to_camera(centre);
        const double d = std::sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]), along = (d * d - radius * radius) / d;
        const double across = radius * std::sqrt(1 - radius * radius / (d * d));
        const Vec3 axis = normalised(c), u = normalised(cross(axis, Vec3{0, 1, 0})), v = cross(axis, u);
        double area = 0;
        constexpr int n = 2000;
        const auto at = [&](int k) {
            const double angle = 2 * std::numbers::pi * k / n;
            return lens.project_camera(along * axis + (across * std::cos(angle)) * u + (across * std::sin(angle)) * v);
        };
        for (int k = 0; k < n; ++k) {
            const auto p = at(k), q = at(k + 1);
            area += 0.5 * (p.x * q.y - q.x * p.y);
        }
        EXPECT_NEAR(blob.area, std::abs(area), 0.02 * std::abs(area)) << centre[0];
    }
}

TEST(LensRendering, PicturesOfAnotherShapeAreRefused) {
    View view = front_view(4);
    view.model = scene::CameraModel("c", {320, 240, 280, 284, 165, 116, {}}, {});
    view.width = 240;
    view.height = 320;
    EXPECT_THROW(render_frame(bare(view)), InputError);
}
