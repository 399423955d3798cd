#pragma once
#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace treacle {

// Disjoint sets of the numbers 0 to n - 1, each found by its least member.
class DisjointSets {
public:
    explicit DisjointSets(std::size_t n = 0) { reset(n); }
    // Each number in a set of its own.
    void reset(std::size_t n) {
        parent_.resize(n);
        std::iota(parent_.begin(), parent_.end(), std::size_t{0});
    }
    std::size_t size() const { return parent_.size(); }
    std::size_t find(std::size_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void join(std::size_t a, std::size_t b) {
        a = find(a);
        b = find(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }

private:
    std::vector<std::size_t> parent_;
};

} // namespace treacle
