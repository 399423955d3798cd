#include "surface/field/points.hpp"

#include "kokkos/scan.hpp"

namespace treacle::surface {

void PointBuilder::reserve_points(int n) {
    const auto grow = [&](auto& view) {
        reserve_keep(view, static_cast<std::size_t>(n), static_cast<std::size_t>(n_));
    };
    for (auto& x : x_) grow(x);
    grow(source_);
    grow(id_);
    grow(image_);
}

void PointBuilder::take_particles(const ParticleStore& store, const PointFields& fields) {
    const int n = store.total();
    n_ = 0;
    reserve_points(n);
    n_ = n;
    const auto x = store.position();
    const auto id = store.id();
    const auto x0 = x_[0], x1 = x_[1], x2 = x_[2];
    const auto source = source_;
    const auto ids = id_, image = image_, mirrored = store.get<Array<std::int64_t>>(fields.image);
    liquid_of_row_ = store.get<Array<int>>(fields.liquid);
    Kokkos::parallel_for(
        "treacle::surface_points", n, KOKKOS_LAMBDA(int i) {
            x0(i) = x(i, 0);
            x1(i) = x(i, 1);
            x2(i) = x(i, 2);
            source(i) = i;
            ids(i) = id(i);
            image(i) = mirrored(i);
        });
}

void PointBuilder::mirror_at_walls(const Lattice& lattice, double support, int axis) {
    const bool at_low = lattice.mirror[0][axis], at_high = lattice.mirror[1][axis];
    if (!at_low && !at_high) return;
    const double low = lattice.position(axis, lattice.lo[axis]), high = lattice.position(axis, lattice.hi[axis]);
    const int n = n_;
    reserve(counts_, static_cast<std::size_t>(n + 1));
    const auto counts = counts_;
    const auto along = x_[axis];
    Kokkos::parallel_for(
        "treacle::count_wall_images", n, KOKKOS_LAMBDA(int i) {
            const double x = along(i);
            counts(i) = (at_low && x >= low && x < low + support ? 1 : 0) +
                        (at_high && x <= high && x > high - support ? 1 : 0);
        });
    const int added = static_cast<int>(counts_to_offsets(counts_, n));
    reserve_points(n + added);
    const auto source = source_;
    const auto id = id_, image = image_;
    const auto x0 = x_[0], x1 = x_[1], x2 = x_[2], mirrored = x_[axis];
    Kokkos::parallel_for(
        "treacle::wall_images", n, KOKKOS_LAMBDA(int i) {
            int to = n + counts(i);
            const double x = mirrored(i);
            for (int side = 0; side < 2; ++side) {
                const bool is =
                    side == 0 ? at_low && x >= low && x < low + support : at_high && x <= high && x > high - support;
                if (!is) continue;
                x0(to) = x0(i);
                x1(to) = x1(i);
                x2(to) = x2(i);
                mirrored(to) = 2 * (side == 0 ? low : high) - x;
                source(to) = source(i);
                id(to) = id(i);
                image(to) = image(i) * 512 + 2 * axis + side + 1;
                ++to;
            }
        });
    n_ += added;
}

// Tile and bin in it of each point; points outside of the window count nowhere.
void PointBuilder::locate_points(const Lattice& lattice, const CellBox& window) {
    const int n = n_;
    const int tiles = static_cast<int>(window.size());
    auto& p = points_;
    p.window = window;
    reserve(p.tile, static_cast<std::size_t>(tiles + 1));
    reserve(bin_, static_cast<std::size_t>(n));
    reserve(slot_, static_cast<std::size_t>(n));
    const auto tile = p.tile;
    const auto bin = bin_, slot = slot_;
    const auto x0 = x_[0], x1 = x_[1], x2 = x_[2];
    const auto lattice_here = lattice;
    Kokkos::parallel_for(
        "treacle::clear_tiles", tiles + 1, KOKKOS_LAMBDA(int t) { tile(t) = 0; });
    Kokkos::parallel_for(
        "treacle::locate_points", n, KOKKOS_LAMBDA(int i) {
            const double x[3] = {x0(i), x1(i), x2(i)};
            int c[3] = {0, 0, 0}, b[3] = {0, 0, 0};
            bool inside = true;
            for (int k = 0; k < lattice_here.dimensions; ++k) {
                const double along = (x[k] - lattice_here.grid.origin[k]) / (2 * lattice_here.step[k]);
                int node = static_cast<int>(math::floor(along));
                c[k] = node >> 2;
                b[k] = node & 3;
                inside = inside && c[k] >= window.lo[k] && c[k] < window.hi[k];
            }
            slot(i) = inside ? window.index(c[0], c[1], c[2]) : -1;
            bin(i) = b[0] + bins_edge * (b[1] + bins_edge * b[2]);
            if (inside) tile(slot(i)) = 1;
        });
    p.tiles = static_cast<int>(counts_to_offsets(p.tile, tiles));
}

void PointBuilder::sort_into_bins(int per_tile) {
    const int n = n_;
    const int tiles = static_cast<int>(points_.window.size());
    auto& p = points_;
    const auto tile = p.tile;
    const auto bin = bin_, slot = slot_;
    bins_ = p.tiles * per_tile;
    reserve(p.begin, static_cast<std::size_t>(bins_ + 1));
    const auto begin = p.begin;
    Kokkos::parallel_for(
        "treacle::clear_bins", bins_ + 1, KOKKOS_LAMBDA(int b) { begin(b) = 0; });
    Kokkos::parallel_for(
        "treacle::count_bins", n, KOKKOS_LAMBDA(int i) {
            if (slot(i) < 0) {
                bin(i) = -1;
                return;
            }
            bin(i) += per_tile * tile(slot(i));
            slot(i) = Kokkos::atomic_fetch_add(&begin(bin(i)), 1);
        });
    p.count = static_cast<int>(counts_to_offsets(p.begin, bins_));
    reserve(order_, static_cast<std::size_t>(p.count));
    const auto order = order_;
    Kokkos::parallel_for(
        "treacle::fill_bins", n, KOKKOS_LAMBDA(int i) {
            if (bin(i) >= 0) order(begin(bin(i)) + slot(i)) = i;
        });
    // Tiles without points: -1. The offsets of the others are their numbers.
    Kokkos::parallel_for(
        "treacle::mark_empty_tiles", 1, KOKKOS_LAMBDA(int) {
            for (int t = 0; t < tiles; ++t) {
                if (tile(t + 1) == tile(t)) tile(t) = -1;
            }
        });
}

void PointBuilder::pack_points(const Lattice& lattice) {
    auto& p = points_;
    for (auto& position : p.position) reserve(position, static_cast<std::size_t>(p.count));
    reserve(p.row, static_cast<std::size_t>(p.count));
    reserve(p.original, static_cast<std::size_t>(p.count));
    reserve(p.liquid, static_cast<std::size_t>(p.count));
    const auto order = order_;
    const auto x0 = x_[0], x1 = x_[1], x2 = x_[2];
    const auto q0 = p.position[0], q1 = p.position[1], q2 = p.position[2];
    const auto row = p.row, original = p.original, liquid = p.liquid, liquid_of_row = liquid_of_row_;
    const auto source = source_;
    const auto image = image_;
    const auto lattice_here = lattice;
    Kokkos::parallel_for(
        "treacle::pack_points", p.count, KOKKOS_LAMBDA(int k) {
            const int i = order(k);
            const auto& l = lattice_here;
            q0(k) = (x0(i) - l.grid.origin[0]) / l.step[0];
            q1(k) = (x1(i) - l.grid.origin[1]) / l.step[1];
            q2(k) = l.dimensions == 3 ? (x2(i) - l.grid.origin[2]) / l.step[2] : 0;
            row(k) = source(i);
            original(k) = image(i) == 0 ? 1 : 0;
            liquid(k) = liquid_of_row(source(i));
        });
}

void PointBuilder::order_bins() {
    const auto begin = points_.begin;
    const auto order = order_;
    const auto id = id_, image = image_;
    Kokkos::parallel_for(
        "treacle::order_bins", bins_, KOKKOS_LAMBDA(int b) {
            for (int k = begin(b) + 1; k < begin(b + 1); ++k) {
                const int moved = order(k);
                int slot = k;
                for (; slot > begin(b); --slot) {
                    const int other = order(slot - 1);
                    if (id(other) < id(moved) || (id(other) == id(moved) && image(other) <= image(moved))) break;
                    order(slot) = other;
                }
                order(slot) = moved;
            }
        });
}

const Points& PointBuilder::build(const ParticleStore& store, const PointFields& fields, const Lattice& lattice,
    const CellBox& window, double support) {
    take_particles(store, fields);
    for (int k = 0; k < lattice.dimensions; ++k) mirror_at_walls(lattice, support, k);
    locate_points(lattice, window);
    sort_into_bins(lattice.bins_per_tile());
    order_bins();
    pack_points(lattice);
    return points_;
}

} // namespace treacle::surface
