#include "app/simulation.hpp"

#include "app/sph_simulation.hpp"

namespace treacle::app {

std::unique_ptr<Simulation> make_simulation(const Comm& comm, const Input& input, double reference_speed,
                                            const Geometry& geometry) {
    return std::make_unique<SphSimulation>(comm, input, reference_speed, geometry);
}

} // namespace treacle::app
