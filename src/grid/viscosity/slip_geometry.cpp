#include "grid/viscosity/slip_geometry.hpp"

#include <algorithm>
#include <limits>

namespace treacle::grid {

namespace {
double length_of(scene::Slip slip, double length) {
    if (slip == scene::Slip::no_slip) return 0;
    return slip == scene::Slip::free_slip ? std::numeric_limits<double>::infinity() : length;
}

// The no-slip sides alone are walls.
scene::Domain no_slip_sides(scene::Domain domain) {
    for (auto& face : domain.faces) {
        const bool slides = length_of(face.slip, face.slip_length) > 0;
        if (face.kind == scene::BoundaryKind::wall && slides) face.kind = scene::BoundaryKind::open;
    }
    return domain;
}

std::vector<char> no_slip_bodies(const SlipSetup& setup) {
    std::vector<char> out;
    for (std::size_t b = 0; b < setup.slip.size(); ++b) {
        out.push_back(length_of(setup.slip[b], setup.slip_length[b]) > 0 ? 0 : 1);
    }
    return out;
}

// The solid whose surface a cell has: that nearest to its middle. Where that is a no-slip one, it may be beside one that liquid slides along: then that
// of the nearest node of the cell which is nearest to such a solid.
struct SlipLengthLoop {
    FineNodes nodes;
    Array<int> number;
    Array<double> distance, of, length, of_centre;
    Array<int> body;

    KOKKOS_INLINE_FUNCTION double length_of_solid(int solid) const {
        return solid == Solids::nothing ? 0 : of(Solids::slot(solid));
    }
    KOKKOS_INLINE_FUNCTION int sliding_near(const int c[3]) const {
        int out = Solids::nothing;
        double least = 0;
        const int corners = nodes.dimensions == 2 ? 9 : 27;
        for (int k = 0; k < corners; ++k) {
            const int corner[3] = {2 * c[0] + k % 3, 2 * c[1] + k / 3 % 3, 2 * c[2] + k / 9};
            bool there = true;
            for (int a = 0; a < nodes.dimensions; ++a) there = there && corner[a] < 2 * nodes.window.hi[a];
            if (!there) continue;
            const int node = nodes.index(corner[0], corner[1], corner[2]);
            const double d = math::fabs(distance(node));
            if (!(length_of_solid(number(node)) > 0) || (out != Solids::nothing && !(d < least))) continue;
            out = number(node);
            least = d;
        }
        return out;
    }
    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        int c[3];
        nodes.window.cell(i, c);
        int nearest = number(FineNodes::per_cell * i + nodes.used() - 1);
        if (nearest != Solids::nothing && !(length_of_solid(nearest) > 0)) {
            if (const int sliding = sliding_near(c); sliding != Solids::nothing) nearest = sliding;
        }
        body(i) = nearest;
        of_centre(i) = distance(FineNodes::per_cell * i + nodes.used() - 1);
        length(i) = length_of_solid(nearest);
    }
};
} // namespace

SlipGeometry::SlipGeometry(const MacGrid& grid, const scene::Domain& domain, const SlipSetup& setup)
    : dimensions_(grid.dimensions), no_slip_(grid, no_slip_sides(domain), no_slip_bodies(setup)) {
    std::vector<double> lengths;
    for (const auto& face : domain.faces) {
        const bool wall = face.kind == scene::BoundaryKind::wall;
        const auto k = lengths.size();
        lengths.push_back(wall ? length_of(face.slip, face.slip_length) : 0);
        slip_.slides[k] = lengths.back() > 0;
        slip_.side[k] = k % 2 == 0 ? domain.min[k / 2] : domain.max[k / 2];
    }
    for (std::size_t b = 0; b < setup.slip.size(); ++b)
        lengths.push_back(length_of(setup.slip[b], setup.slip_length[b]));
    any_ = std::ranges::any_of(lengths, [](double length) { return length > 0; });
    reserve(lengths_, lengths.size());
    auto host = Kokkos::create_mirror_view(lengths_);
    for (std::size_t k = 0; k < lengths.size(); ++k) host(k) = lengths[k];
    Kokkos::deep_copy(lengths_, host);
}

void SlipGeometry::find_lengths(const Solids& solids) {
    const auto& nodes = solids.nodes();
    const auto n = static_cast<std::size_t>(nodes.window.size());
    reserve(slip_.length, n);
    reserve(slip_.body, n);
    reserve(slip_.distance, n);
    Kokkos::parallel_for("treacle::slip_lengths", static_cast<int>(n),
        SlipLengthLoop{nodes, solids.number(), solids.distance(), lengths_, slip_.length, slip_.distance, slip_.body});
}

void SlipGeometry::update(const CellHalo& halo, const rigid::RigidBodies& bodies, const Solids& solids,
    const ClosedCentres& closed, const LevelSet& liquid, FractionMethod method) {
    for (int a = 0; a < dimensions_; ++a) {
        for (int k = 0; k < 2; ++k) slip_.closed_centre[a][k] = closed.offset(a, k);
    }
    no_slip_.update(halo, bodies);
    builder_.build(no_slip_, liquid.distance(), method, slip_.no_slip_fractions);
    if (bodies.size() > 0) {
        builder_.build_body_fractions(
            no_slip_.nodes(), no_slip_.distance(), no_slip_.number(), no_slip_.moves(), body_fractions_.data());
    }
    find_lengths(solids);
}

} // namespace treacle::grid
