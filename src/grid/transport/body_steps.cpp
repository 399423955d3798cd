#include "grid/transport/body_steps.hpp"

#include "rigid/algebra.hpp"

namespace treacle::grid {

void BodyStepRecord::begin(const Solids& solids, const rigid::RigidBodies& bodies, const GridParticles& particles) {
    moves_ = bodies.any_moves();
    if (!moves_) return;
    before_.resize(bodies.size());
    for (std::size_t b = 0; b < bodies.size(); ++b) before_[b] = bodies.pose(b);
    const int n = particles.store.owned();
    reserve(beside_, static_cast<std::size_t>(n) + 1);
    const auto x = particles.position();
    const auto beside = beside_;
    const auto number = solids.number(), moves = solids.moves();
    const auto sampler = solids.sampler();
    const double band = solids.band();
    Kokkos::parallel_for(
        "treacle::body_beside", n, KOKKOS_LAMBDA(int i) {
            const double at[3] = {x(i, 0), x(i, 1), x(i, 2)};
            const int solid = sampler.at(at) < band ? number(sampler.nearest(at)) : -1;
            beside(i) = solid >= 0 && moves(solid) ? solid : -1;
        });
}

BodySteps BodyStepRecord::end(const MacGrid& grid, const Solids& solids, const rigid::RigidBodies& bodies) {
    if (!moves_) return {};
    using namespace rigid;
    step_.bodies = static_cast<int>(bodies.size());
    for (int k = 0; k < 3; ++k) step_.period[k] = grid.cells.period[k];
    reserve(step_.frame, BodyMotion::width * bodies.size());
    auto host = Kokkos::create_mirror_view(step_.frame);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        const auto now = bodies.pose(b), before = before_[b];
        const auto from = transposed(to_matrix(before.turn)), to = to_matrix(now.turn);
        for (std::size_t i = 0; i < 3; ++i) {
            host(BodyMotion::width * b + i) = before.centre[i];
            host(BodyMotion::width * b + 3 + i) = now.centre[i] - before.centre[i];
            host(BodyMotion::width * b + 6 + i) = 0;
            for (std::size_t j = 0; j < 3; ++j) {
                double turn = i == j ? -1 : 0;
                for (std::size_t k = 0; k < 3; ++k) turn += to[i][k] * from[k][j];
                host(BodyMotion::width * b + 9 + 3 * i + j) = turn;
            }
        }
    }
    Kokkos::deep_copy(step_.frame, host);
    return {beside_, step_, solids.number(), solids.moves(), solids.band()};
}

} // namespace treacle::grid
