#include "identify/compare/sheet_comparison.hpp"

#include "../own_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace treacle::identify {
namespace {

Sheet sheet_at() {
    Sheet out;
    out.origin = {0.1, 0, 0.2};
    out.window = 0.01;
    out.noise = 0.001;
    return out;
}

// A flow that grows in time, quadratic in space, shown through a sheet that is scaled, shifted, turned and late.
struct Shown {
    double scale = 0, right = 0, up = 0, turn = 0, late = 0;
    static constexpr double middle_x = 0.02, middle_y = 0.03;

    static Vec3 velocity(const Vec3& x, double time) {
        return {(1 + time) * (x[0] - 2 * x[2] * x[0]), 5, (1 + time) * (3 * x[0] * x[0] - x[2])};
    }

    // What a sheet measures at its place x, y when its scale, shift, turn and time are other than stated.
    SheetVector measured(double x, double y, double time) const {
        const double dx = x - middle_x, dy = y - middle_y;
        const double tx = middle_x + (1 + scale) * (dx - turn * dy) + right,
                     ty = middle_y + (1 + scale) * (dy + turn * dx) + up;
        const auto u = velocity({0.1 + tx, 0, 0.2 + ty}, time - late);
        return {x, y, (u[0] + turn * u[2]) / (1 + scale), (u[2] - turn * u[0]) / (1 + scale)};
    }
    ObservedField field(double time) const {
        ObservedField out{3, time, {}};
        for (int i = 0; i < 25; ++i) out.vectors.push_back(measured(0.01 * (i % 5), 0.01 + 0.01 * (i / 5), time));
        return out;
    }
};

SheetFlow flow_at(double time) {
    SheetFlow out;
    out.time = time;
    out.liquid = [time](const Vec3& x) {
        LocalVelocity local{Shown::velocity(x, time), {}};
        local.gradient[0] = {(1 + time) * (1 - 2 * x[2]), 0, -(1 + time) * 2 * x[0]};
        local.gradient[2] = {(1 + time) * 6 * x[0], 0, -(1 + time)};
        return std::optional(local);
    };
    out.solid = [](const Vec3&) { return std::optional<Vec3>(); };
    return out;
}

TEST(SheetComparison, TheRightFlowHasNoDifferenceButThatOfItsWindow) {
    const auto found = compare_field(sheet_at(), Shown{}.field(0.5), flow_at(0.4), flow_at(0.6));
    ASSERT_EQ(found.segments.size(), 50u);
    // Mean of 3 x^2 over a window of 1 cm: 3 * 1e-4 / 12 more, times 1.5, over the noise.
    for (const auto& row : found.segments)
        EXPECT_NEAR(row.displacement, row.normal_y * 1.5 * 3 * 1e-4 / 12 / 0.001, 1e-9);
    EXPECT_EQ(found.squares.count, 25);
}

TEST(SheetComparison, DerivativesByTheViewAreThoseOfTheResiduals) {
    const auto base = compare_field(sheet_at(), Shown{}.field(0.5), flow_at(0.4), flow_at(0.6));
    const std::vector<std::pair<int, Shown>> moves{{sheet_time, {.late = 1e-3}}, {sheet_scale, {.scale = 1e-4}},
        {sheet_right, {.right = 1e-5}}, {sheet_up, {.up = 1e-5}}, {sheet_turn, {.turn = 1e-4}}};
    for (const auto& [parameter, shown] : moves) {
        const double step = shown.late + shown.scale + shown.right + shown.up + shown.turn;
        const auto moved = compare_field(sheet_at(), shown.field(0.5), flow_at(0.4), flow_at(0.6));
        for (std::size_t i = 0; i < base.segments.size(); ++i) {
            // The residual of the view that is taken into account: r + J v is again that of the true one.
            const double change = base.segments[i].displacement - moved.segments[i].displacement;
            EXPECT_NEAR(
                moved.segments[i].by_view[std::size_t(parameter)] * step, change, 0.02 * std::abs(change) + 2e-4)
                << parameter << " row " << i;
        }
    }
}

TEST(SheetComparison, WindowsAtABodyAreNotComparedAndNeverWithoutLiquid) {
    auto flow = flow_at(0.5);
    flow.solid = [](const Vec3& x) { return x[0] < 0.105 ? std::optional(Vec3{0, 0, -1}) : std::nullopt; };
    const auto liquid = flow.liquid;
    flow.liquid = [liquid](const Vec3& x) { return x[2] > 0.236 ? std::nullopt : liquid(x); };
    const auto found = compare_field(sheet_at(), Shown{}.field(0.5), flow, flow);
    for (const auto& row : found.segments) {
        const bool at_body = row.x<0.0099, above = row.y> 0.0399;
        EXPECT_EQ(row.points, at_body || above ? 0 : 1) << row.x << " " << row.y;
        EXPECT_EQ(std::isfinite(row.displacement), at_body || !above) << row.x << " " << row.y;
    }
}

TEST(SheetComparison, FilesHoldWhatWasWritten) {
    const test::OwnFolder folder;
    const auto found = compare_field(sheet_at(), Shown{}.field(0.5), flow_at(0.4), flow_at(0.6));
    RunResiduals residuals;
    residuals.kind = ExperimentKind::piv;
    residuals.segments = found.segments;
    residuals.segments[4].displacement = std::nan("");
    residuals.squares = {found.squares};
    write_residuals(folder.path(), "ball", residuals);
    write_vectors(folder.path(), "ball", found.vectors);
    const auto read = read_residuals(folder.path(), "ball", ExperimentKind::piv);
    ASSERT_EQ(read.segments.size(), 50u);
    EXPECT_EQ(read.segments[7].displacement, found.segments[7].displacement);
    EXPECT_EQ(read.segments[7].by_view, found.segments[7].by_view);
    EXPECT_TRUE(std::isnan(read.segments[4].displacement));
    EXPECT_DOUBLE_EQ(read.mismatch, found.squares.square);
    const auto vectors = read_vectors(folder.path(), "ball");
    ASSERT_EQ(vectors.size(), 25u);
    EXPECT_EQ(vectors[3].measured.v, found.vectors[3].measured.v);
    EXPECT_EQ(vectors[3].u, found.vectors[3].u);
}

} // namespace
} // namespace treacle::identify
