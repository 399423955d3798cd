#include "surface/field/lattice.hpp"

#include "base/text/error.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::surface {

namespace {
constexpr int unbounded = 1 << 28;

int tile_of(double x, double origin, double step) {
    return static_cast<int>(std::floor((x - origin) / (step * tile_edge)));
}
} // namespace

Domain cropped(const Domain& domain, const Vec3& min, const Vec3& max) {
    Domain out = domain;
    for (std::size_t k = 0; k < static_cast<std::size_t>(domain.dimensions); ++k) {
        const char axis[] = {static_cast<char>('x' + k), 0};
        const bool open_low = domain.sides[2 * k] == Side::open, open_high = domain.sides[2 * k + 1] == Side::open;
        const bool cuts_low = open_low || min[k] > domain.min[k], cuts_high = open_high || max[k] < domain.max[k];
        if (cuts_low) out.min[k] = min[k];
        if (cuts_high) out.max[k] = max[k];
        if (!(out.min[k] < out.max[k])) {
            throw InputError({"box", std::string("holds no part of the domain along ") + axis, "",
                "give the lower corner first, and a part of the domain"});
        }
        if (domain.sides[2 * k] == Side::periodic && (cuts_low || cuts_high)) {
            throw InputError({"box", std::string("cuts the period along ") + axis,
                "the liquid goes on at the other side there", "let the box hold the whole period"});
        }
        if (cuts_low) out.sides[2 * k] = Side::cut;
        if (cuts_high) out.sides[2 * k + 1] = Side::cut;
    }
    return out;
}

Lattice make_lattice(const Domain& domain, double step) {
    Lattice out;
    out.dimensions = domain.dimensions;
    for (std::size_t k = 0; k < 3; ++k) {
        out.lo[k] = -unbounded;
        out.hi[k] = unbounded;
        out.step[k] = step;
        if (static_cast<int>(k) >= domain.dimensions) continue;
        const Side low = domain.sides[2 * k], high = domain.sides[2 * k + 1];
        const double length = domain.max[k] - domain.min[k];
        if (low == Side::periodic) {
            // Two tiles at least, so that a tile's neighbours on both sides are images of others.
            const int tiles = std::max(2, static_cast<int>(std::ceil(length / (step * tile_edge) - 1e-9)));
            out.step[k] = length / (tiles * tile_edge);
            out.periodic[k] = true;
        } else if (low != Side::open && high != Side::open) {
            out.step[k] = length / std::max(2.0, std::round(length / step));
        }
        if (low != Side::open)
            out.origin[k] = domain.min[k];
        else if (high != Side::open)
            out.origin[k] = domain.max[k];
        const int cells = static_cast<int>(std::lround(length / out.step[k]));
        if (low != Side::open) out.lo[k] = 0;
        if (high != Side::open) out.hi[k] = low == Side::open ? 0 : cells;
        // A lower side without a wall: the upper one is where the numbers begin.
        if (low != Side::open && high == Side::open) out.hi[k] = unbounded;
        out.mirror[0][k] = low == Side::wall;
        out.mirror[1][k] = high == Side::wall;
    }
    return out;
}

void cover(Lattice& lattice, const Domain& domain, const double lo[3], const double hi[3]) {
    auto& grid = lattice.grid;
    grid.dimensions = lattice.dimensions;
    for (int k = 0; k < 3; ++k) {
        const auto axis = static_cast<std::size_t>(k);
        if (k >= lattice.dimensions) {
            lattice.base[k] = 0;
            grid.count[k] = 1;
            grid.origin[k] = 0;
            grid.inverse_width[k] = 1e-300;
            grid.period[k] = 0;
            continue;
        }
        int first = tile_of(lo[k], lattice.origin[k], lattice.step[k]) - 1;
        int last = tile_of(hi[k], lattice.origin[k], lattice.step[k]) + 1;
        // Behind a cut one tile more, whose particles count for the nodes before it.
        if (lattice.lo[k] > -unbounded)
            first = std::max(first, floor_divide(lattice.lo[k], tile_edge) - (lattice.mirror[0][k] ? 0 : 1));
        if (lattice.hi[k] < unbounded)
            last = std::min(last, floor_divide(lattice.hi[k], tile_edge) + (lattice.mirror[1][k] ? 0 : 1));
        if (lattice.periodic[k]) {
            first = 0;
            last = lattice.hi[k] / tile_edge - 1;
        }
        last = std::max(first, last);
        lattice.base[k] = first;
        grid.count[k] = last - first + 1;
        grid.origin[k] = lattice.origin[k] + first * tile_edge * lattice.step[k];
        grid.inverse_width[k] = 1 / (tile_edge * lattice.step[k]);
        grid.period[k] = lattice.periodic[k] ? domain.max[axis] - domain.min[axis] : 0;
        if (lattice.lo[k] > -unbounded) lattice.lo[k] -= tile_edge * first;
        if (lattice.hi[k] < unbounded) lattice.hi[k] -= tile_edge * first;
    }
}

} // namespace treacle::surface
