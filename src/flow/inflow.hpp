#pragma once
#include "kokkos/particle_store.hpp"
#include "kokkos/periodic_box.hpp"
#include "scene/scene.hpp"

#include <vector>

namespace treacle::flow {

// An opening through which layers of a lattice flow in at one speed.
struct InletSetup {
    int liquid = 0;
    double viscosity = 0;     // of its particles, where particles have their own [Pa s]
    Vec3 centre{0, 0, 0};     // [m]
    Vec3 direction{0, 0, -1}; // unit
    std::vector<Vec3> points; // of one layer, from the centre, across the direction [m]
    bool round = false;       // they fill a disc; else a rectangle
    Vec3 along{1, 0, 0};      // unit: rows of points run along it
    double speed = 0;         // [m/s]
    double step = 0;          // from layer to layer [m]; 0: the layers' spacing
    double start = 0;         // [s] when the first layer passes the opening
    double end = 0;           // [s] when the last one does; 0: none is the last
};

// Region where particles are taken out: a box, or what lies behind a plane.
struct OutletSetup {
    bool box = true;
    Vec3 min{0, 0, 0}, max{0, 0, 0};      // [m]
    Vec3 point{0, 0, 0}, normal{0, 0, 1}; // [m]; away from what is taken out
};

// Inlets and outlets of a run, the same on every rank.
struct InflowSetup {
    std::vector<InletSetup> inlets;   // an inlet's number is its index
    std::vector<OutletSetup> outlets; // their union
    std::int64_t first_id = 0;        // of what flows in; all others' are below
};

// Layers of a method's lattice, and their number behind an opening.
struct Layers {
    double spacing = 0; // [m]
    int buffered = 0;
};

// From layer to layer [m].
double step_of(const InletSetup& inlet, const Layers& layers);

// Number of layers that an inlet has made up to a time [s], and in a run up to an end.
std::int64_t layers_until(const InletSetup& inlet, const Layers& layers, double time);

// Particles of all layers that inlets have made up to a time.
std::int64_t particles_until(const InflowSetup& setup, const Layers& layers, double time);

// Position of a layer along the direction, from the opening [m]: layer 0 passes it half a spacing after the start.
double layer_position(const InletSetup& inlet, const Layers& layers, std::int64_t layer, double time);

// Puts particles of layers into a store. Ids follow from the number of a layer and the index in it, the inlets' numbers
// alternating: the same on any number of ranks.
class InletEmitter {
public:
    // Fields of the store, by their numbers.
    struct Fields {
        int velocity, liquid, viscosity;
        int inlet = -1; // number of the inlet that holds a particle, from 1 on; -1: there is no such field
    };

    // Copies the points to the device. Positions wrap along periodic axes of the box.
    InletEmitter(const InflowSetup& setup, Layers layers, const PeriodicBox& box);

    // Input of the constructor.
    const InflowSetup& setup() const { return setup_; }
    const Layers& layers() const { return layers_; }

    // A layer of an inlet, where it is at a time.
    struct Layer {
        std::size_t inlet;
        std::int64_t number;
        double time; // [s]
    };
    // Appends the particles of one layer that lie in a rank's own cells, with the inlet's
    // velocity; all other state is zero. Ghosts are dropped.
    void add(
        ParticleStore& store, const Fields& fields, const CellGrid& grid, const CellBox& own, const Layer& layer) const;

private:
    std::int64_t id_of(std::size_t inlet, std::int64_t layer) const;

    InflowSetup setup_;
    Layers layers_;
    PeriodicBox box_;
    std::vector<Array3> points_; // of each inlet
};

} // namespace treacle::flow
