#pragma once
#include "grid/geometry/solids.hpp"
#include "grid/mac/particles.hpp"

#include <vector>

namespace treacle::grid {

// Places that moving bodies take along in a step, for kernels: a particle's way relative to the body beside it starts there.
struct BodySteps {
    Array<int> beside; // [owned particles] moving body within `band` before the step, or -1; empty: no body moves
    BodyMotion step;   // from the poses before it, with the step as the unit of time
    Array<int> number, moves; // Solids::number() after the step, Solids::moves()
    double band = 0;          // [m]

    // The moving body beside particle i at x, before the step or after it, or -1. solid: after the step.
    KOKKOS_INLINE_FUNCTION int body(int i, const DistanceSampler& solid, const double x[3]) const {
        if (beside.extent(0) == 0) return -1;
        if (beside(i) >= 0 || !(solid.at(x) < band)) return beside(i);
        const int now = number(solid.nearest(x));
        return now >= 0 && moves(now) ? now : -1;
    }
    // Writes where that body takes x, or x itself.
    KOKKOS_INLINE_FUNCTION void carry(int i, const DistanceSampler& solid, const double x[3], double to[3]) const {
        const int at = body(i, solid, x);
        double way[3] = {0, 0, 0};
        if (at >= 0) step.velocity(at, x, way);
        for (int k = 0; k < 3; ++k) to[k] = x[k] + way[k];
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
    BodyMotion step_;
};

} // namespace treacle::grid
