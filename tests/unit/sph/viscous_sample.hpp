#pragma once
#include "parts.hpp"
#include "sph/viscosity/implicit_viscosity.hpp"

// Blobs of a viscous liquid.
namespace treacle::sph {

constexpr double viscosity = 50; // [Pa s]
// The symmetric ones.
constexpr ViscosityForm every_form[] = {
    ViscosityForm::corrected, ViscosityForm::adjoint, ViscosityForm::pairwise, ViscosityForm::laplacian};

// A disc or ball of the lattice, or one whose particles are out of order, turning about its centre.
struct BlobSetup {
    int dimensions = 2;
    double radius = 8; // [spacings]
    double jitter = 0; // share of the spacing
    ViscosityForm form = ViscosityForm::corrected;
};
inline Sample turning_blob(const BlobSetup& blob) {
    const bool space = blob.dimensions == 3;
    const double size = 2 * (blob.radius + 2) * spacing, middle = size / 2;
    SphOptions options;
    options.support_ratio = 3;
    options.viscosity.form = blob.form;
    options.viscosity.residual = 1e-12;
    const Vec3 far{size, size, space ? size : spacing};
    Sample sample{
        make_setup(make_domain(blob.dimensions, {0, 0, 0}, far, {scene::BoundaryKind::open}), options), {}, {}};
    sample.setup.forces.viscosity = viscosity;
    const int n = static_cast<int>(2 * blob.radius + 4);
    add_block(sample, {{spacing / 2, spacing / 2, spacing / 2}, {n, n, space ? n : 1}, spacing, blob.jitter});
    std::vector<LiquidPoint> inside;
    for (auto point : sample.liquid) {
        const double x = point.x[0] - middle, y = point.x[1] - middle, z = space ? point.x[2] - middle : 0;
        if (x * x + y * y + z * z > blob.radius * blob.radius * spacing * spacing) continue;
        point.u = {-y, x, 0};
        inside.push_back(point);
    }
    sample.liquid = inside;
    return sample;
}

inline ViscousScene viscous_scene(Parts& parts) {
    return {{parts.setup.options, parts.setup.constants, parts.comm, parts.liquid, parts.solid, parts.neighbours,
                parts.halo, parts.liquid_cells},
        parts.setup.forces};
}

// Parts of a step with the implicit viscosity.
struct ViscousCase {
    Parts parts;
    ImplicitViscosity solver;
    Bodies bodies;

    explicit ViscousCase(const Sample& sample)
        : parts(Comm::world(), sample), solver(parts.comm, parts.liquid, sample.setup.options.viscosity,
                                            sample.setup.grid, std::vector<double>(2, 1.0)),
          bodies({}, {}, 0, sample.setup.bodies, sample.setup.domain) {}
    ViscousScene scene() { return viscous_scene(parts); }
    ImplicitViscosity::Result solve(double dt) { return solver.solve(scene(), bodies, dt); }
};

// nu dt / R^2 of a step.
inline double step_of(double number, const BlobSetup& blob) {
    const double radius = blob.radius * spacing;
    return number * radius * radius * rest_density / viscosity;
}

// Two liquids of different density and viscosity in a corner of walls, out of order.
inline Sample two_liquids_on_a_wall(ViscosityForm form) {
    const BlobSetup blob{3, 4, 0.3, form};
    auto sample = turning_blob(blob);
    sample.setup.constants.immiscible =
        make_immiscible_liquids(std::vector<LiquidMaterial>{{rest_density, viscosity}, {300, 1e4 * viscosity}});
    for (auto& point : sample.liquid) point.liquid = point.x[0] > 6 * spacing ? 1 : 0;
    const int n = 8;
    for (int k = 0; k < n * n; ++k) {
        sample.solid.push_back({{spacing * (2 + k % n), spacing * (2 + k / n), 1.5 * spacing}, 1, {0, 0, 1}});
    }
    sample.setup.constants.wall_depth = 0.7 * spacing;
    return sample;
}

// What a ViscousOperator takes, with solids at rest.
struct ViscousTest {
    Parts parts;
    Array<double> friction = upload({1, 1}), motion = upload(std::vector<double>(12, 0.0));
    MomentReferencePoints points{2};

    explicit ViscousTest(const Sample& sample) : parts(Comm::world(), sample) {}
    ViscousContext all() { return {viscous_scene(parts), points, friction, motion}; }
};

// Numbers between -1/2 and 1/2 that follow no order, the same on any number of ranks.
inline void fill_by_id(const LiquidParticles& liquid, int field, int shift) {
    const auto id = on_host(liquid.id());
    test::edit(liquid.store.get<Array3>(field), [&](auto& v) {
        for (int i = 0; i < liquid.store.owned(); ++i) {
            for (int k = 0; k < 3; ++k) v(i, k) = double((id(i) * 31 + k * 17 + shift) % 1009) / 1009 - 0.5;
        }
    });
}

} // namespace treacle::sph
