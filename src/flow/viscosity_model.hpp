#pragma once
#include "kokkos/types.hpp"
#include "scene/scene.hpp"

namespace treacle::flow {

// Viscosity by shear rate of one liquid (Bird, Armstrong & Hassager 1987; the yield stress regularised as
// Papanastasiou 1987 does). At rates below `least_rate` a power law changes no more, smoothly.
struct ViscosityModel {
    scene::ViscosityModelKind law = scene::ViscosityModelKind::newtonian;
    double viscosity = 0; // [Pa s] newtonian; at 1/s: power law, Herschel-Bulkley; at rest: Carreau, Cross
    double exponent = 1;  // n; of Cross m
    double infinite_shear_viscosity = 0; // [Pa s]
    double relaxation_time = 0;          // [s]
    double yield_stress = 0;             // [Pa]
    double regularisation = 0;           // [s]
    double least_rate = 0;               // [1/s]

    KOKKOS_INLINE_FUNCTION double operator()(double rate) const {
        switch (law) {
        case scene::ViscosityModelKind::newtonian: return viscosity;
        case scene::ViscosityModelKind::power_law: return power(rate);
        case scene::ViscosityModelKind::carreau: {
            const double x = relaxation_time * rate;
            return infinite_shear_viscosity +
                   (viscosity - infinite_shear_viscosity) * math::pow(1 + x * x, 0.5 * (exponent - 1));
        }
        case scene::ViscosityModelKind::cross:
            return infinite_shear_viscosity +
                   (viscosity - infinite_shear_viscosity) / (1 + math::pow(relaxation_time * rate, exponent));
        case scene::ViscosityModelKind::herschel_bulkley: {
            const double x = regularisation * rate;
            const double ratio = x > 1e-6 ? (1 - math::exp(-x)) / x : 1 - 0.5 * x; // of the viscosity at rest
            return power(rate) + yield_stress * regularisation * ratio;
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
ViscosityModel make_viscosity_model(const scene::Liquid& liquid);

} // namespace treacle::flow
