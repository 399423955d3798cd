#include "flow/flow_curve.hpp"

namespace treacle::flow {

FlowCurve make_flow_curve(const scene::Liquid& liquid) {
    const auto& r = liquid.rheology;
    return {r.law,          liquid.viscosity,      r.exponent,        r.infinite_viscosity, r.relaxation_time,
            r.yield_stress, r.regularisation_time, r.least_shear_rate};
}

} // namespace treacle::flow
