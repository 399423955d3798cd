#pragma once
#include "grid/geometry/solids.hpp"
#include "grid/mac/particles.hpp"

#include <vector>

namespace treacle::grid {

// Places that moving bodies take along in a step, for kernels: a particle's way relative to the body beside it starts there.
struct BodySteps {
    static constexpr int width = 15;
    Array<int> beside;   // [owned particles] moving body within `band` before the step, or -1; empty: no body moves
    Array<double> frame; // [bodies][15] centre before the step and way of the centre [m], R - I of the turn, 3 x 3
    double period[3]{0, 0, 0}; // [m], 0: not periodic
    Array<int> number, moves;  // Solids::number() after the step, Solids::moves()
    double band = 0;           // [m]

    // The moving body beside particle i at x, before the step or after it, or -1. solid: after the step.
    KOKKOS_INLINE_FUNCTION int body(int i, const DistanceSampler& solid, const double x[3]) const {
        if (beside.extent(0) == 0) return -1;
        if (beside(i) >= 0 || !(solid.at(x) < band)) return beside(i);
        const int now = number(solid.nearest(x));
        return now >= 0 && moves(now) ? now : -1;
    }
    // Writes where that body takes x, or x itself.
    KOKKOS_INLINE_FUNCTION void carry(int i, const DistanceSampler& solid, const double x[3], double to[3]) const {
        for (int k = 0; k < 3; ++k) to[k] = x[k];
        const int at = width * body(i, solid, x);
        if (at < 0) return;
        double arm[3];
        for (int k = 0; k < 3; ++k) {
            arm[k] = x[k] - frame(at + k);
            if (period[k] > 0) arm[k] -= period[k] * math::floor(arm[k] / period[k] + 0.5);
        }
        for (int k = 0; k < 3; ++k) {
            const int turn = at + 6 + 3 * k;
            to[k] += frame(at + 3 + k) + frame(turn) * arm[0] + frame(turn + 1) * arm[1] + frame(turn + 2) * arm[2];
        }
    }
};

// BodySteps of a step: begin() before the bodies move, end() afterwards. Local.
class BodyStepRecord {
public:
    void begin(const Solids& solids, const rigid::RigidBodies& bodies, const GridParticles& particles);
    BodySteps end(const MacGrid& grid, const Solids& solids, const rigid::RigidBodies& bodies);

private:
    bool moves_ = false;
    std::vector<rigid::Pose> before_;
    Array<int> beside_{"treacle::body_beside", 0};
    Array<double> frame_{"treacle::body_steps", 0};
};

} // namespace treacle::grid
