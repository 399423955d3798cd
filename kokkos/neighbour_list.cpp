#include "kokkos/neighbour_list.hpp"

#include "kokkos/scan.hpp"
#include "kokkos/simd.hpp"

#include <type_traits>

namespace treacle {

namespace {
// Candidates are tested this many at a time; the outcomes of a batch are the bits of one number.
constexpr int batch = 16;
// Particles of one loop index: those of one cell follow one another and share their candidates.
constexpr int chunk = std::is_same_v<Memory, Kokkos::HostSpace> ? 64 : 1;

// The candidates around the particles of a cell: up to 27 cells (9 in 2D), where cells along x that stand one
// behind the other in memory are one run.
struct Runs {
    int first[27], last[27];
    int count = 0;
    int batches = 0;

    KOKKOS_INLINE_FUNCTION void add(int from, int to) {
        if (to <= from) return;
        first[count] = from;
        last[count++] = to;
        batches += (to - from + batch - 1) / batch;
    }
};

struct Search {
    CellGrid grid;
    CellBox window;
    Array<int> begin, end;
    Array3 of;
    Array<double> along_x, along_y, along_z; // of the candidates: contiguous, so that tests go several at a time
    double radius2;
    int n;     // particles whose neighbours are searched
    bool same; // a particle is not its own neighbour

    KOKKOS_INLINE_FUNCTION void find_runs(const int c[3], Runs& runs) const {
        runs.count = 0;
        runs.batches = 0;
        const int x_lo = math::max(c[0] - 1, window.lo[0]), x_hi = math::min(c[0] + 1, window.hi[0] - 1);
        for (int dz = -grid.halo_width(2); dz <= grid.halo_width(2); ++dz) {
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
                        runs.add(first, last);
                        first = b;
                    }
                    last = e;
                }
                runs.add(first, last);
            }
        }
    }

    // visit(i, x, y, z, runs) for the particles of a chunk.
    template <class Visit>
    KOKKOS_INLINE_FUNCTION void each_of(int chunk_index, const Visit& visit) const {
        const int last = math::min(n, (chunk_index + 1) * chunk);
        Runs runs;
        int known[3] = {0, 0, 0};
        for (int i = chunk_index * chunk; i < last; ++i) {
            const double x = of(i, 0), y = of(i, 1), z = of(i, 2);
            int c[3];
            grid.locate(x, y, z, c);
            if (i == chunk_index * chunk || c[0] != known[0] || c[1] != known[1] || c[2] != known[2]) {
                find_runs(c, runs);
                for (int k = 0; k < 3; ++k) known[k] = c[k];
            }
            visit(i, x, y, z, runs);
        }
    }

    KOKKOS_INLINE_FUNCTION std::int64_t count_batches(int chunk_index) const {
        std::int64_t batches = 0;
        each_of(chunk_index, [&](int, double, double, double, const Runs& runs) { batches += runs.batches; });
        return batches;
    }
    // The neighbours among the candidates [start, start + batch), as bits. All of the batch is tested, the last one
    // reading into the padding behind the coordinates; the outcome of a test is as good as random, so that hits are
    // collected as bits, not by branches.
    KOKKOS_INLINE_FUNCTION unsigned hits(
        SimdDouble x, SimdDouble y, SimdDouble z, int start, int last, int self) const {
        unsigned bits = 0;
        for (int k = 0; k < batch; k += lanes) {
            const SimdDouble dx = x - load_lanes(along_x.data() + start + k);
            const SimdDouble dy = y - load_lanes(along_y.data() + start + k);
            const SimdDouble dz = z - load_lanes(along_z.data() + start + k);
            bits |= to_bitmask(dx * dx + dy * dy + dz * dz < SimdDouble(radius2)) << k;
        }
        if (last - start < batch) bits &= (1u << (last - start)) - 1;
        const unsigned own = static_cast<unsigned>(self - start);
        return own < batch ? bits & ~(1u << own) : bits;
    }
    // Tests the candidates of a chunk's particles once; their outcomes stay in `masks` until the rows are laid out.
    KOKKOS_INLINE_FUNCTION void test(int chunk_index, std::uint16_t* mask, const Array<std::int64_t>& count) const {
        each_of(chunk_index, [&](int i, double x, double y, double z, const Runs& runs) {
            const int self = same ? i : -batch;
            int found = 0;
            for (int r = 0; r < runs.count; ++r) {
                for (int start = runs.first[r]; start < runs.last[r]; start += batch) {
                    const unsigned bits = hits(x, y, z, start, runs.last[r], self);
                    *mask++ = static_cast<std::uint16_t>(bits);
                    found += count_bits(bits);
                }
            }
            count(i) = found;
        });
    }
    KOKKOS_INLINE_FUNCTION void fill(
        int chunk_index, const std::uint16_t* mask, const Array<std::int64_t>& offset, const Array<int>& index) const {
        each_of(chunk_index, [&](int i, double, double, double, const Runs& runs) {
            int* row = index.data() + offset(i);
            for (int r = 0; r < runs.count; ++r) {
                for (int start = runs.first[r]; start < runs.last[r]; start += batch) {
                    row += write_set_bits(*mask++, start, row);
                }
            }
        });
    }
};
} // namespace

void NeighbourList::build(
    const ParticleStore& of, const ParticleStore& among, const CellGrid& grid, const CellList& cells, double radius) {
    const int n = of.owned(), total = among.total(), chunks = (n + chunk - 1) / chunk;
    for (auto& axis : along_) reserve(axis, static_cast<std::size_t>(total + batch));
    const Search search{grid, cells.window, cells.begin, cells.end, of.position(), along_[0], along_[1], along_[2],
        radius * radius, n, &of == &among};
    const auto x = among.position();
    Kokkos::parallel_for(
        "treacle::split_positions", total + batch, KOKKOS_LAMBDA(int j) {
            search.along_x(j) = j < total ? x(j, 0) : 0.0;
            search.along_y(j) = j < total ? x(j, 1) : 0.0;
            search.along_z(j) = j < total ? x(j, 2) : 0.0;
        });
    reserve(offset, static_cast<std::size_t>(n) + 1);
    reserve(mask_offset_, static_cast<std::size_t>(chunks) + 1);
    const auto rows = offset, masks_before = mask_offset_;
    Kokkos::parallel_for(
        "treacle::count_batches", chunks, KOKKOS_LAMBDA(int c) { masks_before(c) = search.count_batches(c); });
    reserve(masks_, static_cast<std::size_t>(counts_to_offsets(mask_offset_, chunks)));
    const auto masks = masks_;
    Kokkos::parallel_for(
        "treacle::test_candidates", chunks,
        KOKKOS_LAMBDA(int c) { search.test(c, masks.data() + masks_before(c), rows); });
    size = counts_to_offsets(offset, n);
    reserve(index, static_cast<std::size_t>(size) + padding);
    const auto list = index;
    const auto entries = size;
    Kokkos::parallel_for(
        "treacle::fill_neighbours", chunks,
        KOKKOS_LAMBDA(int c) { search.fill(c, masks.data() + masks_before(c), rows, list); });
    Kokkos::parallel_for(
        "treacle::pad_neighbours", padding, KOKKOS_LAMBDA(int k) { list(entries + k) = 0; });
}

} // namespace treacle
