#include "identify/experiment/occupancy.hpp"

#include "base/options/options.hpp"

#include <algorithm>

namespace treacle::identify {

void Occupancy::declare(Declaration& d) {
    d.integer("windows", windows, range_at_least(3),
        "Windows of time of equal length, each of a whole turn or more: their scatter is the noise of a window.");
    d.numbers("levels", levels, unit::none, range_between(0.01, 0.99),
        "Shares of a window's frames: contours around the pixels that are liquid at least so often are compared.");
    d.choice<MirrorAxis>("mirror", mirror,
        {{"none", MirrorAxis::none}, {"x", MirrorAxis::x}, {"y", MirrorAxis::y}, {"z", MirrorAxis::z}},
        "Axis along which the set-up is its own mirror image: the run counts with its mirror image, which turns the "
        "other way.");
    d.number("mirror_at", mirror_at, unit::length, range_any(), "Where the plane of that mirror crosses the axis.");
    d.check(!levels.empty() && std::ranges::is_sorted(levels, std::less_equal<>()), "levels",
        {"must be given, each higher than the one before", "there is a contour for each",
            "write for instance levels: [0.1, 0.5, 0.9]"});
}

std::vector<std::pair<std::size_t, std::size_t>> windows_of(std::size_t frames, int windows) {
    std::vector<std::pair<std::size_t, std::size_t>> out;
    const auto count = std::size_t(windows);
    for (std::size_t w = 0; w < count; ++w) out.emplace_back(w * frames / count, (w + 1) * frames / count);
    return out;
}

} // namespace treacle::identify
