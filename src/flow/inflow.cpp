#include "flow/inflow.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::flow {

namespace {
// Times and positions closer than this fraction of a spacing count as equal.
constexpr double same_position = 1e-9;
} // namespace

double step_of(const InletSetup& inlet, const Layers& layers) { return inlet.step > 0 ? inlet.step : layers.spacing; }

std::int64_t layers_until(const InletSetup& inlet, const Layers& layers, double time) {
    if (time < inlet.start) return 0;
    const double d = step_of(inlet, layers);
    double count = inlet.speed * (time - inlet.start) / d + layers.buffered;
    if (inlet.end > 0) count = std::min(count, inlet.speed * (inlet.end - inlet.start) / d);
    return static_cast<std::int64_t>(std::floor(count + 0.5 + same_position));
}

std::int64_t particles_until(const InflowSetup& setup, const Layers& layers, double time) {
    std::int64_t sum = 0;
    for (const auto& inlet : setup.inlets) {
        sum += layers_until(inlet, layers, time) * static_cast<std::int64_t>(inlet.points.size());
    }
    return sum;
}

double layer_position(const InletSetup& inlet, const Layers& layers, std::int64_t layer, double time) {
    return inlet.speed * (time - inlet.start) - (double(layer) + 0.5) * step_of(inlet, layers);
}

InletEmitter::InletEmitter(const InflowSetup& setup, Layers layers, const PeriodicBox& box)
    : setup_(setup), layers_(layers), box_(box) {
    for (const auto& inlet : setup.inlets) {
        const Array3 points("treacle::inlet_points", inlet.points.size());
        auto rows = Kokkos::create_mirror_view(points);
        for (std::size_t j = 0; j < inlet.points.size(); ++j) {
            for (std::size_t k = 0; k < 3; ++k) rows(j, k) = inlet.points[j][k];
        }
        Kokkos::deep_copy(points, rows);
        points_.push_back(points);
    }
}

// Id of the first particle of a layer.
std::int64_t InletEmitter::id_of(std::size_t inlet, std::int64_t layer) const {
    const auto count = static_cast<std::int64_t>(setup_.inlets[inlet].points.size());
    return setup_.first_id + layer * count * static_cast<std::int64_t>(setup_.inlets.size()) +
           static_cast<std::int64_t>(inlet);
}

namespace {
// The points of a layer that lie in this rank's cells.
struct LayerPoints {
    Array3 points;
    double middle[3];
    PeriodicBox domain;
    CellGrid grid;
    CellBox own;

    KOKKOS_INLINE_FUNCTION bool locate(int j, double x[3]) const {
        for (int k = 0; k < 3; ++k) x[k] = domain.wrap(k, middle[k] + points(j, k));
        int c[3];
        grid.locate(x[0], x[1], x[2], c);
        return own.contains(c);
    }
};

int count_mine(const LayerPoints& layer) {
    int mine = 0;
    Kokkos::parallel_reduce(
        "treacle::count_inflow", layer.points.extent(0),
        KOKKOS_LAMBDA(int j, int& sum) {
            double x[3];
            sum += static_cast<int>(layer.locate(j, x));
        },
        mine);
    return mine;
}

template <class View>
void clear_rows(const View& view, int first, int n) {
    if constexpr (View::rank == 1) {
        Kokkos::parallel_for(
            "treacle::clear_rows", n, KOKKOS_LAMBDA(int k) { view(first + k) = 0; });
    } else {
        Kokkos::parallel_for(
            "treacle::clear_rows", n, KOKKOS_LAMBDA(int k) {
                for (int c = 0; c < 3; ++c) view(first + k, c) = 0;
            });
    }
}

struct NewParticles {
    Array3 position, velocity;
    Array<std::int64_t> id;
    Array<int> liquid, inlet; // inlet: without rows where there is no such field
    Array<double> viscosity;
    double speed[3], resistance;
    int which, number;
    std::int64_t first_id, stride;
};

void write_layer(const LayerPoints& layer, const NewParticles& to, int first) {
    Kokkos::parallel_scan(
        "treacle::inflow", layer.points.extent(0), KOKKOS_LAMBDA(int j, int& sum, bool last) {
            double x[3];
            const bool mine = layer.locate(j, x);
            if (last && mine) {
                const int i = first + sum;
                for (int k = 0; k < 3; ++k) {
                    to.position(i, k) = x[k];
                    to.velocity(i, k) = to.speed[k];
                }
                to.id(i) = to.first_id + j * to.stride;
                to.liquid(i) = to.which;
                to.viscosity(i) = to.resistance;
                if (to.inlet.extent(0) > 0) to.inlet(i) = to.number;
            }
            sum += static_cast<int>(mine);
        });
}
} // namespace

void InletEmitter::add(
    ParticleStore& store, const Fields& fields, const CellGrid& grid, const CellBox& own, const Layer& layer) const {
    const auto& from = setup_.inlets[layer.inlet];
    LayerPoints layer_points{points_[layer.inlet], {}, box_, grid, own};
    NewParticles to{};
    const double along = layer_position(from, layers_, layer.number, layer.time);
    for (std::size_t k = 0; k < 3; ++k) {
        layer_points.middle[k] = from.centre[k] + along * from.direction[k];
        to.speed[k] = from.speed * from.direction[k];
    }
    const int first = store.owned(), mine = count_mine(layer_points);
    store.resize_owned(first + mine);
    for (const auto& field : store.fields()) {
        if (field.role != FieldRole::state) continue;
        std::visit([&](const auto& view) { clear_rows(view, first, mine); }, field.array);
    }
    to.position = store.position();
    to.velocity = store.get<Array3>(fields.velocity);
    to.id = store.id();
    to.liquid = store.get<Array<int>>(fields.liquid);
    if (fields.inlet >= 0) to.inlet = store.get<Array<int>>(fields.inlet);
    to.viscosity = store.get<Array<double>>(fields.viscosity);
    to.resistance = from.viscosity;
    to.which = from.liquid;
    to.number = static_cast<int>(layer.inlet) + 1;
    to.first_id = id_of(layer.inlet, layer.number);
    to.stride = static_cast<std::int64_t>(setup_.inlets.size());
    write_layer(layer_points, to, first);
}

} // namespace treacle::flow
