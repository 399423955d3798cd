#pragma once
#include "io/frame.hpp"

#include <cstdint>
#include <vector>

// Particle i of a known set: open_frames.py computes the same values.
struct Sample {
    std::vector<double> positions, velocities, densities;
    std::vector<std::int64_t> ids;
    std::vector<std::int32_t> roles;
    std::vector<std::uint8_t> phases;

    // Particles first to first + count - 1.
    Sample(int first, int count) {
        for (int i = first; i < first + count; ++i) {
            positions.insert(positions.end(), {0.25 * i, -0.5 * i, 1.0 / 3.0});
            velocities.insert(velocities.end(), {0.1 * i, 0.0, -1.0});
            densities.push_back(1000.0 + i);
            ids.push_back((std::int64_t{1} << 40) + i);
            roles.push_back(i % 4 - 1);
            phases.push_back(static_cast<std::uint8_t>(200 + i % 2));
        }
    }

    treacle::io::ParticleBlock block() const {
        return {positions, {{"velocity", "m/s", 3, std::span(velocities)},
                               {"density", "kg/m^3", 1, std::span(densities)}, {"id", "1", 1, std::span(ids)},
                               {"role", "1", 1, std::span(roles)}, {"phase", "1", 1, std::span(phases)}}};
    }
};

// Splits total particles over the ranks; the rank that is named gets none unless it is alone.
struct Part {
    int first = 0;
    int count = 0;
};
inline Part part_without(const treacle::Comm& comm, int total, int empty_rank) {
    if (comm.size() == 1) return {0, total};
    const int active = comm.size() - 1;
    const int index = comm.rank() - (comm.rank() > empty_rank ? 1 : 0);
    const int first = total * index / active, end = total * (index + 1) / active;
    return comm.rank() == empty_rank ? Part{0, 0} : Part{first, end - first};
}
