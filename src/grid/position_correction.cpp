#include "grid/position_correction.hpp"

namespace treacle::grid {

namespace {
// Kernel over the radius dx, not normalised: only ratios to the lattice's sum count.
struct Kernel {
    double inverse_radius;

    KOKKOS_INLINE_FUNCTION double value(double r) const {
        const double s = 1 - r * inverse_radius;
        return s > 0 ? s * s * s : 0;
    }
    // Derivative by r, over r.
    KOKKOS_INLINE_FUNCTION double slope(double r) const {
        const double s = 1 - r * inverse_radius;
        return s > 0 && r > 0 ? -3 * s * s * inverse_radius / r : 0;
    }
};

// Sums over what a particle sees: its neighbours, and the images of itself and of them.
struct Pairs {
    Array3 x, image;
    Array<std::int64_t> offset;
    Array<int> index;

    // visit(j, difference x_i - x, r, whether it is an image)
    template <class Visit>
    KOKKOS_INLINE_FUNCTION void visit(int i, const Visit& visit_pair) const {
        see(x, i, i, true, visit_pair);
        for (auto k = offset(i); k < offset(i + 1); ++k) {
            const int j = index(k);
            see(x, i, j, false, visit_pair);
            if (image(j, 0) != Images::none) see(image, i, j, true, visit_pair);
        }
        if (image(i, 0) != Images::none) see(image, i, i, true, visit_pair);
    }
    template <class Visit>
    KOKKOS_INLINE_FUNCTION void see(const Array3& at, int i, int j, bool fixed, const Visit& visit_pair) const {
        const double d[3] = {x(i, 0) - at(j, 0), x(i, 1) - at(j, 1), x(i, 2) - at(j, 2)};
        visit_pair(j, d, math::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), fixed);
    }
};

struct Constraint {
    Kernel kernel;
    double rest, softness; // softness [1/m2]
    Array<double> particle_mass;
    Array<int> liquid;
    double mean_mass; // by which masses are measured: heavier particles move less
};

// lambda_i = -C_i / (sum_k |grad_k C_i|^2 m_0 / m_k + softness), and the density. Returns the largest C.
double find_multipliers(const Constraint& constraint, const Pairs& pairs, int n, double volume, const Array<double>& multiplier,
                        const Array<double>& density) {
    double worst = 0;
    Kokkos::parallel_reduce("treacle::density_constraint", n, KOKKOS_LAMBDA(int i, double& most) {
        double sum = 0, squares = 0, own[3] = {0, 0, 0};
        pairs.visit(i, [&](int j, const double d[3], double r, bool fixed) {
            sum += constraint.kernel.value(r);
            const double slope = constraint.kernel.slope(r) / constraint.rest;
            for (int c = 0; c < 3; ++c) own[c] += slope * d[c];
            // What is fixed, an image, moves with no weight of its own.
            if (!fixed) squares += slope * slope * r * r * constraint.mean_mass / constraint.particle_mass(constraint.liquid(j));
        });
        const double mass = constraint.particle_mass(constraint.liquid(i));
        squares += (own[0] * own[0] + own[1] * own[1] + own[2] * own[2]) * constraint.mean_mass / mass;
        const double excess = sum / constraint.rest - 1;
        density(i) = (excess + 1) * mass / volume;
        multiplier(i) = -math::max(excess, 0.0) / (squares + constraint.softness);
        most = math::max(most, excess);
    }, Kokkos::Max<double>(worst));
    return n > 0 ? worst : 0;
}

// dx_i = m_0 / m_i sum_j (lambda_i + lambda_j) grad W_ij / W_0: equal and opposite but for images.
void find_density_corrections(const Constraint& constraint, const Pairs& pairs, int n, bool with_neighbours,
                              const Array<double>& multiplier, const Array3& correction) {
    Kokkos::parallel_for("treacle::density_correction", n, KOKKOS_LAMBDA(int i) {
        double sum[3] = {0, 0, 0};
        pairs.visit(i, [&](int j, const double d[3], double r, bool) {
            const double factor = multiplier(i) + (with_neighbours ? multiplier(j) : 0);
            const double slope = factor * constraint.kernel.slope(r) / constraint.rest;
            for (int c = 0; c < 3; ++c) sum[c] += slope * d[c];
        });
        const double weight = constraint.mean_mass / constraint.particle_mass(constraint.liquid(i));
        for (int c = 0; c < 3; ++c) correction(i, c) = weight * sum[c];
    });
}

// Springs between particles closer than their spacing (Ando and Tsuruno 2011): gamma d sum (1 - r^2 / d^2) (x_i - x_j) / r.
void find_spring_corrections(const Pairs& pairs, int n, double spacing, const Array3& correction) {
    constexpr double stiffness = 0.1;
    Kokkos::parallel_for("treacle::spring_correction", n, KOKKOS_LAMBDA(int i) {
        double sum[3] = {0, 0, 0};
        pairs.visit(i, [&](int, const double d[3], double r, bool) {
            const double pull = 1 - r * r / (spacing * spacing);
            if (pull <= 0 || r == 0) return;
            for (int c = 0; c < 3; ++c) sum[c] += stiffness * spacing * pull * d[c] / r;
        });
        for (int c = 0; c < 3; ++c) correction(i, c) = sum[c];
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
    Kokkos::parallel_for("treacle::correct_positions", n, KOKKOS_LAMBDA(int i) {
        const double from[3] = {x(i, 0), x(i, 1), x(i, 2)};
        const double scale = math::min(math::max(move.solid.at(from) / move.dx, move.scale_min), move.scale_max);
        double way[3], square = 0;
        for (int c = 0; c < 3; ++c) {
            way[c] = from[c] + move.relaxation * scale * correction(i, c) - start(i, c);
            square += way[c] * way[c];
        }
        const double share = square > move.cap * move.cap ? move.cap / math::sqrt(square) : 1;
        double to[3];
        for (int c = 0; c < 3; ++c) {
            // Where nothing is capped the correction is added as it is: sums of corrections stay what they are.
            to[c] = share < 1 ? start(i, c) + share * way[c] : from[c] + move.relaxation * scale * correction(i, c);
        }
        push_out(move.solid, move.clearance, to);
        for (int c = 0; c < 3; ++c) correction(i, c) = to[c] - from[c];
    });
}

void add_corrections(int n, const Array3& x, const Array3& correction) {
    Kokkos::parallel_for("treacle::add_corrections", n, KOKKOS_LAMBDA(int i) {
        for (int c = 0; c < 3; ++c) x(i, c) += correction(i, c);
    });
}

void wrap_positions(const MacGrid& grid, int n, const Array3& x) {
    for (int k = 0; k < grid.dimensions; ++k) {
        const double period = grid.cells.period[k], low = grid.lower[k];
        if (period == 0) continue;
        Kokkos::parallel_for("treacle::wrap_positions", n, KOKKOS_LAMBDA(int i) {
            if (x(i, k) < low) x(i, k) += period;
            else if (x(i, k) >= low + period) x(i, k) -= period;
        });
    }
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
                squares += kernel.slope(r) * r * kernel.slope(r) * r;
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
    Images::find(particles, setting.solids.sampler(), setting.solids.number(), ImagesIn::all_solids, 0.5 * grid_.dx);
    const Pairs pairs{x, particles.image(), neighbours_.offset, neighbours_.index};
    const Constraint constraint{{1 / grid_.dx}, rest_, options.softness * rest_gradients_, setting.particle_mass,
                                particles.liquid(), on_host(setting.particle_mass)(0)};
    const double volume = std::pow(grid_.dx, 3) / (grid_.dimensions == 2 ? 4 : 8);
    const double worst = setting.comm.max(find_multipliers(constraint, pairs, n, volume, multiplier, particles.density()));
    if (worst < options.tolerance) return worst;
    if (options.method == PositionMethod::density) {
        setting.halo.gather(particles.store, {particles.multiplier_field()});
        find_density_corrections(constraint, pairs, n, options.neighbour_constraints, multiplier, correction);
    } else {
        find_spring_corrections(pairs, n, 0.5 * grid_.dx, correction);
    }
    const AdvectionOptions defaults;
    const double relaxation = options.relaxation * mass_relaxation(setting.particle_mass);
    move_particles({setting.solids.sampler(), relaxation, options.scale_min, options.scale_max, grid_.dx,
                    options.cap * grid_.dx, defaults.clearance * grid_.dx}, n, start_, x, correction);
    setting.halo.gather(particles.store, {particles.correction_field()});
    add_corrections(particles.store.total(), x, correction);
    return worst;
}

PositionReport PositionCorrection::apply(const PositionOptions& options, GridParticles& particles, const Setting& setting) {
    PositionReport report;
    if (options.method == PositionMethod::none) return report;
    const int n = particles.store.owned();
    neighbours_.build(particles.store, particles.store, grid_.cells, setting.cells, grid_.dx);
    reserve(start_, static_cast<std::size_t>(n));
    const auto x = particles.position(), start = start_;
    Kokkos::parallel_for("treacle::keep_positions", n, KOKKOS_LAMBDA(int i) {
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
    Kokkos::parallel_reduce("treacle::correction_energy", n, KOKKOS_LAMBDA(int i, double& sum, double& most) {
        const double d[3] = {x(i, 0) - start(i, 0), x(i, 1) - start(i, 1), x(i, 2) - start(i, 2)};
        sum -= mass(liquid(i)) * (g[0] * d[0] + g[1] * d[1] + g[2] * d[2]);
        most = math::max(most, d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    }, energy, Kokkos::Max<double>(square));
    wrap_positions(grid_, n, x);
    report.energy = setting.comm.sum(energy);
    report.largest_move = math::sqrt(setting.comm.max(n > 0 ? square : 0.0));
    return report;
}

} // namespace treacle::grid
