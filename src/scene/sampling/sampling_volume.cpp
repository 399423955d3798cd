#include "base/text/error.hpp"
#include "scene/sampling/sampling.hpp"
#include "scene/shapes/vector_math.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace treacle::scene {
double distance_to(const Regions& regions, const Vec3& x) {
    double least = Bounds::infinite;
    for (const SolidRegion& region : regions) least = std::min(least, region.distance(x));
    return least;
}

namespace {

using Index = std::array<std::int64_t, 3>;

// Points on faces are classified as if a little further along +x (less along +y, +z): round-off of decimal
// lengths, and of meshes in single precision, is smaller than this. In spacings.
constexpr double face_tolerance = 1e-6;
constexpr std::int64_t estimate_resolution = 128; // blocks along the longest edge of the box that is counted
constexpr int none = -1;

struct IndexBox {
    Index lo{0, 0, 0}, hi{0, 0, 0}; // half-open
    bool empty() const { return lo[0] >= hi[0] || lo[1] >= hi[1] || lo[2] >= hi[2]; }
    std::uint64_t points() const {
        return empty() ? 0
                       : static_cast<std::uint64_t>(hi[0] - lo[0]) * static_cast<std::uint64_t>(hi[1] - lo[1]) *
                             static_cast<std::uint64_t>(hi[2] - lo[2]);
    }
    std::int64_t longest() const { return std::max({hi[0] - lo[0], hi[1] - lo[1], hi[2] - lo[2]}); }
};

Vec3 decided_at(const Vec3& x, const Lattice& lattice) {
    const double e = face_tolerance * lattice.spacing;
    return {x[0] + e, x[1] + 0.7 * e, lattice.dimensions == 2 ? 0 : x[2] + 0.4 * e};
}

// The index of the first point at or above x along an axis, at least `low` and at most `high`.
std::int64_t first_index(const Lattice& lattice, int axis, double x, std::int64_t low, std::int64_t high) {
    const auto at = [&](std::int64_t i) {
        return lattice.min[axis] + (static_cast<double>(i) + 0.5) * lattice.spacing;
    };
    const double guess = std::ceil((x - lattice.min[axis]) / lattice.spacing - 0.5);
    std::int64_t i = guess <= static_cast<double>(low)    ? low
                     : guess >= static_cast<double>(high) ? high
                                                          : static_cast<std::int64_t>(guess);
    while (i > low && at(i - 1) >= x) --i;
    while (i < high && at(i) < x) ++i;
    return i;
}

IndexBox whole(const Lattice& lattice) { return {{0, 0, 0}, lattice.size()}; }

// The points of `within` in the half-open box.
IndexBox points_in(const Lattice& lattice, const Bounds& box, const IndexBox& within) {
    IndexBox result = within;
    for (int a = 0; a < lattice.dimensions; ++a) {
        result.lo[a] = first_index(lattice, a, box.min[a], within.lo[a], within.hi[a]);
        result.hi[a] = first_index(lattice, a, box.max[a], within.lo[a], within.hi[a]);
    }
    return result;
}

Bounds bounds_of(const Regions& regions) {
    Bounds box = Bounds::nothing();
    for (const SolidRegion& region : regions) {
        const Bounds b = region.bounds();
        for (int a = 0; a < 3; ++a) {
            box.min[a] = std::min(box.min[a], b.min[a]);
            box.max[a] = std::max(box.max[a], b.max[a]);
        }
    }
    return box;
}

Bounds grown(Bounds box, double by) {
    for (int a = 0; a < 3; ++a) {
        box.min[a] -= by;
        box.max[a] += by;
    }
    return box;
}

// The liquid of all points within `radius` of x, `none`, or nothing where it is not the same for all.
using Decision = std::optional<int>;

class Decider {
public:
    Decider(const VolumeFill& fill) : fill_(fill) {}

    Decision operator()(const Vec3& x, double radius) const {
        const int liquid_undecided = -2;
        int liquid = none;
        const Vec3 moved = decided_at(x, fill_.lattice);
        for (std::size_t l = 0; l < fill_.liquids.size(); ++l) {
            const double distance = distance_to(fill_.liquids[l], moved);
            if (distance >= radius) continue;
            liquid = distance < -radius ? static_cast<int>(l) : liquid_undecided;
            break;
        }
        if (liquid == none) return none;
        if (fill_.clearance == 0) return beside_solids(x, moved, radius, liquid);
        const double least = fill_.clearance - face_tolerance * fill_.lattice.spacing;
        const double gap = distance_to(fill_.solids, x);
        if (gap < least - radius) return none;
        if (liquid == liquid_undecided || gap < least + radius) return std::nullopt;
        return liquid;
    }

    // Room of the points of a block that has been classified [points].
    double room(const IndexBox& block, int answer) const {
        if (block.points() > 1) return answer == none ? 0 : static_cast<double>(block.points());
        const Vec3 x = fill_.lattice.position(block.lo);
        return in_liquid(x) ? outside_fraction(x) : 0;
    }

private:
    bool in_liquid(const Vec3& x) const {
        const Vec3 moved = decided_at(x, fill_.lattice);
        return std::any_of(fill_.liquids.begin(), fill_.liquids.end(),
            [&](const Regions& one) { return distance_to(one, moved) < 0; });
    }
    // Fraction of the cell of a point that lies outside the solids, as if their surface were flat there.
    double outside_fraction(const Vec3& x) const {
        const double gap = distance_to(fill_.solids, decided_at(x, fill_.lattice));
        return std::clamp(0.5 + gap / fill_.lattice.spacing, 0.0, 1.0);
    }

    Decision beside_solids(const Vec3& x, const Vec3& moved, double radius, int liquid) const {
        const double gap = distance_to(fill_.solids, moved), half = 0.5 * fill_.lattice.spacing;
        if (gap < -half - radius) return none;
        if (liquid < none || (radius > 0 && gap < half + radius)) return std::nullopt;
        // Half open, so that n spacings between two faces hold n layers.
        const bool taken =
            fill_.filling == Filling::points ? gap >= 0 : threshold(x) < 0.5 + gap / fill_.lattice.spacing;
        return taken ? liquid : none;
    }
    // Numbers in [0, 1) of the points of a lattice, evenly spread over any row and plane of it (Roberts 2018, R_3).
    double threshold(const Vec3& x) const {
        constexpr double steps[3] = {0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
        double sum = 0;
        for (int a = 0; a < fill_.lattice.dimensions; ++a) {
            sum += steps[a] * std::round((x[a] - fill_.lattice.min[a]) / fill_.lattice.spacing - 0.5);
        }
        return sum - std::floor(sum);
    }

    const VolumeFill& fill_;
};

// A point of VolumeFill::filling `room`, out of the solids by a quarter of a spacing at least.
Vec3 moved_out(const VolumeFill& fill, Vec3 x) {
    const double d = fill.lattice.spacing, e = 0.01 * d, gap = distance_to(fill.solids, x);
    if (gap >= 0.25 * d) return x;
    Vec3 normal{0, 0, 0};
    for (int a = 0; a < fill.lattice.dimensions; ++a) {
        Vec3 up = x, down = x;
        up[a] += e;
        down[a] -= e;
        normal[a] = distance_to(fill.solids, up) - distance_to(fill.solids, down);
    }
    const double size = length(normal);
    if (size > 0) x = x + ((0.25 * d - gap) / size) * normal;
    return x;
}

int longest_axis(const IndexBox& box) {
    int axis = 0;
    for (int a = 1; a < 3; ++a)
        if (box.hi[a] - box.lo[a] > box.hi[axis] - box.lo[axis]) axis = a;
    return axis;
}

// Cuts the box into blocks for which decide(middle, radius) gives one answer, down to blocks of `finest`
// points an edge, classified by their middle. The distances are 1-Lipschitz, so a block far from every surface
// needs one evaluation.
template <class Decide, class Visit>
void visit_blocks(
    const Lattice& lattice, const IndexBox& box, std::int64_t finest, const Decide& decide, const Visit& visit) {
    if (box.empty()) return;
    Vec3 middle{0, 0, 0}, half{0, 0, 0};
    for (int a = 0; a < lattice.dimensions; ++a) {
        middle[a] = lattice.min[a] + 0.5 * static_cast<double>(box.lo[a] + box.hi[a]) * lattice.spacing;
        half[a] = 0.5 * static_cast<double>(box.hi[a] - box.lo[a] - 1) * lattice.spacing;
    }
    if (box.points() == 1) return visit(box, *decide(lattice.position(box.lo), 0.0));
    // Larger than the round-off of the distances, so that a block is classified as its points are.
    const double radius = (1 + 1e-9) * length(half) + 1e-9 * lattice.spacing;
    if (const auto answer = decide(middle, radius)) return visit(box, *answer);
    if (box.longest() <= finest) return visit(box, *decide(middle, 0.0));
    IndexBox low = box, high = box;
    const int axis = longest_axis(box);
    low.hi[axis] = high.lo[axis] = (box.lo[axis] + box.hi[axis]) / 2;
    visit_blocks(lattice, low, finest, decide, visit);
    visit_blocks(lattice, high, finest, decide, visit);
}

std::int64_t estimate_block(const IndexBox& box) {
    return std::max<std::int64_t>(1, box.longest() / estimate_resolution);
}

// The points of all liquids, in the box.
IndexBox liquid_box(const VolumeFill& fill, const Bounds& part) {
    Regions all;
    for (const Regions& liquid : fill.liquids) all.insert(all.end(), liquid.begin(), liquid.end());
    const IndexBox mine = points_in(fill.lattice, part, whole(fill.lattice));
    return points_in(fill.lattice, grown(bounds_of(all), fill.lattice.spacing), mine);
}

std::uint64_t linear(const Index& i, const Index& n) {
    return (static_cast<std::uint64_t>(i[2]) * static_cast<std::uint64_t>(n[1]) + static_cast<std::uint64_t>(i[1])) *
               static_cast<std::uint64_t>(n[0]) +
           static_cast<std::uint64_t>(i[0]);
}

} // namespace

Moments moments_of(const Regions& regions) {
    if (regions.size() == 1) return regions.front().moments();
    SampledSolid sampled;
    sampled.distance = [&](const Vec3& x) { return distance_to(regions, x); };
    sampled.bounds = bounds_of(regions);
    sampled.dimensions = regions.front().dimensions();
    return moments_of(sampled);
}

VolumeSamples fill_volume(const VolumeFill& fill) {
    const Lattice& lattice = fill.lattice;
    const Index n = lattice.size();
    const IndexBox box = liquid_box(fill, fill.part);
    const Index extent{box.hi[0] - box.lo[0], box.hi[1] - box.lo[1], box.hi[2] - box.lo[2]};
    // One short integer per point keeps the order of the lattice and lets the result be allocated once.
    std::vector<std::int16_t> liquid(box.points(), none);
    std::size_t count = 0;
    const Decider decider(fill);
    double room = 0;
    visit_blocks(lattice, box, 1, decider, [&](const IndexBox& block, int answer) {
        if (fill.clearance == 0) room += decider.room(block, answer);
        if (answer == none) return;
        count += block.points();
        for (auto k = block.lo[2]; k < block.hi[2]; ++k)
            for (auto j = block.lo[1]; j < block.hi[1]; ++j) {
                const auto row = linear({block.lo[0] - box.lo[0], j - box.lo[1], k - box.lo[2]}, extent);
                std::fill_n(liquid.begin() + static_cast<std::ptrdiff_t>(row), block.hi[0] - block.lo[0],
                    static_cast<std::int16_t>(answer));
            }
    });
    VolumeSamples result;
    result.room = room;
    result.positions.reserve(count);
    result.ids.reserve(count);
    result.liquids.reserve(count);
    const std::uint64_t points = lattice.points();
    std::size_t at = 0;
    for (auto k = box.lo[2]; k < box.hi[2]; ++k)
        for (auto j = box.lo[1]; j < box.hi[1]; ++j)
            for (auto i = box.lo[0]; i < box.hi[0]; ++i) {
                const int l = liquid[at++];
                if (l == none) continue;
                const Vec3 x = lattice.position({i, j, k});
                result.positions.push_back(fill.filling == Filling::room ? moved_out(fill, x) : x);
                result.ids.push_back(static_cast<std::uint64_t>(l) * points + linear({i, j, k}, n));
                result.liquids.push_back(l);
            }
    return result;
}

std::vector<std::uint64_t> estimate_liquid_counts(const VolumeFill& fill) {
    std::vector<std::uint64_t> counts(fill.liquids.size(), 0);
    const IndexBox box = liquid_box(fill, {});
    visit_blocks(fill.lattice, box, estimate_block(box), Decider(fill), [&](const IndexBox& block, int answer) {
        if (answer != none) counts[static_cast<std::size_t>(answer)] += block.points();
    });
    return counts;
}

Overlap find_overlap(const Regions& liquid, const Regions& solids, const Lattice& lattice) {
    VolumeFill fill{{liquid}, {}, 0, lattice, {}};
    const Decider in_liquid(fill);
    const double tolerance = face_tolerance * lattice.spacing;
    const IndexBox box = liquid_box(fill, {});
    Overlap result;
    const auto decide = [&](const Vec3& x, double radius) -> Decision {
        const Decision in = in_liquid(x, radius);
        if (in == none) return none;
        const double gap = distance_to(solids, x) + tolerance;
        if (!in || (gap >= -radius && gap < radius)) return std::nullopt;
        return gap < 0 ? 1 : 0;
    };
    visit_blocks(lattice, box, estimate_block(box), decide, [&](const IndexBox& block, int answer) {
        if (answer == none) return;
        result.total += block.points();
        if (answer == 0) return;
        if (result.count == 0)
            result.example = lattice.position({(block.lo[0] + block.hi[0] - 1) / 2, (block.lo[1] + block.hi[1] - 1) / 2,
                (block.lo[2] + block.hi[2] - 1) / 2});
        result.count += block.points();
    });
    return result;
}

namespace {
// Points inside the domain, those too close to its far sides for a particle among them.
Index points_before_far_sides(const Lattice& lattice) {
    Index n = lattice.size();
    for (int a = 0; a < lattice.dimensions; ++a)
        while (lattice.min[a] + (static_cast<double>(n[a]) + 0.5 - face_tolerance) * lattice.spacing < lattice.max[a])
            ++n[a];
    return n;
}

// Cuts off what reaches beyond the domain: the box keeps the part inside.
std::vector<IndexBox> cut_outside(IndexBox& box, const Index& size) {
    std::vector<IndexBox> outside;
    for (int a = 0; a < 3; ++a) {
        IndexBox below = box, above = box;
        below.hi[a] = std::min<std::int64_t>(box.hi[a], 0);
        above.lo[a] = std::max(box.lo[a], size[a]);
        box.lo[a] = std::max<std::int64_t>(box.lo[a], 0);
        box.hi[a] = std::min(box.hi[a], size[a]);
        for (const IndexBox& part : {below, above})
            if (!part.empty()) outside.push_back(part);
    }
    return outside;
}

// The lattice, carried on beyond the domain, over a box of space.
IndexBox box_around(const Lattice& lattice, const Bounds& bounds) {
    IndexBox box{{0, 0, 0}, {1, 1, 1}};
    for (int a = 0; a < lattice.dimensions; ++a) {
        box.lo[a] = static_cast<std::int64_t>(std::floor((bounds.min[a] - lattice.min[a]) / lattice.spacing)) - 1;
        box.hi[a] = static_cast<std::int64_t>(std::ceil((bounds.max[a] - lattice.min[a]) / lattice.spacing)) + 1;
    }
    return points_in(lattice, bounds, box);
}
} // namespace

Overlap find_outside(const Regions& liquid, const Lattice& lattice) {
    Regions bounded;
    for (const SolidRegion& region : liquid)
        if (std::isfinite(region.volume())) bounded.push_back(region);
    Overlap result;
    if (bounded.empty()) return result;
    const VolumeFill fill{{bounded}, {}, 0, lattice, {}};
    IndexBox box = box_around(lattice, grown(bounds_of(bounded), 2 * face_tolerance * lattice.spacing));
    const std::int64_t coarse = estimate_block(box);
    // Thin parts point by point, so that liquid which only touches a side of the domain is not taken for outside.
    constexpr std::int64_t thin = 4;
    constexpr std::uint64_t most_points = 100'000'000;
    for (const IndexBox& part : cut_outside(box, points_before_far_sides(lattice))) {
        std::int64_t thickness = part.hi[0] - part.lo[0];
        for (int a = 1; a < lattice.dimensions; ++a) thickness = std::min(thickness, part.hi[a] - part.lo[a]);
        const bool by_point = thickness <= thin && part.points() <= most_points;
        visit_blocks(
            lattice, part, by_point ? 1 : estimate_block(part), Decider(fill), [&](const IndexBox& block, int answer) {
                if (answer == none) return;
                if (result.count == 0) result.example = lattice.position(block.lo);
                result.count += block.points();
            });
    }
    result.total = result.count;
    visit_blocks(lattice, box, coarse, Decider(fill), [&](const IndexBox& block, int answer) {
        if (answer != none) result.total += block.points();
    });
    return result;
}

double solid_fraction(const Regions& solids, const Lattice& lattice) {
    const IndexBox box = whole(lattice);
    std::uint64_t solid = 0;
    const auto decide = [&](const Vec3& x, double radius) -> Decision {
        const double distance = distance_to(solids, decided_at(x, lattice));
        if (distance >= radius) return 0;
        if (distance < -radius) return 1;
        return std::nullopt;
    };
    visit_blocks(lattice, box, estimate_block(box), decide, [&](const IndexBox& block, int answer) {
        if (answer == 1) solid += block.points();
    });
    return box.points() > 0 ? static_cast<double>(solid) / static_cast<double>(box.points()) : 0;
}

} // namespace treacle::scene
