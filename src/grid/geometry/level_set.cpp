#include "grid/geometry/level_set.hpp"

#include "grid/geometry/mirror_particles.hpp"
#include "kokkos/simd.hpp"

#include <cmath>
#include <vector>

namespace treacle::grid {

namespace {
constexpr int table = 256; // steps of the map of the half space over [0, 1]
// Particles nearer to a solid than this, over dx, have an image in it: the layer at the wall, of two per cell.
constexpr double image_cutoff = 0.6;
// Layers of fine nodes into which the liquid is continued in solids: as deep, along the axes, as the cube of a face with
// fluid reaches.
constexpr int continued_layers = 6;
// [dx] What the surface lies too low, because the mean of scattered particles is farther away than that of a continuum:
// measured of pools and balls of seeded particles (jitter 0.25), in 2D and in 3D.
constexpr double scatter_shift[2] = {0.04, 0.05};
// A cell whose particles are this fraction of the seeded number has no surface in it if those around it are like it.
constexpr double full_fraction = 0.5;

// The mean of the particles of a half space is at distance g(u) from height u, both over the radius: the weight
// (1 - s^2)^3 sums to (1 - s^2)^4 over the plane at distance s in 3D, to (1 - s^2)^3.5 over the line in 2D.
// Returns u at g = 0, 1/table, ..., 1.
std::vector<double> invert_half_space(int dimensions) {
    constexpr int steps = 20000; // over [0, 1]: the midpoint rule is right to 1e-8
    const double power = dimensions == 3 ? 4 : 3.5;
    std::vector<double> out(table + 1, 1.0);
    out[0] = -1;
    double weight = 0, moment = 0, u_before = 1, g_before = 1;
    int entry = table - 1;
    for (int k = 1; k < 2 * steps && entry > 0; ++k) {
        const double s = 1 - (k - 0.5) / steps, w = std::pow(1 - s * s, power);
        weight += w;
        moment += w * s;
        const double u = 1 - double(k) / steps, g = moment / weight;
        for (; entry > 0 && double(entry) / table >= g; --entry) {
            const double fraction = (g_before - double(entry) / table) / (g_before - g);
            out[static_cast<std::size_t>(entry)] = u_before + fraction * (u - u_before);
        }
        u_before = u;
        g_before = g;
    }
    return out;
}

KOKKOS_INLINE_FUNCTION double read_table(const Array<double>& map, double q) {
    const double at = math::min(q, 1.0) * table;
    const int k = math::min(static_cast<int>(at), table - 1);
    return map(k) + (at - k) * (map(k + 1) - map(k));
}

// Weighted sums of the particles around a place.
struct Mean {
    double weight = 0, offset[3] = {0, 0, 0};

    // `mirror`: bit k: the offset along axis k changes its sign.
    KOKKOS_INLINE_FUNCTION void add(const Array3& x, int k, const double at[3], double inverse_square, int mirror) {
        const double d[3] = {x(k, 0) - at[0], x(k, 1) - at[1], x(k, 2) - at[2]};
        const double s = math::max(0.0, 1 - (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) * inverse_square);
        const double w = s * s * s;
        weight += w;
        for (int c = 0; c < 3; ++c) offset[c] += mirror >> c & 1 ? -w * d[c] : w * d[c];
    }
    KOKKOS_INLINE_FUNCTION double distance() const {
        return math::sqrt(offset[0] * offset[0] + offset[1] * offset[1] + offset[2] * offset[2]) / weight;
    }
};

// The same of several particles at a time.
struct LaneMean {
    SimdDouble weight = 0.0, x = 0.0, y = 0.0, z = 0.0;

    KOKKOS_INLINE_FUNCTION void add(
        const Array<double> along[3], int first, int last, const double at[3], double inverse_square) {
        for (int k = first; k < last; k += lanes) {
            const SimdDouble dx = load_lanes(&along[0](k)) - SimdDouble(at[0]),
                             dy = load_lanes(&along[1](k)) - SimdDouble(at[1]),
                             dz = load_lanes(&along[2](k)) - SimdDouble(at[2]);
            const SimdDouble s = math::max(
                SimdDouble(0.0), SimdDouble(1.0) - (dx * dx + dy * dy + dz * dz) * SimdDouble(inverse_square));
            const SimdDouble w = select(tail_mask(last - k), s * s * s, SimdDouble(0.0));
            weight = weight + w;
            x = x + w * dx;
            y = y + w * dy;
            z = z + w * dz;
        }
    }
    KOKKOS_INLINE_FUNCTION void add_to(Mean& mean) const {
        mean.weight += sum_lanes(weight);
        mean.offset[0] += sum_lanes(x);
        mean.offset[1] += sum_lanes(y);
        mean.offset[2] += sum_lanes(z);
    }
};

struct Builder {
    FineNodes nodes;
    CellBox owned;
    CellList cells;
    Array3 x, image;
    Array<double> along[3]; // x, axis by axis
    WallPlanes walls;
    Array<double> solid, map, out;
    double radius, shift; // [m]
    int full;             // particles of a cell without surface

    KOKKOS_INLINE_FUNCTION bool is_solid(const int c[3]) const {
        const int base = FineNodes::per_cell * nodes.window.index(c[0], c[1], c[2]);
        bool inside = true;
        for (int k = 0; k < nodes.used(); ++k) inside = inside && nodes.is_inside(solid(base + k));
        return inside;
    }
    // The fewest and the most particles in the cells around c, itself included, but for those within solids.
    KOKKOS_INLINE_FUNCTION void count_around(const int c[3], int& fewest, int& most) const {
        const int up = nodes.dimensions == 2 ? 0 : 1;
        fewest = full;
        most = 0;
        for (int z = -up; z <= up; ++z) {
            for (int y = -1; y <= 1; ++y) {
                for (int dx = -1; dx <= 1; ++dx) {
                    const int q[3] = {c[0] + dx, c[1] + y, c[2] + z};
                    const int k = cells.window.index(q[0], q[1], q[2]);
                    const int n = cells.end(k) - cells.begin(k);
                    if (n == 0 && is_solid(q)) continue;
                    fewest = math::min(fewest, n);
                    most = math::max(most, n);
                }
            }
        }
    }
    // Bit k: a wall across axis k is so near that particles within the radius have images in it; `side`: which.
    KOKKOS_INLINE_FUNCTION int near_walls(const double position[3], int side[3]) const {
        int near = 0;
        for (int s = 0; s < 2 * nodes.dimensions; ++s) {
            if (!walls.is_wall[s] || walls.distance(s, position) >= (1 + image_cutoff) * radius) continue;
            near |= 1 << s / 2;
            side[s / 2] = s;
        }
        return near;
    }
    // The images of particles [first, last) in some walls: relative to the position's own image they are the particles.
    KOKKOS_INLINE_FUNCTION void add_mirrored(int first, int last, const double position[3], int mirror,
        const int side[3], double inverse_square, Mean& mean) const {
        double at[3] = {position[0], position[1], position[2]};
        for (int k = 0; k < 3; ++k) {
            if (mirror >> k & 1) at[k] = 2 * walls.at[side[k]] - position[k];
        }
        for (int p = first; p < last; ++p) {
            bool near = true;
            for (int k = 0; k < 3; ++k) {
                if (mirror >> k & 1) near = near && math::fabs(x(p, k) - walls.at[side[k]]) < image_cutoff * radius;
            }
            if (!near) continue;
            mean.add(x, p, at, inverse_square, mirror);
            mean.add(image, p, at, inverse_square, mirror);
        }
    }
    KOKKOS_INLINE_FUNCTION double at_node(
        const int c[3], int corner, const double position[3], double solid_distance) const {
        const double inverse_square = 1 / (radius * radius);
        // Beyond this no particle within the radius has an image.
        const bool images = solid_distance < (1 + image_cutoff) * radius;
        int side[3];
        const int near = images ? near_walls(position, side) : 0;
        Mean mean;
        LaneMean seen;
        const int top = nodes.dimensions == 2 ? 0 : corner >> 2 & 1, bottom = nodes.dimensions == 2 ? 0 : -1;
        for (int z = bottom; z <= top; ++z) {
            for (int y = -1; y <= (corner >> 1 & 1); ++y) {
                for (int dx = -1; dx <= (corner & 1); ++dx) {
                    const int k = cells.window.index(c[0] + dx, c[1] + y, c[2] + z);
                    const int first = cells.begin(k), last = cells.end(k);
                    seen.add(along, first, last, position, inverse_square);
                    for (int p = first; images && p < last; ++p) mean.add(image, p, position, inverse_square, 0);
                    for (int mirror = 1; mirror <= near; ++mirror) {
                        if ((mirror & near) == mirror)
                            add_mirrored(first, last, position, mirror, side, inverse_square, mean);
                    }
                }
            }
        }
        seen.add_to(mean);
        return mean.weight > 0 ? radius * read_table(map, mean.distance() / radius) - shift : radius;
    }
};

// Distances at the nodes of the owned cells; returns how many cells were summed over particles.
int sum_particles(const Builder& build) {
    int surface = 0;
    Kokkos::parallel_reduce(
        "treacle::level_set", static_cast<int>(build.owned.size()),
        KOKKOS_LAMBDA(int i, int& count) {
            int c[3], fewest, most;
            build.owned.cell(i, c);
            build.count_around(c, fewest, most);
            const int base = FineNodes::per_cell * build.nodes.window.index(c[0], c[1], c[2]);
            if (most == 0 || fewest >= build.full) {
                for (int k = 0; k < FineNodes::per_cell; ++k)
                    build.out(base + k) = most == 0 ? build.radius : -build.radius;
                return;
            }
            ++count;
            for (int k = 0; k < build.nodes.used(); ++k) {
                double position[3];
                build.nodes.position(c, k, position);
                // Within solids the liquid is continued afterwards.
                const double solid = build.solid(base + k);
                build.out(base + k) =
                    build.nodes.is_inside(solid) ? build.radius : build.at_node(c, k, position, solid);
            }
        },
        surface);
    return surface;
}

// Positions axis by axis, with room behind the last for lanes that do not count.
void split_axes(const Array3& x, int n, Array<double> along[3]) {
    for (int k = 0; k < 3; ++k) {
        const auto to = static_cast<std::size_t>(n + lanes);
        if (along[k].extent(0) < to)
            along[k] = Array<double>("treacle::level_set_along", to + to / 32); // zeros: no NaN behind the end
        const auto axis = along[k];
        Kokkos::parallel_for(
            "treacle::split_axes", n, KOKKOS_LAMBDA(int i) { axis(i) = x(i, k); });
    }
}

// Lists the nodes in solids that the liquid may be continued into, and marks them as not yet found.
int list_nodes(
    const FineNodes& nodes, const Array<double>& solid, double depth, const Array<int>& list, const Array<int>& found) {
    int count = 0;
    const bool write = list.extent(0) > 0;
    Kokkos::parallel_scan(
        "treacle::nodes_in_solids", static_cast<int>(nodes.window.size()),
        KOKKOS_LAMBDA(int i, int& row, bool last) {
            for (int at = FineNodes::per_cell * i; at < FineNodes::per_cell * i + nodes.used(); ++at) {
                if (last && !write) found(at) = nodes.is_inside(solid(at)) ? continued_layers + 1 : 0;
                if (!nodes.is_inside(solid(at)) || solid(at) < -depth) continue;
                if (last && write) list(row) = at;
                ++row;
            }
        },
        count);
    return count;
}

// Nodes in solids that the liquid is continued into.
struct SolidNodes {
    FineNodes nodes;
    Array<double> solid; // [nodes] distance from the solids [m]
    Array<int> list;     // [count] nodes
    int count;
    Array<int> found; // [nodes] layer in which each was found
};

// Nodes in solids take the value of their neighbours nearer to the surface, weighted by how much nearer: constant along
// the gradient of the solid's distance. Nodes that this layer finds count from the next one on.
void continue_layer(const SolidNodes& inside, int layer, const Array<double>& value) {
    const FineNodes nodes = inside.nodes;
    const auto solid = inside.solid;
    const auto found = inside.found;
    const double deepest = (layer + 1e-6) * nodes.width; // depth [m] that as many steps along the axes lead to
    Kokkos::parallel_for(
        "treacle::continue_liquid", inside.count, KOKKOS_LAMBDA(int i) {
            const int at = inside.list(i), corner = at % FineNodes::per_cell;
            const double here = solid(at);
            if (found(at) < layer || here < -deepest) return;
            int c[3];
            nodes.window.cell(at / FineNodes::per_cell, c);
            double sum = 0, weights = 0;
            for (int k = 0; k < nodes.dimensions; ++k) {
                for (int side = -1; side <= 1; side += 2) {
                    int f[3] = {2 * c[0] + (corner & 1), 2 * c[1] + (corner >> 1 & 1), 2 * c[2] + (corner >> 2)};
                    if (nodes.dimensions == 2) f[2] = 0;
                    f[k] += side;
                    if (f[k] < 2 * nodes.window.lo[k] || f[k] >= 2 * nodes.window.hi[k]) continue;
                    const int other = nodes.index(f[0], f[1], f[2]);
                    const double nearer = solid(other) - here;
                    if (found(other) >= layer || nearer <= 0) continue;
                    sum += nearer * value(other);
                    weights += nearer;
                }
            }
            if (weights == 0) return;
            value(at) = sum / weights;
            found(at) = layer;
        });
}
} // namespace

void LevelSet::continue_into_solids(const FineNodes& nodes, const Array<double>& solid) {
    reserve(layer_, nodes.size());
    const double depth = (continued_layers + 1) * nodes.width;
    const int count = list_nodes(nodes, solid, depth, Array<int>(), layer_);
    reserve(in_solids_, static_cast<std::size_t>(count));
    if (count == 0) return;
    list_nodes(nodes, solid, depth, in_solids_, layer_);
    const SolidNodes inside{nodes, solid, in_solids_, count, layer_};
    for (int layer = 1; layer <= continued_layers; ++layer) continue_layer(inside, layer, distance_);
}

void LevelSet::build(
    const MacGrid& grid, CellHalo& halo, const GridParticles& particles, const CellList& cells, const Solids& solids) {
    if (dimensions_ != grid.dimensions) {
        dimensions_ = grid.dimensions;
        const auto map = invert_half_space(dimensions_);
        half_space_ = Array<double>("treacle::half_space_map", map.size());
        const auto host = Kokkos::create_mirror_view(half_space_);
        for (std::size_t k = 0; k < map.size(); ++k) host(k) = map[k];
        Kokkos::deep_copy(half_space_, host);
    }
    const FineNodes nodes = solids.nodes();
    reserve(distance_, nodes.size());
    Kokkos::deep_copy(distance_, grid.dx);
    // Across bodies; walls have theirs by the mirrored positions of nodes.
    MirrorParticles::find(particles, solids.sampler(), solids.number(), MirroredIn::bodies, image_cutoff * grid.dx);
    split_axes(particles.position(), particles.store.total(), along_);
    const int seeded = grid.dimensions == 2 ? 4 : 8;
    surface_ = static_cast<std::size_t>(sum_particles({nodes, halo.owned(), cells, particles.position(),
        particles.image(), {along_[0], along_[1], along_[2]}, solids.walls(), solids.distance(), half_space_, distance_,
        grid.dx, scatter_shift[grid.dimensions - 2] * grid.dx, static_cast<int>(full_fraction * seeded)}));
    halo.gather_blocks(distance_, FineNodes::per_cell);
    pores_.close(halo, solids, distance_);
    continue_into_solids(nodes, solids.distance());
    halo.gather_blocks(distance_, FineNodes::per_cell);
}

} // namespace treacle::grid
