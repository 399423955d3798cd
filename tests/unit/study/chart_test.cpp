#include "study/plots/chart.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <regex>

namespace treacle::study {
namespace {

// Groups of all matches of a pattern with one.
std::vector<double> numbers(const std::string& text, const std::string& pattern) {
    const std::regex one(pattern);
    std::vector<double> out;
    for (std::sregex_iterator at(text.begin(), text.end(), one), end; at != end; ++at)
        out.push_back(std::stod((*at)[1]));
    return out;
}

Chart two_lines() {
    Chart chart;
    chart.series = {{"identified", {1, 2, 3}, {1, 5, 9}, true}, {"", {1, 2, 3}, {9, 9, 9}, true},
        {"measured & more", {1, 2, 3}, {2, 4, 9}, false}};
    return chart;
}

TEST(Chart, TheLegendStandsBesideTheAxesAndWithinThePicture) {
    const auto text = svg(two_lines());
    const auto axis = numbers(text, "x2=\"([0-9.]+)\" y2=\"[0-9.]+\" stroke=\"#222\"");
    const double right = *std::ranges::max_element(axis);
    const auto names = numbers(text, "<text x=\"([0-9.]+)\" y=\"[0-9.]+\" text-anchor=\"start\"");
    ASSERT_EQ(names.size(), 2u);
    for (const double x : names) EXPECT_GT(x, right);
    for (const double x : numbers(text, "<circle cx=\"([0-9.]+)\"")) EXPECT_LT(x, right);
    // A letter of sans-serif is at most some 7 of 12 pixels wide on average.
    EXPECT_LT(names.front() + 7 * double(std::string("measured & more").size()), two_lines().width);
    // Entries follow each other without a gap for what has no name.
    const auto heights = numbers(text, "<text x=\"[0-9.]+\" y=\"([0-9.]+)\" text-anchor=\"start\"");
    EXPECT_NEAR(heights[1] - heights[0], 18, 0.1);
}

TEST(Chart, WithoutNamesTheAxesHaveTheWholeWidth) {
    auto chart = two_lines();
    for (auto& series : chart.series) series.name.clear();
    const auto axis = numbers(svg(chart), "x2=\"([0-9.]+)\" y2=\"[0-9.]+\" stroke=\"#222\"");
    EXPECT_EQ(*std::ranges::max_element(axis), chart.width - 18);
}

} // namespace
} // namespace treacle::study
