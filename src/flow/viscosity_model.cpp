#include "flow/viscosity_model.hpp"

namespace treacle::flow {

ViscosityModel make_viscosity_model(const scene::Liquid& liquid) {
    const auto& r = liquid.rheology;
    return {r.law, liquid.viscosity, r.exponent, r.infinite_shear_viscosity, r.relaxation_time, r.yield_stress,
        r.regularisation_time, r.min_shear_rate};
}

} // namespace treacle::flow
