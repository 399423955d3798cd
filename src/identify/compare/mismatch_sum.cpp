#include "identify/compare/mismatch_sum.hpp"

#include <algorithm>
#include <utility>

namespace treacle::identify {

std::optional<double> mismatch_bound(const std::vector<FilmMismatches>& films, double cut) {
    double known = std::numeric_limits<double>::infinity(); // [s] before which all films are compared
    for (const auto& film : films) known = std::min(known, film.next);
    std::vector<std::pair<double, double>> parts; // time, part of the sum
    for (const auto& film : films) {
        for (std::size_t i = 0; i < film.times.size(); ++i) {
            if (film.times[i] < known) parts.emplace_back(film.times[i], film.mismatches[i] / double(film.masks));
        }
    }
    std::ranges::stable_sort(parts, {}, &std::pair<double, double>::first);
    double sum = 0;
    for (const auto& [time, part] : parts) {
        sum += part;
        if (sum > cut) return sum;
    }
    return {};
}

} // namespace treacle::identify
