#include "scene/renamed_keys.hpp"

#include <array>

namespace treacle::scene {

std::span<const Renamed> renamed_keys() {
    static const std::array table{
        Renamed{"lost_limit", "max_lost_fraction"},
        Renamed{"liquids.*.around_bodies", "subtract_bodies"},
        Renamed{"liquids.*.rheology.infinite_viscosity", "infinite_shear_viscosity"},
        Renamed{"liquids.*.rheology.least_shear_rate", "min_shear_rate"},
        Renamed{"materials.*.rheology.infinite_viscosity", "infinite_shear_viscosity"}, // of a result.yaml
        Renamed{"materials.*.rheology.least_shear_rate", "min_shear_rate"},
        Renamed{"method.rebalance_above", "max_load_imbalance"},
        Renamed{"method.pressure.body_coupling", "coupling"},
        Renamed{"method.pressure.coupling", "strong", "implicit"},
        Renamed{"method.pressure.coupling", "weak", "explicit"},
        Renamed{"method.pressure.preconditioner", "multilevel_rediscretised", "multilevel_grids"},
        Renamed{"method.viscosity.body_coupling", "coupling"},
        Renamed{"method.viscosity.coupling", "strong", "implicit"},
        Renamed{"method.viscosity.coupling", "weak", "explicit"},
        Renamed{"method.viscosity.form", "as_published", "printed"},
        Renamed{"method.viscosity.checkerboard_damping", "hourglass_coefficient"},
        Renamed{"method.viscosity.rheology_solves", "max_picard_iterations"},
        Renamed{"method.viscosity.rheology_residual", "picard_residual"},
        Renamed{"method.grid.rebalance_above", "max_load_imbalance"},
        Renamed{"method.grid.pressure.least_distance", "min_theta"},
        Renamed{"method.grid.pressure.least_opening", "min_face_area_fraction"},
        Renamed{"method.grid.viscosity.least_wet", "min_liquid_fraction"},
        Renamed{"method.grid.viscosity.least_gap", "min_fluid_fraction"},
        Renamed{"method.grid.viscosity.normal_layer", "no_penetration_layer"},
        Renamed{"method.grid.correction.slack", "dead_band"},
        Renamed{"method.grid.correction.softness", "cfm_epsilon"},
        Renamed{"method.grid.contraction", "density_relaxation"},
        Renamed{"method.grid.density_relaxation.slack", "dead_band"},
    };
    return table;
}

} // namespace treacle::scene
