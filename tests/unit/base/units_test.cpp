#include "base/text/units.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace treacle {
namespace {

double read(const std::string& text, const Unit& unit) {
    const auto result = read_quantity(text, unit);
    if (const auto* complaint = std::get_if<Complaint>(&result)) {
        ADD_FAILURE() << text << ": " << complaint->must << "; " << complaint->reason;
        return 0;
    }
    return std::get<double>(result);
}

Complaint complaint(const std::string& text, const Unit& unit) {
    const auto result = read_quantity(text, unit);
    if (const auto* found = std::get_if<Complaint>(&result)) return *found;
    ADD_FAILURE() << text << " was read as " << std::get<double>(result);
    return {};
}

// Powers of ten are applied to the number as read, so the equalities are exact.
TEST(ReadQuantity, PlainNumbersAreSi) {
    EXPECT_EQ(read("0.005", unit::length), 0.005);
    EXPECT_EQ(read(" -3e-2 ", unit::viscosity), -3e-2);
    EXPECT_EQ(read("0.25", unit::none), 0.25);
}

TEST(ReadQuantity, DecimalUnitsAreExact) {
    EXPECT_EQ(read("5 mm", unit::length), 0.005);
    EXPECT_EQ(read("5mm", unit::length), 0.005);
    EXPECT_EQ(read("10 Pa.s", unit::viscosity), 10);
    EXPECT_EQ(read("10 Pa s", unit::viscosity), 10);
    EXPECT_EQ(read("10 Pa*s", unit::viscosity), 10);
    EXPECT_EQ(read("10 Pa·s", unit::viscosity), 10);
    EXPECT_EQ(read("850 cP", unit::viscosity), 0.85);
    EXPECT_EQ(read("850 mPa.s", unit::viscosity), 0.85);
    EXPECT_EQ(read("1 g/cm^3", unit::density), 1000);
    EXPECT_EQ(read("20 g/cm3", unit::density), 20000);
    EXPECT_EQ(read("1.2 kg/l", unit::density), 1200);
    EXPECT_EQ(read("9.81 m/s^2", unit::acceleration), 9.81);
    EXPECT_EQ(read("9.81 m s^-2", unit::acceleration), 9.81);
    EXPECT_EQ(read("9.81 m/s²", unit::acceleration), 9.81);
    EXPECT_EQ(read("9.81 m/s/s", unit::acceleration), 9.81);
    EXPECT_EQ(read("72 mN/m", unit::surface_tension), 0.072);
    EXPECT_EQ(read("72 dyn/cm", unit::surface_tension), 0.072);
    EXPECT_EQ(read("10 ms", unit::time), 0.01);
    EXPECT_EQ(read("7 µm", unit::length), 7e-6);
    EXPECT_EQ(read("100 1/s", unit::frequency), 100);
    EXPECT_EQ(read("3 s^-1", unit::frequency), 3);
    EXPECT_EQ(read("2 kg", unit::mass), 2);
    EXPECT_EQ(read("5 %", unit::none), 0.05);
}

TEST(ReadQuantity, OtherFactorsAreRoundedOnce) {
    EXPECT_DOUBLE_EQ(read("30 deg", unit::angle), std::numbers::pi / 6);
    EXPECT_DOUBLE_EQ(read("2 min", unit::time), 120);
    EXPECT_DOUBLE_EQ(read("36 km/h", unit::velocity), 10);
    EXPECT_DOUBLE_EQ(read("60 rpm", unit::angular_velocity), 2 * std::numbers::pi);
    EXPECT_DOUBLE_EQ(read("6 l/min", unit::volume_flow), 1e-4);
}

TEST(ReadQuantity, AmbiguousSymbolsAreTheWholeUnitFirst) {
    EXPECT_EQ(read("1 min", unit::time), 60);
    EXPECT_EQ(read("1 Pa", unit::pressure), 1);
    EXPECT_EQ(read("1 hPa", unit::pressure), 100);
    EXPECT_EQ(read("1 mbar", unit::pressure), 100);
}

TEST(ReadQuantity, KinematicViscosityNeedsItsUnitAndIsTimesTheDensity) {
    const auto unit = unit::viscosity_of(970);
    // Two roundings: 1e-6 and the product.
    EXPECT_DOUBLE_EQ(read("1 cSt", unit), 970e-6);
    EXPECT_DOUBLE_EQ(read("1000 mm2/s", unit), 0.97);
    EXPECT_EQ(read("1", unit), 1);
    EXPECT_EQ(complaint("1 cSt", unit::viscosity).reason, "\"cSt\" is the unit of a kinematic viscosity");
}

TEST(ReadQuantity, AnotherDimensionIsRejectedWithTheAcceptedUnits) {
    const auto found = complaint("5 mm", unit::density);
    EXPECT_EQ(found.must, "must be a density [kg/m3]");
    EXPECT_EQ(found.reason, "\"mm\" is the unit of a length");
    EXPECT_EQ(found.cure, "accepted units: kg/m3, g/cm3, g/ml, kg/l");
    EXPECT_EQ(complaint("1 rad", unit::none).cure, "write it without a unit");
    EXPECT_EQ(complaint("5 1/s", unit::angular_velocity).reason, "\"1/s\" is the unit of a frequency");
}

TEST(ReadQuantity, AnUnknownUnitIsRejected) {
    for (const char* text : {"5 furlong", "5 m^", "5 m^x", "5 m//s", "5 /m", "5 m.", "5 m^12", "5 kkg", "5 (m)"}) {
        EXPECT_NE(complaint(text, unit::length).reason.find("is not a known unit"), std::string::npos) << text;
    }
}

TEST(ReadQuantity, WhatIsNotANumberIsRejected) {
    for (const char* text : {"", " ", "mm", "five mm", "-", ".", "e5", "0x10"}) {
        EXPECT_EQ(complaint(text, unit::length).must, "must be a length [m]") << text;
    }
    EXPECT_EQ(complaint("a", unit::angle).must, "must be an angle [rad]");
}

TEST(ReadQuantity, NonFiniteNumbersAreRejected) {
    for (const char* text : {"inf", "-inf", ".inf", "-.INF", "nan", ".NaN", "Infinity", "1e999", "1e308 km"}) {
        EXPECT_EQ(complaint(text, unit::length).must, "must be finite") << text;
    }
}

TEST(WithUnit, IsAddedToPlainNumbersOnly) {
    EXPECT_EQ(with_unit("-3", unit::viscosity), "-3 Pa s");
    EXPECT_EQ(with_unit("3 cP", unit::viscosity), "3 cP");
    EXPECT_EQ(with_unit("3", unit::none), "3");
    EXPECT_EQ(with_unit("words", unit::viscosity), "words");
}

} // namespace
} // namespace treacle
