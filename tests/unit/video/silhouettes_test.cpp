#include "../own_folder.hpp"
#include "test_film.hpp"
#include "video/silhouettes.hpp"

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
    std::vector<Silhouette> frames;
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
            std::printf("frame %zu: mean %.3f by area %.3f sd %.3f max %.2f iou %.4f area %zu width %.2f faint %.0f gain %.3f specks %d\n", k, error.mean,
                        error.mean_by_area, error.deviation, error.largest, error.overlap, exact.area(), found.frames[k].edge_width, found.frames[k].faint,
                        found.frames[k].gain, found.frames[k].cleaning.specks);
    }
    return worst;
}

TestFilm standard() {
    TestFilm film;
    film.times = test::steady_times(40, 10);
    film.look.width = 640;
    film.look.height = 360;
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

TEST_F(Silhouettes, DarkLiquidOnALightBackgroundIsFoundToAFifthOfAPixel) { expect_accurate(measure(folder, standard())); }

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
