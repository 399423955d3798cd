#pragma once
#include <optional>
#include <string_view>

namespace treacle {

// A number with a unit, "1 cm", as a number of another unit of its dimension, "mm": 10. Nothing where either is no unit that is
// known, or the dimensions differ.
std::optional<double> in_unit(std::string_view text, std::string_view unit);

} // namespace treacle
