#pragma once
#include "app/render/moving_solids.hpp"
#include "identify/compare/sheet_comparison.hpp"

#include <memory>

namespace treacle::app {

// Flow of a run frame by frame: the liquid between its particles, and the velocities of its bodies. Each rank reads for itself.
class RunFlow {
public:
    // Collective. The run must stay. Throws InputError.
    RunFlow(const Comm& comm, const RunView& run);
    ~RunFlow();
    // Flow of a frame, good until the second call after this one. Throws InputError for frames without velocities.
    const identify::SheetFlow& frame(std::size_t k);
    // The two frames around a time [s], or the two nearest to it.
    std::array<std::size_t, 2> around(double time) const;

private:
    struct Loaded;
    const RunView& run_;
    MovingSolids solids_;
    std::array<std::unique_ptr<Loaded>, 2> loaded_;
    std::size_t next_ = 0; // of the two that is replaced
};

} // namespace treacle::app
