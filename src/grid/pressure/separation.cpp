#include "grid/pressure/separation.hpp"

#include "scene/shapes/vector_math.hpp"

namespace treacle::grid {

namespace {
constexpr double depth = 0.5;        // widths, of the centre of a cell that separates
constexpr double least_slope = 0.05; // cosine between the normal of a wall and gravity from which the wall is one above

struct SeparationLoop {
    PressureFaces faces;
    Array<int> cell_of, closed, separated;
    Array<double> pressure, distance;
    double up[3]; // against gravity, unit length
    double surface;
    bool some_closed;

    // Area of the walls in and around a cell, out of the liquid, along `up` [faces]: what the open parts of its faces lack to close.
    KOKKOS_INLINE_FUNCTION double wall_above(std::size_t cell) const {
        double sum = 0;
        for (int a = 0; a < faces.dimensions; ++a) {
            sum += up[a] * (faces.open(a, cell) - faces.open(a, cell + static_cast<std::size_t>(faces.stride[a])));
        }
        return sum;
    }
    KOKKOS_INLINE_FUNCTION void operator()(int r, int& found) const {
        const auto cell = static_cast<std::size_t>(cell_of(r));
        if (!(pressure(cell) < 0) || (some_closed && closed(r) >= 0) || !(wall_above(cell) > least_slope)) return;
        distance(cell) = surface;
        separated(cell) = 1;
        ++found;
    }
};
} // namespace

bool Separation::find(const Comm& comm, const Scene& scene) {
    const int rows = scene.system.rows();
    reserve(separated_, static_cast<std::size_t>(scene.halo.window().size()));
    if (!any_) Kokkos::deep_copy(separated_, 0);
    SeparationLoop loop{scene.system.faces(), scene.system.cell_of(), {}, separated_, scene.pressure, scene.distance,
        {}, depth * scene.dx, !scene.closed.empty()};
    for (std::size_t a = 0; a < 3; ++a) loop.up[a] = -scene.gravity[a] / scene::length(scene.gravity);
    if (loop.some_closed) {
        reserve(closed_, scene.closed.size());
        const auto host = Kokkos::create_mirror_view(closed_);
        for (std::size_t r = 0; r < scene.closed.size(); ++r) host(r) = scene.closed[r];
        Kokkos::deep_copy(closed_, host);
        loop.closed = closed_;
    }
    int found = 0;
    if (rows > 0) Kokkos::parallel_reduce("treacle::separation", rows, loop, found);
    if (!comm.any(found > 0)) return false;
    any_ = true;
    scene.halo.gather({scene.distance});
    scene.halo.gather({separated_});
    return true;
}

} // namespace treacle::grid
