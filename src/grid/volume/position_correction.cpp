#include "grid/volume/position_correction.hpp"

#include "kokkos/simd.hpp"

#include <cmath>

namespace treacle::grid {

namespace {
// Kernel over the radius dx, not normalised: only ratios to the lattice's sum count.
struct Kernel {
    double inverse_radius;

    template <Number T>
    KOKKOS_INLINE_FUNCTION T value(T r) const {
        const T s = math::max(T(0.0), T(1.0) - r * T(inverse_radius));
        return s * s * s;
    }
    // Derivative by r.
    template <Number T>
    KOKKOS_INLINE_FUNCTION T slope(T r) const {
        const T s = math::max(T(0.0), T(1.0) - r * T(inverse_radius));
        return T(-3 * inverse_radius) * s * s;
    }
};

// Pairs of a particle: its neighbours and, near solids, the images of itself and of them.
struct Pairs {
    Array4 packed; // x, y, z and a number of the loop's
    Array3 image;
    Array<int> near; // 1: images count
    Array<std::int64_t> offset;
    Array<int> index;

    // visit(x_i - x_j, y_i - y_j, z_i - z_j, the loop's number of j) of neighbours, several at a time; lanes beyond the last one
    // are far away.
    template <class Visit>
    KOKKOS_INLINE_FUNCTION void neighbours(int i, const Visit& visit) const {
        const SimdDouble x = packed(i, 0), y = packed(i, 1), z = packed(i, 2), far = 1e10;
        const auto end = offset(i + 1);
        for (auto k = offset(i); k < end; k += lanes) {
            const Quads other = gather_quads(packed.data(), &index(k));
            const LaneMask there = tail_mask(static_cast<int>(math::min(end - k, std::int64_t(lanes))));
            visit(select(there, x - other.x, far), y - other.y, z - other.z, other.w);
        }
    }
    // The same of images, one by one.
    template <class Visit>
    KOKKOS_INLINE_FUNCTION void images(int i, const Visit& visit) const {
        if (!near(i)) return;
        for (auto k = offset(i) - 1; k < offset(i + 1); ++k) {
            const int j = k < offset(i) ? i : index(k);
            if (image(j, 0) == MirrorParticles::none) continue;
            visit(packed(i, 0) - image(j, 0), packed(i, 1) - image(j, 1), packed(i, 2) - image(j, 2), packed(j, 3));
        }
    }
};

struct Constraint {
    Kernel kernel;
    double rest, cfm_epsilon, dead_band; // cfm_epsilon [1/m2]
    Array<double> particle_mass;
    Array<int> liquid;
    double mean_mass; // by which masses are measured: heavier particles move less

    KOKKOS_INLINE_FUNCTION double mobility(int i) const { return mean_mass / particle_mass(liquid(i)); }
};

void pack_positions(const Array3& x, int n, const Constraint& constraint, const Array4& packed) {
    Kokkos::parallel_for(
        "treacle::pack_positions", n, KOKKOS_LAMBDA(int i) {
            for (int c = 0; c < 3; ++c) packed(i, c) = x(i, c);
            packed(i, 3) = constraint.mobility(i);
        });
}

// Sums of one particle's constraint.
template <Number T>
struct ConstraintSums {
    T density = 0.0, squares = 0.0, x = 0.0, y = 0.0, z = 0.0;

    KOKKOS_INLINE_FUNCTION void add(const Kernel& kernel, T dx, T dy, T dz, T mobility) {
        const auto at = distance(dx * dx + dy * dy + dz * dz);
        const T slope = kernel.slope(at.r), along = slope * at.inverse;
        density = density + kernel.value(at.r);
        squares = squares + slope * slope * mobility;
        x = x + along * dx;
        y = y + along * dy;
        z = z + along * dz;
    }
};

// lambda_i = -max(C_i - dead_band, 0) / (sum_k |grad_k C_i|^2 m_0 / m_k + cfm_epsilon), and the density. Returns the largest C.
double find_multipliers(const Constraint& constraint, const Pairs& pairs, int n, double volume,
    const Array<double>& multiplier, const Array<double>& density) {
    double worst = 0;
    Kokkos::parallel_reduce(
        "treacle::density_constraint", n,
        KOKKOS_LAMBDA(int i, double& most) {
            ConstraintSums<SimdDouble> lane;
            ConstraintSums<double> fixed;
            pairs.neighbours(i, [&](SimdDouble dx, SimdDouble dy, SimdDouble dz, SimdDouble mobility) {
                lane.add(constraint.kernel, dx, dy, dz, mobility);
            });
            // An image is not moved: it has no square of its own.
            pairs.images(
                i, [&](double dx, double dy, double dz, double) { fixed.add(constraint.kernel, dx, dy, dz, 0.0); });
            const double x = sum_lanes(lane.x) + fixed.x, y = sum_lanes(lane.y) + fixed.y,
                         z = sum_lanes(lane.z) + fixed.z;
            const double mobility = pairs.packed(i, 3);
            const double squares =
                (sum_lanes(lane.squares) + (x * x + y * y + z * z) * mobility) / (constraint.rest * constraint.rest);
            const double sum = constraint.kernel.value(0.0) + sum_lanes(lane.density) + fixed.density;
            const double excess = sum / constraint.rest - 1;
            density(i) = (excess + 1) * constraint.mean_mass / mobility / volume;
            multiplier(i) = -math::max(excess - constraint.dead_band, 0.0) / (squares + constraint.cfm_epsilon);
            most = math::max(most, excess);
        },
        Kokkos::Max<double>(worst));
    return n > 0 ? worst : 0;
}

void write_multipliers(const Array<double>& multiplier, int n, const Array4& packed) {
    Kokkos::parallel_for(
        "treacle::multipliers", n, KOKKOS_LAMBDA(int i) { packed(i, 3) = multiplier(i); });
}

// dx_i = m_0 / m_i sum_j (lambda_i + lambda_j) grad W_ij / W_0: equal and opposite but for images.
void find_density_corrections(
    const Constraint& constraint, const Pairs& pairs, int n, bool with_neighbours, const Array3& correction) {
    const double theirs = with_neighbours ? 1 : 0;
    Kokkos::parallel_for(
        "treacle::density_correction", n, KOKKOS_LAMBDA(int i) {
            const double mine = pairs.packed(i, 3);
            SimdDouble x = 0.0, y = 0.0, z = 0.0;
            pairs.neighbours(i, [&](SimdDouble dx, SimdDouble dy, SimdDouble dz, SimdDouble other) {
                const auto at = distance(dx * dx + dy * dy + dz * dz);
                const SimdDouble factor =
                    (SimdDouble(mine) + SimdDouble(theirs) * other) * constraint.kernel.slope(at.r) * at.inverse;
                x = x + factor * dx;
                y = y + factor * dy;
                z = z + factor * dz;
            });
            double sum[3] = {sum_lanes(x), sum_lanes(y), sum_lanes(z)};
            pairs.images(i, [&](double dx, double dy, double dz, double other) {
                const auto at = distance(dx * dx + dy * dy + dz * dz);
                const double factor = (mine + theirs * other) * constraint.kernel.slope(at.r) * at.inverse;
                sum[0] += factor * dx;
                sum[1] += factor * dy;
                sum[2] += factor * dz;
            });
            const double weight = constraint.mobility(i) / constraint.rest;
            for (int c = 0; c < 3; ++c) correction(i, c) = weight * sum[c];
        });
}

// Springs between particles closer than their spacing (Ando and Tsuruno 2011): gamma d sum (1 - r^2 / d^2) (x_i - x_j) / r.
void find_spring_corrections(const Pairs& pairs, int n, double spacing, const Array3& correction) {
    constexpr double stiffness = 0.1;
    Kokkos::parallel_for(
        "treacle::spring_correction", n, KOKKOS_LAMBDA(int i) {
            SimdDouble x = 0.0, y = 0.0, z = 0.0;
            pairs.neighbours(i, [&](SimdDouble dx, SimdDouble dy, SimdDouble dz, SimdDouble) {
                const auto at = distance(dx * dx + dy * dy + dz * dz);
                const SimdDouble pull =
                    math::max(SimdDouble(0.0), SimdDouble(1.0) - at.r * at.r * SimdDouble(1 / (spacing * spacing))) *
                    at.inverse;
                x = x + pull * dx;
                y = y + pull * dy;
                z = z + pull * dz;
            });
            const double factor = stiffness * spacing;
            correction(i, 0) = factor * sum_lanes(x);
            correction(i, 1) = factor * sum_lanes(y);
            correction(i, 2) = factor * sum_lanes(z);
        });
}

// Light particles beside heavy ones do all of the moving, by the constraints of both: half of each correction, where
// all of it would overshoot.
double mass_relaxation(const Array<double>& particle_mass) {
    const auto mass = on_host(particle_mass);
    for (std::size_t k = 1; k < mass.extent(0); ++k) {
        if (mass(k) != mass(0)) return 0.5;
    }
    return 1;
}

struct Move {
    DistanceSampler solid;
    double relaxation, scale_min, scale_max;
    double dx, cap, clearance; // [m]
};

// Moves the owned particles by their corrections, at most `cap` from where they started, out of solids, and leaves in the
// field how far each has gone.
void move_particles(const Move& move, int n, const Array3& start, const Array3& x, const Array3& correction) {
    Kokkos::parallel_for(
        "treacle::correct_positions", n, KOKKOS_LAMBDA(int i) {
            const double from[3] = {x(i, 0), x(i, 1), x(i, 2)};
            const double scale = math::min(math::max(move.solid.at(from) / move.dx, move.scale_min), move.scale_max);
            double way[3], square = 0;
            for (int c = 0; c < 3; ++c) {
                way[c] = from[c] + move.relaxation * scale * correction(i, c) - start(i, c);
                square += way[c] * way[c];
            }
            const double fraction = square > move.cap * move.cap ? move.cap / math::sqrt(square) : 1;
            double to[3];
            for (int c = 0; c < 3; ++c) {
                // The correction is added as it is where nothing is capped: sums of corrections stay what they are.
                to[c] = fraction < 1 ? start(i, c) + fraction * way[c]
                                     : from[c] + move.relaxation * scale * correction(i, c);
            }
            push_out(move.solid, move.clearance, to);
            for (int c = 0; c < 3; ++c) correction(i, c) = to[c] - from[c];
        });
}

void add_corrections(int n, const Array3& x, const Array3& correction) {
    Kokkos::parallel_for(
        "treacle::add_corrections", n, KOKKOS_LAMBDA(int i) {
            for (int c = 0; c < 3; ++c) x(i, c) += correction(i, c);
        });
}

// Marks particles that may have images: within the kernel's support radius of a solid, and the farthest move.
void find_near(const DistanceSampler& solid, const Array3& x, int n, double cutoff, const Array<int>& near) {
    Kokkos::parallel_for(
        "treacle::near_solids", n, KOKKOS_LAMBDA(int i) {
            const double p[3] = {x(i, 0), x(i, 1), x(i, 2)};
            near(i) = solid.at(p) < cutoff ? 1 : 0;
        });
}

void wrap_positions(const PeriodicBox& box, int n, const Array3& x) {
    Kokkos::parallel_for(
        "treacle::wrap_positions", n, KOKKOS_LAMBDA(int i) {
            for (int k = 0; k < 3; ++k) x(i, k) = box.wrap(k, x(i, k));
        });
}
} // namespace

PositionCorrection::PositionCorrection(const MacGrid& grid) : grid_(grid) {
    // The lattice of spacing dx / 2 around a particle, as far as the kernel reaches.
    const Kernel kernel{1 / grid.dx};
    const double spacing = 0.5 * grid.dx;
    double squares = 0;
    for (int z = grid.dimensions == 2 ? 0 : -2; z <= (grid.dimensions == 2 ? 0 : 2); ++z) {
        for (int y = -2; y <= 2; ++y) {
            for (int x = -2; x <= 2; ++x) {
                const double r = spacing * math::sqrt(double(x * x + y * y + z * z));
                rest_ += kernel.value(r);
                squares += (r > 0 ? kernel.slope(r) * kernel.slope(r) : 0);
            }
        }
    }
    rest_gradients_ = squares / (rest_ * rest_);
}

// One iteration; returns the largest constraint before it, of all ranks.
double PositionCorrection::correct(const PositionOptions& options, GridParticles& particles, const Setting& setting) {
    const int n = particles.store.owned();
    const auto x = particles.position(), correction = particles.correction();
    const auto multiplier = particles.multiplier();
    MirrorParticles::find(
        particles, setting.solids.sampler(), setting.solids.number(), MirroredIn::all_solids, 0.5 * grid_.dx);
    const Pairs pairs{packed_, particles.image(), near_, neighbours_.offset, neighbours_.index};
    const Constraint constraint{{1 / grid_.dx}, rest_, options.cfm_epsilon * rest_gradients_, options.dead_band,
        setting.particle_mass, particles.liquid(), on_host(setting.particle_mass)(0)};
    const int total = particles.store.total();
    pack_positions(x, total, constraint, packed_);
    const double volume = std::pow(grid_.dx, 3) / (grid_.dimensions == 2 ? 4 : 8);
    const double worst =
        setting.comm.max(find_multipliers(constraint, pairs, n, volume, multiplier, particles.density()));
    if (worst < options.tolerance) return worst;
    if (options.method == PositionMethod::density) {
        setting.halo.gather(particles.store, {particles.multiplier_field()});
        write_multipliers(multiplier, total, packed_);
        find_density_corrections(constraint, pairs, n, options.neighbour_constraints, correction);
    } else {
        find_spring_corrections(pairs, n, 0.5 * grid_.dx, correction);
    }
    const AdvectionOptions defaults;
    const double relaxation = options.relaxation * mass_relaxation(setting.particle_mass);
    move_particles({setting.solids.sampler(), relaxation, options.scale_min, options.scale_max, grid_.dx,
                       options.cap * grid_.dx, defaults.clearance * grid_.dx},
        n, start_, x, correction);
    setting.halo.gather(particles.store, {particles.correction_field()});
    add_corrections(total, x, correction);
    return worst;
}

PositionReport PositionCorrection::apply(
    const PositionOptions& options, GridParticles& particles, const Setting& setting) {
    PositionReport report;
    if (options.method == PositionMethod::none) return report;
    const int n = particles.store.owned();
    neighbours_.build(particles.store, particles.store, grid_.cells, setting.cells, grid_.dx);
    reserve(start_, static_cast<std::size_t>(n));
    reserve(near_, static_cast<std::size_t>(n));
    reserve(packed_, static_cast<std::size_t>(particles.store.total()) + 1); // rows end with entries that name row 0
    find_near(setting.solids.sampler(), particles.position(), n, (1 + options.cap) * grid_.dx, near_);
    const auto x = particles.position(), start = start_;
    Kokkos::parallel_for(
        "treacle::keep_positions", n, KOKKOS_LAMBDA(int i) {
            for (int c = 0; c < 3; ++c) start(i, c) = x(i, c);
        });
    PositionOptions last = options;
    last.tolerance = 1e300; // measures without moving
    for (int k = 0; k <= options.iterations; ++k) {
        report.density_after = correct(k < options.iterations ? options : last, particles, setting);
        if (k == 0) report.density_before = report.density_after;
        report.iterations = k;
        if (report.density_after < options.tolerance) break;
    }
    const auto liquid = particles.liquid();
    const auto mass = setting.particle_mass;
    const double g[3] = {setting.gravity[0], setting.gravity[1], setting.gravity[2]};
    double energy = 0, square = 0;
    Kokkos::parallel_reduce(
        "treacle::correction_energy", n,
        KOKKOS_LAMBDA(int i, double& sum, double& most) {
            const double d[3] = {x(i, 0) - start(i, 0), x(i, 1) - start(i, 1), x(i, 2) - start(i, 2)};
            sum -= mass(liquid(i)) * (g[0] * d[0] + g[1] * d[1] + g[2] * d[2]);
            most = math::max(most, d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        },
        energy, Kokkos::Max<double>(square));
    wrap_positions(periodic_box(grid_), n, x);
    report.energy = setting.comm.sum(energy);
    report.largest_move = math::sqrt(setting.comm.max(n > 0 ? square : 0.0));
    return report;
}

} // namespace treacle::grid
