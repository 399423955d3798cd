// Films of 1280 x 720 pixels at 30 Hz against their exact masks, for tools/claims seeing: too long for the suite, which has
// smaller ones in silhouettes_test.cpp.
#include "../own_folder.hpp"
#include "test_film.hpp"
#include "video/silhouette/silhouettes.hpp"

#include <gtest/gtest.h>
#include <ostream>

using namespace treacle;
using namespace treacle::video;
using test::TestFilm;

namespace {
struct Case {
    const char* name;
    double blur = 0.8;
    bool dark = true; // the liquid
    double drift = 0;
    double still = 0; // seconds at rest after it has grown
    bool by_code = false;
    SilhouetteMethod method = SilhouetteMethod::gmm;
};
std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

TestFilm film_of(const Case& c, bool quick) {
    TestFilm film;
    film.look.blur = c.blur;
    film.look.exposure_drift = c.drift;
    film.look.blur_code = c.by_code;
    if (!c.dark) {
        film.look.background = {0.05, 0.05, 0.06};
        film.liquid = {0.6, 0.55, 0.4};
    }
    film.begin = quick ? 0.3 : 0.5;
    film.rest = quick ? 0.8 : 3;
    film.times = test::steady_times(int(30 * (film.rest + c.still)) + 1, 30);
    return film;
}

class ContourAccuracy : public testing::TestWithParam<Case> {
protected:
    // Means over all frames with more than 4000 px of liquid, and the worst frame.
    void measure(bool quick) {
        const auto film = film_of(GetParam(), quick);
        const test::OwnFolder own;
        film.write(own.path() / "film.mp4");
        SourceRequest request;
        request.clip = own.path() / "film.mp4";
        const auto source = open_frames(request);
        SilhouetteSettings settings;
        settings.method = GetParam().method;
        SilhouetteMaker maker(*source, settings, [](std::int64_t, std::int64_t) {});
        double mean = 0, deviation = 0, least_overlap = 1;
        int frames = 0;
        TimedFrame frame;
        Mask exact;
        while (const auto found = maker.next(frame)) {
            const double time = film.times[std::size_t(found->index)];
            if (exact.pixels.empty() || time <= film.rest + 1 / 30.0) exact = film.mask(time);
            if (exact.area() < 4000) continue;
            const auto error = compare_contours(found->mask, exact);
            mean = std::max(mean, std::abs(error.mean));
            deviation = std::max(deviation, error.deviation);
            least_overlap = std::min(least_overlap, error.overlap);
            ++frames;
        }
        RecordProperty("mean_px", std::to_string(mean));
        RecordProperty("deviation_px", std::to_string(deviation));
        RecordProperty("overlap", std::to_string(least_overlap));
        RecordProperty("frames", frames);
        EXPECT_GT(frames, 5);
    }
};
} // namespace

TEST_P(ContourAccuracy, DISABLED_Full) { measure(false); }
TEST_P(ContourAccuracy, DISABLED_Quick) { measure(true); }

INSTANTIATE_TEST_SUITE_P(Films, ContourAccuracy,
    testing::Values(Case{"DarkSharp"}, Case{"LightSharp", 0.8, false}, Case{"DarkBlur4", 4},
        Case{"LightBlur4", 4, false}, Case{"DarkBlur4Code", 4, true, 0, 0, true}, Case{"DarkStill", 0.8, true, 0, 10},
        Case{"DarkDrift", 0.8, true, 0.2}, Case{"DarkBlur4Drift", 4, true, 0.2}, Case{"LightBlur4Drift", 4, false, 0.2},
        Case{"Difference", 2, true, 0.2, 0, false, SilhouetteMethod::difference},
        Case{"Threshold", 2, true, 0.1, 0, false, SilhouetteMethod::threshold}),
    [](const testing::TestParamInfo<Case>& info) { return info.param.name; });
