#pragma once
#include "grid/mac/mac_grid.hpp"
#include "grid/mac/particles.hpp"
#include "grid/pressure/pressure_coupling.hpp"
#include "kokkos/cells.hpp"
#include "mpi/cell_halo.hpp"
#include "rigid/bodies.hpp"

#include <array>
#include <span>
#include <vector>

namespace treacle::grid {

// (M) Momentum of liquid and bodies together. The solves exchange momentum between bodies and the liquid of the faces, whose
// mass is that of its volume fractions; particles read the faces, those beyond the solved ones among them, and so get more or
// less of it. What is missing belongs to all that touches: liquid and dynamic bodies that hang together and touch nothing else
// are given it as one rigid body, which strains nothing and moves nothing against anything else (the correction of least energy).
// Where they touch a body that is led, that one gives it: its load is what the liquid got. Walls and solids at rest likewise, and
// there is nothing to do.
class MomentumBalance {
public:
    // Input of a balance; arrays are over the window of the halo, particles with their ghosts.
    struct Scene {
        const MacGrid& grid;
        CellHalo& halo;
        const CellList& cells;                   // of the particles
        const Array<double>& distance;           // [window] of cells' centres from the liquid's surface [m]
        const FaceField& fluid;                  // fractions of the faces' cubes that are not solid
        const FaceBodyFractions& body_fractions; // of bodies that move
        const GridParticles& particles;
        const Array<double>& particle_mass; // [liquids] [kg]
    };
    // Collective, after the solves: which bodies and which liquid hang together, and the liquid's momentum while its particles have
    // the velocities of before.
    void begin(const Comm& comm, const Scene& scene, const rigid::RigidBodies& bodies);
    // Collective. `loads`: what the step has put on each body, mean over its kick, 6 numbers each [N], [N m], about their
    // centres; they become those that balance.
    struct Kick {
        const Vec3& gravity; // [m/s2]
        double time;         // that it acted for [s]
    };
    void end(
        const Comm& comm, const Scene& scene, const Kick& kick, rigid::RigidBodies& bodies, std::span<double> loads);

    // Memory of this rank [bytes].
    std::size_t bytes() const { return sizeof(double) * label_.span() + sizeof(int) * group_.span(); }

    // Part of begin(); not private, since nvcc takes no kernel in a private function.
    struct Sums {
        std::array<double, 6> momentum{}; // about the origin
        double mass = 0;                  // [kg]
        std::array<double, 3> moment{};   // mass times place
        std::array<double, 9> turn{}; // angular momentum of unit spins about each axis through the origin, by columns
    };
    Sums sums(const Comm& comm, const Scene& scene, int group) const;
    void move(const Scene& scene, int group, const Vec3& velocity, const Vec3& spin) const;

private:
    struct Group {
        std::vector<std::size_t> bodies;
        bool balanced = false; // touches nothing that rests
        bool free = false;     // nor a body that is led, or that joints or locks hold
        Sums before;
    };
    struct Labels;
    void connect(const Comm& comm, const Scene& scene, const rigid::RigidBodies& bodies);
    void lower_labels(const Comm& comm, const Scene& scene, const Array<int>::HostMirror& liquid, Labels& labels);
    std::vector<double> group_bodies(Labels& labels, const rigid::RigidBodies& bodies);

    Array<double> label_{
        "treacle::momentum_label", 0};               // [window] the least number of what hangs together, -1: no liquid
    Array<int> group_{"treacle::momentum_group", 0}; // [window] of groups_, -1
    std::vector<Group> groups_;
};

} // namespace treacle::grid
