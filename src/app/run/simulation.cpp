#include "app/run/simulation.hpp"

#include "app/run/grid_simulation.hpp"
#include "app/run/sph_simulation.hpp"

namespace treacle::app {

std::unique_ptr<Simulation> make_simulation(
    const Comm& comm, const Input& input, double reference_speed, const Geometry& geometry) {
    if (input.on_grid()) return std::make_unique<GridSimulation>(comm, input, geometry);
    return std::make_unique<SphSimulation>(comm, input, reference_speed, geometry);
}

} // namespace treacle::app
