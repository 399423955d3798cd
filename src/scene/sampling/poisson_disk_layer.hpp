#pragma once
// Private to src/scene: points spread evenly over a curved surface.
#include "base/text/vec3.hpp"

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace treacle::scene {

// Points in the cells of a hashed grid.
class PointGrid {
public:
    using Cell = std::array<std::int64_t, 3>;
    PointGrid(double cell, std::size_t expected);
    void add(const Vec3& x);
    const std::vector<Vec3>& points() const { return points_; }
    // Calls visit(index, point) for all points in the 27 cells around x.
    template <class Visit>
    void visit_near(const Vec3& x, Visit&& visit) const {
        const auto c = cell_of(x);
        for (int n = 0; n < 27; ++n) {
            const Cell cell{c[0] + n % 3 - 1, c[1] + n / 3 % 3 - 1, c[2] + n / 9 - 1};
            for (int p = first(cell); p >= 0; p = next_[p]) visit(p, points_[p]);
        }
    }
    // True when a point lies nearer than `radius` <= cell to x.
    bool any_within(const Vec3& x, double radius) const;

private:
    Cell cell_of(const Vec3& x) const;
    int first(const Cell& cell) const;
    std::size_t slot_of(const Cell& cell) const;
    void grow();

    double cell_;
    std::vector<Vec3> points_;
    std::vector<int> next_;
    std::vector<int> head_; // open addressing; -1: free
    std::vector<Cell> keys_;
    std::size_t used_ = 0;
};

// Poisson-disk elimination of candidates in a fixed order, then repulsion along the surface.
class PoissonDiskLayer {
public:
    // Back onto the surface, to within the tolerance [m]; nothing where that fails.
    using Project = std::function<std::optional<Vec3>(const Vec3&, double tolerance)>;
    PoissonDiskLayer(double spacing, Project project) : spacing_(spacing), project_(std::move(project)) {}

    // Chosen points keep their place where they are fixed ones.
    void choose(const std::vector<Vec3>& candidates, const std::vector<Vec3>& fixed = {});
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
    std::size_t fixed_ = 0; // the first points
    std::optional<PointGrid> grid_;
};

// 0 .. n-1 in a pseudo-random order, the same everywhere.
std::vector<std::uint32_t> shuffled(std::size_t n);

} // namespace treacle::scene
