#pragma once
#include "grid/momentum/loose_liquid.hpp"
#include "grid/momentum/momentum_scene.hpp"
#include "grid/momentum/momentum_sums.hpp"
#include "rigid/bodies.hpp"

#include <span>
#include <vector>

namespace treacle::grid {

// (M) Momentum of liquid and bodies together. The solves exchange momentum between bodies and the liquid of the faces, whose
// mass is that of its volume fractions; particles read the faces, those beyond the solved ones among them, and so get more or
// less of it. What is missing belongs to all that touches: liquid and dynamic bodies that hang together and touch nothing else
// are given it as one rigid body, which strains nothing and moves nothing against anything else (the correction of least energy).
// Where they touch a body that is led, that one gives it: its load is what the liquid got. Walls and solids at rest likewise, and
// there is nothing to do. Liquid that touches no solid: loose_liquid.hpp. Between balances particles fly straight and carry what they
// had: paths that bend, gradients at other places in a cell and the position correction are no torques.
class MomentumBalance {
public:
    // Adds what particles carry, before there are any.
    void add_field(GridParticles& particles) {
        kept_ = particles.store.add<Array3>("angular_momentum", "kg m2/s", FieldRole::state);
    }
    const Array3& kept(const GridParticles& particles) const { return particles.store.get<Array3>(kept_); }
    using Scene = MomentumScene;
    // Collective, after the solves: which bodies and which liquid hang together, and the liquid's momentum while its particles have
    // the velocities of before.
    void begin(const Comm& comm, const Scene& scene, const rigid::RigidBodies& bodies);
    // Collective. `loads`: what the step has put on each body, mean over its kick, 6 numbers each [N], [N m], about their
    // centres; they become those that balance.
    void end(const Comm& comm, const Scene& scene, const MomentumKick& kick, rigid::RigidBodies& bodies,
        std::span<double> loads);

    // Memory of this rank [bytes].
    std::size_t bytes() const { return sizeof(double) * label_.span() + sizeof(int) * group_.span() + loose_.bytes(); }

    // Parts of begin() and end(); not private, since nvcc takes no kernel in a private function.
    MomentumSums sums(const Comm& comm, const Scene& scene, int group) const;
    void move(const Scene& scene, int group, const RigidMotion& motion) const;

private:
    struct Group {
        std::vector<std::size_t> bodies;
        bool balanced = false; // touches nothing that rests
        bool free = false;     // nor a body that is led, or that joints or locks hold
        MomentumSums before;
    };
    struct Labels;
    void connect(const Comm& comm, const Scene& scene, const rigid::RigidBodies& bodies);
    void lower_labels(const Comm& comm, const Scene& scene, const Array<int>::HostMirror& liquid, Labels& labels);
    std::vector<double> group_bodies(Labels& labels, const rigid::RigidBodies& bodies);

    Array<double> label_{
        "treacle::momentum_label", 0};               // [window] the least number of what hangs together, -1: no liquid
    Array<int> group_{"treacle::momentum_group", 0}; // [window] of groups_, -1
    std::vector<Group> groups_;
    LooseLiquid loose_;
    int kept_ = -1;     // field of the particles
    bool acts_ = false; // something moves
};

// Sets MomentumScene::kept of the owned particles from `begin` on to what they have.
void keep_angular_momenta(const MomentumScene& scene, int begin);

} // namespace treacle::grid
