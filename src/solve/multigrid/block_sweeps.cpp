#include "solve/multigrid/block_sweeps.hpp"

#include <algorithm>
#include <cstddef>

namespace treacle::solve {

namespace {
// Sums of products with M lines, lane by lane: added up across the lanes once a row of blocks.
template <int M>
struct BlockProducts {
    double sums[M][M] = {};

    void add(const double* block, const double* z) {
        for (int k = 0; k < M; ++k) {
            for (int l = 0; l < M; ++l) sums[k][l] += block[M * k + l] * z[l];
        }
    }
    void subtract_from(double* out) const {
        for (int k = 0; k < M; ++k) {
            double sum = 0;
            for (int l = 0; l < M; ++l) sum += sums[k][l];
            out[k] -= sum;
        }
    }
};

// to += the transpose of the block times z.
template <int M>
void add_transposed(const double* block, const double* z, double* to) {
    double lanes[M];
    for (int l = 0; l < M; ++l) lanes[l] = to[l];
    for (int k = 0; k < M; ++k) {
        for (int l = 0; l < M; ++l) lanes[l] += block[M * k + l] * z[k];
    }
    for (int l = 0; l < M; ++l) to[l] = lanes[l];
}
} // namespace

void BlockSweeps::take(int size, Index rows, const Index* offsets, const Index* columns, const double* values) {
    size_ = size == 6 || size == 3 ? size : 0;
    if (!taken()) return;
    offsets_.assign(1, 0);
    columns_.clear();
    below_.clear();
    own_.clear();
    for (Index row = 0; row < rows; row += size) {
        const Index begin = offsets[row], end = offsets[row + 1], length = end - begin;
        for (Index e = begin; e < end && columns[e] <= row; e += size) {
            auto& store = columns[e] < row ? below_ : own_;
            for (int k = 0; k < size; ++k) {
                const double* const line = values + e + std::ptrdiff_t{length} * k;
                store.insert(store.end(), line, line + size);
            }
            if (columns[e] < row) columns_.push_back(columns[e]);
        }
        offsets_.push_back(static_cast<Index>(columns_.size()));
    }
    above_.resize(static_cast<std::size_t>(rows));
    changes_.resize(static_cast<std::size_t>(rows));
}

template <int M>
void BlockSweeps::down_from_zero_of(const double* inverse, const double* r, double* z, double* t) const {
    const Index blocks = static_cast<Index>(offsets_.size()) - 1;
    const Index* const columns = columns_.data();
    for (Index block = 0; block < blocks; ++block) {
        const Index begin = offsets_[static_cast<std::size_t>(block)],
                    end = offsets_[static_cast<std::size_t>(block) + 1];
        const double* const below = below_.data() + std::ptrdiff_t{M * M} * begin;
        const double* const own = own_.data() + std::ptrdiff_t{M * M} * block;
        const Index row = M * block;
        double sums[M], left[M] = {}, solved[M], reversed[M];
        for (int k = 0; k < M; ++k) sums[k] = r[row + k];
        BlockProducts<M> lanes;
        for (Index e = begin; e < end; ++e) lanes.add(below + M * M * (e - begin), z + columns[e]);
        lanes.subtract_from(sums);
        for (int k = 0; k < M; ++k) {
            solved[k] = sums[k] * inverse[row + k];
            for (int l = k + 1; l < M; ++l) sums[l] -= own[M * l + k] * solved[k];
            for (int l = 0; l < k; ++l) left[l] -= own[M * k + l] * solved[k];
            reversed[k] = -solved[k];
        }
        for (int k = 0; k < M; ++k) {
            z[row + k] = solved[k];
            t[row + k] = left[k];
        }
        for (Index e = begin; e < end; ++e) add_transposed<M>(below + M * M * (e - begin), reversed, t + columns[e]);
    }
}

// `above`: what the values above take, which each row of blocks passes on when it has computed its own; zero before.
template <int M>
void BlockSweeps::up_of(
    const double* inverse, const double* r, double* z, double* above, double* t, double* changes) const {
    const Index* const columns = columns_.data();
    for (Index block = static_cast<Index>(offsets_.size()) - 1; block-- > 0;) {
        const Index begin = offsets_[static_cast<std::size_t>(block)],
                    end = offsets_[static_cast<std::size_t>(block) + 1];
        const double* const below = below_.data() + std::ptrdiff_t{M * M} * begin;
        const double* const own = own_.data() + std::ptrdiff_t{M * M} * block;
        const Index row = M * block;
        double sums[M], now[M], change[M];
        for (int k = 0; k < M; ++k) {
            sums[k] = r[row + k] - above[row + k];
            now[k] = z[row + k];
        }
        BlockProducts<M> lanes;
        for (Index e = begin; e < end; ++e) lanes.add(below + M * M * (e - begin), z + columns[e]);
        lanes.add(own, now);
        lanes.subtract_from(sums);
        for (int k = M; k-- > 0;) {
            change[k] = sums[k] * inverse[row + k];
            now[k] += change[k];
            for (int l = 0; l < M; ++l) sums[l] -= own[M * k + l] * change[k]; // a symmetric block
        }
        for (int k = 0; k < M; ++k) z[row + k] = now[k];
        for (Index e = begin; e < end; ++e) add_transposed<M>(below + M * M * (e - begin), now, above + columns[e]);
        if (!t) continue;
        for (int k = 0; k < M; ++k) {
            t[row + k] = sums[k];
            changes[row + k] = change[k];
        }
    }
}

// t -= L times the changes.
template <int M>
void BlockSweeps::subtract_below(const double* changes, double* t) const {
    const Index blocks = static_cast<Index>(offsets_.size()) - 1;
    const Index* const columns = columns_.data();
    for (Index block = 0; block < blocks; ++block) {
        BlockProducts<M> lanes;
        const Index begin = offsets_[static_cast<std::size_t>(block)],
                    end = offsets_[static_cast<std::size_t>(block) + 1];
        const double* const below = below_.data() + std::ptrdiff_t{M * M} * begin;
        for (Index e = begin; e < end; ++e) lanes.add(below + M * M * (e - begin), changes + columns[e]);
        lanes.subtract_from(t + M * block);
    }
}

void BlockSweeps::down_from_zero(
    std::span<const double> inverse, std::span<const double> r, std::span<double> z, std::span<double> t) const {
    if (size_ == 6)
        down_from_zero_of<6>(inverse.data(), r.data(), z.data(), t.data());
    else
        down_from_zero_of<3>(inverse.data(), r.data(), z.data(), t.data());
}

void BlockSweeps::up(std::span<const double> inverse, std::span<const double> r, std::span<double> z) {
    std::fill(above_.begin(), above_.end(), 0.0);
    if (size_ == 6)
        up_of<6>(inverse.data(), r.data(), z.data(), above_.data(), nullptr, nullptr);
    else
        up_of<3>(inverse.data(), r.data(), z.data(), above_.data(), nullptr, nullptr);
}

void BlockSweeps::up(
    std::span<const double> inverse, std::span<const double> r, std::span<double> z, std::span<double> t) {
    std::fill(above_.begin(), above_.end(), 0.0);
    if (size_ == 6) {
        up_of<6>(inverse.data(), r.data(), z.data(), above_.data(), t.data(), changes_.data());
        subtract_below<6>(changes_.data(), t.data());
    } else {
        up_of<3>(inverse.data(), r.data(), z.data(), above_.data(), t.data(), changes_.data());
        subtract_below<3>(changes_.data(), t.data());
    }
}

std::size_t BlockSweeps::bytes() const {
    return sizeof(Index) * (offsets_.capacity() + columns_.capacity()) +
           sizeof(double) * (below_.capacity() + own_.capacity() + above_.capacity() + changes_.capacity());
}

} // namespace treacle::solve
