#include "grid/mac/mac_grid.hpp"

#include "base/text/error.hpp"
#include "base/text/text.hpp"

#include <cmath>

namespace treacle::grid {

namespace {
// Shares of a cell by which a length may miss a whole number of cells.
constexpr double whole = 1e-6;

// By how much the cells begin before the domain does: of an axis that is open on both sides what they reach beyond it is shared by both, so that
// what is symmetrical about its middle stays so at any spacing. Otherwise they begin at the side itself, as walls are sharpest on nodes.
double first_side_surplus(const scene::Domain& domain, std::size_t axis, int cells) {
    if (domain.faces[2 * axis].kind != scene::BoundaryKind::open ||
        domain.faces[2 * axis + 1].kind != scene::BoundaryKind::open)
        return 0;
    const double surplus = cells * domain.spacing - (domain.max[axis] - domain.min[axis]);
    return surplus > whole * domain.spacing ? 0.5 * surplus : 0;
}
} // namespace

MacGrid make_mac_grid(const scene::Domain& domain) {
    MacGrid grid;
    grid.dx = domain.spacing;
    grid.dimensions = domain.dimensions;
    grid.cells.dimensions = domain.dimensions;
    for (int k = 0; k < 3; ++k) {
        const auto axis = static_cast<std::size_t>(k);
        grid.cells.inverse_width[k] = 1 / grid.dx;
        if (k >= domain.dimensions) {
            grid.lower[k] = -0.5 * grid.dx;
            grid.cells.origin[k] = grid.lower[k];
            continue;
        }
        const double length = domain.max[axis] - domain.min[axis];
        const double cells = length / grid.dx;
        const bool periodic = domain.faces[2 * axis].kind == scene::BoundaryKind::periodic;
        if (periodic && std::fabs(cells - std::round(cells)) > whole) {
            throw InputError({domain.where,
                "domain.spacing = " + format_number(grid.dx) + " m does not divide the period of " +
                    format_number(length) + " m",
                "a periodic axis of method grid holds a whole number of cells",
                "take " + format_number(length / std::ceil(cells)) + " m, or another period"});
        }
        const int count = static_cast<int>(std::ceil(cells - whole));
        const int beyond = periodic ? 0 : MacGrid::padding;
        grid.lower[k] = domain.min[axis] - beyond * grid.dx - first_side_surplus(domain, axis, count);
        grid.cells.origin[k] = grid.lower[k];
        grid.cells.count[k] = count + 2 * beyond;
        grid.cells.period[k] = periodic ? length : 0;
    }
    return grid;
}

PeriodicBox periodic_box(const MacGrid& grid) {
    PeriodicBox box;
    for (int k = 0; k < 3; ++k) {
        box.lo[k] = grid.lower[k];
        box.period[k] = grid.cells.period[k];
        box.hi[k] = box.lo[k] + box.period[k];
    }
    return box;
}

} // namespace treacle::grid
