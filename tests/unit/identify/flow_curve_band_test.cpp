#include "identify/material/flow_curve_band.hpp"

#include "base/text/error.hpp"

#include <cmath>
#include <fstream>
#include <gtest/gtest.h>

namespace treacle::identify {
namespace {

// Half of the dissipation at 0.8 to 1.25 1/s, half at 80 to 125 1/s.
TEST(ShearRates, QuantilesAndMeanAreOfTheDissipation) {
    ShearRates rates;
    EXPECT_TRUE(rates.empty());
    EXPECT_EQ(rates.mean(), 0);
    for (int i = 0; i < 10; ++i) {
        rates.add(1.01, 0.2);
        rates.add(101, 0.2);
    }
    rates.add(0, 5);
    rates.add(3, std::nan(""));
    EXPECT_NEAR(rates.quantile(0.25), 1.12, 0.02);
    EXPECT_NEAR(rates.quantile(0.75), 112, 2);
    EXPECT_NEAR(rates.mean(), 56, 2); // of the middles of bins, 12 % wide to either side
    const auto folder = std::filesystem::temp_directory_path() / "treacle_shear_rates_test";
    std::filesystem::create_directories(folder);
    write_shear_rates(folder, rates);
    EXPECT_EQ(read_shear_rates(folder).weights(), rates.weights());
    EXPECT_TRUE(read_shear_rates(folder / "none").empty());
    std::filesystem::remove_all(folder);
}

ViscositiesByRate power_law(double consistency, double exponent) {
    ViscositiesByRate out;
    for (double rate = 0.1; rate < 200; rate *= 1.3) {
        out.rates.push_back(rate);
        out.viscosities.push_back(consistency * std::pow(rate, exponent - 1));
    }
    return out;
}

TEST(FlowCurveBand, IsComparedOverTheFlowsRatesAndTheUsualOnes) {
    FlowCurveBand band;
    band.liquid = "lotion";
    band.value = power_law(11, 0.5);
    band.low = power_law(10, 0.5);
    band.high = power_law(12, 0.5);
    band.measured = power_law(10, 0.5);
    band.flow.add(5, 1);
    EXPECT_NEAR(*curve_error(band, 1, 30), std::log(1.1), 1e-9);
    EXPECT_FALSE(curve_error(band, 1000, 2000).has_value());
    EXPECT_NEAR(*band.value.at(4), 11 / 2.0, 1e-9);
    EXPECT_FALSE(band.value.at(0.05).has_value());
    const auto lines = describe(band);
    EXPECT_EQ(lines.size(), 3u); // no measured point within the narrow range of rates
    EXPECT_NE(lines[1].find("10 %"), std::string::npos);
    EXPECT_NE(yaml(band).find("error_1_to_30: 0.0953"), std::string::npos);
    EXPECT_NE(chart(band).find("measured"), std::string::npos);
}

TEST(FlowCurveBand, TablesOfRheometersAreReadAndBadOnesRefused) {
    const auto path = std::filesystem::temp_directory_path() / "treacle_flow_curve_test.csv";
    const auto read = [&](const char* text) {
        std::ofstream(path) << text;
        return read_flow_curve(path);
    };
    const auto curve = read("shear_rate_1_per_s,shear_stress_Pa,viscosity_Pa_s\n10,20,2\n0.1,1,10\n1,4,4\n");
    EXPECT_EQ(curve.rates, (std::vector<double>{0.1, 1, 10}));
    EXPECT_EQ(curve.viscosities, (std::vector<double>{10, 4, 2}));
    EXPECT_EQ(read("shear rate [1/s],viscosity [Pa.s]\n1,4\n2,3\n").rates.size(), 2u);
    EXPECT_THROW(read("shear rate [1/min],viscosity [Pa.s]\n1,4\n2,3\n"), InputError);
    EXPECT_THROW(read("rate,viscosity\n1,4\n2,3\n"), InputError);
    EXPECT_THROW(read("shear rate,viscosity\n1,4\n"), InputError);
    std::filesystem::remove(path);
}

} // namespace
} // namespace treacle::identify
