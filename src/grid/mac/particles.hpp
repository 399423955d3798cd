#pragma once
#include "kokkos/particle_store.hpp"

namespace treacle::grid {

// The liquid's particles: they carry mass, velocity and its gradient from step to step (APIC), and mark where the
// liquid is. Sorted with the box of CellHalo::owned(), so that ghosts stand in every cell beside it.
class GridParticles {
public:
    GridParticles()
        : velocity_(store.add<Array3>("mid_step_velocity", "m/s", FieldRole::state)),
          end_velocity_(store.add<Array3>("velocity", "m/s", FieldRole::state, true)),
          acceleration_(store.add<Array3>("acceleration", "m/s2", FieldRole::state)),
          affine_{store.add<Array3>("gradient_of_u", "1/s", FieldRole::state),
              store.add<Array3>("gradient_of_v", "1/s", FieldRole::state),
              store.add<Array3>("gradient_of_w", "1/s", FieldRole::state)},
          liquid_(store.add<Array<int>>("liquid", "", FieldRole::state, true)),
          viscosity_(store.add<Array<double>>("viscosity", "Pa s", FieldRole::state, true)),
          pressure_(store.add<Array<double>>("pressure", "Pa", FieldRole::state, true)),
          density_(store.add<Array<double>>("density", "kg/m3", FieldRole::work, true)),
          image_(store.add<Array3>("image", "m", FieldRole::work)),
          correction_(store.add<Array3>("correction", "m", FieldRole::work)),
          multiplier_(store.add<Array<double>>("multiplier", "m2", FieldRole::work)),
          cause_(store.add<Array<int>>("cause", "", FieldRole::work)) {}

    // Fields [particles]: owned particles, then ghosts with the fields that were gathered last.
    ParticleStore store;
    const Array3& position() const { return store.position(); }
    const Array<std::int64_t>& id() const { return store.id(); }
    const Array3& velocity() const { return store.get<Array3>(velocity_); }           // of the middle of the last step
    const Array3& end_velocity() const { return store.get<Array3>(end_velocity_); }   // of its end, synchronise.hpp
    const Array3& acceleration() const { return store.get<Array3>(acceleration_); }   // of the last step
    const Array3& affine(int axis) const { return store.get<Array3>(affine_[axis]); } // gradient of one component
    const Array<int>& liquid() const { return store.get<Array<int>>(liquid_); }       // from 0
    const Array<double>& viscosity() const { return store.get<Array<double>>(viscosity_); } // [Pa s]
    const Array<double>& pressure() const {
        return store.get<Array<double>>(pressure_);
    }                                                                                   // of the last step, for frames
    const Array<double>& density() const { return store.get<Array<double>>(density_); } // position_correction.hpp
    const Array3& image() const { return store.get<Array3>(image_); }                   // level_set.hpp
    const Array3& correction() const { return store.get<Array3>(correction_); }         // [m], position_correction.hpp
    const Array<double>& multiplier() const { return store.get<Array<double>>(multiplier_); } // lambda [m2]
    const Array<int>& cause() const { return store.get<Array<int>>(cause_); } // LossCause, advection.hpp

    // Field numbers, for the halo.
    int velocity_field() const { return velocity_; }
    int affine_field(int axis) const { return affine_[axis]; }
    int liquid_field() const { return liquid_; }
    int viscosity_field() const { return viscosity_; }
    int correction_field() const { return correction_; }
    int multiplier_field() const { return multiplier_; }

private:
    int velocity_, end_velocity_, acceleration_, affine_[3], liquid_, viscosity_, pressure_, density_, image_,
        correction_, multiplier_, cause_;
};

} // namespace treacle::grid
