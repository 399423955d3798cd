#pragma once
#include "surface/field/points.hpp"
#include "surface/mesh/triangulation.hpp"

namespace treacle::surface {

inline constexpr int most_liquids = 16;

// Fields of a store that the vertices take their values from; -1: there is none.
struct Sources {
    int velocity = -1, pressure = -1, liquid = -1;
    std::vector<int> scalars; // up to most_scalars
};

// The store, and its fields of these.
struct SourceParticles {
    const ParticleStore& store;
    const Sources& fields;
};

// (SV1) Values at the vertices: means of the particles around them, weighted with the splines of the implicit function; of the
// liquids the one with most weight.
class Attributes {
public:
    void interpolate(const Patch& patch, const SourceParticles& sources, const Lattice& lattice, const Points& points,
        const Options& options);

    const Array<double>& velocity() const { return velocity_; } // [vertices * 3]
    const Array<double>& pressure() const { return pressure_; } // [vertices]
    const Array<int>& liquid() const { return liquid_; }        // [vertices]
    const Array<double>& scalars() const { return scalars_; }   // [scalars][vertices]

private:
    Array<double> velocity_{"treacle::surface_velocity", 0}, pressure_{"treacle::surface_pressure", 0};
    Array<int> liquid_{"treacle::surface_liquid", 0};
    Array<double> scalars_{"treacle::surface_scalars", 0};
};

} // namespace treacle::surface
