#include "search/population/swarm.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::search {

namespace {
constexpr double constriction = 0.72984, attraction = 2.05; // Clerc & Kennedy 2002
constexpr double rebound = -0.5;                            // of a velocity beyond a bound
} // namespace

Swarm::Swarm(std::vector<Axis> axes, SwarmOptions options)
    : Search(std::move(axes), options.limits), options_(options), random_(options.seed) {
    if (options_.particles == 0)
        options_.particles = 10 + static_cast<std::size_t>(2 * std::sqrt(double(dimensions())));
}

Task<void> Swarm::method() {
    begin();
    for (std::uint32_t generation = 0;; ++generation) {
        std::vector<Point> points;
        for (const Particle& particle : particles_) points.push_back(particle.x);
        const std::vector<Value> values = co_await evaluate(points);
        for (std::size_t k = 0; k < particles_.size(); ++k) {
            Particle& particle = particles_[k];
            if (!values[k].is_measured() || !(values[k] < particle.best_value)) continue;
            particle.best = particle.x;
            particle.best_value = values[k];
        }
        if (has_converged()) co_return;
        move(generation);
    }
}

// The first particle is at the start; half the way to another random place is the first velocity.
void Swarm::begin() {
    particles_.resize(options_.particles);
    for (std::uint32_t k = 0; k < particles_.size(); ++k) {
        Point x = start(), other = start();
        for (std::uint32_t i = 0; i < x.size(); ++i) {
            const double step = axes()[i].step;
            if (k > 0) x[i] += 2 * step * (2 * random_.uniform(Purpose::swarm_start, 0, k, i) - 1);
            other[i] += 2 * step * (2 * random_.uniform(Purpose::swarm_start, 1, k, i) - 1);
        }
        Particle& particle = particles_[k];
        particle.x = particle.best = clamped(x);
        other = clamped(other);
        for (std::size_t i = 0; i < x.size(); ++i) particle.velocity.push_back(0.5 * (other[i] - particle.x[i]));
    }
}

std::size_t Swarm::leader(std::size_t k) const {
    const std::size_t count = particles_.size();
    std::size_t out = k;
    for (const std::size_t j : {(k + count - 1) % count, (k + 1) % count})
        if (particles_[j].best_value < particles_[out].best_value) out = j;
    return out;
}

void Swarm::move(std::uint32_t generation) {
    std::vector<std::size_t> leaders;
    for (std::size_t k = 0; k < particles_.size(); ++k) leaders.push_back(leader(k));
    for (std::uint32_t k = 0; k < particles_.size(); ++k) {
        Particle& particle = particles_[k];
        const Point& drawn = particles_[leaders[k]].best;
        for (std::uint32_t i = 0; i < dimensions(); ++i) {
            const double own = attraction * random_.uniform(Purpose::swarm_own, generation, k, i);
            const double others = attraction * random_.uniform(Purpose::swarm_best, generation, k, i);
            double& v = particle.velocity[i];
            v = constriction * (v + own * (particle.best[i] - particle.x[i]) + others * (drawn[i] - particle.x[i]));
            const double wanted = particle.x[i] + v;
            particle.x[i] = std::clamp(wanted, axes()[i].lower, axes()[i].upper);
            if (particle.x[i] != wanted) v *= rebound;
        }
    }
}

double Swarm::cut(std::size_t k) const {
    return k < particles_.size() && particles_[k].best_value.is_measured() ? particles_[k].best_value.value()
                                                                           : std::numeric_limits<double>::infinity();
}

Point Swarm::spread() const {
    Point out(dimensions());
    for (std::size_t i = 0; i < out.size(); ++i) {
        if (particles_.empty()) out[i] = axes()[i].step;
        for (const Particle& particle : particles_)
            out[i] += std::pow(particle.best[i] - centre()[i], 2) / double(particles_.size());
        if (!particles_.empty()) out[i] = std::sqrt(out[i]);
    }
    return out;
}

bool Swarm::has_converged() {
    std::vector<Value> values;
    for (const Particle& particle : particles_) values.push_back(particle.best_value);
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    if (least->is_failed()) {
        end(StopKind::failed, "failures", "no particle of the first generation had a value");
        return true;
    }
    const Point size = spread();
    bool small = true;
    for (std::size_t i = 0; i < size.size(); ++i) small = small && size[i] <= axes()[i].smallest();
    if (small) {
        end(StopKind::converged, "tolx", "the particles' best places are within the tolerance on every axis");
    } else if (most->is_measured() && most->value() - least->value() <= options_.value_tolerance) {
        end(StopKind::converged, "tolfun", "the particles' best values differ by less than the tolerance");
    }
    return stopped().has_value();
}

} // namespace treacle::search
