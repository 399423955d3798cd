#include "grid/viscosity/volume_stiffness.hpp"

#include "grid/pressure/pressure.hpp"
#include "grid/viscosity/viscous_faces.hpp"

namespace treacle::grid {

namespace {
// The exact fraction of a pressure's flux is 1/(2 eta) in a cell between equally viscous ones; the loop below has
// 4 d/((2 d + 2) eta) of it in d dimensions.
double exact_fraction(int dimensions) { return 4.0 * dimensions / (2.0 * dimensions + 2); }

// The inverse of the sum of (area weight)^2 / (resistance of the face's own stresses) over the faces whose velocities the flux of a
// cell with a pressure takes; none beside faces that no stress resists, through which liquid leaves against its mass alone. The matrix
// holds none of cells without a stress of their own: mechanisms (mechanisms.hpp) stay what they are.
struct StiffnessLoop {
    ViscousFaces viscous;
    OpenFlux flux;
    PressureFaces pressure;
    Array<int> cell_of, by_body;
    double face, factor; // [m2], of a 2D scene [m]
    Array<double> by_row, stiffness_by_row, stiffness;

    // Resistance of a face's own stresses against its velocity.
    KOKKOS_INLINE_FUNCTION double resistance(int a, std::ptrdiff_t i) const {
        double stress = 0;
        viscous.each_stress(a, i, viscous.normal, viscous.shear, [&](double w) { stress += w; });
        const double fraction = viscous.fraction.axis[a](i);
        return fraction * fraction * stress;
    }
    KOKKOS_INLINE_FUNCTION void operator()(int r) const {
        double sum = 0;
        bool unresisted = false;
        for (int a = 0; a < pressure.dimensions; ++a) {
            for (int side = 0; side < 2; ++side) {
                const auto i = cell_of(r) + side * pressure.stride[a];
                const double area = face * pressure.open(a, static_cast<std::size_t>(i));
                if (!(area > 0)) continue;
                flux.each_taken(a, i, [&](std::ptrdiff_t j, double weight) {
                    const double resists = resistance(a, j);
                    unresisted = unresisted || !(resists > 0);
                    if (resists > 0) sum += area * area * weight * weight / resists;
                });
            }
        }
        const bool stress_free = !(viscous.normal(cell_of(r)) > 0);
        const double own = unresisted || !(sum > 0) ? 0.0 : factor / sum,
                     more = stress_free || by_body(r) != 0 ? 0.0 : own;
        by_row(r) = own + more;
        stiffness_by_row(r) = more;
        stiffness(cell_of(r)) = face * face * more;
    }
};
} // namespace

void VolumeStresses::find(Pressure& pressure, const ViscousFaces& viscous, const OpenFlux& flux,
    const rigid::RigidBodies& bodies, CellHalo& halo, double face) {
    const auto& system = pressure.system();
    const auto rows = static_cast<std::size_t>(system.rows());
    stiffness_.faces = system.faces();
    reserve(stiffness_.stiffness, static_cast<std::size_t>(halo.window().size()));
    Kokkos::deep_copy(stiffness_.stiffness, 0.0);
    reserve(by_row_, rows);
    reserve(stiffness_by_row_, rows);
    reserve(by_body_, rows);
    const auto by_body = Kokkos::create_mirror_view(by_body_);
    Kokkos::deep_copy(by_body, 0);
    for (const auto& entry : pressure.coupling().entries()) {
        if (bodies.dynamic(static_cast<std::size_t>(entry.body))) by_body(static_cast<std::size_t>(entry.row)) = 1;
    }
    Kokkos::deep_copy(by_body_, by_body);
    Kokkos::parallel_for("treacle::volume_stiffness", system.rows(),
        StiffnessLoop{viscous, flux, system.faces(), system.cell_of(), by_body_, face,
            exact_fraction(stiffness_.faces.dimensions), by_row_, stiffness_by_row_, stiffness_.stiffness});
    halo.gather({stiffness_.stiffness});
}

} // namespace treacle::grid
