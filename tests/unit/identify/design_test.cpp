#include "identify/estimate/design.hpp"

#include "base/text/error.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace treacle::identify {
namespace {

// Segments whose displacement is a times the first parameter and b times the second, the same for all when `even`.
RunResiduals run(double x, double y, bool even) {
    RunResiduals out;
    for (int s = 0; s < 40; ++s) {
        SegmentResidual one;
        one.points = 25;
        const double fraction = even ? 1 : s / 20.0;
        one.displacement = x + fraction * y;
        one.by_view[view_contour] = 1;
        out.segments.push_back(one);
    }
    return out;
}

ViewInformation known() { return 1e12 * ViewInformation::Identity(); }

// 40 segments of half a pixel, each a pixel by the parameter: 40 / 0.25.
TEST(Design, InformationIsThatOfIndependentSegments) {
    const auto found = information_of_runs(run(0, 0, true), {run(0.1, 0, true)}, {0.1}, known(), 1);
    EXPECT_NEAR(found(0, 0), 160, 1e-6);
    EXPECT_NEAR(information_of_runs(run(0, 0, true), {run(0.1, 0, true)}, {0.1}, known(), 4)(0, 0), 40, 1e-6);
}

// A shift of all contours that is not known leaves nothing of a parameter that does the same.
TEST(Design, TheViewTakesItsShare) {
    auto prior = known();
    prior(view_contour, view_contour) = 1 / (0.3 * 0.3);
    const auto found = information_of_runs(run(0, 0, true), {run(0.1, 0, true)}, {0.1}, prior, 1);
    EXPECT_NEAR(found(0, 0), 1 / (1.0 / 160 + 0.09), 1e-6);
}

// Two parameters that one block does not distinguish are distinguished by a block on which their effects have another
// ratio.
TEST(Design, ABlockThatTellsTheRidgeApartNarrowsTheBandMore) {
    const Eigen::MatrixXd before = covariance_after(10 * Eigen::MatrixXd::Identity(2, 2),
        information_of_runs(run(0, 0, true), {run(0.1, 0, true), run(0, 0.1, true)}, {0.1, 0.1}, known(), 1));
    const auto same =
        information_of_runs(run(0, 0, true), {run(0.1, 0, true), run(0, 0.1, true)}, {0.1, 0.1}, known(), 1);
    const auto other =
        information_of_runs(run(0, 0, false), {run(0.1, 0, false), run(0, 0.1, false)}, {0.1, 0.1}, known(), 1);
    Eigen::MatrixXd slopes(2, 2);
    slopes << 1, 0, 1, 2;
    const double width = band_half_width(before, slopes),
                 after_same = band_half_width(covariance_after(before, same), slopes),
                 after_other = band_half_width(covariance_after(before, other), slopes);
    EXPECT_GT(after_same, 0.95 * width);
    EXPECT_LT(after_other, 0.2 * width);
}

TEST(Design, RunsThatShareNothingAreRefused) {
    auto empty = run(0, 0, true);
    for (auto& one : empty.segments) one.points = 0;
    EXPECT_THROW(information_of_runs(empty, {run(0.1, 0, true)}, {0.1}, known(), 1), InputError);
}

} // namespace
} // namespace treacle::identify
