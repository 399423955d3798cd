#include "app/video/run_flow.hpp"

#include "app/setup/geometry.hpp"
#include "base/text/error.hpp"

#include <algorithm>

namespace treacle::app {

// A frame in memory, with what is built over it.
struct RunFlow::Loaded {
    std::size_t number = 0;
    io::Frame frame;
    surface::Solids solids;
    std::unique_ptr<identify::VelocitySampler> sampler;
    identify::SheetFlow flow;
};

RunFlow::RunFlow(const Comm& comm, const RunView& run) : run_(run), solids_(comm, run) {}
RunFlow::~RunFlow() = default;

const identify::SheetFlow& RunFlow::frame(std::size_t k) {
    for (const auto& one : loaded_) {
        if (one && one->number == k) return one->flow;
    }
    auto fresh = std::make_unique<Loaded>();
    fresh->number = k;
    fresh->frame = io::read_frame(run_.frame(k));
    const auto* velocity = fresh->frame.find("velocity");
    if (!velocity)
        throw InputError({run_.frame(k).string(), "has no velocity", "PIV measures it",
            "add velocity to output.fields of the scene"});
    fresh->solids = solids_.at(fresh->frame.step);
    fresh->sampler = std::make_unique<identify::VelocitySampler>(fresh->frame.positions,
        std::get<std::vector<double>>(velocity->values), particle_spacing(run_.input),
        run_.input.scene.domain.dimensions);
    auto& loaded = *fresh;
    loaded.flow.time = loaded.frame.time;
    loaded.flow.liquid = [&loaded](const Vec3& x) { return loaded.sampler->at(x); };
    loaded.flow.solid = [this, &loaded](const Vec3& x) -> std::optional<Vec3> {
        for (std::size_t b = 0; b < loaded.solids.bodies.size(); ++b) {
            if (loaded.solids.bodies[b].distance(x) < 0) return solids_.velocity(loaded.frame.step, b, x);
        }
        return {};
    };
    auto& slot = loaded_[next_];
    next_ = 1 - next_;
    slot = std::move(fresh);
    return slot->flow;
}

std::array<std::size_t, 2> RunFlow::around(double time) const {
    const auto& frames = run_.frames;
    const auto later = std::ranges::upper_bound(frames, time, {}, &io::SeriesEntry::time);
    const auto after = std::clamp<std::ptrdiff_t>(
        later - frames.begin(), 1, std::max<std::ptrdiff_t>(1, std::ptrdiff_t(frames.size()) - 1));
    return {std::size_t(after - 1), std::min(std::size_t(after), frames.size() - 1)};
}

} // namespace treacle::app
