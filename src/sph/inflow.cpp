#include "sph/inflow.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::sph {

namespace {
// Times and places closer than this share of a spacing count as equal.
constexpr double same_place = 1e-9;

constexpr int numbers = 9; // of an inlet in `prescribed`
} // namespace

int held_layers(const Constants& constants) {
    return static_cast<int>(std::ceil(constants.support / constants.spacing)) + 1;
}

std::int64_t layers_until(const InletSetup& inlet, const Constants& constants, double time) {
    if (time < inlet.start) return 0;
    const double d = constants.spacing;
    double layers = inlet.speed * (time - inlet.start) / d + held_layers(constants);
    if (inlet.end > 0) layers = std::min(layers, inlet.speed * (inlet.end - inlet.start) / d);
    return static_cast<std::int64_t>(std::floor(layers + 0.5 + same_place));
}

Inflow::Inflow(const InflowSetup& setup, const Constants& constants, const DomainBox& domain,
               LiquidParticles& liquid)
    : setup_(setup), constants_(constants), domain_(domain),
      prescribed_("treacle::inlets", numbers * setup.inlets.size()) {
    liquid.add_inlets();
    auto host = Kokkos::create_mirror_view(prescribed_);
    for (std::size_t q = 0; q < setup.inlets.size(); ++q) {
        const auto& inlet = setup.inlets[q];
        const Array3 points("treacle::inlet_points", inlet.points.size());
        auto rows = Kokkos::create_mirror_view(points);
        for (std::size_t j = 0; j < inlet.points.size(); ++j) {
            for (std::size_t k = 0; k < 3; ++k) rows(j, k) = inlet.points[j][k];
        }
        Kokkos::deep_copy(points, rows);
        for (std::size_t k = 0; k < 3; ++k) {
            host(numbers * q + k) = inlet.speed * inlet.direction[k];
            host(numbers * q + 3 + k) = inlet.centre[k];
            host(numbers * q + 6 + k) = inlet.direction[k];
        }
        openings_.push_back({inlet, points});
    }
    Kokkos::deep_copy(prescribed_, host);
}

// Along the direction, from the opening [m]: layer 0 passes it half a spacing after the start.
double Inflow::place_of(const InletSetup& inlet, std::int64_t layer) const {
    return inlet.speed * (time_ - inlet.start) - (double(layer) + 0.5) * constants_.spacing;
}

// Of the first particle of a layer; the inlets' numbers alternate.
std::int64_t Inflow::id_of(std::size_t inlet, std::int64_t layer) const {
    const auto count = static_cast<std::int64_t>(openings_[inlet].setup.points.size());
    return setup_.first_id + layer * count * static_cast<std::int64_t>(openings_.size()) +
           static_cast<std::int64_t>(inlet);
}

namespace {
// The points of a layer that lie in this rank's cells.
struct LayerPlaces {
    Array3 points;
    double middle[3];
    DomainBox domain;
    CellGrid grid;
    CellBox box;

    KOKKOS_INLINE_FUNCTION bool place(int j, double x[3]) const {
        for (int k = 0; k < 3; ++k) x[k] = domain.wrap(k, middle[k] + points(j, k));
        int c[3];
        grid.locate(x[0], x[1], x[2], c);
        return box.contains(c);
    }
};

int count_mine(const LayerPlaces& layer) {
    int mine = 0;
    Kokkos::parallel_reduce(
        "treacle::count_inflow", layer.points.extent(0),
        KOKKOS_LAMBDA(int j, int& sum) {
            double x[3];
            sum += static_cast<int>(layer.place(j, x));
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
    Array<int> liquid, inlet;
    Array<double> viscosity;
    double speed[3], resistance;
    int which, number;
    std::int64_t first_id, stride;
};

void write_layer(const LayerPlaces& layer, const NewParticles& to, int first) {
    Kokkos::parallel_scan(
        "treacle::inflow", layer.points.extent(0), KOKKOS_LAMBDA(int j, int& sum, bool last) {
            double x[3];
            const bool mine = layer.place(j, x);
            if (last && mine) {
                const int i = first + sum;
                for (int k = 0; k < 3; ++k) {
                    to.position(i, k) = x[k];
                    to.velocity(i, k) = to.speed[k];
                }
                to.id(i) = to.first_id + j * to.stride;
                to.liquid(i) = to.which;
                to.viscosity(i) = to.resistance;
                to.inlet(i) = to.number;
            }
            sum += static_cast<int>(mine);
        });
}
} // namespace

void Inflow::emit(LiquidParticles& liquid, const Decomposition& decomposition) {
    for (std::size_t q = 0; q < openings_.size(); ++q) {
        auto& opening = openings_[q];
        const auto& inlet = opening.setup;
        for (const auto due = layers_until(inlet, constants_, time_); opening.layers < due;
             ++opening.layers) {
            LayerPlaces layer{opening.points, {}, domain_, decomposition.grid(), decomposition.box()};
            const double along = place_of(inlet, opening.layers);
            NewParticles to{};
            for (std::size_t k = 0; k < 3; ++k) {
                layer.middle[k] = inlet.centre[k] + along * inlet.direction[k];
                to.speed[k] = inlet.speed * inlet.direction[k];
            }
            const int first = liquid.store.owned(), mine = count_mine(layer);
            liquid.store.resize_owned(first + mine);
            for (const auto& field : liquid.store.fields()) {
                if (field.role != FieldRole::state) continue;
                std::visit([&](const auto& view) { clear_rows(view, first, mine); }, field.array);
            }
            to.position = liquid.position();
            to.velocity = liquid.velocity();
            to.id = liquid.id();
            to.liquid = liquid.liquid();
            to.inlet = liquid.inlet();
            to.viscosity = liquid.viscosity();
            to.resistance = inlet.viscosity;
            to.which = inlet.liquid;
            to.number = static_cast<int>(q) + 1;
            to.first_id = id_of(q, opening.layers);
            to.stride = static_cast<std::int64_t>(openings_.size());
            write_layer(layer, to, first);
        }
    }
}

void Inflow::hold(LiquidParticles& liquid) const {
    const auto inlet = liquid.inlet();
    const auto u = liquid.velocity();
    const auto prescribed = prescribed_;
    Kokkos::parallel_for(
        "treacle::hold_inflow", liquid.store.owned(), KOKKOS_LAMBDA(int i) {
            if (inlet(i) == 0) return;
            for (int k = 0; k < 3; ++k) u(i, k) = prescribed(numbers * (inlet(i) - 1) + k);
        });
}

void Inflow::close(LiquidParticles& liquid) const {
    const auto inlet = liquid.inlet(), role = liquid.role();
    const auto source = liquid.source(), diagonal = liquid.diagonal(), wall_term = liquid.wall_term();
    Kokkos::parallel_for(
        "treacle::close_inflow", liquid.store.owned(), KOKKOS_LAMBDA(int i) {
            if (inlet(i) == 0) return;
            diagonal(i) -= wall_term(i);
            wall_term(i) = 0;
            source(i) = 0;
            role(i) = diagonal(i) > 0 ? Role::poisson : Role::dirichlet;
        });
}

namespace {
// Held particles that are past their openings.
struct Passage {
    Array<double> prescribed;
    DomainBox domain;

    KOKKOS_INLINE_FUNCTION bool passed(const Array3& x, int i, int inlet) const {
        const double* of = &prescribed(numbers * (inlet - 1));
        double along = 0;
        for (int k = 0; k < 3; ++k) {
            double from = x(i, k) - of[3 + k];
            const double period = domain.period[k];
            if (period > 0) from -= period * math::floor(from / period + 0.5);
            along += from * of[6 + k];
        }
        return along >= 0;
    }
};
} // namespace

void Inflow::pass(LiquidParticles& liquid, double dt) {
    time_ += dt;
    const Passage passage{prescribed_, domain_};
    const auto inlet = liquid.inlet();
    const auto x = liquid.position();
    Kokkos::parallel_for(
        "treacle::pass_inlets", liquid.store.owned(), KOKKOS_LAMBDA(int i) {
            if (inlet(i) > 0 && passage.passed(x, i, inlet(i))) inlet(i) = 0;
        });
}

std::int64_t Inflow::emitted() const {
    std::int64_t sum = 0;
    for (const auto& opening : openings_)
        sum += opening.layers * static_cast<std::int64_t>(opening.setup.points.size());
    return sum;
}

double Inflow::max_speed() const {
    double most = 0;
    for (const auto& opening : openings_) most = std::max(most, opening.setup.speed);
    return most;
}

std::vector<double> Inflow::state() const {
    std::vector<double> out{time_};
    for (const auto& opening : openings_) out.push_back(double(opening.layers));
    return out;
}

void Inflow::restore(const std::vector<double>& state) {
    time_ = state.at(0);
    for (std::size_t q = 0; q < openings_.size(); ++q)
        openings_[q].layers = static_cast<std::int64_t>(state.at(q + 1));
}

namespace {
struct Drain {
    DomainBox domain;
    Array<double> outlets; // [count][7] 1 for a box, then its corners, or a point and the normal
    int count;

    KOKKOS_INLINE_FUNCTION bool beyond_open_side(const double x[3]) const {
        bool out = false;
        for (int k = 0; k < domain.dimensions; ++k) {
            if (domain.period[k] > 0) continue;
            out = out || (domain.open[2 * k] && x[k] < domain.lo[k]) ||
                  (domain.open[2 * k + 1] && x[k] > domain.hi[k]);
        }
        return out;
    }
    KOKKOS_INLINE_FUNCTION bool in_outlet(const double* outlet, const double x[3]) const {
        if (outlet[0] == 0) {
            double along = 0;
            for (int k = 0; k < 3; ++k) along += (x[k] - outlet[1 + k]) * outlet[4 + k];
            return along < 0;
        }
        bool in = true;
        for (int k = 0; k < domain.dimensions; ++k) in = in && x[k] >= outlet[1 + k] && x[k] <= outlet[4 + k];
        return in;
    }
    // A position that is not finite is no outflow.
    KOKKOS_INLINE_FUNCTION bool takes(const Array3& positions, int i) const {
        const double x[3] = {positions(i, 0), positions(i, 1), positions(i, 2)};
        const double sum = x[0] + x[1] + x[2];
        if (sum - sum != 0) return false;
        if (beyond_open_side(x)) return true;
        for (int o = 0; o < count; ++o) {
            if (in_outlet(&outlets(7 * o), x)) return true;
        }
        return false;
    }
};
} // namespace

int remove_outflow(const DomainBox& domain, const Array<double>& outlets, LiquidParticles& liquid) {
    const Drain drain{domain, outlets, static_cast<int>(outlets.extent(0) / 7)};
    const auto x = liquid.position();
    const int n = liquid.store.owned();
    int gone = 0;
    Kokkos::parallel_reduce(
        "treacle::count_outflow", n,
        KOKKOS_LAMBDA(int i, int& sum) { sum += static_cast<int>(drain.takes(x, i)); }, gone);
    if (gone == 0) return 0;
    const auto keep = liquid.component(); // not in use between steps
    Kokkos::parallel_scan(
        "treacle::outflow", n, KOKKOS_LAMBDA(int i, int& sum, bool last) {
            const bool stays = !drain.takes(x, i);
            if (last && stays) keep(sum) = i;
            sum += static_cast<int>(stays);
        });
    liquid.store.permute(keep, n - gone);
    return gone;
}

Array<double> upload_outlets(const std::vector<OutletSetup>& outlets) {
    Array<double> out("treacle::outlets", 7 * outlets.size());
    auto host = Kokkos::create_mirror_view(out);
    for (std::size_t o = 0; o < outlets.size(); ++o) {
        host(7 * o) = outlets[o].box ? 1 : 0;
        for (std::size_t k = 0; k < 3; ++k) {
            host(7 * o + 1 + k) = outlets[o].box ? outlets[o].min[k] : outlets[o].point[k];
            host(7 * o + 4 + k) = outlets[o].box ? outlets[o].max[k] : outlets[o].normal[k];
        }
    }
    Kokkos::deep_copy(out, host);
    return out;
}

void clear_held(const LiquidParticles& liquid, const Array3& rows) {
    if (!liquid.has_inlets()) return;
    const auto inlet = liquid.inlet();
    Kokkos::parallel_for(
        "treacle::clear_held", liquid.store.owned(), KOKKOS_LAMBDA(int i) {
            for (int k = 0; k < 3; ++k) rows(i, k) = inlet(i) > 0 ? 0 : rows(i, k);
        });
}

} // namespace treacle::sph
