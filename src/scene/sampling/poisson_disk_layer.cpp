#include "scene/sampling/poisson_disk_layer.hpp"

#include "scene/shapes/vector_math.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace treacle::scene {
namespace {

// In spacings. Elimination at 0.71 leaves about 1.13 points per d^2, whose nearest distances repulsion evens
// out to 0.92 in the mean; afterwards nothing is nearer than 0.62, no candidate further away than 0.66.
constexpr double chosen_distance = 0.71;
constexpr double min_distance = 0.62;
constexpr double cover_distance = 0.66;
constexpr double repulsion_range = 1.3;
constexpr double repulsion_strength = 0.7;
constexpr double largest_move = 0.2;
constexpr int sweeps = 14;
constexpr double sweep_tolerance = 0.3; // a single step ends well within it, except in thin parts
constexpr double final_tolerance = 1e-4;

std::uint64_t mix(std::uint64_t x) { // SplitMix64
    x += 0x9E3779B97F4A7C15ull;
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ull;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBull;
    return x ^ (x >> 31);
}

} // namespace

std::vector<std::uint32_t> shuffled(std::size_t n) {
    std::vector<std::uint32_t> order(n);
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [](std::uint32_t a, std::uint32_t b) { return mix(a) < mix(b); });
    return order;
}

PointGrid::PointGrid(double cell, std::size_t expected) : cell_(cell) {
    std::size_t capacity = 64;
    while (capacity < 2 * expected) capacity *= 2;
    head_.assign(capacity, -1);
    keys_.resize(capacity);
    points_.reserve(expected);
    next_.reserve(expected);
}

PointGrid::Cell PointGrid::cell_of(const Vec3& x) const {
    Cell cell;
    for (std::size_t a = 0; a < 3; ++a) cell[a] = static_cast<std::int64_t>(std::floor(x[a] / cell_));
    return cell;
}

std::size_t PointGrid::slot_of(const Cell& cell) const {
    std::uint64_t hash = 0;
    for (const std::int64_t c : cell) hash = (hash ^ static_cast<std::uint64_t>(c)) * 0x9E3779B97F4A7C15ull;
    std::size_t slot = mix(hash) & (head_.size() - 1);
    while (head_[slot] >= 0 && keys_[slot] != cell) slot = (slot + 1) & (head_.size() - 1);
    return slot;
}

int PointGrid::first(const Cell& cell) const { return head_[slot_of(cell)]; }

void PointGrid::add(const Vec3& x) {
    if (2 * (used_ + 1) > head_.size()) grow();
    const Cell cell = cell_of(x);
    const std::size_t slot = slot_of(cell);
    used_ += head_[slot] < 0;
    keys_[slot] = cell;
    next_.push_back(head_[slot]);
    head_[slot] = static_cast<int>(points_.size());
    points_.push_back(x);
}

void PointGrid::grow() {
    const std::vector<Vec3> points = std::move(points_);
    const std::size_t capacity = 2 * head_.size();
    head_.assign(capacity, -1);
    keys_.assign(capacity, Cell{});
    next_.clear();
    points_.clear();
    used_ = 0;
    for (const Vec3& x : points) add(x);
}

bool PointGrid::any_within(const Vec3& x, double radius) const {
    bool found = false;
    visit_near(x, [&](int, const Vec3& p) {
        const Vec3 gap = x - p;
        found = found || dot(gap, gap) < radius * radius;
    });
    return found;
}

void PoissonDiskLayer::rebuild(const std::vector<Vec3>& points, double least) {
    grid_.emplace(repulsion_range * spacing_, points.size());
    for (const Vec3& x : points)
        if (!grid().any_within(x, least * spacing_)) grid().add(x);
}

void PoissonDiskLayer::choose(const std::vector<Vec3>& candidates, const std::vector<Vec3>& fixed) {
    grid_.emplace(repulsion_range * spacing_, candidates.size() / 8);
    const auto take = [&](const std::vector<Vec3>& from) {
        for (const std::uint32_t c : shuffled(from.size()))
            if (!grid().any_within(from[c], chosen_distance * spacing_)) grid().add(from[c]);
    };
    take(fixed);
    fixed_ = points().size();
    take(candidates);
}

void PoissonDiskLayer::relax() {
    const double range = repulsion_range * spacing_;
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        const std::vector<Vec3>& old = points();
        std::vector<Vec3> moved = old;
        for (std::size_t i = fixed_; i < old.size(); ++i) {
            Vec3 push{0, 0, 0};
            grid().visit_near(old[i], [&](int j, const Vec3& p) {
                const Vec3 gap = old[i] - p;
                const double r = length(gap);
                if (j == static_cast<int>(i) || r >= range || r == 0) return;
                const double weight = (1 - r / range) * (1 - r / range);
                push += (weight / r) * gap;
            });
            push = (repulsion_strength * spacing_) * push;
            const double size = length(push), limit = largest_move * spacing_;
            if (size > limit) push = (limit / size) * push;
            const auto there = project_(old[i] + push, sweep_tolerance * spacing_);
            // A point that would jump across a crease or a thin part stays where it is.
            if (there && length(*there - old[i]) < 2 * limit) moved[i] = *there;
        }
        rebuild(moved, 0);
    }
    std::vector<Vec3> last(points().begin(), points().begin() + static_cast<std::ptrdiff_t>(fixed_));
    for (std::size_t i = fixed_; i < points().size(); ++i)
        if (const auto there = project_(points()[i], final_tolerance * spacing_)) last.push_back(*there);
    rebuild(last, min_distance);
}

bool PoissonDiskLayer::covers(const Vec3& x) const { return grid_->any_within(x, cover_distance * spacing_); }

void PoissonDiskLayer::fill(const std::vector<Vec3>& candidates) {
    for (const Vec3& x : candidates)
        if (!covers(x)) add(x);
}

} // namespace treacle::scene
