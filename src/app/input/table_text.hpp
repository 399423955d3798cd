#pragma once
#include <cstdint>
#include <string>

namespace treacle::app {

// Lines of the commands that report: a label in a column of its own, numbers as one reads them.

std::string label(const std::string& text); // "  time [s]             "
std::string short_number(double value);     // four digits: "0.1235", "1.2e+07"
std::string grouped(std::uint64_t count);   // "1 234 567"

} // namespace treacle::app
