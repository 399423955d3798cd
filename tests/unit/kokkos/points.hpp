#pragma once
#include "kokkos/particle_store.hpp"

#include <algorithm>
#include <array>
#include <random>
#include <tuple>
#include <vector>

namespace treacle::test {

// Particles as plain values, for tests that have all of them.
struct Point {
    std::int64_t id;
    std::array<double, 3> x; // [m]

    bool operator==(const Point&) const = default;
    auto operator<=>(const Point&) const = default;
};

class Random {
public:
    explicit Random(std::uint64_t seed) : engine_(seed) {}
    // In [0, 1), a multiple of 2^-20: sums of such numbers with whole periods are exact.
    double unit() { return static_cast<double>(engine_() >> 44) * 0x1p-20; }
    int below(int n) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(n)); }
    template <class T>
    void shuffle(std::vector<T>& values) {
        std::shuffle(values.begin(), values.end(), engine_);
    }

private:
    std::mt19937_64 engine_;
};

// A grid of cells of 1/8 m from the origin, without periodic axes.
inline CellGrid make_grid(int dimensions, std::array<int, 3> count) {
    CellGrid grid;
    grid.dimensions = dimensions;
    for (int k = 0; k < 3; ++k) {
        grid.count[k] = count[static_cast<std::size_t>(k)];
        grid.inverse_width[k] = 8;
    }
    if (dimensions == 2) grid.origin[2] = -0.0625;
    return grid;
}

// Points anywhere in the grid; the plane's have z = 0. Ids are not in the order of the points.
inline std::vector<Point> random_points(const CellGrid& grid, int n, std::uint64_t seed) {
    Random random(seed);
    std::vector<Point> points(static_cast<std::size_t>(n));
    std::int64_t id = 7;
    for (auto& point : points) {
        point.id = id;
        id += 1 + random.below(1000);
        for (int k = 0; k < 3; ++k) {
            point.x[static_cast<std::size_t>(k)] = k < grid.dimensions ? random.unit() * grid.count[k] / 8 : 0.0;
        }
    }
    random.shuffle(points);
    return points;
}

using treacle::on_host;

// Changes rows of a field through set(host copy).
template <class View, class Set>
void edit(const View& view, const Set& set) {
    auto host = on_host(view);
    set(host);
    Kokkos::deep_copy(view, host);
}

inline void fill(ParticleStore& store, const std::vector<Point>& points) {
    store.resize_owned(static_cast<int>(points.size()));
    edit(store.position(), [&](auto& x) {
        for (std::size_t i = 0; i < points.size(); ++i) {
            for (std::size_t k = 0; k < 3; ++k) x(i, k) = points[i].x[k];
        }
    });
    edit(store.id(), [&](auto& id) {
        for (std::size_t i = 0; i < points.size(); ++i) id(i) = points[i].id;
    });
}

// Rows [first, last) of a store.
inline std::vector<Point> read(const ParticleStore& store, int first, int last) {
    const auto x = on_host(store.position());
    const auto id = on_host(store.id());
    std::vector<Point> points;
    for (int i = first; i < last; ++i) points.push_back({id(i), {x(i, 0), x(i, 1), x(i, 2)}});
    return points;
}

inline std::array<int, 3> cell_of(const CellGrid& grid, const Point& point) {
    std::array<int, 3> c;
    grid.locate(point.x[0], point.x[1], point.x[2], c.data());
    return c;
}

// Cells in the order in which they stand in memory, then ids.
inline bool before(const CellGrid& grid, const Point& a, const Point& b) {
    const auto p = cell_of(grid, a), q = cell_of(grid, b);
    return std::tuple(p[2], p[1], p[0], a.id) < std::tuple(q[2], q[1], q[0], b.id);
}

} // namespace treacle::test
