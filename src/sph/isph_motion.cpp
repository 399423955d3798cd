#include "sph/isph_step.hpp"

#include "sph/forces/end_velocity.hpp"
#include "sph/forces/motion.hpp"

// Motion at the ends of steps, and what a checkpoint holds of it.
namespace treacle::sph {

void IsphStep::begin_motion() {
    begin_velocities(liquid_, 0, setup_.forces.gravity);
    end_motion_.start(middle_motion(),
        {measure_momentum(comm_, liquid_, setup_.constants, liquid_.rate()), bodies_.rigid.weight_rates()});
}

flow::EndMotion::Middle IsphStep::middle_motion() const {
    return {measure_momentum(comm_, liquid_, setup_.constants, liquid_.velocity()), bodies_.rigid.free_momenta()};
}

// (S10)
void IsphStep::end_motion(const flow::StepTimes& times) {
    before_ = times.drift;
    if (!setup_.options.pressure.recovers_positions()) return begin_motion();
    end_velocities(liquid_, times);
    const auto weights = bodies_.rigid.weight_rates();
    end_motion_.record(middle_motion(), {bodies_.rigid.impact_momenta(), weights}, times);
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
    const auto& momentum = end_motion_.liquid();
    const auto of_bodies = bodies_.rigid.moment_of_lead();
    for (std::size_t k = 0; k < 3; ++k) {
        out.momentum[k] = momentum[k];
        out.angular_momentum[k] = momentum[3 + k] - of_bodies[k];
    }
    return out;
}

} // namespace treacle::sph
