#include "kokkos/float4x4.hpp"

#include <gtest/gtest.h>

#include <array>
#include <functional>

namespace treacle::tile_test {

namespace {
using Sixteen = std::array<float, 16>;

Float4x4 tile_of(const Sixteen& values) { return Float4x4::load(values.data()); }

// The k-th element of an operation's result must be wanted(k).
void expect(const Float4x4& tile, const std::function<float(int)>& wanted) {
    Sixteen found{};
    tile.store(found.data());
    for (int k = 0; k < 16; ++k) EXPECT_EQ(found[static_cast<std::size_t>(k)], wanted(k)) << k;
}
constexpr Sixteen counted{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
constexpr double matrix[6] = {1, 2, 3, 4, 5, 6}; // xx, yy, zz, xy, xz, yz
constexpr float rows[3][3] = {{1, 4, 5}, {4, 2, 6}, {5, 6, 3}};
} // namespace

TEST(Float4x4, SpreadsPlacesAndQuads) {
    const Float4x4 tile = tile_of(counted);
    expect(tile.all<3>(), [](int k) { return static_cast<float>(k / 4 * 4 + 3); });
    expect(tile.all<1>(), [](int k) { return static_cast<float>(k / 4 * 4 + 1); });
    expect(tile.quad<3>(), [](int k) { return static_cast<float>(12 + k % 4); });
    expect(tile.quad<0>(), [](int k) { return static_cast<float>(k % 4); });
}

TEST(Float4x4, TransposesTheElementsAndNoneElse) {
    expect(tile_of(counted).transposed(), [](int k) {
        const bool element = k < 12 && k % 4 < 3;
        return static_cast<float>(element ? k % 4 * 4 + k / 4 : k);
    });
}

TEST(Float4x4, IsMadeOfTheRowsOfASymmetricMatrix) {
    constexpr float eight[8] = {1, 2, 3, 4, 5, 6, 7, 8};
    expect(Float4x4::broadcast_elements<0>(eight), [](int k) { return k < 12 ? rows[0][k / 4] : 0; });
    expect(Float4x4::broadcast_elements<2>(eight), [](int k) { return k < 12 ? rows[2][k / 4] : 0; });
    expect(Float4x4::broadcast_row<1>(matrix), [](int k) { return k % 4 < 3 ? rows[1][k % 4] : 0; });
}

TEST(Float4x4, AddsProductsAndStoresItsVectorsAlone) {
    Float4x4 sum = 1.0f;
    sum.add(tile_of(counted), Float4x4(2.0f) * tile_of(counted) - Float4x4(1.0f));
    expect(sum + Float4x4(3.0f), [](int k) { return static_cast<float>(4 + k * (2 * k - 1)); });
    Sixteen kept{};
    kept.fill(-1);
    tile_of(counted).store_vectors(kept.data());
    for (int k = 0; k < 16; ++k) {
        EXPECT_EQ(kept[static_cast<std::size_t>(k)], k < 12 && k % 4 < 3 ? static_cast<float>(k) : -1) << k;
    }
}

} // namespace treacle::tile_test
