#include "grid/pressure/resting_solids.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::grid {

RestingSolids::RestingSolids(const MacGrid& grid, const scene::Domain& domain, std::size_t bodies)
    : count_(6 + bodies) {
    motion_.bodies = static_cast<int>(count_);
    reserve(motion_.frame, BodyMotion::width * count_);
    reserve(counts_, count_);
    auto frame = Kokkos::create_mirror_view(motion_.frame);
    Kokkos::deep_copy(frame, 0.0);
    for (int k = 0; k < 3; ++k) {
        motion_.period[k] = grid.cells.period[k];
        if (motion_.period[k] > 0) centre_[static_cast<std::size_t>(k)] = grid.lower[k] + 0.5 * motion_.period[k];
    }
    for (std::size_t solid = 0; solid < count_; ++solid) {
        for (std::size_t k = 0; k < 3; ++k) frame(BodyMotion::width * solid + k) = centre_[k];
    }
    for (std::size_t side = 0; side < 6; ++side) {
        const auto& v = domain.faces[side].velocity;
        for (std::size_t k = 0; k < 3; ++k) frame(BodyMotion::width * side + 3 + k) = motion_.side[side][k] = v[k];
        max_speed_ = std::max(max_speed_, std::hypot(v[0], v[1], v[2]));
    }
    Kokkos::deep_copy(motion_.frame, frame);
    any_moves_ = max_speed_ > 0;
}

void RestingSolids::about_origin(std::vector<double>& loads) const {
    for (std::size_t at = 0; at + 6 <= loads.size(); at += 6) {
        for (std::size_t a = 0; a < 3; ++a) {
            const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
            loads[at + 3 + a] += centre_[b] * loads[at + c] - centre_[c] * loads[at + b];
        }
    }
}

void RestingSolids::renumber(const Array<int>& number, std::size_t n, Array<int>& out) const {
    reserve(out, n);
    const auto to = out, counts = counts_;
    Kokkos::parallel_for(
        "treacle::resting_numbers", static_cast<int>(n), KOKKOS_LAMBDA(int i) {
            const int slot = number(i) == Solids::nothing ? -1 : Solids::slot(number(i));
            to(i) = slot >= 0 && counts(slot) != 0 ? slot : -1;
        });
}

void RestingSolids::find(const Solids& solids, const FractionBuilder& builder, const rigid::RigidBodies& bodies) {
    const auto& nodes = solids.nodes();
    if (any_found_ && !bodies.any_moves() && same_cells(found_, nodes.window)) return;
    if (!any_found_) {
        auto counts = Kokkos::create_mirror_view(counts_);
        for (std::size_t k = 0; k < count_; ++k) counts(k) = k >= 6 && bodies.moves(k - 6) ? 0 : 1;
        Kokkos::deep_copy(counts_, counts);
    }
    any_found_ = true;
    found_ = nodes.window;
    renumber(solids.number(), nodes.size(), number_);
    builder.build_body_fractions(nodes, solids.distance(), number_, counts_, body_fractions_.data());
}

void RestingSolids::add_velocities(
    int axis, const CellBox& window, const Array<double>& factor, const Array<double>& out) const {
    const auto& of = body_fractions_[static_cast<std::size_t>(axis)];
    const auto first = of.first, which = of.body;
    const auto fraction = of.fraction, frame = motion_.frame;
    const bool scaled = factor.extent(0) > 0;
    Kokkos::parallel_for(
        "treacle::add_side_velocities", static_cast<int>(window.size()), KOKKOS_LAMBDA(int i) {
            double sum = 0;
            for (int k = first(i); k < first(i + 1); ++k)
                sum += fraction(k) * frame(BodyMotion::width * which(k) + 3 + axis);
            if (sum != 0) out(i) += (scaled ? factor(i) : 1.0) * sum;
        });
}

std::size_t RestingSolids::bytes() const {
    std::size_t total = 4 * (counts_.span() + number_.span()) + 8 * motion_.frame.span();
    for (const auto& of : body_fractions_) total += 4 * (of.first.span() + of.body.span()) + 8 * of.fraction.span();
    return total;
}

} // namespace treacle::grid
