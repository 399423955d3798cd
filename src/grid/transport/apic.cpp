#include "grid/transport/apic.hpp"

namespace treacle::grid {

namespace {
// Places that stand alike in their cells: bit k of `node`: at the lower end along axis k, else in the middle.
struct Weights {
    int index;              // of the node with the smallest coordinates
    double upper_weight[3]; // of the upper node along each axis
    double away[3];         // [m] from the particle to the lower node

    KOKKOS_INLINE_FUNCTION Weights(const double p[3], int node, double dx, const CellBox& window, int dimensions) {
        int base[3] = {0, 0, window.lo[2]};
        for (int k = 0; k < 3; ++k) {
            upper_weight[k] = away[k] = 0;
            if (k >= dimensions) continue;
            const double s = p[k] - (node >> k & 1 ? 0.0 : 0.5);
            base[k] = static_cast<int>(math::floor(s));
            upper_weight[k] = s - base[k];
            away[k] = -upper_weight[k] * dx;
        }
        index = window.index(base[0], base[1], base[2]);
    }
};

// Rows of cells of one colour, and the numbering of a window's places.
struct Rows {
    CellList cells;
    CellBox window;
    int dimensions;
    double lower[3], dx;
    int first[2], step[2], count[2]; // rows of the colour along y and z

    Rows(const MacGrid& grid, const CellList& list, const CellBox& to, int colour)
        : cells(list), window(to), dimensions(grid.dimensions), lower{grid.lower[0], grid.lower[1], grid.lower[2]},
          dx(grid.dx) {
        const int offset[2] = {colour % 3, colour / 3};
        for (int k = 0; k < 2; ++k) {
            const int lo = list.window.lo[k + 1], hi = list.window.hi[k + 1];
            const bool flat = k == 1 && dimensions == 2;
            step[k] = flat ? 1 : 3;
            // The first row whose number is the colour's modulo 3, whatever part of the grid the rank has.
            first[k] = flat ? lo : lo + ((offset[k] - lo) % 3 + 3) % 3;
            count[k] = hi > first[k] ? (hi - first[k] + step[k] - 1) / step[k] : 0;
        }
    }
    int size() const { return count[0] * count[1]; }
    static int colours(int dimensions) { return dimensions == 2 ? 3 : 9; }

    // visit(particle, place in cells) for all of row i.
    template <class Visit>
    KOKKOS_INLINE_FUNCTION void visit(int i, const Array3& x, const Visit& visit_particle) const {
        const int y = first[0] + step[0] * (i % count[0]), z = first[1] + step[1] * (i / count[0]);
        const int start = cells.window.index(cells.window.lo[0], y, z);
        const int end = start + cells.window.hi[0] - cells.window.lo[0];
        for (int c = start; c < end; ++c) {
            for (int k = cells.begin(c); k < cells.end(c); ++k) {
                const double p[3] = {(x(k, 0) - lower[0]) / dx, (x(k, 1) - lower[1]) / dx, (x(k, 2) - lower[2]) / dx};
                visit_particle(k, p);
            }
        }
    }
};

// Mass, value and gradient that a particle gives the places around it.
struct Carried {
    double mass, value;     // [kg], [value]
    const double* gradient; // [3] [value/m]
};

// Adds w m to the masses and w m (u + gradient (x_f - x_p)) to the sums of the eight (four) places around.
KOKKOS_INLINE_FUNCTION void spread(
    const Rows& rows, const Weights& w, const Carried& from, const Array<double>& masses, const Array<double>& sums) {
    const CellBox& window = rows.window;
    const double* gradient = from.gradient;
    const double dx = rows.dx;
    const int dy = window.hi[0] - window.lo[0], dz = dy * (window.hi[1] - window.lo[1]);
    const double at_base = from.value + gradient[0] * w.away[0] + gradient[1] * w.away[1] + gradient[2] * w.away[2];
    const int up = rows.dimensions == 2 ? 0 : 1;
    for (int z = 0; z <= up; ++z) {
        for (int y = 0; y < 2; ++y) {
            const int i = w.index + y * dy + z * dz;
            const double m = from.mass * (y ? w.upper_weight[1] : 1 - w.upper_weight[1]) *
                             (z ? w.upper_weight[2] : 1 - w.upper_weight[2]);
            const double low = m * (1 - w.upper_weight[0]), high = m * w.upper_weight[0];
            const double value = at_base + dx * (y * gradient[1] + z * gradient[2]);
            masses(i) += low;
            masses(i + 1) += high;
            sums(i) += low * value;
            sums(i + 1) += high * (value + dx * gradient[0]);
        }
    }
}

void spread_velocities(const Rows& rows, const LiquidScene& liquids, const FaceField& mass, const FaceField& momentum) {
    const auto& particles = liquids.particles;
    const auto x = particles.position(), u = particles.velocity();
    const Array3 affine[3] = {particles.affine(0), particles.affine(1), particles.affine(2)};
    const Array3 cx = affine[0], cy = affine[1], cz = affine[2];
    const auto liquid = particles.liquid();
    const auto particle_mass = liquids.particle_mass;
    Kokkos::parallel_for(
        "treacle::particles_to_faces", rows.size(), KOKKOS_LAMBDA(int i) {
            rows.visit(i, x, [&](int k, const double p[3]) {
                const double m = particle_mass(liquid(k));
                for (int a = 0; a < rows.dimensions; ++a) {
                    const Array3& c = a == 0 ? cx : a == 1 ? cy : cz;
                    const double gradient[3] = {c(k, 0), c(k, 1), c(k, 2)};
                    const Weights w(p, 1 << a, rows.dx, rows.window, rows.dimensions);
                    spread(rows, w, {m, u(k, a), gradient}, mass.axis[a], momentum.axis[a]);
                }
            });
        });
}

void spread_fluidities(const Rows& rows, const LiquidScene& liquids, int node, const FluiditySums& out) {
    const auto x = liquids.particles.position();
    const auto liquid = liquids.particles.liquid();
    const auto viscosity = liquids.particles.viscosity();
    const auto particle_mass = liquids.particle_mass, mass = out.mass, sums = out.fluidity;
    Kokkos::parallel_for(
        "treacle::fluidity_sums", rows.size(), KOKKOS_LAMBDA(int i) {
            const double none[3] = {0, 0, 0};
            rows.visit(i, x, [&](int k, const double p[3]) {
                const Weights w(p, node, rows.dx, rows.window, rows.dimensions);
                spread(rows, w, {particle_mass(liquid(k)), fluidity_of(viscosity(k)), none}, mass, sums);
            });
        });
}

void clear(Array<double>& field, std::size_t n) {
    reserve(field, n);
    Kokkos::deep_copy(Kokkos::subview(field, Kokkos::make_pair(std::size_t(0), n)), 0.0);
}

// Fluidities to viscosities.
void invert(const Array<double>& sums, const Array<double>& mass, std::size_t n) {
    Kokkos::parallel_for(
        "treacle::invert_fluidity", static_cast<int>(n),
        KOKKOS_LAMBDA(int i) { sums(i) = harmonic_viscosity(mass(i), sums(i)); });
}

// Sums to means.
void divide(const Array<double>& sums, const Array<double>& mass, std::size_t n) {
    Kokkos::parallel_for(
        "treacle::divide_by_mass", static_cast<int>(n), KOKKOS_LAMBDA(int i) {
            if (mass(i) > 0) sums(i) /= mass(i);
        });
}
} // namespace

void particles_to_faces(
    const MacGrid& grid, const LiquidScene& liquids, const CellBox& window, FaceField& mass, FaceField& velocity) {
    const auto n = static_cast<std::size_t>(window.size());
    for (int a = 0; a < grid.dimensions; ++a) {
        clear(mass.axis[a], n);
        clear(velocity.axis[a], n);
    }
    for (int colour = 0; colour < Rows::colours(grid.dimensions) && n > 0; ++colour) {
        spread_velocities(Rows(grid, liquids.cells, window, colour), liquids, mass, velocity);
    }
    for (int a = 0; a < grid.dimensions; ++a) divide(velocity.axis[a], mass.axis[a], n);
}

void fluidity_sums(
    const MacGrid& grid, const LiquidScene& liquids, const CellBox& window, int node, const FluiditySums& out) {
    const auto n = static_cast<std::size_t>(window.size());
    clear(out.mass, n);
    clear(out.fluidity, n);
    for (int colour = 0; colour < Rows::colours(grid.dimensions) && n > 0; ++colour) {
        spread_fluidities(Rows(grid, liquids.cells, window, colour), liquids, node, out);
    }
}

void harmonic_viscosities(
    const MacGrid& grid, const LiquidScene& liquids, const CellBox& window, Array<double>& centres, EdgeField& edges) {
    const auto n = static_cast<std::size_t>(window.size());
    Array<double> mass("treacle::viscosity_mass", n);
    const auto mean = [&](int node, Array<double>& out) {
        fluidity_sums(grid, liquids, window, node, {mass, out});
        invert(out, mass, n);
    };
    mean(0, centres);
    for (int a = grid.dimensions == 2 ? 2 : 0; a < 3; ++a)
        mean((grid.dimensions == 2 ? 3 : 7) & ~(1 << a), edges.axis[a]);
}

void faces_to_particles(
    const MacGrid& grid, const CellBox& window, const FaceField& velocity, const GridParticles& particles) {
    const FaceSampler sampler(grid, window, velocity);
    const auto x = particles.position(), u = particles.velocity();
    const Array3 cx = particles.affine(0), cy = particles.affine(1), cz = particles.affine(2);
    Kokkos::parallel_for(
        "treacle::faces_to_particles", particles.store.owned(), KOKKOS_LAMBDA(int k) {
            const double p[3] = {x(k, 0), x(k, 1), x(k, 2)};
            for (int a = 0; a < 3; ++a) {
                const Array3& c = a == 0 ? cx : a == 1 ? cy : cz;
                double gradient[3] = {0, 0, 0};
                u(k, a) = a < sampler.dimensions ? sampler.component(a, p, gradient) : 0;
                for (int b = 0; b < 3; ++b) c(k, b) = gradient[b];
            }
        });
}

void pressures_to_particles(
    const MacGrid& grid, const CellBox& window, const Array<double>& pressure, const GridParticles& particles) {
    const auto x = particles.position();
    const auto out = particles.pressure();
    const MacGrid staggered = grid;
    Kokkos::parallel_for(
        "treacle::pressures_to_particles", particles.store.owned(), KOKKOS_LAMBDA(int k) {
            int base[3] = {0, 0, window.lo[2]};
            double s[3] = {0, 0, 0};
            for (int a = 0; a < staggered.dimensions; ++a) {
                const double p = (x(k, a) - staggered.lower[a]) / staggered.dx - 0.5;
                base[a] = static_cast<int>(math::floor(p));
                s[a] = p - base[a];
            }
            double sum = 0;
            for (int n = 0; n < (staggered.dimensions == 2 ? 4 : 8); ++n) {
                const int i = n & 1, j = n >> 1 & 1, l = n >> 2;
                const double weight = (i ? s[0] : 1 - s[0]) * (j ? s[1] : 1 - s[1]) * (l ? s[2] : 1 - s[2]);
                sum += weight * pressure(window.index(base[0] + i, base[1] + j, base[2] + l));
            }
            out(k) = sum;
        });
}

} // namespace treacle::grid
