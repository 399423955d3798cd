#pragma once
#include "kokkos/particle_store.hpp"

namespace treacle::sph {

// Role of a liquid particle in the pressure system (dissertation, section 2.4.1 and 3.4).
enum Role : int {
    poisson = 0,   // an unknown
    dirichlet = 1, // p = 0
    separated = 2  // without liquid neighbours, touching a solid: its pressure follows directly
};

// The liquid's particles. State fields migrate and are checkpointed; work fields are valid for one step.
class LiquidParticles {
public:
    LiquidParticles()
        : velocity_(store.add<Array3>("mid_step_velocity", "m/s", FieldRole::state)),
          end_velocity_(store.add<Array3>("velocity", "m/s", FieldRole::state, true)),
          rate_(store.add<Array3>("rate", "m/s2", FieldRole::state)),
          pressure_(store.add<Array<double>>("pressure", "Pa", FieldRole::state, true)),
          liquid_(store.add<Array<int>>("liquid", "", FieldRole::state, true)),
          viscosity_(store.add<Array<double>>("viscosity", "Pa s", FieldRole::state, true)),
          density_(store.add<Array<double>>("density", "kg/m3", FieldRole::work, true)),
          volume_(store.add<Array<double>>("volume", "m3", FieldRole::work)),
          load_(store.add<Array<double>>("load", "Pa m6/kg2", FieldRole::work)),
          blended_(store.add<Array<double>>("blended_density", "kg/m3", FieldRole::work, true)),
          source_(store.add<Array<double>>("source", "kg/m3/s2", FieldRole::work)),
          diagonal_(store.add<Array<double>>("diagonal", "1/m2", FieldRole::work)),
          wall_term_(store.add<Array<double>>("wall_term", "1/m2", FieldRole::work)),
          response_(store.add<Array<double>>("response", "Pa/m2", FieldRole::work)),
          acceleration_(store.add<Array3>("acceleration", "m/s2", FieldRole::work)),
          role_(store.add<Array<int>>("role", "", FieldRole::work, true)),
          row_(store.add<Array<int>>("row", "", FieldRole::work)),
          component_(store.add<Array<int>>("component", "", FieldRole::work)) {}

    ParticleStore store; // owned particles, then ghosts
    // Copies of what pair sums read of a neighbour, one load each; of owned and ghost particles. Each loop over pairs
    // writes anew what it reads.
    Array4 packed_position{"treacle::packed_position", 0}; // x, y, z, and a number that is the loop's: volume or load
    Array4 motion{"treacle::motion", 0};                   // ux, uy, uz, p
    std::size_t bytes() const { return store.bytes() + 8 * (packed_position.span() + motion.span()); }

    // Fields [particles] or [particles][3]: owned particles, then ghosts with what was gathered last.
    const Array3& position() const { return store.position(); }  // [m]
    const Array<std::int64_t>& id() const { return store.id(); } // the same from step to step, on any number of ranks
    const Array3& velocity() const { return store.get<Array3>(velocity_); } // of the middle of the last step [m/s]
    const Array3& end_velocity() const {
        return store.get<Array3>(end_velocity_);
    }                                                               // of its end, end_velocity.hpp [m/s]
    const Array3& rate() const { return store.get<Array3>(rate_); } // of velocity() by the last step [m/s2]
    const Array<double>& pressure() const { return store.get<Array<double>>(pressure_); } // [Pa]
    const Array<int>& liquid() const { return store.get<Array<int>>(liquid_); } // number of its liquid, from 0
    // Used with ForceOptions::by_particle; otherwise a copy of the liquid's, for frames [Pa s].
    const Array<double>& viscosity() const { return store.get<Array<double>>(viscosity_); }
    const Array<double>& density() const { return store.get<Array<double>>(density_); } // [kg/m3]
    const Array<double>& volume() const { return store.get<Array<double>>(volume_); }   // m / density [m^D]
    const Array<double>& load() const { return store.get<Array<double>>(load_); } // pressure / density^2 [Pa m6/kg2]
    const Array<double>& blended_density() const { return store.get<Array<double>>(blended_); } // [kg/m3]
    const Array<double>& source() const { return store.get<Array<double>>(source_); }     // right-hand side [kg/m3/s2]
    const Array<double>& diagonal() const { return store.get<Array<double>>(diagonal_); } // sum a_ij + wall_term [1/m2]
    const Array<double>& wall_term() const { return store.get<Array<double>>(wall_term_); } // [1/m2]
    const Array<double>& response() const { return store.get<Array<double>>(response_); }   // bodies.hpp [Pa/m2]
    const Array3& acceleration() const { return store.get<Array3>(acceleration_); }         // [m/s2]
    const Array<int>& role() const { return store.get<Array<int>>(role_); }                 // Role
    const Array<int>& row() const { return store.get<Array<int>>(row_); } // global number of its row, -1: none
    const Array<int>& component() const { return store.get<Array<int>>(component_); }

    // With PressureOptions::corrects_gradients(): B of gradient_correction.hpp.
    void add_gradient_correction() {
        correction_diagonal_ = store.add<Array3>("gradient_correction_diagonal", "", FieldRole::work);
        correction_off_diagonal_ = store.add<Array3>("gradient_correction_off_diagonal", "", FieldRole::work);
        correction_weight_ = store.add<Array<double>>("gradient_correction_weight", "", FieldRole::work);
    }
    bool has_gradient_correction() const { return correction_diagonal_ >= 0; }
    const Array3& correction_diagonal() const { return store.get<Array3>(correction_diagonal_); }
    const Array3& correction_off_diagonal() const { return store.get<Array3>(correction_off_diagonal_); }
    const Array<double>& correction_weight() const { return store.get<Array<double>>(correction_weight_); }
    int correction_diagonal_field() const { return correction_diagonal_; }
    int correction_off_diagonal_field() const { return correction_off_diagonal_; }

    // With inlets: the number of the one that still moves the particle as prescribed, from 1 on; 0: it is free.
    void add_inlets() { inlet_ = store.add<Array<int>>("inlet", "", FieldRole::state); }
    bool has_inlets() const { return inlet_ >= 0; }
    const Array<int>& inlet() const { return store.get<Array<int>>(inlet_); }
    int inlet_field() const { return inlet_; }

    // Field numbers, for the halo.
    int velocity_field() const { return velocity_; }
    int liquid_field() const { return liquid_; }
    int viscosity_field() const { return viscosity_; }
    int pressure_field() const { return pressure_; }
    int volume_field() const { return volume_; }
    int load_field() const { return load_; }
    int acceleration_field() const { return acceleration_; }
    int role_field() const { return role_; }
    int row_field() const { return row_; }
    int component_field() const { return component_; }

private:
    int velocity_, end_velocity_, rate_, pressure_, liquid_, viscosity_, density_, volume_, load_, blended_, source_,
        diagonal_, wall_term_, response_, acceleration_, role_, row_, component_;
    int inlet_ = -1, correction_diagonal_ = -1, correction_off_diagonal_ = -1, correction_weight_ = -1;
};

// One layer of particles on each solid's surface and on the walls of the domain.
class SolidParticles {
public:
    SolidParticles()
        : velocity_(store.add<Array3>("velocity", "m/s", FieldRole::state)),
          volume_(store.add<Array<double>>("volume", "m3", FieldRole::state)),
          body_(store.add<Array<int>>("body", "", FieldRole::state, true)),
          reference_(store.add<Array3>("reference", "m", FieldRole::state)),
          normal_(store.add<Array3>("normal", "", FieldRole::state)),
          reference_normal_(store.add<Array3>("reference_normal", "", FieldRole::state)),
          pressure_(store.add<Array<double>>("pressure", "Pa", FieldRole::state, true)),
          diagonal_(store.add<Array<double>>("diagonal", "1/m2", FieldRole::work)),
          dirichlet_fraction_(store.add<Array<double>>("hold", "", FieldRole::work)),
          wetting_(store.add<Array<double>>("wetting", "1/m2", FieldRole::work)),
          role_(store.add<Array<int>>("role", "", FieldRole::work, true)),
          row_(store.add<Array<int>>("row", "", FieldRole::work)) {}

    ParticleStore store;                                         // owned particles, then ghosts
    const Array3& position() const { return store.position(); }  // [m]
    const Array<std::int64_t>& id() const { return store.id(); } // the same from step to step, on any number of ranks
    const Array3& velocity() const { return store.get<Array3>(velocity_); }           // [m/s]
    const Array<double>& volume() const { return store.get<Array<double>>(volume_); } // V_s [m^D]
    const Array<int>& body() const { return store.get<Array<int>>(body_); }           // 0: the domain's walls

    const Array3& reference() const { return store.get<Array3>(reference_); }               // position at the start
    const Array3& normal() const { return store.get<Array3>(normal_); }                     // unit, out of the solid
    const Array3& reference_normal() const { return store.get<Array3>(reference_normal_); } // at the start
    // With solids as unknowns (solid_rows.hpp); pressures are 0 without.
    const Array<double>& pressure() const { return store.get<Array<double>>(pressure_); }
    const Array<double>& diagonal() const { return store.get<Array<double>>(diagonal_); }
    const Array<double>& dirichlet_fraction() const { return store.get<Array<double>>(dirichlet_fraction_); }
    const Array<double>& wetting() const { return store.get<Array<double>>(wetting_); } // wall_slip.hpp
    const Array<int>& role() const { return store.get<Array<int>>(role_); }
    const Array<int>& row() const { return store.get<Array<int>>(row_); }

    // Field numbers, for the halo.
    int volume_field() const { return volume_; }
    int body_field() const { return body_; }
    int normal_field() const { return normal_; }
    int velocity_field() const { return velocity_; }
    int pressure_field() const { return pressure_; }
    int dirichlet_fraction_field() const { return dirichlet_fraction_; }
    int wetting_field() const { return wetting_; }
    int role_field() const { return role_; }
    int row_field() const { return row_; }

private:
    int velocity_, volume_, body_, reference_, normal_, reference_normal_, pressure_, diagonal_, dirichlet_fraction_,
        wetting_, role_, row_;
};

} // namespace treacle::sph
