#pragma once
#include "../kokkos/points.hpp"
#include "sph/isph_step.hpp"
#include "sph/model/lattice.hpp"

#include <cmath>
#include <map>
#include <memory>

// Scenes made by hand, all of which every rank has.
namespace treacle::sph {

constexpr double spacing = 0.0625;    // d [m]
constexpr double rest_density = 1000; // [kg/m3]

struct LiquidPoint {
    Vec3 x;
    Vec3 u{0, 0, 0};
    double p = 0;
    int liquid = 0;
};
struct SolidPoint {
    Vec3 x;
    int body = 0;
    Vec3 normal{0, 0, 0};
};

// Ids are the places in the lists, spread so that they follow no order in space.
inline std::int64_t id_of(std::size_t index) { return static_cast<std::int64_t>(index * 7919 % 1000003); }

struct Sample {
    IsphSetup setup;
    std::vector<LiquidPoint> liquid;
    std::vector<SolidPoint> solid;
};

struct Sides {
    scene::BoundaryKind kind = scene::BoundaryKind::wall;
    std::array<bool, 3> periodic{false, false, false};
};

inline scene::Domain make_domain(int dimensions, const Vec3& min, const Vec3& max, const Sides& sides = {}) {
    scene::Domain domain;
    domain.dimensions = dimensions;
    domain.min = min;
    domain.max = max;
    domain.spacing = spacing;
    for (std::size_t f = 0; f < 6; ++f) {
        domain.faces[f].kind = sides.periodic[f / 2] ? scene::BoundaryKind::periodic : sides.kind;
    }
    return domain;
}

inline IsphSetup make_setup(const scene::Domain& domain, const SphOptions& options = {}) {
    IsphSetup setup;
    setup.options = options;
    auto& c = setup.constants;
    c.dimensions = domain.dimensions;
    c.spacing = domain.spacing;
    c.support = options.support_ratio * domain.spacing;
    const auto lattice = compute_lattice_sums(options.kernel, domain.dimensions, c.support, domain.spacing);
    c.rest_density = rest_density;
    c.rest_volume = lattice.volume;
    c.mass = rest_density * lattice.volume;
    c.number_density = lattice.number_density;
    c.laplacian_diagonal = lattice.laplacian_diagonal;
    c.wall_laplacian_factor =
        wall_laplacian_factor({options.kernel, c.dimensions, c.support, c.spacing, c.spacing}, options.density);
    setup.domain = make_domain_box(domain, 1.5 * domain.spacing);
    setup.grid = make_cell_grid(domain, c.support);
    setup.forces.gravity = {0, 0, 0};
    setup.forces.friction = {0, 0};
    setup.bodies = 2;
    return setup;
}

struct Block {
    Vec3 corner; // the first particle [m]
    std::array<int, 3> count;
    double step = spacing;
    double jitter = 0; // share of the step
    std::uint64_t seed = 1;
};

inline void add_block(Sample& sample, const Block& block) {
    test::Random random(block.seed);
    for (int k = 0; k < block.count[2]; ++k) {
        for (int j = 0; j < block.count[1]; ++j) {
            for (int i = 0; i < block.count[0]; ++i) {
                LiquidPoint point;
                const int at[3] = {i, j, k};
                for (std::size_t c = 0; c < 3; ++c) {
                    const double noise = block.jitter * (2 * random.unit() - 1);
                    const bool flat = static_cast<int>(c) >= sample.setup.constants.dimensions;
                    point.x[c] = flat ? 0 : block.corner[c] + block.step * (at[c] + noise);
                }
                sample.liquid.push_back(point);
            }
        }
    }
}

// The six sides of a box of lattice points from lo, one layer.
inline void add_shell(Sample& sample, const Vec3& lo, const std::array<int, 3>& count, int body) {
    for (int k = 0; k < count[2]; ++k) {
        for (int j = 0; j < count[1]; ++j) {
            for (int i = 0; i < count[0]; ++i) {
                const int at[3] = {i, j, k};
                bool surface = false;
                SolidPoint point{{}, body};
                for (std::size_t c = 0; c < 3; ++c) {
                    surface = surface || at[c] == 0 || at[c] == count[c] - 1;
                    point.x[c] = lo[c] + spacing * at[c];
                }
                if (surface) sample.solid.push_back(point);
            }
        }
    }
}

// Flow towards a point, fast enough that every particle is predicted to be compressed: u = -rate (x -
// centre).
inline void converge(Sample& sample, const Vec3& centre, double rate) {
    for (auto& point : sample.liquid) {
        for (int c = 0; c < sample.setup.constants.dimensions; ++c) {
            const auto k = static_cast<std::size_t>(c);
            point.u[k] = -rate * (point.x[k] - centre[k]);
        }
    }
}

// Puts this rank's part of the lists, every size-th particle, into empty stores.
inline void put(const Comm& comm, const Sample& sample, LiquidParticles& liquid, SolidParticles& solid) {
    const auto split = [&](std::size_t n) {
        std::vector<std::size_t> mine;
        for (std::size_t k = 0; k < n; ++k) {
            if (static_cast<int>(k) % comm.size() == comm.rank()) mine.push_back(k);
        }
        return mine;
    };
    const auto& domain = sample.setup.domain;
    std::vector<test::Point> points;
    const auto drops = split(sample.liquid.size());
    for (const auto k : drops) {
        test::Point point{id_of(k), {}};
        for (int c = 0; c < 3; ++c) point.x[std::size_t(c)] = domain.wrap(c, sample.liquid[k].x[std::size_t(c)]);
        points.push_back(point);
    }
    test::fill(liquid.store, points);
    test::edit(liquid.velocity(), [&](auto& v) {
        for (std::size_t i = 0; i < drops.size(); ++i) {
            for (std::size_t c = 0; c < 3; ++c) v(i, c) = sample.liquid[drops[i]].u[c];
        }
    });
    test::edit(liquid.pressure(), [&](auto& v) {
        for (std::size_t i = 0; i < drops.size(); ++i) v(i) = sample.liquid[drops[i]].p;
    });
    test::edit(liquid.liquid(), [&](auto& v) {
        for (std::size_t i = 0; i < drops.size(); ++i) v(i) = sample.liquid[drops[i]].liquid;
    });
    points.clear();
    const auto bricks = split(sample.solid.size());
    for (const auto k : bricks) {
        test::Point point{id_of(k), {}};
        for (int c = 0; c < 3; ++c) point.x[std::size_t(c)] = domain.wrap(c, sample.solid[k].x[std::size_t(c)]);
        points.push_back(point);
    }
    test::fill(solid.store, points);
    test::edit(solid.velocity(), [&](auto& v) {
        for (std::size_t i = 0; i < 3 * bricks.size(); ++i) v(i / 3, i % 3) = 0;
    });
    test::edit(solid.normal(), [&](auto& v) {
        for (std::size_t i = 0; i < bricks.size(); ++i) {
            for (std::size_t c = 0; c < 3; ++c) v(i, c) = sample.solid[bricks[i]].normal[c];
        }
    });
    test::edit(solid.volume(), [&](auto& v) {
        for (std::size_t i = 0; i < bricks.size(); ++i) v(i) = 0;
    });
    test::edit(solid.pressure(), [&](auto& v) {
        for (std::size_t i = 0; i < bricks.size(); ++i) v(i) = 0;
    });
    test::edit(solid.body(), [&](auto& v) {
        for (std::size_t i = 0; i < bricks.size(); ++i) v(i) = sample.solid[bricks[i]].body;
    });
}

// The stepper of a sample with its particles, before the first step.
inline std::unique_ptr<IsphStep> started(const Comm& comm, const Sample& sample) {
    auto step = std::make_unique<IsphStep>(comm, sample.setup);
    put(comm, sample, step->liquid(), step->solid());
    step->start();
    return step;
}

// All particles of all ranks by id, with some of their fields.
struct State {
    Vec3 x, u;
    double p = 0;

    bool operator==(const State&) const = default;
};
inline std::map<std::int64_t, State> all_states(const Comm& comm, const LiquidParticles& liquid) {
    std::vector<std::int64_t> ids;
    std::vector<double> values;
    const auto id = test::on_host(liquid.id());
    const auto x = test::on_host(liquid.position()), u = test::on_host(liquid.velocity());
    const auto p = test::on_host(liquid.pressure());
    for (int i = 0; i < liquid.store.owned(); ++i) {
        ids.push_back(id(i));
        for (int k = 0; k < 3; ++k) values.push_back(x(i, k));
        for (int k = 0; k < 3; ++k) values.push_back(u(i, k));
        values.push_back(p(i));
    }
    ids = comm.all_gather(std::span<const std::int64_t>(ids));
    values = comm.all_gather(std::span<const double>(values));
    std::map<std::int64_t, State> out;
    for (std::size_t k = 0; k < ids.size(); ++k) {
        const double* v = &values[7 * k];
        out[ids[k]] = {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, v[6]};
    }
    return out;
}

// One number of every owned particle of all ranks by id.
template <class View>
std::map<std::int64_t, double> by_id(const Comm& comm, const LiquidParticles& liquid, const View& view) {
    std::vector<std::int64_t> ids;
    std::vector<double> values;
    const auto id = test::on_host(liquid.id());
    const auto v = test::on_host(view);
    for (int i = 0; i < liquid.store.owned(); ++i) {
        ids.push_back(id(i));
        values.push_back(double(v(i)));
    }
    ids = comm.all_gather(std::span<const std::int64_t>(ids));
    values = comm.all_gather(std::span<const double>(values));
    std::map<std::int64_t, double> out;
    for (std::size_t k = 0; k < ids.size(); ++k) out[ids[k]] = values[k];
    return out;
}

} // namespace treacle::sph
