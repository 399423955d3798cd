#include "sph/pressure/complementarity.hpp"

namespace treacle::sph {

namespace {
// Times that other particles may be held before what is held is taken as it is.
constexpr int most_rounds = 8;
} // namespace

Complementarity::Complementarity(const Comm& comm, const solve::KrylovOptions& options)
    : solver_(comm, "pressure", options) {}

std::int64_t Complementarity::anchor(const ComplementarityContext& parts) {
    auto& liquid = parts.liquid;
    const auto n = static_cast<std::size_t>(liquid.store.owned());
    std::vector<int> before(n);
    const auto role = on_host(liquid.role());
    for (std::size_t i = 0; i < n; ++i) before[i] = role(i);
    const auto pinned =
        parts.pinning.anchor(parts.options, parts.constants, parts.comm, liquid, parts.neighbours, parts.halo);
    const auto after = on_host(liquid.role());
    pinned_.assign(n, 0);
    for (std::size_t i = 0; i < n; ++i) pinned_[i] = before[i] != after(i);
    return pinned;
}

std::vector<solve::RowState> Complementarity::states(const LiquidParticles& liquid, const solve::Matrix& matrix) const {
    std::vector<solve::RowState> out(static_cast<std::size_t>(matrix.rows()));
    const auto role = on_host(liquid.role()), row = on_host(liquid.row());
    for (std::size_t i = 0; i < pinned_.size(); ++i) {
        if (row(i) < 0) continue;
        auto& state = out[static_cast<std::size_t>(row(i) - matrix.first_row())];
        state = pinned_[i] != 0            ? solve::RowState::fixed
                : role(i) == Role::poisson ? solve::RowState::free
                                           : solve::RowState::bound;
    }
    return out;
}

// Poisson: particles with pressure, and held ones that would have some.
void Complementarity::write_roles(
    const ComplementarityContext& parts, const PressureSystem::HostSystem& host, int first_row) {
    auto& liquid = parts.liquid;
    const auto role = on_host(liquid.role()), row = on_host(liquid.row());
    const auto gradient = solver_.gradient();
    for (std::size_t i = 0; i < pinned_.size(); ++i) {
        if (row(i) < 0) continue;
        const auto r = static_cast<std::size_t>(row(i) - first_row);
        const bool pressed = host.solution(r) > 0 || (pinned_[i] != 0 && gradient[r] < 0);
        role(i) = pressed ? Role::poisson : Role::dirichlet;
    }
    Kokkos::deep_copy(liquid.role(), role);
    parts.halo.gather(liquid.store, {liquid.role_field()});
}

solve::SolveReport Complementarity::solve(const ComplementarityContext& parts, solve::Matrix& matrix,
    const PressureSystem::HostSystem& host, const solve::ConvergenceTest& test, std::int64_t& pinned) {
    const auto rows = static_cast<std::size_t>(matrix.rows());
    auto& liquid = parts.liquid;
    std::vector<int> first(pinned_.size());
    {
        const auto role = on_host(liquid.role());
        for (std::size_t i = 0; i < first.size(); ++i) first[i] = role(i);
    }
    solve::SolveReport total;
    set_changes_ = 0;
    for (int round = 0;; ++round) {
        auto now = states(liquid, matrix);
        const auto report =
            solver_.solve(matrix, {host.right_hand_side.data(), rows}, {host.solution.data(), rows}, now, test);
        set_changes_ += report.set_changes;
        const auto before = total;
        total = report.solve;
        total.iterations += before.iterations;
        total.products += before.products;
        total.set_up_seconds += before.set_up_seconds;
        total.iteration_seconds += before.iteration_seconds;
        const bool singular = total.outcome == solve::Outcome::indefinite_matrix;
        if (!total.converged() && !singular) return total;
        write_roles(parts, host, matrix.first_row());
        const auto previous = pinned_;
        pinned = anchor(parts);
        if (!parts.comm.any(previous != pinned_)) break;
        if (round + 1 == most_rounds) {
            if (singular) return total;
            pinned_ = previous;
            break;
        }
    }
    if (!total.converged()) return total;
    misclassified_ = 0;
    const auto role = on_host(liquid.role());
    for (std::size_t i = 0; i < first.size(); ++i) misclassified_ += first[i] != role(i) ? 1 : 0;
    return total;
}

} // namespace treacle::sph
