#pragma once
// Private to src/scene: points spread evenly over a curved surface.
#include "base/vec3.hpp"

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace treacle::scene {

// Points in the cells of a hashed grid.
class PointGrid {
public:
    PointGrid(double cell, std::size_t expected);
    void add(const Vec3& x);
    const std::vector<Vec3>& points() const { return points_; }
    // Calls visit(index, point) for all points in the 27 cells around x.
    template <class Visit>
    void visit_near(const Vec3& x, Visit&& visit) const {
        const auto c = cell_of(x);
        for (std::int64_t k = -1; k <= 1; ++k)
            for (std::int64_t j = -1; j <= 1; ++j)
                for (std::int64_t i = -1; i <= 1; ++i)
                    for (int p = first({c[0] + i, c[1] + j, c[2] + k}); p >= 0; p = next_[p]) visit(p, points_[p]);
    }
    // Whether a point lies nearer than `radius` <= cell to x.
    bool any_within(const Vec3& x, double radius) const;

private:
    using Cell = std::array<std::int64_t, 3>;
    Cell cell_of(const Vec3& x) const;
    int first(const Cell& cell) const;
    std::size_t slot_of(const Cell& cell) const;
    void grow();

    double cell_;
    std::vector<Vec3> points_;
    std::vector<int> next_;
    std::vector<int> head_;   // open addressing; -1: free
    std::vector<Cell> keys_;
    std::size_t used_ = 0;
};

// Poisson-disk elimination of candidates in a fixed order, then repulsion along the surface.
class EvenLayer {
public:
    using Project = std::function<std::optional<Vec3>(const Vec3&)>; // back onto the surface
    EvenLayer(double spacing, Project project) : spacing_(spacing), project_(std::move(project)) {}

    void choose(const std::vector<Vec3>& candidates);
    void relax();
    // Adds those candidates that are still uncovered.
    void fill(const std::vector<Vec3>& candidates);
    bool covers(const Vec3& x) const;
    void add(const Vec3& x) { grid().add(x); }
    const std::vector<Vec3>& points() const { return grid_->points(); }

private:
    PointGrid& grid() { return *grid_; }
    void rebuild(const std::vector<Vec3>& points, double least);

    double spacing_;
    Project project_;
    std::optional<PointGrid> grid_;
};

// 0 .. n-1 in an order that looks random and is the same everywhere.
std::vector<std::uint32_t> shuffled(std::size_t n);

} // namespace treacle::scene
