#pragma once
#include "grid/geometry/closed_centres.hpp"
#include "grid/geometry/fractions.hpp"
#include "grid/viscosity/viscosity.hpp"
#include "solve/rows/runtime.hpp"

#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

// Liquid, solids and bodies that are given by distances, for the viscous solve alone.
namespace treacle::grid {

using ViscousDistance = std::function<double(const Vec3&)>; // [m], < 0 inside

inline ViscousDistance ball(const Vec3& centre, double radius) {
    return [=](const Vec3& x) { return std::hypot(x[0] - centre[0], x[1] - centre[1], x[2] - centre[2]) - radius; };
}

// A body of given mass, and inertia as that of a ball or disc of a radius.
inline rigid::BodySetup make_body(const Vec3& centre, double mass, double radius) {
    rigid::BodySetup out;
    out.kind = scene::BodyKind::dynamic;
    out.mass = mass;
    out.centre = centre;
    for (std::size_t k = 0; k < 3; ++k) out.inertia[k][k] = 0.4 * mass * radius * radius;
    return out;
}

struct ViscousSample {
    int cells = 16; // along each axis of the unit cube
    int dimensions = 3;
    std::array<bool, 3> periodic{};
    bool walls = false; // of the cube, where it is not periodic
    ViscousDistance liquid = [](const Vec3&) { return -1.0; };
    ViscousDistance solid = [](const Vec3&) { return 1.0; };
    bool solid_slips = false; // and the bodies
    double slip_length = std::numeric_limits<double>::infinity();
    std::vector<ViscousDistance> body; // by number
    rigid::BodiesSetup bodies;
    std::function<double(const Vec3&)> viscosity = [](const Vec3&) { return 1.0; };
    double density = 1000;
    ViscosityOptions options;
    Coupling coupling = Coupling::strong;
};

class ViscousCase {
public:
    ViscousCase(const Comm& comm, const ViscousSample& sample)
        : sample_(sample), grid(make_grid(sample)), decomposition(comm, grid.cells), bodies(sample.bodies),
          viscosity(comm, sample.options, sample.coupling) {
        cut();
        halo.connect(decomposition, grid.cells.all(), 3);
        window_size_ = static_cast<std::size_t>(halo.window().size());
        for (auto& field : velocity.axis) field = Array<double>("velocity", window_size_);
        fill_fractions();
        fill_viscosities();
        if (sample.solid_slips) fill_slip();
    }

    ViscosityReport solve(double dt) { return viscosity.solve(viscous_scene(), velocity, bodies, dt); }

    // Of the viscosity alone, or with the pressures of the same solve.
    ViscousScene viscous_scene(const PressureFaces* pressure_faces = nullptr) {
        return {.grid = grid,
            .halo = halo,
            .fractions = fractions,
            .body_fractions = body_fractions,
            .viscosity = viscosities,
            .density = sample_.density,
            .slip = sample_.solid_slips ? &slip : nullptr,
            .pressure_faces = pressure_faces,
            .no_slip = no_slip};
    }

    void set_velocity(const std::function<double(int, const Vec3&)>& u) {
        each(halo.window(), [&](std::size_t at, const int c[3]) {
            for (int a = 0; a < grid.dimensions; ++a) velocity.axis[a](at) = u(a, face(a, c));
        });
    }
    // The same on any number of ranks.
    void set_noise() {
        set_velocity([&](int a, const Vec3& x) {
            return std::sin(91 * x[0] + 57 * x[1] + 73 * x[2] + 2 * a) + std::cos(33 * x[0] * x[1] + 41 * x[2] + a);
        });
    }
    // Linear and angular momentum about the origin of the liquid [kg m/s, kg m2/s], over all ranks.
    std::array<double, 6> liquid_momentum() const {
        std::array<double, 6> sums{};
        each(halo.owned(), [&](std::size_t at, const int c[3]) {
            for (int a = 0; a < grid.dimensions; ++a) {
                const double m =
                    sample_.density * std::pow(grid.dx, grid.dimensions) * fractions.face_liquid_clipped.axis[a](at);
                const auto x = face(a, c);
                add_load(a, x.data(), m * velocity.axis[a](at), sums.data());
            }
        });
        decomposition.comm().sum(std::span<double>(sums));
        return sums;
    }
    // The sum over all ranks of value(axis, place, position) of owned faces.
    double sum(const std::function<double(int, std::size_t, const Vec3&)>& value) const {
        double total = 0;
        each(halo.owned(), [&](std::size_t at, const int c[3]) {
            for (int a = 0; a < grid.dimensions; ++a) total += value(a, at, face(a, c));
        });
        return decomposition.comm().sum(total);
    }
    double most(const std::function<double(int, std::size_t, const Vec3&)>& value) const {
        double out = 0;
        each(halo.owned(), [&](std::size_t at, const int c[3]) {
            for (int a = 0; a < grid.dimensions; ++a) out = std::max(out, value(a, at, face(a, c)));
        });
        return decomposition.comm().max(out);
    }
    Vec3 face(int a, const int c[3]) const {
        Vec3 x;
        grid.face(a, c, x.data());
        return x;
    }

private:
    const ViscousSample sample_;
    std::size_t window_size_ = 0;

public:
    const MacGrid grid;
    Decomposition decomposition;
    CellHalo halo;
    rigid::RigidBodies bodies;
    Fractions fractions;
    std::array<BodyFractions, 3> body_fractions, all_body_fractions; // of no-slip bodies; with slip, of all
    Viscosities viscosities;
    SlipSolids slip;
    ClosedCentres closed_centres; // of all solids
    DistanceSampler no_slip;      // of the no-slip solids
    FaceField velocity;
    Viscosity viscosity;

private:
    static MacGrid make_grid(const ViscousSample& sample) {
        scene::Domain domain;
        domain.dimensions = sample.dimensions;
        domain.spacing = 1.0 / sample.cells;
        for (std::size_t k = 0; k < 6; ++k) {
            if (sample.periodic[k / 2]) domain.faces[k].kind = scene::BoundaryKind::periodic;
        }
        return make_mac_grid(domain);
    }
    void cut() {
        std::vector<int> cells;
        if (decomposition.comm().is_root()) {
            const auto all = grid.cells.all();
            for (int i = 0; i < all.size(); ++i) {
                int c[3];
                all.cell(i, c);
                cells.insert(cells.end(), c, c + 3);
            }
        }
        const std::vector<double> weights(cells.size() / 3, 1.0);
        decomposition.repartition(cells, weights);
    }
    template <class Use>
    static void each(const CellBox& box, const CellBox& window, const Use& use) {
        for (int i = 0; i < box.size(); ++i) {
            int c[3];
            box.cell(i, c);
            use(static_cast<std::size_t>(window.index(c[0], c[1], c[2])), c);
        }
    }
    template <class Use>
    void each(const CellBox& box, const Use& use) const {
        each(box, halo.window(), use);
    }

    double walls_at(const Vec3& x) const {
        double least = 1;
        for (std::size_t k = 0; sample_.walls && k < static_cast<std::size_t>(sample_.dimensions); ++k) {
            if (!sample_.periodic[k]) least = std::min({least, x[k], 1 - x[k]});
        }
        return least;
    }
    // Nodes of the window take the values of the periodic domain.
    Array<double> at_nodes(const FineNodes& nodes, const ViscousDistance& distance) const {
        Array<double> out("distance", nodes.size());
        for (int i = 0; i < nodes.window.size(); ++i) {
            int c[3];
            nodes.window.cell(i, c);
            for (int corner = 0; corner < nodes.used(); ++corner) {
                Vec3 x;
                nodes.position(c, corner, x.data());
                out(static_cast<std::size_t>(FineNodes::per_cell * i + corner)) = distance(x);
            }
        }
        return out;
    }
    void fill_fractions() {
        const FineNodes nodes(grid, halo.window());
        const auto nearest = [&](const Vec3& x) {
            double least = std::min(sample_.solid(x), walls_at(x)), number = -1;
            for (std::size_t b = 0; b < sample_.body.size(); ++b) {
                if (sample_.body[b](x) >= least) continue;
                least = sample_.body[b](x);
                number = double(b);
            }
            return std::array<double, 2>{least, number};
        };
        const auto solid = at_nodes(nodes, [&](const Vec3& x) { return nearest(x)[0]; });
        const auto numbers = at_nodes(nodes, [&](const Vec3& x) { return nearest(x)[1]; });
        Array<int> number("number", nodes.size()), moves("moves", sample_.body.size());
        for (std::size_t k = 0; k < nodes.size(); ++k) number(k) = static_cast<int>(numbers(k));
        for (std::size_t b = 0; b < sample_.body.size(); ++b) moves(b) = 1;
        no_slip = {nodes, solid};
        closed_centres.find(nodes, solid);
        FractionBuilder builder;
        builder.build(nodes, solid, at_nodes(nodes, sample_.liquid), FractionMethod::consistent, fractions);
        builder.build_body_fractions(nodes, solid, number, moves, body_fractions.data());
    }
    void fill_viscosities() {
        viscosities.cell = Array<double>("viscosity", window_size_);
        for (auto& field : viscosities.edge.axis) field = Array<double>("viscosity", window_size_);
        each(halo.window(), [&](std::size_t at, const int c[3]) {
            Vec3 x;
            grid.centre(c, x.data());
            viscosities.cell(at) = sample_.viscosity(x);
            for (int a = 0; a < 3; ++a) {
                grid.edge(a, c, x.data());
                viscosities.edge.axis[a](at) = sample_.viscosity(x);
            }
        });
    }
    void fill_slip() {
        const FineNodes nodes(grid, halo.window());
        FractionBuilder builder;
        no_slip = {nodes, at_nodes(nodes, [&](const Vec3& x) { return walls_at(x); })};
        builder.build(
            nodes, no_slip.values, at_nodes(nodes, sample_.liquid), FractionMethod::consistent, slip.no_slip_fractions);
        for (int a = 0; a < 3; ++a) {
            for (int k = 0; k < 2; ++k) slip.closed_centre[a][k] = closed_centres.offset(a, k);
        }
        slip.length = Array<double>("length", window_size_);
        Kokkos::deep_copy(slip.length, sample_.slip_length);
        slip.body = Array<int>("body", window_size_);
        slip.distance = Array<double>("distance", window_size_);
        each(halo.window(), [&](std::size_t at, const int c[3]) {
            Vec3 x;
            grid.centre(c, x.data());
            slip.body(at) = -1;
            double least = sample_.solid(x);
            for (std::size_t b = 0; b < sample_.body.size(); ++b) {
                if (sample_.body[b](x) >= least) continue;
                least = sample_.body[b](x);
                slip.body(at) = static_cast<int>(b);
            }
            slip.distance(at) = std::min(least, walls_at(x));
        });
        for (std::size_t a = 0; a < 3; ++a) { // bodies that slip have none
            all_body_fractions[a] = body_fractions[a];
            body_fractions[a].first = Array<int>("first", all_body_fractions[a].first.extent(0));
        }
    }
};

} // namespace treacle::grid
