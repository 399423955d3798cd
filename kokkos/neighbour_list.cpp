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

constexpr int batch = 16;

KOKKOS_INLINE_FUNCTION int lowest_bit(unsigned bits) {
#if defined(__CUDA_ARCH__) || defined(__HIP_DEVICE_COMPILE__)
    return __ffs(static_cast<int>(bits)) - 1;
#else
    return __builtin_ctz(bits);
#endif
}

KOKKOS_INLINE_FUNCTION int count_bits(unsigned bits) {
#if defined(__CUDA_ARCH__) || defined(__HIP_DEVICE_COMPILE__)
    return __popc(bits);
#else
    return __builtin_popcount(bits);
#endif
}

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
    // The neighbours among the candidates [start, start + batch), as bits. All of the batch is tried, the last one
    // reading into the padding behind the coordinates; the outcome of a test is as good as random, so that hits are
    // collected as bits, not by branches.
    KOKKOS_INLINE_FUNCTION unsigned hits(double x, double y, double z, int start, int last, int self) const {
        unsigned bits = 0;
        for (int k = 0; k < batch; ++k) bits |= static_cast<unsigned>(close(x, y, z, start + k)) << k;
        if (last - start < batch) bits &= (1u << (last - start)) - 1;
        if (self >= start && self < start + batch) bits &= ~(1u << (self - start));
        return bits;
    }
    KOKKOS_INLINE_FUNCTION int count(int i) const {
        const double x = of(i, 0), y = of(i, 1), z = of(i, 2);
        const int self = same ? i : -1;
        int n = 0;
        surroundings.walk(x, y, z, [&](int first, int last) {
            for (int start = first; start < last; start += batch) n += count_bits(hits(x, y, z, start, last, self));
        });
        return n;
    }
    KOKKOS_INLINE_FUNCTION void fill(int i, int* row) const {
        const double x = of(i, 0), y = of(i, 1), z = of(i, 2);
        const int self = same ? i : -1;
        surroundings.walk(x, y, z, [&](int first, int last) {
            for (int start = first; start < last; start += batch) {
                unsigned bits = hits(x, y, z, start, last, self);
                for (; bits != 0; bits &= bits - 1) *row++ = start + lowest_bit(bits);
            }
        });
    }
};
} // namespace

void NeighbourList::build(const ParticleStore& of, const ParticleStore& among, const CellGrid& grid,
                          const CellList& cells, double radius) {
    const int n = of.owned();
    for (auto& axis : along_) reserve(axis, static_cast<std::size_t>(among.total() + batch));
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
