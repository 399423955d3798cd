#include "grid/geometry/seeding.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace treacle::grid {

double particle_volume(const MacGrid& grid) { return std::pow(grid.dx, 3) / (grid.dimensions == 2 ? 4 : 8); }

std::int64_t seeded_ids(const MacGrid& grid) { return (grid.dimensions == 2 ? 4 : 8) * grid.cells.all().size(); }

namespace {
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr int spread_layers = 4; // at a face that cuts sub-cells

// A counter-based random number in [-1, 1): the finaliser of SplitMix64 (Steele, Lea and Flood 2014) of a key.
double random_number(std::uint64_t key) {
    key += 0x9E3779B97F4A7C15ull;
    key = (key ^ (key >> 30)) * 0xBF58476D1CE4E5B9ull;
    key = (key ^ (key >> 27)) * 0x94D049BB133111EBull;
    key ^= key >> 31;
    return static_cast<double>(key >> 11) * 0x1p-52 - 1;
}

struct Seed {
    std::int64_t id;
    Vec3 x;
    int liquid;
};

// One of the equal parts of a cell that hold a particle each where all is liquid.
struct SubCell {
    Vec3 middle{0, 0, 0}, half{0, 0, 0};        // [m] half: of its sides, 0 along an axis that there is not
    Vec3 position{0, 0, 0};                     // [m] at random around the middle
    std::array<std::int64_t, 3> index{0, 0, 0}; // in the lattice of all
    double threshold = 0;                       // in (0, 1): it holds a particle if more of it than that is liquid

    double width(std::size_t axis) const { return 2 * half[axis]; }
    SubCell shifted(std::size_t axis, int by) const;
};

// Place where a line along an axis through a sub-cell's middle leaves a liquid.
struct Face {
    double distance = infinity; // [m] from the middle, negative behind the face
    int side = 1;               // of the middle along the axis, 1 or -1

    bool found() const { return distance < infinity; }
};

// Liquid of sub-cells, and positions of particles in it.
class SubCellFilling {
public:
    SubCellFilling(const Seeding& seeding, const MacGrid& grid)
        : seeding_(seeding), dimensions_(grid.dimensions), clearance_(seeding.clearance * grid.dx) {
        for (const auto& liquid : seeding.liquids)
            without_meshes_.push_back(
                std::ranges::all_of(liquid, [](const auto& region) { return region.meshes().empty(); }));
    }

    // The liquid whose particle the sub-cell holds, or -1: over many sub-cells as often as that liquid fills of them.
    int liquid_of(const SubCell& sub_cell) const {
        const double bounding_radius = std::hypot(sub_cell.half[0], sub_cell.half[1], sub_cell.half[2]);
        double before = 0;
        for (int l = 0; l < liquids(); ++l) {
            const double distance = to_liquid(l, sub_cell.middle);
            if (distance >= bounding_radius) continue;
            const bool full = distance <= -bounding_radius && to_solids(sub_cell.middle) >= bounding_radius;
            before = full ? 1 : before + volume_fraction(sub_cell, l);
            if (sub_cell.threshold < before) return l;
        }
        return -1;
    }

    // The sub-cell's own position if the liquid is there, else the innermost of the middles of its quarters or eighths, moved into the
    // liquid and out of solids. None where there is no room.
    std::optional<Vec3> position_in(const SubCell& sub_cell, int liquid) const {
        Vec3 x = sub_cell.position;
        if (near_surface(sub_cell, liquid)) {
            for (std::size_t k = 0; k < static_cast<std::size_t>(dimensions_); ++k) x[k] += spread(sub_cell, liquid, k);
            if (outside(x, liquid, clearance_) < 0) return x;
            x = sub_cell.position;
        }
        if (outside(x, liquid, clearance_) < 0) return x;
        for (int s = 0; s < parts(); ++s) {
            const Vec3 middle = part_middle(sub_cell, s);
            if (outside(middle, liquid, clearance_) < outside(x, liquid, clearance_)) x = middle;
        }
        constexpr int most = 4; // steps; one is enough but in corners
        for (int i = 0; i < most && !(outside(x, liquid, clearance_) < 0); ++i) step_inward(sub_cell, liquid, x);
        if (!(outside(x, liquid, clearance_) < 0)) return {};
        return x;
    }

private:
    int liquids() const { return static_cast<int>(seeding_.liquids.size()); }
    int parts() const { return dimensions_ == 2 ? 4 : 8; }
    static Vec3 part_middle(const SubCell& sub_cell, int s) {
        Vec3 out = sub_cell.middle;
        for (std::size_t k = 0; k < 3; ++k) out[k] += sub_cell.half[k] * ((s >> k & 1) - 0.5);
        return out;
    }
    double to_solids(const Vec3& x) const { return seeding_.solid_distance ? seeding_.solid_distance(x) : infinity; }
    double to_liquid(int liquid, const Vec3& x) const {
        return scene::distance_to(seeding_.liquids[static_cast<std::size_t>(liquid)], x);
    }
    // Signed distance [m] to where a liquid is and solids are a clearance away, negative in there. Surfaces may coincide.
    double outside(const Vec3& x, int liquid, double clearance) const {
        return std::max(outside_liquid(x, liquid), clearance - to_solids(x));
    }
    double outside_liquid(const Vec3& x, int liquid) const {
        double out = to_liquid(liquid, x);
        for (int l = 0; l < liquid; ++l) out = std::max(out, -to_liquid(l, x));
        return out;
    }
    // The face within `cutoff` [m] of the sub-cell's middle on one side of it along an axis, by Newton's method; none where the surface is
    // steeper along another axis, along which its layers are spread then.
    Face face_at(const SubCell& sub_cell, int liquid, std::size_t axis, int side, double cutoff) const {
        const double near = 1e-3 * sub_cell.half[axis], least_slope = 0.3;
        Vec3 x = sub_cell.middle;
        constexpr int most = 12; // steps; one is enough where the surface is flat and across the axis
        for (int i = 0; i < most; ++i) {
            const double distance = side * (x[axis] - sub_cell.middle[axis]), remaining = outside_liquid(x, liquid);
            if (distance > cutoff || distance < -sub_cell.half[axis]) return {};
            const double slope = side * slope_of(x, liquid, axis, near);
            if (std::abs(remaining) < 1e-3 * near)
                return leads_out(x, liquid, axis, slope, near) ? Face{distance, side} : Face{};
            x[axis] -=
                side * remaining / (slope < least_slope ? 1 : slope); // where another face is nearer, by the distance
        }
        return {};
    }
    double slope_of(Vec3 x, int liquid, std::size_t axis, double near) const {
        x[axis] += near;
        const double ahead = outside_liquid(x, liquid);
        x[axis] -= 2 * near;
        return (ahead - outside_liquid(x, liquid)) / (2 * near);
    }
    // True where the distance rises along the axis by more than along any other, or as much as along one after it.
    bool leads_out(const Vec3& x, int liquid, std::size_t axis, double slope, double near) const {
        constexpr double round_off = 1e-6;
        for (std::size_t k = 0; k < static_cast<std::size_t>(dimensions_); ++k) {
            const double most = slope + (k < axis ? -round_off : round_off);
            if (k != axis && std::abs(slope_of(x, liquid, k, near)) > most) return false;
        }
        return true;
    }
    // True where spread() may move the sub-cell's particle.
    bool near_surface(const SubCell& sub_cell, int liquid) const {
        return without_meshes_[static_cast<std::size_t>(liquid)] &&
               outside_liquid(sub_cell.middle, liquid) >= -spread_cutoff(sub_cell.width(0));
    }
    static double spread_cutoff(double width) { return (spread_layers + 1) * width; } // [m]
    // Displacement along an axis [m] of a sub-cell's particle near a face that cuts sub-cells. Of these some hold a particle and
    // some do not: in each column the outer layers are spread evenly up to the face, or holes would leave it rough.
    double spread(const SubCell& sub_cell, int liquid, std::size_t axis) const {
        const double width = sub_cell.width(axis), cutoff = spread_cutoff(width);
        const Face ahead = face_at(sub_cell, liquid, axis, 1, cutoff),
                   behind = face_at(sub_cell, liquid, axis, -1, cutoff);
        const Face& face = behind.distance < ahead.distance ? behind : ahead;
        if (!face.found()) return 0;
        const Face opposite = face_at(sub_cell, liquid, axis, -face.side, 2 * cutoff);
        const double thickness = (face.distance + opposite.distance) / width;
        const int layers = std::min(spread_layers, int(std::min(thickness, 1e3) / 2) - 1);
        constexpr double round_off = 1e-6;
        const double beyond = face.distance / width - 0.5; // layers, -1/2 to 0 where the face cuts this sub-cell
        const int cut = int(std::floor(beyond + round_off)) + 1;
        const double filled = beyond + 1 - cut;
        if (filled < round_off || layers < 1 || cut > layers) return 0;
        const bool occupied = liquid_of(sub_cell.shifted(axis, face.side * cut)) == liquid;
        const double spacing = (layers + filled) / (layers + (occupied ? 1 : 0));
        return face.side * (face.distance - width * spacing * (cut - (occupied ? 0 : 1) + 0.5));
    }
    void step_inward(const SubCell& sub_cell, int liquid, Vec3& x) const {
        const double step = 1e-3 * sub_cell.half[0], here = outside(x, liquid, clearance_);
        Vec3 slope{0, 0, 0};
        double square = 0;
        for (std::size_t k = 0; k < static_cast<std::size_t>(dimensions_); ++k) {
            Vec3 ahead = x, behind = x;
            ahead[k] += step;
            behind[k] -= step;
            slope[k] = (outside(ahead, liquid, clearance_) - outside(behind, liquid, clearance_)) / (2 * step);
            square += slope[k] * slope[k];
        }
        if (!(square > 0)) return;
        for (std::size_t k = 0; k < static_cast<std::size_t>(dimensions_); ++k)
            x[k] = std::clamp(x[k] - (here + step) * slope[k] / square, sub_cell.middle[k] - sub_cell.half[k],
                sub_cell.middle[k] + sub_cell.half[k]);
    }
    // Volume fraction of a liquid in the sub-cell: exact for a plane across an axis.
    double volume_fraction(const SubCell& sub_cell, int liquid) const {
        double sum = 0;
        for (int s = 0; s < parts(); ++s)
            sum += std::clamp(0.5 - outside(part_middle(sub_cell, s), liquid, 0) / sub_cell.half[0], 0.0, 1.0);
        constexpr double round_off = 1e-9;
        const double out = sum / parts();
        return out < round_off ? 0 : out > 1 - round_off ? 1 : out;
    }

    const Seeding& seeding_;
    int dimensions_;
    double clearance_;
    std::vector<bool> without_meshes_; // per liquid: distances from meshes take long
};

// A sub-cell's threshold in (0, 1), by its index in the lattice of all: evenly spread along any axis and in any plane across one, since no
// rational number is near the steps. The number of those below a fraction is that fraction of all to about one along a line.
double dither_threshold(const std::array<std::int64_t, 3>& index) {
    constexpr std::array steps{0.61803398874989484820, 0.41421356237309504880,
        0.73205080756887729353}; // golden ratio, and roots of 2 and 3, less 1
    double sum = 0.5;
    for (std::size_t k = 0; k < 3; ++k) sum += steps[k] * static_cast<double>(index[k]);
    return sum - std::floor(sum);
}

SubCell SubCell::shifted(std::size_t axis, int by) const {
    SubCell out = *this;
    out.index[axis] += by;
    out.middle[axis] += by * width(axis);
    out.position[axis] += by * width(axis); // with the same random part
    out.threshold = dither_threshold(out.index);
    return out;
}

SubCell sub_cell_of(const Seeding& seeding, const MacGrid& grid, const int c[3], int s, std::uint64_t number) {
    SubCell out;
    for (int k = 0; k < grid.dimensions; ++k) {
        const auto axis = static_cast<std::size_t>(k);
        const int side = s >> k & 1;
        out.half[axis] = 0.25 * grid.dx;
        out.middle[axis] = grid.lower[k] + grid.dx * (c[k] + 0.25 + 0.5 * side);
        out.position[axis] = out.middle[axis] +
                             0.5 * grid.dx * seeding.jitter * random_number(3 * number + static_cast<std::uint64_t>(k));
        out.index[axis] = 2 * std::int64_t(c[k]) + side;
    }
    out.threshold = dither_threshold(out.index);
    return out;
}

void seed_cell(const Seeding& seeding, const MacGrid& grid, const SubCellFilling& filling, const int c[3],
    std::vector<Seed>& out) {
    const int sub_cells = grid.dimensions == 2 ? 4 : 8;
    const std::uint64_t cell =
        grid.cells.all().empty()
            ? 0
            : static_cast<std::uint64_t>(c[0]) +
                  static_cast<std::uint64_t>(grid.cells.count[0]) *
                      (static_cast<std::uint64_t>(c[1]) +
                          static_cast<std::uint64_t>(grid.cells.count[1]) * static_cast<std::uint64_t>(c[2]));
    const auto all = static_cast<std::uint64_t>(seeded_ids(grid));
    for (int s = 0; s < sub_cells; ++s) {
        const std::uint64_t number = static_cast<std::uint64_t>(sub_cells) * cell + static_cast<std::uint64_t>(s);
        const SubCell sub_cell = sub_cell_of(seeding, grid, c, s, number);
        const int liquid = filling.liquid_of(sub_cell);
        if (liquid < 0) continue;
        if (const auto x = filling.position_in(sub_cell, liquid))
            out.push_back({static_cast<std::int64_t>(static_cast<std::uint64_t>(liquid) * all + number), *x, liquid});
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
    const SubCellFilling filling(seeding, grid);
    const double radius = grid.dx * std::sqrt(double(grid.dimensions));
    for (int i = 0; i < box.size(); ++i) {
        int c[3];
        box.cell(i, c);
        Vec3 middle;
        grid.centre(c, middle.data());
        const bool touched = std::ranges::any_of(
            seeding.liquids, [&](const scene::Regions& liquid) { return scene::distance_to(liquid, middle) < radius; });
        if (touched) seed_cell(seeding, grid, filling, c, made);
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
        viscosity(before + i) = seeding.viscosity                    ? seeding.viscosity(seed.liquid, seed.x)
                                : which < seeding.viscosities.size() ? seeding.viscosities[which]
                                                                     : 0;
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
