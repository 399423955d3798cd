#include "sph/isph_step.hpp"

#include "sph/forces/end_velocity.hpp"
#include "sph/forces/motion.hpp"

#include <algorithm>

// Motion at the ends of steps, and what a checkpoint holds of it.
namespace treacle::sph {

namespace {
// Rates of RigidBodies::free_momenta() by gravity.
std::vector<double> fall_rates(const rigid::RigidBodies& bodies) {
    std::vector<double> out(rigid::RigidBodies::momentum_numbers * bodies.size());
    const auto& setup = bodies.setup();
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        if (!bodies.dynamic(b)) continue;
        Vec3 force{0, 0, 0};
        for (std::size_t k = 0; k < static_cast<std::size_t>(setup.dimensions); ++k) {
            if (!setup.bodies[b].locked[k]) force[k] = setup.bodies[b].mass * setup.gravity[k];
        }
        const auto at = out.begin() + static_cast<std::ptrdiff_t>(rigid::RigidBodies::momentum_numbers * b);
        std::ranges::copy(force, at);
        std::ranges::copy(rigid::cross(bodies.pose(b).centre, force), at + 6);
    }
    return out;
}
} // namespace

void IsphStep::begin_motion() {
    begin_velocities(liquid_, 0, setup_.forces.gravity);
    end_motion_.start(middle_motion(),
        {measure_momentum(comm_, liquid_, setup_.constants, liquid_.rate()), fall_rates(bodies_.rigid)});
}

flow::EndMotion::Middle IsphStep::middle_motion() const {
    return {measure_momentum(comm_, liquid_, setup_.constants, liquid_.velocity()), bodies_.rigid.free_momenta()};
}

// (S10)
void IsphStep::end_motion(const flow::StepTimes& times) {
    before_ = times.drift;
    if (!setup_.options.pressure.recovers_positions()) return begin_motion();
    end_velocities(liquid_, times);
    end_motion_.record(middle_motion(), bodies_.rigid.impact_momenta(), times);
    bodies_.rigid.set_lead(end_motion_.lead());
}

std::vector<double> IsphStep::history() const {
    std::vector<double> out{before_};
    const auto motion = end_motion_.state();
    out.insert(out.end(), motion.begin(), motion.end());
    if (!inflow_) return out;
    const auto inflow = inflow_->state();
    out.insert(out.end(), inflow.begin(), inflow.end());
    return out;
}

void IsphStep::restore_history(std::span<const double> state) {
    before_ = state[0];
    state = state.subspan(1);
    end_motion_.restore(state, bodies_.rigid.size());
    if (!inflow_) return;
    const auto inflow = state.subspan(end_motion_.state().size());
    inflow_->restore({inflow.begin(), inflow.end()});
}

LiquidTotals IsphStep::totals() const {
    auto out = measure_totals(comm_, liquid_, setup_.constants, setup_.forces.gravity, liquid_.end_velocity());
    std::copy_n(end_motion_.liquid().begin(), 3, out.momentum.begin());
    std::copy_n(end_motion_.liquid().begin() + 3, 3, out.angular_momentum.begin());
    return out;
}

} // namespace treacle::sph
