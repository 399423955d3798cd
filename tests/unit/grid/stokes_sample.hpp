#pragma once
#include "grid/unified/stokes.hpp"
#include "viscous_sample.hpp"

#include "grid/transport/face_fields.hpp"

// Liquid, solids and bodies that are given by distances, for pressure and viscosity together.
namespace treacle::grid {

struct StokesSample : ViscousSample {
    Vec3 gravity{0, 0, 0};
    double surface_tension = 0;
    PressureOptions pressure;
    StokesOptions stokes{StokesSolve::together, 1e-12, 500};
};

class StokesCase : public ViscousCase {
public:
    StokesCase(const Comm& comm, const StokesSample& given)
        : ViscousCase(comm, given), sample(given),
          pressure(comm, with_residual(given), given.coupling, given.dimensions), stokes(comm, given.stokes) {
        distance = Array<double>("distance", static_cast<std::size_t>(halo.window().size()));
        for (int i = 0; i < halo.window().size(); ++i) {
            int c[3];
            Vec3 x;
            halo.window().cell(i, c);
            grid.centre(c, x.data());
            distance(static_cast<std::size_t>(i)) = sample.liquid(x);
        }
    }

    // Gravity, the projection, and both together.
    StokesReport step(double dt) {
        bodies.begin(dt);
        bodies.fall(dt);
        accelerate(grid, halo.window(), sample.gravity, dt, velocity);
        build(dt);
        project(dt);
        return solve_together(dt);
    }
    // The parts of it.
    void build(double dt) {
        auto& problem = viscosity.problem();
        pressed_ = pressure.describe(scene());
        problem.update_faces(viscous_scene(&pressed_), bodies, dt);
        close_prescribed_faces(problem.viscous_faces(), fractions.open, open);
        auto closed = scene();
        closed.open = &open;
        pressure.build(closed);
    }
    void project(double dt, Pressure::SurfaceTension surface = Pressure::SurfaceTension::include) {
        pressure.project(velocity, bodies, dt, surface);
        gather_faces(grid, halo, velocity);
    }
    StokesReport solve_together(double dt) {
        auto& problem = viscosity.problem();
        const auto viscous = viscous_scene(&pressed_);
        auto report = stokes.solve({pressure, problem, viscous, dt}, velocity, bodies);
        gather_faces(grid, halo, velocity);
        return report;
    }
    // Pressure, viscosity, pressure.
    void split_step(double dt) {
        accelerate(grid, halo.window(), sample.gravity, dt, velocity);
        pressure.build(scene());
        project(dt);
        ViscousCase::solve(dt);
        gather_faces(grid, halo, velocity);
        project(dt, Pressure::SurfaceTension::omit);
    }
    // Linear and angular momentum about the origin of bodies and liquid, with the masses of the solve.
    std::array<double, 6> momentum(double dt) {
        auto total = bodies.momentum();
        std::array<double, 6> sums{};
        const auto& mass = viscosity.problem().viscous_faces().mass;
        each_owned([&](int a, std::size_t at, const Vec3& x) {
            add_load(a, x.data(), mass.axis[a](at) * dt * velocity.axis[a](at), sums.data());
        });
        decomposition.comm().sum(std::span<double>(sums));
        for (std::size_t k = 0; k < 6; ++k) total[k] += sums[k];
        return total;
    }
    // Largest flux out of a cell that has a pressure, of liquid and bodies [m/s].
    double max_flux() {
        std::vector<double> flux(pressure.rows());
        pressure.flux(velocity, flux);
        pressure.coupling().add_flux(body_velocities(bodies), -1, flux);
        double most = 0;
        for (const double value : flux) most = std::max(most, std::fabs(value));
        return decomposition.comm().max(most);
    }
    // The fastest face that the solve is about.
    double max_speed() {
        const auto& role = viscosity.problem().viscous_faces().role;
        double out = 0;
        each_owned([&](int a, std::size_t at, const Vec3&) {
            if (role[a](at) != inactive_face) out = std::max(out, std::fabs(velocity.axis[a](at)));
        });
        return decomposition.comm().max(out);
    }

    const StokesSample sample;
    Pressure pressure;
    Stokes stokes;
    Array<double> distance;
    FaceField open;

private:
    static PressureOptions with_residual(const StokesSample& sample) {
        auto out = sample.pressure;
        out.residual = sample.stokes.residual;
        return out;
    }
    template <class Use>
    void each_owned(const Use& use) const {
        const auto owned = halo.owned();
        for (int i = 0; i < owned.size(); ++i) {
            int c[3];
            owned.cell(i, c);
            for (int a = 0; a < grid.dimensions; ++a)
                use(a, static_cast<std::size_t>(halo.window().index(c[0], c[1], c[2])), face(a, c));
        }
    }
    SlipAreas slip_areas() const {
        if (!sample.solid_slips) return {};
        const Array<double> lengths("lengths", 6 + bodies.size());
        for (std::size_t k = 6; k < lengths.extent(0); ++k) lengths(k) = sample.slip_length;
        return {&closed_centres, lengths};
    }
    PressureContext scene() {
        return {grid, halo, distance, fractions, sample.solid_slips ? all_body_fractions : body_fractions, bodies,
            sample.density, sample.surface_tension, nullptr, nullptr, slip_areas()};
    }

    PressureFaces pressed_;
};

} // namespace treacle::grid
