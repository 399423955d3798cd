#pragma once
#include "search/problem/random.hpp"
#include "search/problem/search.hpp"

namespace treacle::search {

// Options of Swarm.
struct SwarmOptions {
    std::uint64_t seed = 1;         // of the particles' places, velocities and pulls
    std::size_t particles = 0;      // 0: 10 + floor(2 sqrt n), as SPSO 2007 has it
    double value_tolerance = 1e-11; // range of the particles' best values that ends the search
    Limits limits{};                // of evaluations, generations and the objective
};

// Particle swarm with constriction, each particle drawn to the best of its own places and of those of its two neighbours on a
// ring (Clerc & Kennedy 2002, Bratton & Kennedy 2007). It begins within two steps around the start.
class Swarm : public Search {
public:
    explicit Swarm(std::vector<Axis> axes, SwarmOptions options = {});

    // A place that is worse than the particle's best changes nothing.
    double cut(std::size_t k) const override;
    Point spread() const override; // deviation of the particles' best places from the best of all
    const char* name() const override { return "swarm"; }

protected:
    Task<void> method() override;

private:
    struct Particle {
        Point x;
        std::vector<double> velocity; // [n] a generation
        Point best;
        Value best_value = Value::failed();
    };
    void begin();
    void move(std::uint32_t generation);
    std::size_t leader(std::size_t k) const; // the best of k and its neighbours
    bool has_converged();

    SwarmOptions options_;
    Random random_;
    std::vector<Particle> particles_;
};

} // namespace treacle::search
