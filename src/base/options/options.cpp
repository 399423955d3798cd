#include "base/options/options.hpp"

#include "base/text/text.hpp"

#include <algorithm>
#include <cmath>

namespace treacle {

Range Range::because(std::string why, std::string what_to_do) const {
    Range out = *this;
    out.reason = std::move(why);
    out.cure = std::move(what_to_do);
    return out;
}

bool Range::contains(double value) const {
    if (lower == Lower::included && value < min) return false;
    if (lower == Lower::excluded && value <= min) return false;
    return value <= max;
}

std::string Range::text() const {
    const bool bounded = std::isfinite(max);
    const std::string low = lower == Lower::excluded ? "> " : ">= ";
    if (lower == Lower::none) return bounded ? "<= " + format_number(max) : "";
    if (!bounded) return low + format_number(min);
    if (lower == Lower::excluded) return low + format_number(min) + " and <= " + format_number(max);
    return "in [" + format_number(min) + ", " + format_number(max) + "]";
}

Range range_any() { return {}; }

Range range_above(double min) {
    Range range;
    range.lower = Range::Lower::excluded;
    range.min = min;
    return range;
}

Range range_at_least(double min) {
    Range range;
    range.lower = Range::Lower::included;
    range.min = min;
    return range;
}

Range range_between(double min, double max) {
    Range range = range_at_least(min);
    range.max = max;
    return range;
}

Range range_above_to(double min, double max) {
    Range range = range_above(min);
    range.max = max;
    return range;
}

void Declaration::direction(const std::string& key, Vec3& value, const std::string& doc, VectorKind kind) {
    vec3(key, value, unit::none, doc, kind);
    check(std::ranges::any_of(value, [](double x) { return x != 0; }), key,
        {"must not be zero", "it gives a direction", "write for instance [0, 1, 0]"});
}

} // namespace treacle
