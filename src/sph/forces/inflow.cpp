#include "sph/forces/inflow.hpp"

#include "base/losses.hpp"
#include <algorithm>
#include <cmath>

namespace treacle::sph {

namespace {
constexpr int numbers = 9; // of an inlet in `prescribed`
} // namespace

int buffer_layers(const Constants& constants) {
    return static_cast<int>(std::ceil(constants.support / constants.spacing)) + 1;
}

flow::Layers layers_of(const Constants& constants) { return {constants.spacing, buffer_layers(constants)}; }

Inflow::Inflow(
    const flow::InflowSetup& setup, const Constants& constants, const DomainBox& domain, LiquidParticles& liquid)
    : source_(setup, layers_of(constants), domain), domain_(domain), made_(setup.inlets.size(), 0),
      prescribed_("treacle::inlets", numbers * setup.inlets.size()) {
    liquid.add_inlets();
    auto host = Kokkos::create_mirror_view(prescribed_);
    for (std::size_t q = 0; q < setup.inlets.size(); ++q) {
        const auto& inlet = setup.inlets[q];
        for (std::size_t k = 0; k < 3; ++k) {
            host(numbers * q + k) = inlet.speed * inlet.direction[k];
            host(numbers * q + 3 + k) = inlet.centre[k];
            host(numbers * q + 6 + k) = inlet.direction[k];
        }
    }
    Kokkos::deep_copy(prescribed_, host);
}

void Inflow::emit(LiquidParticles& liquid, const Decomposition& decomposition) {
    const flow::InletEmitter::Fields fields{
        liquid.velocity_field(), liquid.liquid_field(), liquid.viscosity_field(), liquid.inlet_field()};
    for (std::size_t q = 0; q < made_.size(); ++q) {
        for (const auto due = layers_until(source_.setup().inlets[q], source_.layers(), time_); made_[q] < due;
             ++made_[q]) {
            source_.add(liquid.store, fields, decomposition.grid(), decomposition.box(), {q, made_[q], time_});
        }
    }
}

void Inflow::prescribe(LiquidParticles& liquid) const {
    const auto inlet = liquid.inlet();
    const auto u = liquid.velocity();
    const auto prescribed = prescribed_;
    Kokkos::parallel_for(
        "treacle::prescribe_inflow", liquid.store.owned(), KOKKOS_LAMBDA(int i) {
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
    for (std::size_t q = 0; q < made_.size(); ++q) {
        sum += made_[q] * static_cast<std::int64_t>(source_.setup().inlets[q].points.size());
    }
    return sum;
}

double Inflow::max_speed() const {
    double most = 0;
    for (const auto& inlet : source_.setup().inlets) most = std::max(most, inlet.speed);
    return most;
}

std::vector<double> Inflow::state() const {
    std::vector<double> out{time_};
    for (const auto layers : made_) out.push_back(double(layers));
    return out;
}

void Inflow::restore(const std::vector<double>& state) {
    time_ = state.at(0);
    for (std::size_t q = 0; q < made_.size(); ++q) made_[q] = static_cast<std::int64_t>(state.at(q + 1));
}

namespace {
struct Drain {
    DomainBox domain;
    flow::Outlets outlets;

    KOKKOS_INLINE_FUNCTION bool lets_go(int side) const {
        return domain.open[side] == static_cast<int>(LossCause::outflow);
    }
    KOKKOS_INLINE_FUNCTION bool beyond_such_a_side(const double x[3]) const {
        bool out = false;
        for (int k = 0; k < domain.dimensions; ++k) {
            if (domain.period[k] > 0) continue;
            out = out || (lets_go(2 * k) && x[k] < domain.lo[k]) || (lets_go(2 * k + 1) && x[k] > domain.hi[k]);
        }
        return out;
    }
    // A position that is not finite is no outflow.
    KOKKOS_INLINE_FUNCTION bool takes(const Array3& positions, int i) const {
        const double x[3] = {positions(i, 0), positions(i, 1), positions(i, 2)};
        const double sum = x[0] + x[1] + x[2];
        if (sum - sum != 0) return false;
        return beyond_such_a_side(x) || outlets.take(x);
    }
};
} // namespace

int remove_outflow(const DomainBox& domain, const flow::Outlets& outlets, LiquidParticles& liquid) {
    const Drain drain{domain, outlets};
    const auto x = liquid.position();
    const int n = liquid.store.owned();
    int gone = 0;
    Kokkos::parallel_reduce(
        "treacle::count_outflow", n, KOKKOS_LAMBDA(int i, int& sum) { sum += static_cast<int>(drain.takes(x, i)); },
        gone);
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

void clear_prescribed(const LiquidParticles& liquid, const Array3& rows) {
    if (!liquid.has_inlets()) return;
    const auto inlet = liquid.inlet();
    Kokkos::parallel_for(
        "treacle::clear_prescribed", liquid.store.owned(), KOKKOS_LAMBDA(int i) {
            for (int k = 0; k < 3; ++k) rows(i, k) = inlet(i) > 0 ? 0 : rows(i, k);
        });
}

} // namespace treacle::sph
