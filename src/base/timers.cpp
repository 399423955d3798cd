#include "base/timers.hpp"

#include <algorithm>

namespace treacle {

using Clock = std::chrono::steady_clock;

PhaseTimers::Scope::Scope(PhaseTimers& timers, std::size_t phase)
    : timers_(timers), phase_(phase), start_(Clock::now()) {}

PhaseTimers::Scope::~Scope() {
    auto& phase = timers_.phases_[phase_];
    phase.seconds += std::chrono::duration<double>(Clock::now() - start_).count();
    ++phase.calls;
}

const PhaseTimers::Phase* PhaseTimers::find(std::string_view name) const {
    const auto found = std::ranges::find(phases_, name, &Phase::name);
    return found == phases_.end() ? nullptr : &*found;
}

std::size_t PhaseTimers::index(std::string_view name) {
    if (const auto* phase = find(name)) return static_cast<std::size_t>(phase - phases_.data());
    phases_.push_back({std::string(name)});
    return phases_.size() - 1;
}

double PhaseTimers::seconds(std::string_view name) const {
    const auto* phase = find(name);
    return phase ? phase->seconds : 0;
}

std::int64_t PhaseTimers::calls(std::string_view name) const {
    const auto* phase = find(name);
    return phase ? phase->calls : 0;
}

void PhaseTimers::reset() {
    for (auto& phase : phases_) {
        phase.seconds = 0;
        phase.calls = 0;
    }
}

} // namespace treacle
