#ifndef TREACLE_CONTRACTS
#define TREACLE_CONTRACTS
#endif
#include "base/text/contract.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace treacle::contract_test {
namespace {
int half_of(int even) {
    TREACLE_EXPECT(even % 2 == 0);
    const int out = even / 2;
    TREACLE_ENSURE(2 * out == even);
    return out;
}

TEST(Contract, holds_where_its_condition_does) { EXPECT_EQ(half_of(6), 3); }

TEST(Contract, names_place_function_and_condition_where_it_is_broken) {
    try {
        half_of(5);
        FAIL() << "nothing was thrown";
    } catch (const std::logic_error& error) {
        const std::string text = error.what();
        for (const auto* part : {"contract_test.cpp:", "half_of", "expects even % 2 == 0"})
            EXPECT_NE(text.find(part), std::string::npos) << text;
    }
}
} // namespace
} // namespace treacle::contract_test
