#include "identify/experiment/digits.hpp"

#include <cstdio>

namespace treacle::identify {

std::string digits(double value, int count) {
    char text[32];
    std::snprintf(text, sizeof text, "%.*g", count, value);
    return text;
}

} // namespace treacle::identify
