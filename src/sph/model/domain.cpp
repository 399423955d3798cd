#include "sph/model/domain.hpp"

#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "flow/sides.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::sph {

namespace {
bool periodic(const scene::Domain& domain, int axis) {
    return domain.faces[static_cast<std::size_t>(2 * axis)].kind == scene::BoundaryKind::periodic;
}

// A power of two so small that twice the domain is counted in whole, exactly representable steps.
double position_quantum(const scene::Domain& domain) {
    double extent = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        extent = std::max({extent, std::abs(domain.min[k]), std::abs(domain.max[k]), domain.max[k] - domain.min[k]});
    }
    return std::exp2(std::ceil(std::log2(extent)) + 2 - 52);
}
} // namespace

DomainBox make_domain_box(const scene::Domain& domain, double leak_depth) {
    DomainBox box{};
    box.dimensions = domain.dimensions;
    box.leak_depth = leak_depth;
    box.quantum = position_quantum(domain);
    for (int k = 0; k < 3; ++k) {
        const auto u = static_cast<std::size_t>(k);
        box.lo[k] = domain.min[u];
        box.hi[k] = domain.max[u];
        if (periodic(domain, k) && k < domain.dimensions) {
            box.lo[k] = std::round(domain.min[u] / box.quantum) * box.quantum;
            box.period[k] = std::round((domain.max[u] - domain.min[u]) / box.quantum) * box.quantum;
            box.hi[k] = box.lo[k] + box.period[k];
        }
        box.open[2 * k] = flow::beyond(domain.faces[2 * u]);
        box.open[2 * k + 1] = flow::beyond(domain.faces[2 * u + 1]);
    }
    return box;
}

CellGrid make_cell_grid(const scene::Domain& domain, double support) {
    CellGrid grid;
    grid.dimensions = domain.dimensions;
    const auto box = make_domain_box(domain, 0);
    const double width = support * (1 + 1e-12); // so that rounding never parts neighbours by two cells
    for (int k = 0; k < 3; ++k) {
        if (k >= domain.dimensions) {
            grid.origin[k] = -0.5 * width;
            grid.inverse_width[k] = 1 / width;
            continue;
        }
        const double length = box.hi[k] - box.lo[k];
        if (box.period[k] > 0) {
            grid.count[k] = static_cast<int>(std::floor(length / width));
            if (grid.count[k] < 2) {
                // Both as written: a period that misses the two radii by the digits of a double is as long as they are.
                const bool same = std::fabs(length - 2 * support) < 1e-9 * support;
                const auto [given, least] = tell_apart(same ? 2 * support : length, 2 * support);
                throw InputError({domain.where,
                    "domain: the period of " + given + " m in " + "xyz"[k] + " is not above two support radii, " +
                        least + " m",
                    "a particle must not meet two images of a neighbour",
                    "lengthen the domain, or refine domain.spacing"});
            }
            grid.origin[k] = box.lo[k];
            grid.inverse_width[k] = grid.count[k] / length;
            grid.period[k] = box.period[k];
        } else {
            grid.count[k] = static_cast<int>(std::ceil(length / width)) + 2;
            grid.origin[k] = box.lo[k] - width;
            grid.inverse_width[k] = 1 / width;
        }
    }
    return grid;
}

} // namespace treacle::sph
