#include "grid/slip_geometry.hpp"

#include <algorithm>
#include <limits>

namespace treacle::grid {

namespace {
double length_of(scene::Slip slip, double length) {
    if (slip == scene::Slip::no_slip) return 0;
    return slip == scene::Slip::free_slip ? std::numeric_limits<double>::infinity() : length;
}

// The sides that grip alone are walls.
scene::Domain gripping_sides(scene::Domain domain) {
    for (auto& face : domain.faces) {
        const bool slides = length_of(face.slip, face.slip_length) > 0;
        if (face.kind == scene::FaceKind::wall && slides) face.kind = scene::FaceKind::open;
    }
    return domain;
}

std::vector<char> gripping_bodies(const SlipSetup& setup) {
    std::vector<char> out;
    for (std::size_t b = 0; b < setup.slip.size(); ++b) {
        out.push_back(length_of(setup.slip[b], setup.slip_length[b]) > 0 ? 0 : 1);
    }
    return out;
}
} // namespace

SlipGeometry::SlipGeometry(const MacGrid& grid, const scene::Domain& domain, const SlipSetup& setup)
    : dimensions_(grid.dimensions), gripping_(grid, gripping_sides(domain), gripping_bodies(setup)) {
    std::vector<double> lengths;
    for (const auto& face : domain.faces) {
        const bool wall = face.kind == scene::FaceKind::wall;
        lengths.push_back(wall ? length_of(face.slip, face.slip_length) : 0);
    }
    for (std::size_t b = 0; b < setup.slip.size(); ++b) lengths.push_back(length_of(setup.slip[b], setup.slip_length[b]));
    any_ = std::ranges::any_of(lengths, [](double length) { return length > 0; });
    reserve(lengths_, lengths.size());
    auto host = Kokkos::create_mirror_view(lengths_);
    for (std::size_t k = 0; k < lengths.size(); ++k) host(k) = lengths[k];
    Kokkos::deep_copy(lengths_, host);
}

void SlipGeometry::find_lengths(const Solids& solids) {
    const auto& window = solids.nodes().window;
    const auto n = static_cast<std::size_t>(window.size());
    reserve(slip_.length, n);
    reserve(slip_.body, n);
    const auto length = slip_.length, of = lengths_;
    const auto body = slip_.body, number = solids.number();
    const int middle = dimensions_ == 2 ? 3 : 7;
    Kokkos::parallel_for("treacle::slip_lengths", static_cast<int>(n), KOKKOS_LAMBDA(int i) {
        const int nearest = number(FineNodes::per_cell * i + middle);
        body(i) = nearest;
        length(i) = nearest == Solids::nothing ? 0 : of(Solids::place(nearest));
    });
}

void SlipGeometry::update(const CellHalo& halo, const rigid::RigidBodies& bodies, const Solids& solids,
                          const LevelSet& liquid, FractionMethod method) {
    gripping_.update(halo, bodies);
    builder_.build(gripping_.nodes(), gripping_.distance(), liquid.distance(), method, slip_.grip);
    if (bodies.size() > 0) {
        builder_.build_body_shares(gripping_.nodes(), gripping_.distance(), gripping_.number(), gripping_.moves(),
                                   shares_.data());
    }
    find_lengths(solids);
}

} // namespace treacle::grid
