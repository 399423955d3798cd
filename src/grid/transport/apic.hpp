#pragma once
#include "grid/mac/mac_grid.hpp"
#include "grid/mac/particles.hpp"

namespace treacle::grid {

// Affine particle-in-cell transfers with the weights of linear interpolation (Jiang et al. 2015): with c = sum grad w u
// both directions keep linear and angular momentum where all faces around a particle have weights.

// The particles that determine the liquid of each place.
struct LiquidScene {
    const GridParticles& particles; // ghosts with their liquid and viscosity
    const CellList& cells;
    const Array<double>& particle_mass; // [liquids] [kg]
};

// Masses [kg] (in 2D [kg/m] times dx, as Fractions) and velocities [m/s] of the faces of a window that has
// the cells of the list and one layer more: m_f = sum w m_p, m_f u_f = sum w m_p (u_p + c_p (x_f - x_p)).
// Faces that no particle reaches have mass 0 and velocity 0. Right for the faces of owned cells when the ghosts'
// velocity, affine fields and liquid have been gathered; then CellHalo::gather.
// The order of the sums is fixed: colours of rows of cells, no two of one colour sharing a face.
void particles_to_faces(
    const MacGrid& grid, const LiquidScene& liquids, const CellBox& window, FaceField& mass, FaceField& velocity);

// Velocity and affine matrix of the owned particles from the faces of the window, halo included.
void faces_to_particles(
    const MacGrid& grid, const CellBox& window, const FaceField& velocity, const GridParticles& particles);

// Pressures [Pa] of the owned particles from those of the centres of the window's cells, one cell around the owned ones
// included: linear in between.
void pressures_to_particles(
    const MacGrid& grid, const CellBox& window, const Array<double>& pressure, const GridParticles& particles);

// (R3) Viscosities [Pa s] of each centre and edge from the particles around, 1/mu = sum w m/mu_p / sum w m: liquids of different
// viscosity resist one after the other what shears the layer between them, since the stress is continuous. Where there are no
// particles, or some without viscosity, 0. As particles_to_faces(), with the ghosts' viscosity and liquid gathered.
void harmonic_viscosities(
    const MacGrid& grid, const LiquidScene& liquids, const CellBox& window, Array<double>& centres, EdgeField& edges);

// Viscosities below this count as none [Pa s].
constexpr double min_viscosity = 1e-12;
// Finite where there is none, and such that hardly any liquid without viscosity leaves less than min_viscosity.
KOKKOS_INLINE_FUNCTION double fluidity_of(double viscosity) { return 1 / math::max(viscosity, 1e-9 * min_viscosity); }
KOKKOS_INLINE_FUNCTION double harmonic_viscosity(double mass, double fluidity) {
    const double viscosity = mass > 0 ? mass / fluidity : 0;
    return viscosity > min_viscosity ? viscosity : 0;
}

// The sums of harmonic_viscosities(), for places that stand alike in their cells: sum w m and sum w m / mu over the
// particles around. Bit k of `node`: the places are at the lower end of their cell along axis k, else in its middle.
struct FluiditySums {
    Array<double>& mass;     // [window] sum w m [kg]
    Array<double>& fluidity; // [window] sum w m / mu [kg/(Pa s)]
};
void fluidity_sums(
    const MacGrid& grid, const LiquidScene& liquids, const CellBox& window, int node, const FluiditySums& out);

// The velocity anywhere among the faces of a window.
struct FaceSampler {
    CellBox window;
    double lower[3]{}, inverse_width = 0, width = 0; // [m], [1/m], [m]
    int dimensions = 3;
    FaceField faces;

    // Sampler of the field's arrays, which it shares.
    FaceSampler(const MacGrid& grid, const CellBox& cells, const FaceField& field)
        : window(cells), lower{grid.lower[0], grid.lower[1], grid.lower[2]}, inverse_width(1 / grid.dx), width(grid.dx),
          dimensions(grid.dimensions), faces(field) {}

    // Component `axis` at x [m/s] and, on request, its gradient [1/s]. Outside of the window as at its border.
    KOKKOS_INLINE_FUNCTION double component(int axis, const double x[3], double gradient[3] = nullptr) const {
        int base[3] = {0, 0, window.lo[2]};
        double s[3] = {0, 0, 0};
        for (int k = 0; k < dimensions; ++k) {
            double p = (x[k] - lower[k]) * inverse_width - (k == axis ? 0.0 : 0.5);
            // In this order what is not a number goes to the border.
            p = math::min(double(window.hi[k] - 1), math::max(double(window.lo[k]), p));
            base[k] = math::min(static_cast<int>(p) - (p < 0 ? 1 : 0), window.hi[k] - 2);
            s[k] = p - base[k];
        }
        const auto& u = faces.axis[axis];
        const int dy = window.hi[0] - window.lo[0], dz = dimensions == 2 ? 0 : dy * (window.hi[1] - window.lo[1]);
        const int i = window.index(base[0], base[1], base[2]), j = i + dz;
        const double a00 = u(i), a10 = u(i + 1), a01 = u(i + dy), a11 = u(i + dy + 1);
        const double b00 = u(j), b10 = u(j + 1), b01 = u(j + dy), b11 = u(j + dy + 1);
        const double a0 = a00 + s[0] * (a10 - a00), a1 = a01 + s[0] * (a11 - a01);
        const double b0 = b00 + s[0] * (b10 - b00), b1 = b01 + s[0] * (b11 - b01);
        const double a = a0 + s[1] * (a1 - a0), b = b0 + s[1] * (b1 - b0);
        if (gradient) {
            const double ax = (a10 - a00) + s[1] * ((a11 - a01) - (a10 - a00));
            const double bx = (b10 - b00) + s[1] * ((b11 - b01) - (b10 - b00));
            gradient[0] = inverse_width * (ax + s[2] * (bx - ax));
            gradient[1] = inverse_width * ((a1 - a0) + s[2] * ((b1 - b0) - (a1 - a0)));
            gradient[2] = inverse_width * (b - a);
        }
        return a + s[2] * (b - a);
    }
    // All components at x [m/s]; in 2D u[2] = 0.
    KOKKOS_INLINE_FUNCTION void velocity(const double x[3], double u[3]) const {
        for (int a = 0; a < 3; ++a) u[a] = a < dimensions ? component(a, x) : 0;
    }
};

} // namespace treacle::grid
