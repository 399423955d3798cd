#pragma once
#include "app/frame_set.hpp"
#include "surface/mesher.hpp"

#include <memory>

namespace treacle::app {

surface::Domain surface_domain(const Input& input);
surface::Options surface_options(const Input& input);

// The surfaces of a run's liquid, frame by frame, cut at walls and at the solids where these are at the frame's time.
class SceneSurface {
public:
    // Collective. Throws InputError. The run must stay.
    SceneSurface(const Comm& comm, const RunView& run, const surface::Options& options);

    // Collective: each rank reads an equal part of the frame's rows. The mesh stays until the next call. Throws InputError.
    const surface::Mesh& build(std::size_t frame);
    const surface::Summary& summary() const { return mesher_.summary(); }
    double time() const { return time_; } // [s] of that frame
    const surface::Solids& solids() const { return solids_; } // where they are at that time
    bool solids_move() const { return !poses_.empty(); }

private:
    surface::Solids solids_at(std::int64_t step) const;

    Comm comm_;
    const RunView& run_;
    surface::Mesher mesher_;
    std::vector<surface::Solid> start_;   // per body
    std::vector<int> moving_;             // per body: column of its position in bodies.csv; -1: it stays
    std::vector<std::vector<double>> poses_; // rows of bodies.csv: step, then 6 numbers a moving body
    double time_ = 0;
    surface::Solids solids_;
};

} // namespace treacle::app
