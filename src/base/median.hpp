#pragma once
#include <algorithm>
#include <iterator>
#include <vector>

namespace treacle {

// Median, of an even number of values the upper of the two in the middle; 0 for none. Reorders the values.
template <class Number>
double upper_median(std::vector<Number>& values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + std::ssize(values) / 2;
    std::ranges::nth_element(values, middle);
    return *middle;
}

} // namespace treacle
