#pragma once
#include "app/setup/geometry.hpp"
#include "kokkos/particle_store.hpp"
#include "mpi/comm.hpp"
#include "rigid/bodies.hpp"

namespace treacle::app {

// Points on the surfaces of bodies, for frames and pictures of methods whose solids are no particles. They are shared out
// evenly over the ranks and follow the bodies.
class SolidPoints {
public:
    SolidPoints(const Comm& comm, const Geometry& geometry);

    // Moves the points to where the bodies are.
    void move_points(const rigid::RigidBodies& bodies);
    const ParticleStore& store() const { return store_; } // fields id and body, as frames of solids have them

private:
    ParticleStore store_;
    std::vector<Vec3> start_;       // [m]
    std::vector<std::size_t> body_; // of the scene
};

} // namespace treacle::app
