#include "kokkos/pair_products.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace treacle::pair_products_test {
namespace {
// Rows [x, s, u, 0] without an order.
std::vector<float> some_rows(int count) {
    std::vector<float> out;
    for (int k = 0; k < 8 * count; ++k)
        out.push_back(k % 8 == 7 ? 0.0f : static_cast<float>(std::sin(1.7 * k * k + 0.3)));
    return out;
}

std::array<double, 16> sum_one_by_one(const std::vector<float>& rows, int i, const std::vector<int>& index,
    const std::vector<float>& weights, int count) {
    const auto at = [&](int row, int k) { return static_cast<double>(rows[static_cast<std::size_t>(8 * row + k)]); };
    std::array<double, 16> out{};
    for (int k = 0; k < count; ++k) {
        const auto entry = static_cast<std::size_t>(k);
        const int j = index[entry];
        const double left[4] = {at(i, 0) - at(j, 0), at(i, 1) - at(j, 1), at(i, 2) - at(j, 2), -(at(i, 3) + at(j, 3))};
        const double right[4] = {at(i, 4) - at(j, 4), at(i, 5) - at(j, 5), at(i, 6) - at(j, 6), 1};
        for (std::size_t l = 0; l < 4; ++l) {
            for (std::size_t m = 0; m < 4; ++m)
                out[4 * l + m] += static_cast<double>(weights[entry]) * left[l] * right[m];
        }
    }
    return out;
}
} // namespace

// Weights behind the row are another row's: they must not count, whatever they are.
TEST(PairProducts, AreThoseOfTheRowAlone) {
    const auto rows = some_rows(20);
    const std::vector<int> index{3, 7, 1, 12, 19, 0, 5, 6, 11, 2, 18, 4, 9, 8};
    for (int count = 0; count <= 11; ++count) {
        std::vector<float> weights(index.size(), 1e30f);
        for (int k = 0; k < count; ++k) weights[static_cast<std::size_t>(k)] = 0.1f * static_cast<float>(k + 1);
        const Float4x4 sum = sum_pair_products(rows.data(), 14, index.data(), weights.data(), count);
        float found[16];
        sum.store(found);
        const auto wanted = sum_one_by_one(rows, 14, index, weights, count);
        for (std::size_t k = 0; k < 16; ++k) EXPECT_NEAR(found[k], wanted[k], 1e-5) << count << " pairs, place " << k;
    }
}
} // namespace treacle::pair_products_test
