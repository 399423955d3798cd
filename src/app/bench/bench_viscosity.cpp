#include "app/bench/bench_viscosity.hpp"

#include "base/text/clock.hpp"
#include "grid/geometry/fractions.hpp"
#include "grid/viscosity/viscosity.hpp"
#include "io/value.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace treacle::app {

namespace {
using grid::Preconditioner;

constexpr double density = 1000, time_step = 0.01, gravity = 9.81;
constexpr int products_per_case = 7;

struct Scene {
    const char* name;
    double viscosity;                // [Pa s]
    double (*liquid)(const Vec3& x); // distance [m]
};
double ball_over_pool(const Vec3& x) {
    return std::min(x[1] - 0.12, std::hypot(x[0] - 0.5, x[1] - 0.55, x[2] - 0.45) - 0.25);
}
double sheet_on_pool(const Vec3& x) {
    return std::min(x[1] - 0.08, std::max({std::fabs(x[0] - 0.5) - 0.04, std::fabs(x[2] - 0.5) - 0.3, x[1] - 0.9}));
}
constexpr std::array<Scene, 3> scenes{
    {{"ball", 1e3, ball_over_pool}, {"ball", 1e5, ball_over_pool}, {"sheet", 1e5, sheet_on_pool}}};

Preconditioner find_preconditioner(const std::string& word) {
    std::string known;
    for (const auto& [name, preconditioner] : grid::preconditioners) {
        if (word == name) return preconditioner;
        known += (known.empty() ? "" : ", ") + name;
    }
    throw InputError({"--preconditioner " + word, "is not known", "it names how the viscous system is solved", known});
}

// A number in [-1, 1) that depends on the place alone.
double noise(int axis, const int c[3]) {
    std::uint64_t x = static_cast<std::uint64_t>(axis + 1) +
                      0x9e3779b97f4a7c15u * static_cast<std::uint64_t>(c[0] + 1000 * (c[1] + 1000 * c[2]) + 7);
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
    x = (x ^ x >> 27) * 0x94d049bb133111ebu;
    return double((x ^ x >> 31) >> 11) * 0x1p-52 - 1;
}

// Cells, halo and volumes of a scene.
struct Setting {
    grid::MacGrid grid;
    Decomposition decomposition;
    CellHalo halo;
    grid::Fractions fractions;
    std::array<grid::BodyFractions, 3> body_fractions;
    grid::Viscosities viscosities;
    grid::FaceField velocity;

    Setting(const Comm& comm, int cells, const Scene& scene) : grid(make_grid(cells)), decomposition(comm, grid.cells) {
        cut(scene);
        halo.connect(decomposition, grid.cells.all(), 3);
        build_fractions(scene);
        const auto window_size = static_cast<std::size_t>(halo.window().size());
        viscosities.cell = Array<double>("treacle::viscosity", window_size);
        for (auto& field : viscosities.edge.axis) field = Array<double>("treacle::viscosity", window_size);
        for (auto& field : velocity.axis) field = Array<double>("treacle::velocity", window_size);
        for (auto& of : body_fractions) of.first = Array<int>("treacle::no_bodies", window_size + 1);
    }
    void set_viscosity(double value) const {
        Kokkos::deep_copy(viscosities.cell, value);
        for (const auto& field : viscosities.edge.axis) Kokkos::deep_copy(field, value);
    }
    void set_velocity() const {
        for (int a = 0; a < 3; ++a) {
            const auto host = Kokkos::create_mirror_view(velocity.axis[a]);
            for (int i = 0; i < halo.window().size(); ++i) {
                int c[3];
                halo.window().cell(i, c);
                host(static_cast<std::size_t>(i)) = noise(a, c) - (a == 1 ? gravity * time_step : 0);
            }
            Kokkos::deep_copy(velocity.axis[a], host);
        }
    }

private:
    static grid::MacGrid make_grid(int cells) {
        scene::Domain domain;
        domain.spacing = 1.0 / cells;
        return grid::make_mac_grid(domain);
    }
    // By the liquid.
    void cut(const Scene& scene) {
        std::vector<int> cells;
        const auto box = decomposition.box();
        for (int i = 0; i < box.size(); ++i) {
            int c[3];
            box.cell(i, c);
            Vec3 x;
            grid.centre(c, x.data());
            if (scene.liquid(x) < 0) cells.insert(cells.end(), c, c + 3);
        }
        decomposition.repartition(cells, std::vector<double>(cells.size() / 3, 1.0));
    }
    void build_fractions(const Scene& scene) {
        const grid::FineNodes nodes(grid, halo.window());
        Array<double> solid("treacle::solid", nodes.size()), liquid("treacle::liquid", nodes.size());
        const auto solid_host = Kokkos::create_mirror_view(solid), liquid_host = Kokkos::create_mirror_view(liquid);
        for (int i = 0; i < nodes.window.size(); ++i) {
            int c[3];
            nodes.window.cell(i, c);
            for (int corner = 0; corner < nodes.used(); ++corner) {
                Vec3 x;
                nodes.position(c, corner, x.data());
                const auto at = static_cast<std::size_t>(grid::FineNodes::per_cell * i + corner);
                solid_host(at) = std::min({x[0], 1 - x[0], x[1], 1 - x[1], x[2], 1 - x[2]});
                liquid_host(at) = scene.liquid(x);
            }
        }
        Kokkos::deep_copy(solid, solid_host);
        Kokkos::deep_copy(liquid, liquid_host);
        grid::FractionBuilder().build(nodes, solid, liquid, grid::FractionMethod::consistent, fractions);
    }
};

struct Figures {
    std::string preconditioner;
    const char* scene;
    int cells;
    double stiffness;
    grid::ViscosityReport report;
    double product = 0, set_up = 0, work = 0; // [s], of the slowest rank; [products]; [products], set-up included
};

double product_seconds(const Comm& comm, const solve::Matrix& matrix) {
    const std::vector<double> x(static_cast<std::size_t>(matrix.rows()), 1.0);
    std::vector<double> y(x.size());
    std::vector<double> seconds;
    for (int k = 0; k < products_per_case; ++k) {
        comm.barrier();
        const auto start = Clock::now();
        matrix.multiply(x, y);
        seconds.push_back(comm.max(seconds_since(start)));
    }
    std::sort(seconds.begin(), seconds.end());
    return seconds[products_per_case / 2];
}

Figures measure(const Comm& comm, Setting& setting, const Scene& scene, double viscosity, const std::string& word,
    const ViscosityBenchRequest& request) {
    grid::ViscosityOptions options;
    options.preconditioner = find_preconditioner(word);
    options.residual = request.residual;
    options.max_iterations = 5000;
    grid::Viscosity solver(comm, options, grid::Coupling::one_way);
    rigid::RigidBodies bodies;
    const double dx = setting.grid.dx;
    Figures out{
        word, scene.name, static_cast<int>(std::lround(1 / dx)), viscosity / density * time_step / (dx * dx), {}};
    setting.set_viscosity(viscosity);
    struct Timed {
        double work, set_up, product; // [products], [products], [s]
    };
    std::vector<Timed> timed;
    for (int k = 0; k < request.repeats; ++k) {
        setting.set_velocity();
        out.report = solver.solve(
            {setting.grid, setting.halo, setting.fractions, setting.body_fractions, setting.viscosities, density},
            setting.velocity, bodies, time_step);
        const auto& solve = out.report.solve;
        const double product = product_seconds(comm, *solver.matrix()); // at once, while the machine is as it was
        timed.push_back({comm.max(solve.set_up_seconds + solve.iteration_seconds) / product,
            comm.max(solve.set_up_seconds) / product, product});
    }
    std::sort(timed.begin(), timed.end(), [](const Timed& a, const Timed& b) { return a.work < b.work; });
    const auto& median = timed[timed.size() / 2];
    out.work = median.work;
    out.set_up = median.set_up;
    out.product = median.product;
    return out;
}

void print(const Figures& f) {
    std::printf("%-20s %-6s %5d %10.2e %10lld %9.1f %10d %11.1f %10.1f %11.2f\n", f.preconditioner.c_str(), f.scene,
        f.cells, f.stiffness, static_cast<long long>(f.report.unknowns),
        double(f.report.entries) / double(f.report.unknowns), f.report.solve.iterations, f.set_up, f.work,
        1e3 * f.product);
    std::fflush(stdout);
}

io::Value values(const std::vector<Figures>& all, int ranks) {
    auto solves = io::Value::list({});
    for (const auto& f : all) {
        solves.add(io::Value::object({{"preconditioner", f.preconditioner}, {"scene", std::string(f.scene)},
            {"cells", std::int64_t{f.cells}}, {"nu dt/dx2", f.stiffness}, {"unknowns", f.report.unknowns},
            {"entries", f.report.entries}, {"iterations", std::int64_t{f.report.solve.iterations}},
            {"set-up [WU]", f.set_up}, {"work [WU]", f.work}, {"one WU [s]", f.product}}));
    }
    return io::Value::object({{"bench", "viscosity"}, {"ranks", std::int64_t{ranks}}, {"solves", solves}});
}
} // namespace

ExitCode run_viscosity_bench(const Comm& comm, const ViscosityBenchRequest& request) {
    auto names = request.preconditioners;
    if (names.empty()) names = {"multilevel", "boomeramg"};
    for (const auto& name : names) (void)find_preconditioner(name);
    const auto sizes = request.cells.empty() ? std::vector<int>{96} : request.cells;
    if (comm.is_root()) {
        std::printf("preconditioner       scene  cells  nu dt/dx2   unknowns   entries iterations set-up [WU]  work "
                    "[WU] one WU [ms]\n");
    }
    std::vector<Figures> all;
    for (const int cells : sizes) {
        for (const auto& scene : scenes) {
            const bool same = &scene == &scenes[1] && !request.stiffness.empty(); // the ball once
            if (same) continue;
            Setting setting(comm, cells, scene);
            std::vector<double> viscosities{scene.viscosity};
            if (!request.stiffness.empty()) viscosities.clear();
            for (const double s : request.stiffness) viscosities.push_back(s * density / (time_step * cells * cells));
            for (const double viscosity : viscosities) {
                for (const auto& name : names) {
                    all.push_back(measure(comm, setting, scene, viscosity, name, request));
                    if (comm.is_root()) print(all.back());
                }
            }
        }
    }
    comm.guard_root([&] {
        if (!request.json.empty()) io::write_json(request.json, values(all, comm.size()));
    });
    return ExitCode::ok;
}

} // namespace treacle::app
