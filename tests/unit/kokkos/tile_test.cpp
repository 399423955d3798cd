#include "kokkos/tile.hpp"

#include <gtest/gtest.h>

#include <array>
#include <functional>

namespace treacle::tile_test {

namespace {
using Sixteen = std::array<float, 16>;

Tile tile_of(const Sixteen& values) { return Tile::load(values.data()); }

// The k-th element of an operation's result must be wanted(k).
void expect(const Tile& tile, const std::function<float(int)>& wanted) {
    Sixteen found{};
    tile.store(found.data());
    for (int k = 0; k < 16; ++k) EXPECT_EQ(found[static_cast<std::size_t>(k)], wanted(k)) << k;
}
constexpr Sixteen counted{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
constexpr double matrix[6] = {1, 2, 3, 4, 5, 6}; // xx, yy, zz, xy, xz, yz
constexpr float rows[3][3] = {{1, 4, 5}, {4, 2, 6}, {5, 6, 3}};
} // namespace

TEST(Tile, SpreadsPlacesAndQuads) {
    const Tile tile = tile_of(counted);
    expect(tile.all<3>(), [](int k) { return static_cast<float>(k / 4 * 4 + 3); });
    expect(tile.all<1>(), [](int k) { return static_cast<float>(k / 4 * 4 + 1); });
    expect(tile.quad<3>(), [](int k) { return static_cast<float>(12 + k % 4); });
    expect(tile.quad<0>(), [](int k) { return static_cast<float>(k % 4); });
}

TEST(Tile, TransposesTheElementsAndNoneElse) {
    expect(tile_of(counted).transposed(), [](int k) {
        const bool element = k < 12 && k % 4 < 3;
        return static_cast<float>(element ? k % 4 * 4 + k / 4 : k);
    });
}

TEST(Tile, IsMadeOfTheRowsOfASymmetricMatrix) {
    constexpr float eight[8] = {1, 2, 3, 4, 5, 6, 7, 8};
    expect(Tile::spread<0>(eight), [](int k) { return k < 12 ? rows[0][k / 4] : 0; });
    expect(Tile::spread<2>(eight), [](int k) { return k < 12 ? rows[2][k / 4] : 0; });
    expect(Tile::repeat<1>(matrix), [](int k) { return k % 4 < 3 ? rows[1][k % 4] : 0; });
}

TEST(Tile, AddsProductsAndStoresItsVectorsAlone) {
    Tile sum = 1.0f;
    sum.add(tile_of(counted), Tile(2.0f) * tile_of(counted) - Tile(1.0f));
    expect(sum + Tile(3.0f), [](int k) { return static_cast<float>(4 + k * (2 * k - 1)); });
    Sixteen kept{};
    kept.fill(-1);
    tile_of(counted).store_vectors(kept.data());
    for (int k = 0; k < 16; ++k) {
        EXPECT_EQ(kept[static_cast<std::size_t>(k)], k < 12 && k % 4 < 3 ? static_cast<float>(k) : -1) << k;
    }
}

} // namespace treacle::tile_test
