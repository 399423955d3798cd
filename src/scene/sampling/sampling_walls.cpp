#include "base/text/error.hpp"
#include "scene/sampling/sampling.hpp"
#include "scene/shapes/vector_math.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace treacle::scene {
namespace {

// The places of a face's points along one of its axes: `before` beyond the lower end of the lattice, n on
// it, `after` beyond the upper end. The steps beyond an end are equal and at most d, the last one on the
// edge of the neighbouring wall's layer.
struct Line {
    double first = 0, spacing = 0; // [m] of the lattice
    std::int64_t before = 0, n = 1, after = 0;
    double low_step = 0, high_step = 0; // [m]

    std::int64_t size() const { return before + n + after; }
    double at(std::int64_t i) const { // 0 .. size() - 1
        const std::int64_t j = i - before;
        if (j < 0) return first + 0.5 * spacing + static_cast<double>(j) * low_step;
        if (j < n) return first + (static_cast<double>(j) + 0.5) * spacing;
        return first + (static_cast<double>(n) - 0.5) * spacing + static_cast<double>(j - n + 1) * high_step;
    }
};

int axis_of(int side) { return side / 2; }

// The points of `side` along `axis`. Edges belong to the side of the lower axis.
Line line_of(const WallSampling& s, int side, int axis) {
    const Lattice& lattice = s.lattice;
    Line line{lattice.min[axis], lattice.spacing, 0, lattice.size()[static_cast<std::size_t>(axis)], 0, 0, 0};
    const bool owns_edges = axis_of(side) < axis;
    const auto carry_on = [&](double gap, std::int64_t& count, double& step) {
        const auto steps =
            std::max<std::int64_t>(1, static_cast<std::int64_t>(std::ceil(gap / lattice.spacing - 1e-6)));
        step = gap / static_cast<double>(steps);
        count = owns_edges ? steps : steps - 1;
    };
    if (s.sides[static_cast<std::size_t>(2 * axis)] == Side::wall)
        carry_on(0.5 * lattice.spacing + s.outset, line.before, line.low_step);
    if (s.sides[static_cast<std::size_t>(2 * axis + 1)] == Side::wall) {
        const auto gap = [&] {
            const double last = lattice.min[axis] + (static_cast<double>(line.n) - 0.5) * lattice.spacing;
            return lattice.max[axis] + s.outset - last;
        };
        // In a domain that is no multiple of d the last point may come close to the corner.
        if (gap() < (0.5 - 1e-6) * lattice.spacing && line.n > 1) --line.n;
        carry_on(gap(), line.after, line.high_step);
    }
    return line;
}

struct Wall {
    int side = 0;
    std::array<int, 2> axes{0, 0}; // along the face; axes[1] = -1 in 2D
    std::array<Line, 2> lines;
    std::uint64_t first_id = 0;
    double level = 0; // [m] of the layer
    std::uint64_t points() const {
        return static_cast<std::uint64_t>(lines[0].size()) * static_cast<std::uint64_t>(lines[1].size());
    }
};

void require_valid(const WallSampling& s) {
    for (int a = 0; a < s.lattice.dimensions; ++a) {
        if (s.sides[static_cast<std::size_t>(2 * a)] != Side::periodic || s.lattice.fits(a)) continue;
        const double edge = s.lattice.max[a] - s.lattice.min[a];
        std::ostringstream problem, cure;
        problem << "domain: the periodic edge of " << edge << " m along "
                << "xyz"[a] << " is not a multiple of the spacing of " << s.lattice.spacing << " m";
        cure << "make it " << std::max(1.0, std::round(edge / s.lattice.spacing)) * s.lattice.spacing << " m";
        throw InputError({"", problem.str(), "the lattice of particles would not close on itself", cure.str()});
    }
}

std::vector<Wall> walls_of(const WallSampling& s) {
    require_valid(s);
    std::vector<Wall> walls;
    std::uint64_t next = 0;
    for (int side = 0; side < 2 * s.lattice.dimensions; ++side) {
        if (s.sides[static_cast<std::size_t>(side)] != Side::wall) continue;
        Wall wall;
        wall.side = side;
        const int normal = axis_of(side);
        wall.axes = s.lattice.dimensions == 2 ? std::array{1 - normal, -1}
                                              : std::array{normal == 0 ? 1 : 0, normal == 2 ? 1 : 2};
        for (std::size_t l = 0; l < 2; ++l)
            if (wall.axes[l] >= 0) wall.lines[l] = line_of(s, side, wall.axes[l]);
        wall.level = side % 2 == 0 ? s.lattice.min[normal] - s.outset : s.lattice.max[normal] + s.outset;
        wall.first_id = next;
        next += wall.points();
        walls.push_back(wall);
    }
    return walls;
}

// A coordinate moved into the domain, whose upper end counts as inside.
double into_domain(const Lattice& lattice, int axis, double x) {
    return std::clamp(x, lattice.min[axis], std::nextafter(lattice.max[axis], lattice.min[axis]));
}

// Range of a line that belongs to the part of space: [begin, end).
std::array<std::int64_t, 2> index_range(const WallSampling& s, const Line& line, int axis) {
    if (axis < 0) return {0, 1};
    const auto first_at_or_above = [&](double bound) {
        std::int64_t low = 0, high = line.size();
        while (low < high) {
            const std::int64_t middle = (low + high) / 2;
            if (into_domain(s.lattice, axis, line.at(middle)) < bound)
                low = middle + 1;
            else
                high = middle;
        }
        return low;
    };
    return {first_at_or_above(s.part.min[axis]), first_at_or_above(s.part.max[axis])};
}

// Into the domain; on edges and corners the mean of the walls that meet there.
Vec3 normal_at(const WallSampling& s, const Vec3& x) {
    Vec3 n{0, 0, 0};
    const double tolerance = 1e-6 * s.lattice.spacing;
    for (int a = 0; a < s.lattice.dimensions; ++a) {
        const auto side = static_cast<std::size_t>(2 * a);
        if (s.sides[side] == Side::wall && x[a] < s.lattice.min[a] - s.outset + tolerance) n[a] += 1;
        if (s.sides[side + 1] == Side::wall && x[a] > s.lattice.max[a] + s.outset - tolerance) n[a] -= 1;
    }
    return unit(n);
}

void add_wall(const WallSampling& s, const Wall& wall, WallSamples& result) {
    const int normal = axis_of(wall.side);
    const double level = into_domain(s.lattice, normal, wall.level);
    if (level < s.part.min[normal] || level >= s.part.max[normal]) return;
    const auto u = index_range(s, wall.lines[0], wall.axes[0]), v = index_range(s, wall.lines[1], wall.axes[1]);
    for (auto j = v[0]; j < v[1]; ++j)
        for (auto i = u[0]; i < u[1]; ++i) {
            Vec3 x{0, 0, 0};
            x[normal] = wall.level;
            x[wall.axes[0]] = wall.lines[0].at(i);
            if (wall.axes[1] >= 0) x[wall.axes[1]] = wall.lines[1].at(j);
            result.positions.push_back(x);
            result.normals.push_back(normal_at(s, x));
            result.faces.push_back(wall.side);
            result.ids.push_back(wall.first_id +
                                 static_cast<std::uint64_t>(j) * static_cast<std::uint64_t>(wall.lines[0].size()) +
                                 static_cast<std::uint64_t>(i));
        }
}

} // namespace

WallSamples sample_domain_walls(const WallSampling& sampling) {
    WallSamples result;
    for (const Wall& wall : walls_of(sampling)) add_wall(sampling, wall, result);
    return result;
}

std::uint64_t count_domain_walls(const WallSampling& sampling) {
    std::uint64_t count = 0;
    for (const Wall& wall : walls_of(sampling)) count += wall.points();
    return count;
}

} // namespace treacle::scene
