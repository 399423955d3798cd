#include "../own_folder.hpp"
#include "base/text/error.hpp"
#include "test_film.hpp"
#include "video/silhouette/silhouettes.hpp"

#include <gtest/gtest.h>

using namespace treacle;
using namespace treacle::video;
using test::TestFilm;
namespace fs = std::filesystem;

namespace {
class Silhouettes : public testing::Test {
protected:
    const test::OwnFolder own;
    const fs::path& folder = own.path();
};

struct Found {
    std::vector<FrameSilhouette> frames;
    std::vector<std::string> notes;
};

Found make(const SourceRequest& request, const SilhouetteSettings& settings) {
    const auto source = open_frames(request);
    SilhouetteMaker maker(*source, settings, [](std::int64_t, std::int64_t) {});
    Found found;
    TimedFrame frame;
    while (auto silhouette = maker.next(frame)) found.frames.push_back(std::move(*silhouette));
    found.notes = maker.notes();
    return found;
}

// Of the frames in which the liquid is large enough for a statistic.
struct Accuracy {
    double mean = 0, deviation = 0;
    std::size_t frames = 0;
};

Accuracy compare(const TestFilm& film, const Found& found) {
    Accuracy worst;
    for (std::size_t k = 0; k < found.frames.size(); ++k) {
        const auto exact = film.mask(film.times[k]);
        if (exact.area() < 4000) continue;
        const auto error = compare_contours(found.frames[k].mask, exact);
        if (std::abs(error.mean) > std::abs(worst.mean)) worst.mean = error.mean;
        worst.deviation = std::max(worst.deviation, error.deviation);
        ++worst.frames;
        if (std::getenv("SHOW") != nullptr && k % 10 == 0)
            std::printf("frame %2zu: mean %.3f by area %.3f sd %.3f max %.2f iou %.4f area %zu width %.2f faint %.0f "
                        "gain %.3f specks %d\n",
                k, error.mean, error.mean_by_area, error.deviation, error.largest, error.overlap, exact.area(),
                found.frames[k].edge_width, found.frames[k].faint, found.frames[k].gain,
                found.frames[k].cleaning.specks);
    }
    return worst;
}

TestFilm standard() {
    TestFilm film;
    film.times = test::steady_times(24, 8);
    film.look.width = 480;
    film.look.height = 270;
    return film;
}

Accuracy measure(const fs::path& folder, const TestFilm& film, const SilhouetteSettings& settings = {}) {
    film.write(folder / "a.mp4");
    SourceRequest request;
    request.clip = folder / "a.mp4";
    const auto found = make(request, settings);
    if (std::getenv("SHOW") != nullptr)
        for (const auto& note : found.notes) std::printf("%s\n", note.c_str());
    return compare(film, found);
}

void expect_accurate(const Accuracy& worst) {
    EXPECT_GT(worst.frames, 5u);
    EXPECT_LE(std::abs(worst.mean), 0.2);
    EXPECT_LE(worst.deviation, 0.5);
}
} // namespace

TEST_F(Silhouettes, DarkLiquidOnALightBackgroundIsFoundToAFifthOfAPixel) {
    expect_accurate(measure(folder, standard()));
}

TEST_F(Silhouettes, ABlurOf4PixelsDoesNotMoveTheContour) {
    auto film = standard();
    film.look.blur = 4;
    expect_accurate(measure(folder, film));
}

TEST_F(Silhouettes, LightLiquidOnADarkBackgroundWithABlurOf4Pixels) {
    auto film = standard();
    film.look.blur = 4;
    film.look.background = {0.05, 0.05, 0.06};
    film.liquid = {0.6, 0.55, 0.4};
    expect_accurate(measure(folder, film));
}

TEST_F(Silhouettes, BlurOfTheNumbersIsNoticed) {
    auto film = standard();
    film.look.blur = 4;
    film.look.blur_code = true;
    expect_accurate(measure(folder, film));
}

TEST_F(Silhouettes, ExposureThatDriftsByAFifth) {
    auto film = standard();
    film.look.exposure_drift = 0.2;
    expect_accurate(measure(folder, film));
}

TEST_F(Silhouettes, ThresholdOfABackLitFilm) {
    auto film = standard();
    film.look.background = {0.8, 0.8, 0.8};
    film.look.texture = 0.02;
    film.look.blur = 3;
    film.look.exposure_drift = 0.1;
    SilhouetteSettings settings;
    settings.method = SilhouetteMethod::threshold;
    expect_accurate(measure(folder, film, settings));
}

TEST_F(Silhouettes, DifferenceFromTheMean) {
    auto film = standard();
    film.look.blur = 2;
    film.look.exposure_drift = 0.2;
    SilhouetteSettings settings;
    settings.method = SilhouetteMethod::difference;
    expect_accurate(measure(folder, film, settings));
}

TEST_F(Silhouettes, ColourOfTheLiquid) {
    auto film = standard();
    film.liquid = {0.6, 0.05, 0.02};
    SilhouetteSettings settings;
    settings.method = SilhouetteMethod::colour;
    settings.colour = {203, 63, 39};
    settings.tolerance = 90;
    expect_accurate(measure(folder, film, settings));
}

// The mixture is frozen: liquid at rest does not fade into the background.
TEST_F(Silhouettes, LiquidAtRestFor10SecondsStaysForeground) {
    auto film = standard();
    film.begin = 2;
    film.rest = 4;
    film.times = test::steady_times(42, 3); // at rest from 4 s to 14 s
    const auto worst = measure(folder, film);
    EXPECT_GT(worst.frames, 30u);
    expect_accurate(worst);
}

TEST_F(Silhouettes, TurnedFilesGiveTheSameMasks) {
    auto film = standard();
    film.begin = 1.7;
    film.times = test::steady_times(12, 4);
    std::vector<Found> found;
    for (const int degrees : {0, 90, 180, 270}) {
        ClipOptions options;
        options.codec = ClipCodec::h264_lossless;
        options.turned = degrees;
        film.write(folder / "a.mp4", options);
        SourceRequest request;
        request.clip = folder / "a.mp4";
        found.push_back(make(request, {}));
        for (std::size_t k = 0; k < film.times.size(); ++k)
            EXPECT_EQ(found.back().frames[k].mask.pixels, found.front().frames[k].mask.pixels) << degrees;
    }
}

TEST_F(Silhouettes, VariableRateKeepsItsTimes) {
    auto film = standard();
    film.times = {0.2, 0.233, 0.29, 0.31, 0.4, 0.444, 0.52, 0.9, 1.3, 1.35, 1.61, 2, 2.5, 3.125};
    film.write(folder / "a.mp4");
    SourceRequest request;
    request.clip = folder / "a.mp4";
    const auto found = make(request, {});
    for (std::size_t k = 0; k < film.times.size(); ++k) EXPECT_NEAR(found.frames[k].time, film.times[k], 1e-4);
    const auto start = find_motion_start(found.frames);
    ASSERT_TRUE(start);
    EXPECT_EQ(start->frame, 8);
    EXPECT_LE(std::abs(start->time - film.begin), start->uncertainty);
}

TEST_F(Silhouettes, SoftShadowIsNoLiquid) {
    auto film = standard();
    film.look.shadow = 0.4;
    SilhouetteSettings settings;
    settings.shadow_ratio = 0.45;
    const auto worst = measure(folder, film, settings);
    EXPECT_LE(std::abs(worst.mean), 0.3);
    EXPECT_LE(worst.deviation, 0.6);
}

TEST_F(Silhouettes, HandsAndRegionsAreExcluded) {
    auto film = standard();
    film.times = test::steady_times(20, 8);
    film.write(folder / "a.mp4");
    SourceRequest request;
    request.clip = folder / "a.mp4";
    SilhouetteSettings settings;
    settings.exclusions.push_back({"hand", "0:18", "0,0 220,0 220,269 0,269", ""});
    const auto found = make(request, settings);
    const auto exact = film.mask(film.times[18]);
    const auto &with = found.frames[18].mask, &without = found.frames[19].mask;
    EXPECT_EQ(with.at(200, 135), mask_excluded);
    EXPECT_EQ(without.at(200, 135), mask_liquid);
    for (int x = 225; x < 480; ++x) EXPECT_EQ(with.liquid(x, 135), exact.liquid(x, 135)) << x;
    settings.exclusions[0].polygon = "0,0 10,10";
    EXPECT_THROW(make(request, settings), InputError);
}

// A film whose camera jumps aside by (2.3, -1.6) pixels half way.
TEST_F(Silhouettes, SmallShiftsOfTheCameraAreTakenOutAndLargeOnesRefused) {
    auto film = standard();
    film.look.texture = 0.4;
    for (const double size : {1.0, 30.0}) {
        {
            ClipOptions options;
            options.width = film.look.width;
            options.height = film.look.height;
            ClipWriter writer(folder / "a.mp4", options);
            auto moved = film.look;
            moved.shake = {2.3 * size, -1.6 * size};
            const FilmPainter still(film.look), aside(moved);
            auto shifted = film;
            for (std::size_t k = 0; k < film.times.size(); ++k) {
                FilmLight light;
                const bool late = k >= 16;
                for (int y = 0; y < film.look.height; ++y)
                    for (int x = 0; x < film.look.width; ++x) {
                        const double d = film.distance(
                            x + (late ? moved.shake[0] : 0), y + (late ? moved.shake[1] : 0), film.times[k]);
                        light.coverage.push_back(float(std::clamp(0.5 - d, 0.0, 1.0)));
                        for (const double c : film.liquid) light.liquid.push_back(float(c));
                    }
                writer.add((late ? aside : still).paint(light, 0, k), film.times[k]);
            }
            writer.finish();
        }
        SourceRequest request;
        request.clip = folder / "a.mp4";
        if (size > 1) {
            EXPECT_THROW(make(request, {}), InputError);
            continue;
        }
        const auto found = make(request, {});
        EXPECT_NEAR(found.frames[20].shift.x, -2.3, 0.05);
        EXPECT_NEAR(found.frames[20].shift.y, 1.6, 0.05);
        expect_accurate(compare(film, found));
    }
}

TEST_F(Silhouettes, ReadyMasksPassUnchanged) {
    auto film = standard();
    film.times = test::steady_times(6, 2);
    for (std::size_t k = 0; k < 6; ++k) {
        auto mask = film.mask(film.times[k]);
        mask.pixels[5] = mask_liquid;                                      // a speck and a hole stay
        for (auto& value : mask.pixels) value = std::uint8_t(255 - value); // black liquid
        write_mask(folder / ("m_" + std::to_string(k) + ".png"), mask);
    }
    SourceRequest request;
    request.clip = folder / "m_%d.png";
    request.rate = 2;
    SilhouetteSettings settings;
    settings.method = SilhouetteMethod::masks;
    const auto found = make(request, settings);
    for (std::size_t k = 0; k < 6; ++k) {
        auto exact = film.mask(film.times[k]);
        exact.pixels[5] = mask_liquid;
        EXPECT_EQ(found.frames[k].mask.pixels, exact.pixels) << k;
    }
}

TEST(ContourError, OfADiscThatIsTooLargeByAKnownAmount) {
    const auto disc = [](double radius) {
        Mask mask{200, 200, std::vector<std::uint8_t>(40000)};
        for (int y = 0; y < 200; ++y)
            for (int x = 0; x < 200; ++x)
                mask.pixels[std::size_t(200 * y + x)] =
                    std::hypot(x - 100.3, y - 99.6) < radius ? mask_liquid : mask_background;
        return mask;
    };
    const auto same = compare_contours(disc(60), disc(60));
    EXPECT_DOUBLE_EQ(same.mean, 0);
    EXPECT_DOUBLE_EQ(same.deviation, 0);
    EXPECT_DOUBLE_EQ(same.overlap, 1);
    for (const double excess : {-1.0, -0.3, 0.3, 1.0}) {
        const auto error = compare_contours(disc(60 + excess), disc(60));
        EXPECT_NEAR(error.mean, excess, 0.12 * std::abs(excess) + 0.02);
        EXPECT_NEAR(error.mean_by_area, excess, 0.12 * std::abs(excess) + 0.02);
    }
}

TEST(Cleaning, DropsSpecksFillsHolesAndKeepsWhatTouchesTheStart) {
    auto mask = draw_polygon("10,10 60,10 60,60 10,60", 100, 80, "test");
    for (int y = 30; y < 40; ++y)
        for (int x = 30; x < 40; ++x) mask.pixels[std::size_t(100 * y + x)] = mask_background; // a hole
    for (int y = 70; y < 75; ++y)
        for (int x = 80; x < 85; ++x) mask.pixels[std::size_t(100 * y + x)] = mask_liquid; // a speck of 25
    for (int y = 10; y < 30; ++y)
        for (int x = 75; x < 95; ++x) mask.pixels[std::size_t(100 * y + x)] = mask_liquid; // a part of 400
    SilhouetteSettings settings;
    settings.closing = settings.opening = 0;
    auto all = mask;
    auto report = clean_mask(all, settings, {});
    EXPECT_EQ(report.filled, 100u);
    EXPECT_EQ(report.specks, 1);
    EXPECT_EQ(report.dropped, 25u);
    EXPECT_EQ(report.parts, 2);
    settings.keep = KeptParts::connected;
    settings.fill_holes = false;
    report = clean_mask(mask, settings, draw_polygon("0,0 20,0 20,20", 100, 80, "test"));
    EXPECT_EQ(report.parts, 1);
    EXPECT_EQ(report.dropped, 425u);
    EXPECT_FALSE(mask.liquid(35, 35));
}
