#pragma once
#include <string>

namespace treacle::identify {

// Significant digits of a number for a reader: "0.1235", "1.2e+07".
std::string digits(double value, int count = 4);

} // namespace treacle::identify
