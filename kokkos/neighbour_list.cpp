#include "kokkos/neighbour_list.hpp"

namespace treacle {

namespace {
// Walks the up to 27 (9 in the plane) cells around a particle. Cells along x that stand one behind the other
// in memory are handed to `visit(first, last)` as one run.
struct Surroundings {
    CellGrid grid;
    CellBox window;
    Array<int> begin, end;

    template <class Visit>
    KOKKOS_INLINE_FUNCTION void walk(double x, double y, double z, const Visit& visit) const {
        int c[3];
        grid.locate(x, y, z, c);
        const int x_lo = math::max(c[0] - 1, window.lo[0]), x_hi = math::min(c[0] + 1, window.hi[0] - 1);
        for (int dz = -grid.reach(2); dz <= grid.reach(2); ++dz) {
            const int cz = c[2] + dz;
            if (cz < window.lo[2] || cz >= window.hi[2]) continue;
            for (int cy = c[1] - 1; cy <= c[1] + 1; ++cy) {
                if (cy < window.lo[1] || cy >= window.hi[1]) continue;
                int first = 0, last = 0;
                for (int cx = x_lo; cx <= x_hi; ++cx) {
                    const int cell = window.index(cx, cy, cz);
                    const int b = begin(cell), e = end(cell);
                    if (b == e) continue;
                    if (b != last) {
                        if (last > first) visit(first, last);
                        first = b;
                    }
                    last = e;
                }
                if (last > first) visit(first, last);
            }
        }
    }
};

struct Search {
    Surroundings surroundings;
    Array3 of;
    Array<double> along_x, along_y, along_z; // of the candidates: contiguous, so that tests go several at a time
    double radius2;
    bool same; // a particle is not its own neighbour

    KOKKOS_INLINE_FUNCTION int close(double x, double y, double z, int j) const {
        const double dx = x - along_x(j), dy = y - along_y(j), dz = z - along_z(j);
        return dx * dx + dy * dy + dz * dz < radius2 ? 1 : 0;
    }
    KOKKOS_INLINE_FUNCTION int count(int i) const {
        const double x = of(i, 0), y = of(i, 1), z = of(i, 2);
        int n = same ? -1 : 0;
        surroundings.walk(x, y, z, [&](int first, int last) {
            for (int j = first; j < last; ++j) n += close(x, y, z, j);
        });
        return n;
    }
    // Candidates are tried in small batches whose hits are collected without a branch: the outcome of the
    // distance test is as good as random.
    KOKKOS_INLINE_FUNCTION void fill(int i, int* row) const {
        constexpr int batch = 32;
        const double x = of(i, 0), y = of(i, 1), z = of(i, 2);
        const int self = same ? i : -1;
        surroundings.walk(x, y, z, [&](int first, int last) {
            int hit[batch], hits[batch + 1];
            for (int start = first; start < last; start += batch) {
                const int size = math::min(batch, last - start);
                for (int k = 0; k < size; ++k) hit[k] = close(x, y, z, start + k);
                if (self >= start && self < start + size) hit[self - start] = 0;
                int n = 0;
                for (int k = 0; k < size; ++k) {
                    hits[n] = start + k;
                    n += hit[k];
                }
                for (int k = 0; k < n; ++k) row[k] = hits[k];
                row += n;
            }
        });
    }
};
} // namespace

void NeighbourList::build(const ParticleStore& of, const ParticleStore& among, const CellGrid& grid,
                          const CellList& cells, double radius) {
    const int n = of.owned();
    for (auto& axis : along_) reserve(axis, static_cast<std::size_t>(among.total()));
    const Search search{{grid, cells.window, cells.begin, cells.end}, of.position(), along_[0], along_[1],
                        along_[2], radius * radius, &of == &among};
    const auto x = among.position();
    Kokkos::parallel_for("treacle::split_positions", among.total(), KOKKOS_LAMBDA(int j) {
        search.along_x(j) = x(j, 0);
        search.along_y(j) = x(j, 1);
        search.along_z(j) = x(j, 2);
    });
    reserve(offset, static_cast<std::size_t>(n) + 1);
    const auto rows = offset;
    std::int64_t total = 0;
    Kokkos::parallel_for("treacle::count_neighbours", n, KOKKOS_LAMBDA(int i) { rows(i) = search.count(i); });
    Kokkos::parallel_scan("treacle::scan_neighbours", n + 1,
        KOKKOS_LAMBDA(int i, std::int64_t& sum, bool last) {
            const std::int64_t count = i < n ? rows(i) : 0;
            if (last) rows(i) = sum;
            sum += count;
        }, total);
    size = total;
    reserve(index, static_cast<std::size_t>(size));
    const auto list = index;
    Kokkos::parallel_for("treacle::fill_neighbours", n, KOKKOS_LAMBDA(int i) {
        search.fill(i, list.data() + rows(i));
    });
}

} // namespace treacle
