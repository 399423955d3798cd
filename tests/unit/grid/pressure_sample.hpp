#pragma once
#include "grid/pressure/pressure.hpp"
#include "grid/surface_tension/curvature.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

// Liquid, solids and bodies that are given by distances, for the pressure solve alone.
namespace treacle::grid {

using Distance = std::function<double(const Vec3&)>; // [m], < 0 inside

struct PressureSample {
    int cells = 16; // along each axis, within the unit cube
    int dimensions = 3;
    std::array<bool, 3> periodic{};
    Distance liquid = [](const Vec3&) { return -1.0; };
    Distance solid = [](const Vec3&) { return 1.0; }; // at rest; the sides of the cube are walls anyway
    Distance body = [](const Vec3&) { return 1.0; };  // number 0
    rigid::BodiesSetup bodies;
    double density = 1000;
    double surface_tension = 0;
    double curvature = 0; // of the surface [1/m]; 0: found from the shares of liquid
    PressureOptions options;
    Coupling coupling = Coupling::strong;
};

class PressureCase {
public:
    PressureCase(const Comm& comm, const PressureSample& sample)
        : sample_(sample), grid(make_grid(sample)), decomposition(comm, grid.cells), bodies(sample.bodies),
          pressure(comm, sample.options, sample.coupling, sample.dimensions) {
        cut(comm);
        halo.connect(decomposition, grid.cells.all(), 3);
        const auto window_size = static_cast<std::size_t>(halo.window().size());
        distance = Array<double>("distance", window_size);
        for (int a = 0; a < 3; ++a) {
            velocity.axis[a] = Array<double>("velocity", window_size);
            fractions.open.axis[a] = Array<double>("open", window_size);
            fractions.face_fluid.axis[a] = Array<double>("fluid", window_size);
            auto& of = body_fractions[static_cast<std::size_t>(a)];
            of.first = Array<int>("first", window_size + 1);
            of.body = Array<int>("body", window_size);
            of.fraction = Array<double>("share", window_size);
        }
        each_cell([&](std::size_t at, const int c[3]) { fill(at, c); });
    }

    void build() {
        if (sample_.surface_tension > 0) {
            Array<double> fraction("share", static_cast<std::size_t>(halo.window().size()));
            // As linear weights spread liquid below a plane across an axis.
            each_cell([&](std::size_t at, const int*) {
                const double d = std::clamp(distance(at) / grid.dx, -1.0, 1.0);
                fraction(at) = 0.5 - d + 0.5 * d * std::fabs(d);
            });
            curvature.find(grid, halo, fraction);
            curvature_ = curvature.at_centres();
        }
        if (sample_.curvature > 0) {
            curvature_ = Array<double>("given_curvature", static_cast<std::size_t>(halo.window().size()));
            Kokkos::deep_copy(curvature_, sample_.curvature);
        }
        pressure.build({grid, halo, distance, fractions, body_fractions, bodies, sample_.density,
            sample_.surface_tension, nullptr, nullptr, {}, nullptr, &curvature_});
    }
    PressureReport project(double dt) { return pressure.project(velocity, bodies, dt); }

    // Velocities of faces, with their halo. A face that is closed gets 0.
    void set_velocity(const std::function<double(int, const Vec3&)>& u) {
        each_cell([&](std::size_t at, const int c[3]) {
            for (int a = 0; a < grid.dimensions; ++a) {
                velocity.axis[a](at) = fractions.open.axis[a](at) > 0 ? u(a, face(a, c)) : 0;
            }
        });
    }
    void accelerate(const Vec3& g, double dt) {
        set_velocity([&](int a, const Vec3&) { return g[static_cast<std::size_t>(a)] * dt; });
    }

    // use(place, cell) for all cells of the window, or the owned ones.
    template <class Use>
    void each_cell(const Use& use) const {
        each(halo.window(), use);
    }
    template <class Use>
    void each_owned(const Use& use) const {
        each(halo.owned(), use);
    }

    Vec3 face(int a, const int c[3]) const {
        Vec3 x;
        grid.face(a, c, x.data());
        return x;
    }
    Vec3 centre(const int c[3]) const {
        Vec3 x;
        grid.centre(c, x.data());
        return x;
    }
    bool wet(std::size_t at) const { return distance(at) < 0; }
    std::size_t below(int a, std::size_t at) const {
        return at - static_cast<std::size_t>(pressure.system().faces().stride[a]);
    }
    // The fastest of the faces that pass liquid, over all ranks.
    double max_speed() const {
        double most = 0;
        each_owned([&](std::size_t at, const int*) {
            for (int a = 0; a < grid.dimensions; ++a) {
                if (fractions.open.axis[a](at) >= sample_.options.min_face_area_fraction &&
                    (wet(at) || wet(below(a, at)))) {
                    most = std::max(most, std::fabs(velocity.axis[a](at)));
                }
            }
        });
        return decomposition.comm().max(most);
    }
    // Largest flux out of a cell of the solve, of velocities with their halo [m/s].
    double max_flux() {
        halo.gather({velocity.axis[0], velocity.axis[1], velocity.axis[2]});
        const auto rows = static_cast<std::size_t>(pressure.system().rows());
        Array<double> flux("flux", rows);
        auto faces = pressure.system().faces();
        faces.has_jump = false;
        divergence(faces, pressure.system(), velocity, 1, flux);
        double most = 0;
        for (std::size_t r = 0; r < rows; ++r) most = std::max(most, std::fabs(flux(r)));
        return decomposition.comm().max(most);
    }

private:
    const PressureSample sample_;

public:
    const MacGrid grid;
    Decomposition decomposition;
    CellHalo halo;
    rigid::RigidBodies bodies;
    Array<double> distance;
    Fractions fractions;
    FaceBodyFractions body_fractions;
    FaceField velocity;
    Curvature curvature;
    Array<double> curvature_;
    Pressure pressure;

private:
    static MacGrid make_grid(const PressureSample& sample) {
        scene::Domain domain;
        domain.dimensions = sample.dimensions;
        domain.spacing = 1.0 / sample.cells;
        for (std::size_t k = 0; k < 6; ++k) {
            if (sample.periodic[k / 2]) domain.faces[k].kind = scene::BoundaryKind::periodic;
        }
        return make_mac_grid(domain);
    }
    void cut(const Comm& comm) {
        std::vector<int> cells;
        if (comm.is_root()) {
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
    void each(const CellBox& box, const Use& use) const {
        for (int i = 0; i < box.size(); ++i) {
            int c[3];
            box.cell(i, c);
            use(static_cast<std::size_t>(halo.window().index(c[0], c[1], c[2])), c);
        }
    }
    // Of the walls of the cube.
    double wall(const Vec3& x) const {
        double out = 1;
        for (std::size_t k = 0; k < static_cast<std::size_t>(grid.dimensions); ++k) {
            if (!sample_.periodic[k]) out = std::min({out, x[k], 1 - x[k]});
        }
        return out;
    }
    // Share of a face or a cube outside, linear in the distance of its middle.
    double outside(double d) const { return std::clamp(0.5 + d / grid.dx, 0.0, 1.0); }
    void fill(std::size_t at, const int c[3]) {
        distance(at) = sample_.liquid(centre(c));
        for (int a = 0; a < grid.dimensions; ++a) {
            const auto x = face(a, c);
            // The walls lie along faces.
            const bool beyond = wall(x) < 1e-9 * grid.dx;
            const double body = 1 - outside(sample_.body(x)), rest = beyond ? 1 : 1 - outside(sample_.solid(x));
            const double solid = std::min(1.0, body + rest);
            fractions.open.axis[a](at) = 1 - solid;
            fractions.face_fluid.axis[a](at) = 1 - solid;
            auto& of = body_fractions[static_cast<std::size_t>(a)];
            of.first(at) = static_cast<int>(at);
            of.first(at + 1) = static_cast<int>(at) + 1;
            of.body(at) = 0;
            of.fraction(at) = beyond ? 0 : std::min(body, solid);
        }
    }
};

// A number in [-1, 1] that depends on the place alone.
inline double noise(int axis, const Vec3& x) {
    const double s = std::sin(37.1 * x[0] + 59.3 * x[1] + 83.7 * x[2] + 11.9 * axis) * 43758.5453;
    return 2 * (s - std::floor(s)) - 1;
}

} // namespace treacle::grid
