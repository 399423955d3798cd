#pragma once
#include "kokkos/types.hpp"
#include "scene/scene.hpp"

namespace treacle::flow {

// Viscosity by shear rate of one liquid (Bird, Armstrong & Hassager 1987; the yield stress regularised as
// Papanastasiou 1987 does). At rates below `least_rate` a power law changes no more, smoothly.
struct FlowCurve {
    scene::ShearLaw law = scene::ShearLaw::newtonian;
    double viscosity = 0; // [Pa s] newtonian; at 1/s: power law, Herschel-Bulkley; at rest: Carreau, Cross
    double exponent = 1;  // n; of Cross m
    double infinite_viscosity = 0; // [Pa s]
    double relaxation_time = 0;    // [s]
    double yield_stress = 0;       // [Pa]
    double regularisation = 0;     // [s]
    double least_rate = 0;         // [1/s]

    KOKKOS_INLINE_FUNCTION double operator()(double rate) const {
        switch (law) {
        case scene::ShearLaw::newtonian:
            return viscosity;
        case scene::ShearLaw::power_law:
            return power(rate);
        case scene::ShearLaw::carreau: {
            const double x = relaxation_time * rate;
            return infinite_viscosity +
                   (viscosity - infinite_viscosity) * math::pow(1 + x * x, 0.5 * (exponent - 1));
        }
        case scene::ShearLaw::cross:
            return infinite_viscosity +
                   (viscosity - infinite_viscosity) / (1 + math::pow(relaxation_time * rate, exponent));
        case scene::ShearLaw::herschel_bulkley: {
            const double x = regularisation * rate;
            const double share = x > 1e-6 ? (1 - math::exp(-x)) / x : 1 - 0.5 * x; // of the viscosity at rest
            return power(rate) + yield_stress * regularisation * share;
        }
        }
        return viscosity;
    }

private:
    KOKKOS_INLINE_FUNCTION double power(double rate) const {
        return viscosity * math::pow(rate * rate + least_rate * least_rate, 0.5 * (exponent - 1));
    }
};

// Curve of a liquid's viscosity and rheology; its profile and regions do not count.
FlowCurve make_flow_curve(const scene::Liquid& liquid);

} // namespace treacle::flow
