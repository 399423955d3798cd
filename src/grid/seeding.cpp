#include "grid/seeding.hpp"

#include <cmath>

namespace treacle::grid {

double particle_volume(const MacGrid& grid) { return std::pow(grid.dx, 3) / (grid.dimensions == 2 ? 4 : 8); }

std::int64_t seeded_ids(const MacGrid& grid) { return (grid.dimensions == 2 ? 4 : 8) * grid.cells.all().size(); }

namespace {
// A counter-based random number in [-1, 1): the finaliser of SplitMix64 (Steele, Lea and Flood 2014) of a key.
double random_number(std::uint64_t key) {
    key += 0x9E3779B97F4A7C15ull;
    key = (key ^ (key >> 30)) * 0xBF58476D1CE4E5B9ull;
    key = (key ^ (key >> 27)) * 0x94D049BB133111EBull;
    key ^= key >> 31;
    return static_cast<double>(key >> 11) * 0x1p-52 - 1;
}

// The first liquid that holds a place, or -1.
int liquid_at(const std::vector<scene::Regions>& liquids, const Vec3& x) {
    for (std::size_t l = 0; l < liquids.size(); ++l) {
        for (const auto& region : liquids[l]) {
            if (region.distance(x) < 0) return static_cast<int>(l);
        }
    }
    return -1;
}

// Whether any liquid may reach into a ball.
bool any_within(const std::vector<scene::Regions>& liquids, const Vec3& x, double radius) {
    for (const auto& liquid : liquids) {
        for (const auto& region : liquid) {
            if (region.distance(x) < radius) return true;
        }
    }
    return false;
}

struct Seed {
    std::int64_t id;
    Vec3 x;
    int liquid;
};

// The particles of one cell. The place of a share is the middle of it and the random number's part of its width.
void seed_cell(const Seeding& seeding, const MacGrid& grid, const int c[3], std::vector<Seed>& out) {
    const int shares = grid.dimensions == 2 ? 4 : 8;
    const std::uint64_t cell = grid.cells.all().empty() ? 0
        : static_cast<std::uint64_t>(c[0]) + static_cast<std::uint64_t>(grid.cells.count[0]) *
              (static_cast<std::uint64_t>(c[1]) + static_cast<std::uint64_t>(grid.cells.count[1]) * static_cast<std::uint64_t>(c[2]));
    const auto all = static_cast<std::uint64_t>(seeded_ids(grid));
    for (int s = 0; s < shares; ++s) {
        const std::uint64_t number = static_cast<std::uint64_t>(shares) * cell + static_cast<std::uint64_t>(s);
        Vec3 x{0, 0, 0};
        for (int k = 0; k < grid.dimensions; ++k) {
            const double shift = 0.5 * seeding.jitter * random_number(3 * number + static_cast<std::uint64_t>(k));
            x[static_cast<std::size_t>(k)] = grid.lower[k] + grid.dx * (c[k] + 0.25 + 0.5 * (s >> k & 1) + shift);
        }
        const int liquid = liquid_at(seeding.liquids, x);
        if (liquid < 0 || (seeding.solid_distance && seeding.solid_distance(x) < seeding.clearance * grid.dx)) continue;
        out.push_back({static_cast<std::int64_t>(static_cast<std::uint64_t>(liquid) * all + number), x, liquid});
    }
}
LinearVelocity motion_of(const Seeding& seeding, const Seed& seed) {
    const auto which = static_cast<std::size_t>(seed.liquid);
    return which < seeding.velocities.size() ? seeding.velocities[which] : LinearVelocity{};
}

// Component k of a particle's velocity [m/s].
double speed_of(const Seeding& seeding, const Seed& seed, std::size_t k) {
    const auto motion = motion_of(seeding, seed);
    double out = motion.at_origin[k];
    for (std::size_t c = 0; c < 3; ++c) out += motion.gradient[k][c] * seed.x[c];
    return out;
}
} // namespace

void seed(const Seeding& seeding, const MacGrid& grid, const Decomposition& decomposition, GridParticles& particles) {
    std::vector<Seed> made;
    const CellBox box = decomposition.box();
    const double radius = grid.dx * std::sqrt(double(grid.dimensions));
    for (int i = 0; i < box.size(); ++i) {
        int c[3];
        box.cell(i, c);
        Vec3 middle;
        grid.centre(c, middle.data());
        if (any_within(seeding.liquids, middle, radius)) seed_cell(seeding, grid, c, made);
    }
    const auto before = static_cast<std::size_t>(particles.store.owned());
    particles.store.resize_owned(static_cast<int>(before + made.size()));
    const auto x = on_host(particles.position()), u = on_host(particles.velocity());
    const auto id = on_host(particles.id());
    const auto liquid = on_host(particles.liquid());
    const auto viscosity = on_host(particles.viscosity());
    for (std::size_t i = 0; i < made.size(); ++i) {
        const Seed& seed = made[i];
        const auto which = static_cast<std::size_t>(seed.liquid);
        for (std::size_t k = 0; k < 3; ++k) {
            x(before + i, k) = seed.x[k];
            u(before + i, k) = speed_of(seeding, seed, k);
        }
        id(before + i) = seed.id;
        liquid(before + i) = seed.liquid;
        viscosity(before + i) = seeding.viscosity ? seeding.viscosity(seed.liquid, seed.x)
                                : which < seeding.viscosities.size() ? seeding.viscosities[which] : 0;
    }
    Kokkos::deep_copy(particles.position(), x);
    Kokkos::deep_copy(particles.velocity(), u);
    Kokkos::deep_copy(particles.id(), id);
    Kokkos::deep_copy(particles.liquid(), liquid);
    Kokkos::deep_copy(particles.viscosity(), viscosity);
    const auto pressure = on_host(particles.pressure());
    for (std::size_t i = before; i < before + made.size(); ++i) pressure(i) = 0;
    Kokkos::deep_copy(particles.pressure(), pressure);
    for (int a = 0; a < 3; ++a) {
        const auto affine = on_host(particles.affine(a));
        for (std::size_t i = 0; i < made.size(); ++i) {
            const Vec3 gradient = motion_of(seeding, made[i]).gradient[static_cast<std::size_t>(a)];
            for (std::size_t k = 0; k < 3; ++k) affine(before + i, k) = gradient[k];
        }
        Kokkos::deep_copy(particles.affine(a), affine);
    }
}

} // namespace treacle::grid
