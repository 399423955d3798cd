#include "base/text/error.hpp"
#include "base/text/split.hpp"
#include "base/text/text.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace treacle {
namespace {

TEST(Text, NumbersThatDifferAreToldApart) {
    const auto [a, b] = tell_apart(0.05, 0.0500004);
    EXPECT_EQ(a, "0.05");
    EXPECT_EQ(b, "0.0500004");
    EXPECT_NE(tell_apart(1, std::nextafter(1, 2)).first, tell_apart(1, std::nextafter(1, 2)).second);
    EXPECT_EQ(tell_apart(12345.678, 3).first, "1.235e+04");
    EXPECT_EQ(tell_apart(0.1, 0.1).first, "0.1");
}

TEST(Diagnostic, EndsWithOneMark) {
    const auto text = [](const char* cure) { return Diagnostic{"a.yaml:1", "b", "", cure}.text(); };
    EXPECT_EQ(text("take c"), "a.yaml:1: b; take c.");
    EXPECT_EQ(text("take c."), "a.yaml:1: b; take c.");
    EXPECT_EQ(text("c?"), "a.yaml:1: b; c?");
}

TEST(EditDistance, CountsInsertionsDeletionsSubstitutionsAndSwaps) {
    EXPECT_EQ(edit_distance("viscosity", "viscosity"), 0);
    EXPECT_EQ(edit_distance("viscosity", "viscosty"), 1);
    EXPECT_EQ(edit_distance("viscosity", "viscossity"), 1);
    EXPECT_EQ(edit_distance("viscosity", "vizcosity"), 1);
    EXPECT_EQ(edit_distance("viscosity", "vsicosity"), 1);
    EXPECT_EQ(edit_distance("", "abc"), 3);
    EXPECT_EQ(edit_distance("kitten", "sitting"), 3);
}

TEST(EditDistance, TakesCaseAndDashesForEqual) { EXPECT_EQ(edit_distance("X-Min", "x_min"), 0); }

TEST(Nearest, FindsTheMisspeltWord) {
    EXPECT_EQ(nearest("densty", {"viscosity", "density"}), "density");
    EXPECT_EQ(nearest("X-min", {"x_max", "x_min"}), "x_min");
}

TEST(Nearest, FindsNothingInDistantWords) {
    EXPECT_FALSE(nearest("colour", {"viscosity", "density"}));
    EXPECT_FALSE(nearest("a", {"b"}));
    EXPECT_FALSE(nearest("colour", {}));
    EXPECT_FALSE(nearest(std::string(1000, 'x'), {"x"}));
}

TEST(FormatNumber, ReadsBackAsTheSameDouble) {
    for (const double x : {0.1, 1.0 / 3, 1e-300, -4.9e-324, 1.7976931348623157e308, 123456789.123456789}) {
        EXPECT_EQ(read_number(format_number(x)), x);
    }
    EXPECT_EQ(format_number(0.005), "0.005");
}

TEST(ReadNumber, TakesTheWholeTextOrNothing) {
    EXPECT_EQ(read_number("+1.5e2"), 150);
    for (const char* text : {"", "1x", "x", "1 2", "+", "--1", "+-1", "0x10"}) EXPECT_FALSE(read_number(text)) << text;
}

TEST(ReadNumber, TellsTooLargeFromTooSmall) {
    EXPECT_EQ(read_number("1e999"), std::numeric_limits<double>::infinity());
    EXPECT_LE(std::abs(*read_number("1e-999")), std::numeric_limits<double>::denorm_min());
}

TEST(FormatDuration, ChangesUnitsAtTheirLimits) {
    EXPECT_EQ(format_duration(0.25), "250 ms");
    EXPECT_EQ(format_duration(12.34), "12.3 s");
    EXPECT_EQ(format_duration(59.97), "1 min 00 s");
    EXPECT_EQ(format_duration(245), "4 min 05 s");
    EXPECT_EQ(format_duration(3 * 3600 + 120), "3 h 02 min");
    EXPECT_EQ(format_duration(2 * 86400 + 4 * 3600), "2 d 04 h");
    EXPECT_EQ(format_duration(std::nan("")), "?");
}

TEST(FormatBytes, UsesPowersOfThousand) {
    EXPECT_EQ(format_bytes(999), "999 B");
    EXPECT_EQ(format_bytes(1000), "1.0 kB");
    EXPECT_EQ(format_bytes(999'999), "1.0 MB");
    EXPECT_EQ(format_bytes(1'240'000'000), "1.2 GB");
}

TEST(Wrap, BreaksBetweenWordsOnly) {
    EXPECT_EQ(wrap("one two three", 9, 2), "one two\n  three");
    EXPECT_EQ(wrap("unbreakable", 4, 0), "unbreakable");
}

TEST(Shorten, KeepsWholeLettersAndOneLine) {
    const auto text = shorten(std::string(59, 'a') + "ä" + std::string(20, 'b'));
    EXPECT_EQ(text, std::string(59, 'a') + "...");
    EXPECT_EQ(shorten("a\nb"), "a b");
}

TEST(Split, PartsMayBeEmptyAndWordsAreNot) {
    using Texts = std::vector<std::string>;
    EXPECT_EQ(split("a::b:", ':'), (Texts{"a", "", "b", ""}));
    EXPECT_EQ(split("", ','), Texts{""});
    EXPECT_EQ(split_words("  a\t b  "), (Texts{"a", "b"}));
    EXPECT_EQ(split_words("a;;b c", ";"), (Texts{"a", "b c"}));
    EXPECT_TRUE(split_words(" ").empty());
}

} // namespace
} // namespace treacle
