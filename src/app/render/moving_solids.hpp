#pragma once
#include "app/render/frame_set.hpp"
#include "surface/field/solids.hpp"

#include <functional>

namespace treacle::app {

// The solids of a run where they are at its frames, by its table of bodies.
class MovingSolids {
public:
    // Collective. Throws InputError. The run must stay.
    MovingSolids(const Comm& comm, const RunView& run);

    // At the end of the step, from bodies.csv; before the first one: at the start.
    surface::Solids at(std::int64_t step) const;
    bool any_moves() const { return !poses_.empty(); } // false when all bodies are static
    // Velocity of the point x of a body [m/s].
    Vec3 velocity(std::int64_t step, std::size_t body, const Vec3& x) const;

private:
    std::vector<surface::Solid> start_;      // per body
    std::vector<int> moving_;                // per body: column of its position in bodies.csv; -1: it stays
    std::vector<std::vector<double>> poses_; // rows of bodies.csv: step, then 12 numbers a moving body
    std::vector<Vec3> first_velocity_;       // [m/s] per body, before the first step

    const std::vector<double>* row_of(std::int64_t step) const; // null before the first step
};

// Distance [m] from the solids that do not fill all space but what they hold, negative inside; `none` without any. Bodies of the names in
// `through` are transparent.
std::function<double(const Vec3&)> distance_of_seen(
    const Input& input, const surface::Solids& solids, double none, const std::vector<std::string>& through = {});

} // namespace treacle::app
