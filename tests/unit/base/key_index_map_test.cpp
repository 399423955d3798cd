#include "base/key_index_map.hpp"

#include <gtest/gtest.h>

namespace treacle {

TEST(KeyIndexMap, numbers_keys_in_the_order_in_which_they_come) {
    KeyIndexMap numbers;
    for (const std::size_t expected : {std::size_t(0), std::size_t(5000)}) {
        numbers.clear(expected);
        constexpr int n = 3000;
        const auto key = [](int k) { return (std::int64_t(k) << 40) - 7 * k; };
        for (int k = 0; k < n; ++k) EXPECT_EQ(numbers.number(key(k)), k);
        for (int k = n - 1; k >= 0; --k) EXPECT_EQ(numbers.number(key(k)), k);
        EXPECT_EQ(numbers.size(), n);
        EXPECT_EQ(numbers.find(key(17)), 17);
        EXPECT_EQ(numbers.find(key(n)), -1);
        EXPECT_EQ(numbers.keys()[123], key(123));
    }
}

} // namespace treacle
