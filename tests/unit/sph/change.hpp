#pragma once
#include "parts.hpp"

#include <functional>

namespace treacle::sph {

// What all liquid particles together gained.
struct Change {
    Vec3 momentum{}, angular{}; // [kg m/s], [kg m2/s] about the origin
    double size = 0;            // sum of |m du|
};
// density: of a liquid by its number, over the first one's.
inline Change change(
    const Parts& parts, const std::map<std::int64_t, State>& before,
    const std::function<double(int)>& density = [](int) { return 1.0; }) {
    const auto liquid = by_id(parts.comm, parts.liquid, parts.liquid.liquid());
    Change out;
    for (const auto& [id, now] : all_states(parts.comm, parts.liquid)) {
        const double m = parts.setup.constants.mass * density(static_cast<int>(liquid.at(id)));
        Vec3 p;
        for (std::size_t k = 0; k < 3; ++k) {
            p[k] = m * (now.u[k] - before.at(id).u[k]);
            out.momentum[k] += p[k];
            out.size += std::abs(p[k]);
        }
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t a = (k + 1) % 3, b = (k + 2) % 3;
            out.angular[k] += now.x[a] * p[b] - now.x[b] * p[a];
        }
    }
    return out;
}

} // namespace treacle::sph
