#include "identify/estimate/estimate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace treacle::identify {
namespace {

constexpr int frames = 40, segments = 30;
constexpr double truth = 2.3; // ln of 10 Pa s

// Contours of a made-up flow: each segment moves with the logarithm of the viscosity, more at its front and later; the
// noise of neighbouring segments and frames is the same.
struct Film {
    std::vector<double> noise;
    double shift = 0; // [px] of all contours
    double rise = 0;  // of the logarithm of the viscosity, from the first frame to the last

    Film(int seed, double size, int along, int times, double common) {
        std::mt19937 generator{std::uint32_t(seed)};
        std::normal_distribution<double> normal;
        shift = common * normal(generator);
        std::vector<double> draws(std::size_t(frames * segments));
        for (auto& one : draws) one = size * normal(generator);
        for (int f = 0; f < frames; ++f) {
            for (int s = 0; s < segments; ++s) noise.push_back(draws[std::size_t((f / times) * segments + s / along)]);
        }
    }
    EvaluatedRun run(double x) const {
        EvaluatedRun out;
        out.point = Eigen::VectorXd::Constant(1, x);
        auto& residuals = out.experiments.emplace_back();
        for (int f = 0; f < frames; ++f) {
            for (int s = 0; s < segments; ++s) {
                const double angle = 2 * std::numbers::pi * s / segments;
                SegmentResidual one;
                one.frame = f;
                one.time = 0.03 * f;
                one.x = 100 + 50 * std::cos(angle);
                one.y = 100 + 50 * std::sin(angle);
                one.points = 25;
                const double d = x - truth - rise * (double(f) / (frames - 1) - 0.5),
                             slope = -20 * std::max(0.0, std::cos(angle)) * f / frames;
                one.displacement = slope * (d - 0.1 * d * d) - shift - noise[std::size_t(f * segments + s)];
                one.by_view[view_contour] = 1;
                residuals.segments.push_back(one);
            }
        }
        return out;
    }
    std::vector<EvaluatedRun> runs() const { return {run(1), run(2.6), run(2.2), run(2.4), run(3)}; }
};

std::vector<ViewInformation> prior(double contour) {
    ViewInformation out = ViewInformation::Identity() * 1e12;
    out(view_contour, view_contour) = 1 / (contour * contour);
    return {out};
}

TEST(Estimate, FindsTheValueWithoutNoise) {
    const Film film(1, 1e-9, 1, 1, 0);
    const auto found = estimate(film.runs(), prior(0.3));
    EXPECT_NEAR(found.point[0], truth, 1e-4); // the model's own cubic term over runs 0.1 away
    EXPECT_EQ(found.runs, 5u);
}

TEST(Estimate, AShiftOfAllContoursIsTakenForOne) {
    Film film(1, 1e-9, 1, 1, 0);
    film.shift = 0.4;
    const auto found = estimate(film.runs(), prior(1));
    EXPECT_NEAR(found.point[0], truth, 2e-3);
    EXPECT_NEAR(found.view[0][view_contour], 0.4, 0.02);
    // A view that is held to be known leaves the shift to the viscosity.
    EXPECT_GT(std::abs(estimate(film.runs(), prior(1e-4)).point[0] - truth), 5e-3);
}

// A camera that stands a few standard deviations off is no noise.
TEST(Estimate, AShiftOfManyPixelsIsNotTakenForNoise) {
    Film film(1, 0.2, 1, 1, 0);
    for (const double shift : {-3., -2., 2., 3.}) {
        film.shift = shift;
        const auto found = estimate(film.runs(), prior(2));
        EXPECT_NEAR(found.view[0][view_contour], shift, 0.1);
        EXPECT_NEAR(found.point[0], truth, 0.02);
        EXPECT_LT(found.noise[0], 0.3);
    }
}

// A liquid that grows thicker over a film is distinguished from one that does not, few of whose films have a
// significant drift.
TEST(Estimate, AViscosityThatRisesOverTheFramesIsSeenInWindowsOfTime) {
    Film steady(1, 1e-9, 1, 1, 0);
    for (const double rise : {-0.2, 0.0, 0.2}) {
        steady.rise = rise;
        const auto found = estimate(steady.runs(), prior(0.3));
        ASSERT_EQ(found.drifts.size(), 1u);
        const auto& drift = found.drifts[0];
        ASSERT_EQ(drift.windows.size(), 4u);
        EXPECT_EQ(drift.windows.front().from, 0);
        EXPECT_DOUBLE_EQ(drift.windows.back().to, 0.03 * (frames - 1));
        for (const auto& window : drift.windows) {
            const auto rise_at = [&](double time) { return rise * (time / (0.03 * (frames - 1)) - 0.5); };
            const auto [low, high] = std::minmax({rise_at(window.from), rise_at(window.to)});
            EXPECT_GE(found.point[0] + window.change - truth, low - 1e-3);
            EXPECT_LE(found.point[0] + window.change - truth, high + 1e-3);
        }
    }
    int seen = 0, seeming = 0;
    for (int seed = 1; seed <= 24; ++seed) {
        Film film(seed, 0.5, 3, 4, 0.3);
        const auto still = estimate(film.runs(), prior(0.3)).drifts[0];
        film.rise = 0.4;
        const auto rising = estimate(film.runs(), prior(0.3)).drifts[0];
        seen += rising.change > 2 * rising.deviation;
        seeming += std::abs(still.change) > 2 * still.deviation;
    }
    EXPECT_GE(seen, 19);
    EXPECT_LE(seeming, 4);
}

// Contours that move with the viscosity in proportion to time tell by its square.
TEST(Estimate, LateFramesTellMore) {
    const Film film(1, 1e-9, 1, 1, 0);
    const auto found = estimate(film.runs(), prior(1e-6));
    ASSERT_EQ(found.information_fraction.size(), std::size_t(frames));
    double squares = 0;
    for (int f = 0; f < frames; ++f) squares += double(f) * f;
    for (int f = 0; f < frames; ++f)
        EXPECT_NEAR(found.information_fraction[std::size_t(f)], f * f / squares, 1e-3 / frames);
}

// 90 % intervals hold the truth in about 90 % of films although segments are not independent; independent segments would
// claim far less: noise is alike over 3 segments and 4 frames, so that 12 of them count as one.
TEST(Estimate, IntervalsHoldTheTruthThoughPixelsAreNotIndependent) {
    constexpr int films = 120;
    int inside = 0, inside_independent = 0;
    double squares = 0;
    for (int seed = 1; seed <= films; ++seed) {
        const Film film(seed, 0.5, 3, 4, 0.3);
        const auto found = estimate(film.runs(), prior(0.3));
        const double z = (found.point[0] - truth) / std::sqrt(found.parts[0].total());
        squares += z * z / films;
        inside += std::abs(z) < ninety_percent(found.parts[0], found.freedom[0]);
        inside_independent += std::abs(found.point[0] - truth) < 1.645 * found.naive[0];
    }
    // Of 120, three standard deviations of the count from 108.
    EXPECT_GE(inside, 98);
    EXPECT_LE(inside, 118);
    EXPECT_GT(std::sqrt(squares), 0.75);
    EXPECT_LT(std::sqrt(squares), 1.3);
    EXPECT_LT(inside_independent, 70);
}

// What a turn does it does all around: windows of a film that coils have a noise that all their segments share.
TEST(Estimate, IntervalsOfWindowsHoldTheTruthThoughSegmentsShareAllTheirNoise) {
    constexpr int films = 30, windows = 5;
    int inside = 0;
    for (int seed = 1; seed <= films; ++seed) {
        auto runs = Film(seed, 0.5, segments, frames / windows, 0).runs();
        for (auto& run : runs) {
            run.experiments[0].kind = ExperimentKind::occupancy;
            for (auto& one : run.experiments[0].segments) one.frame /= frames / windows;
        }
        const auto found = estimate(runs, prior(0.3));
        EXPECT_EQ(found.blocks, std::size_t(windows));
        EXPECT_LT(found.freedom[0], windows);
        inside += std::abs(found.point[0] - truth) <
                  ninety_percent(found.parts[0], found.freedom[0]) * std::sqrt(found.parts[0].total());
    }
    EXPECT_GE(inside, 22); // of 30, three standard deviations of the count from 27
}

TEST(Estimate, AnotherResolutionsRunMovesTheAnswer) {
    const Film film(1, 1e-9, 1, 1, 0);
    const auto runs = film.runs();
    auto finer = film.run(2.35);
    finer.point[0] = 2.3; // at 2.3 its contours are those of the others at 2.35
    const auto found = estimate(runs, prior(0.3), {{finer}});
    EXPECT_NEAR(found.point[0], 2.25, 1e-3);
}

// Runs against a film of which each row is later than that above: fronts run by 60 px/s, in the lower half of the picture.
std::vector<EvaluatedRun> with_readout(std::vector<EvaluatedRun> runs, double readout) {
    for (auto& run : runs) {
        for (auto& one : run.experiments[0].segments) {
            const double later = 0.4 * std::sin(2 * std::numbers::pi * (one.y - 40) / 480),
                         speed = 60 * std::max(0.0, (one.x - 100) / 50);
            one.by_view[view_readout] = later * speed;
            one.displacement -= readout * later * speed;
        }
    }
    return runs;
}

TEST(Estimate, ARollingShutterThatIsIgnoredBiasesTheAnswerAndOneThatIsFreeDoesNot) {
    const auto runs = with_readout(Film(1, 0.05, 1, 1, 0).runs(), 0.02);
    const auto ignored = estimate(runs, prior(0.3));
    auto priors = prior(0.3);
    priors[0](view_readout, view_readout) = 1 / (0.03 * 0.03);
    const auto free = estimate(runs, priors);
    EXPECT_GT(std::abs(ignored.point[0] - truth), 0.015);
    EXPECT_LT(std::abs(free.point[0] - truth), 0.004);
    EXPECT_LT(std::abs(free.point[0] - truth),
        ninety_percent(free.parts[0], free.freedom[0]) * std::sqrt(free.parts[0].total()));
    EXPECT_NEAR(free.view[0][view_readout], 0.02, 0.002);
}

// A sheet of PIV beside a film: vectors in units of their noise. `odd` is the logarithm of the viscosity by them.
EvaluatedRun with_vectors(EvaluatedRun run, double odd, double noise, int seed) {
    std::mt19937 generator{std::uint32_t(seed)};
    std::normal_distribution<double> normal(0, noise);
    auto& sheet = run.experiments.emplace_back();
    sheet.kind = ExperimentKind::piv;
    for (int f = 0; f < 20; ++f) {
        for (int i = 0; i < 60; ++i) {
            SegmentResidual one;
            one.frame = f;
            one.x = i % 10;
            one.y = i / 10;
            one.points = 1;
            one.displacement = 30 * (run.point[0] - odd) * std::sin(i) + normal(generator);
            if (i == 3) one.points = 0;
            if (i == 4 && run.point[0] > 2.9) one.displacement = std::nan("");
            sheet.segments.push_back(one);
        }
    }
    return run;
}

TEST(Estimate, ExperimentsOfTwoKindsAddUpEachByItsOwnNoise) {
    const Film film(3, 0.5, 1, 1, 0);
    auto priors = prior(0.3);
    priors.push_back(ViewInformation::Identity());
    const auto both = [&](double odd, double noise) {
        std::vector<EvaluatedRun> runs;
        for (const auto& one : film.runs()) runs.push_back(with_vectors(one, odd, noise, 11));
        return estimate(runs, priors);
    };
    const auto alone = estimate(film.runs(), prior(0.3)), agreeing = both(truth, 1);
    EXPECT_LT(agreeing.parts[0].total(), 0.5 * alone.parts[0].total());
    EXPECT_LT(std::abs(agreeing.point[0] - truth), 3 * std::sqrt(agreeing.parts[0].total()));
    EXPECT_NEAR(agreeing.noise[0], 0.5, 0.05); // [px]
    EXPECT_NEAR(agreeing.noise[1], 1, 0.1);    // [noises]
    // Vectors that are sixty times as noisy as stated hardly count, whatever their values.
    EXPECT_LT(std::abs(both(truth + 0.3, 60).point[0] - alone.point[0]), std::sqrt(alone.parts[0].total()));
    EXPECT_EQ(agreeing.misfit.size(), 60u); // by frame and field
    EXPECT_EQ(agreeing.misfit_of.back(), 1u);
}

TEST(Estimate, OneRunIsNotEnough) {
    const Film film(1, 0.1, 1, 1, 0);
    EXPECT_THROW(estimate({film.run(2)}, prior(0.3)), std::exception);
    EXPECT_THROW(estimate({}, prior(0.3)), std::exception);
    auto empty = film.run(2);
    empty.experiments.front().segments.clear();
    EXPECT_THROW(estimate({empty, empty}, prior(0.3)), std::exception);
}

TEST(ResidualObjective, IsLeastAtTheTruthAndCutsWhatIsFarAway) {
    const Film film(1, 0.3, 3, 4, 0.3);
    const double best = residual_objective(film.run(truth), prior(0.3));
    for (const double x : {0.5, 1.5, 2.1, 2.5, 4.0}) EXPECT_GT(residual_objective(film.run(x), prior(0.3)), best);
    EXPECT_GT(residual_objective(film.run(8), prior(0.3)), residual_objective(film.run(5), prior(0.3)));
}

} // namespace
} // namespace treacle::identify
