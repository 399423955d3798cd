#include "app/bench/bench_pressure.hpp"

#include "app/bench/bench_results.hpp"
#include "app/bench/bench_scene.hpp"
#include "app/setup/build_scene.hpp"
#include "base/text/clock.hpp"
#include "io/value.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

namespace treacle::app {

namespace {
constexpr double jitter = 0.2;     // most displacement along each axis, in spacings
constexpr double time_step = 4e-3; // [s]; large, so that hardly a particle under the surface is let go
constexpr int products_per_case = 5;

// The residual and the time since the start of the solve, at every iteration of one.
struct History {
    std::vector<double> squares; // ||r||^2
    std::vector<double> seconds;

    void add(std::span<const double> residual, Clock::time_point start) {
        double sum = 0;
        for (const double r : residual) sum += r * r;
        squares.push_back(sum);
        seconds.push_back(seconds_since(start));
    }
    // ||r|| / ||b||. Collective.
    void sum_over(const Comm& comm, double norm_b) {
        comm.sum(std::span(squares));
        comm.max(std::span(seconds));
        for (double& square : squares) square = std::sqrt(square) / norm_b;
    }
    io::Value values() const {
        auto residuals = io::Value::list({}), times = io::Value::list({});
        for (const double r : squares) residuals.add(r);
        for (const double t : seconds) times.add(t);
        return io::Value::object({{"residuals", residuals}, {"seconds", times}});
    }
};

struct Case {
    std::string preconditioner;
    double residual = 0;
    solve::SolveReport report;
    double seconds = 0; // set-up and iterations, of the slowest rank
    double set_up = 0;  // [s]
    double product = 0; // one WU measured beside it [s]
    History history;
    double work() const { return seconds / product; }
    double set_up_work() const { return set_up / product; }
};

struct Form {
    std::string preconditioner;
    double asymmetry = 0; // |<Bx, y> - <x, By>| / sqrt(<Bx, x> <By, y>)
    bool positive = false;
    double complexity = 1; // stored entries of all levels over those of the matrix
    std::vector<solve::LevelSize> levels;
    History sweeps;
};

// A number in [-1, 1) that depends on the particle and the seed alone.
double noise(std::int64_t id, unsigned seed) {
    std::minstd_rand engine(static_cast<unsigned>(id % 2147483629) * 7919u + seed);
    engine.discard(3);
    return 2 * (double(engine()) - double(engine.min())) / double(engine.max() - engine.min()) - 1;
}

double dot(const Comm& comm, const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return comm.sum(sum);
}

class PressureBench {
public:
    PressureBench(const Comm& comm, const Input& input, sph::IsphStep& step, const PressureBenchRequest& request)
        : comm_(comm), input_(input), step_(step), request_(request) {}

    void shake();
    void measure(solve::Matrix& matrix);
    std::string table() const;
    io::Value values() const;

private:
    void fill_vectors(solve::Matrix& matrix);
    double product_seconds(const solve::Matrix& matrix);
    History sweep(const solve::Matrix& matrix, solve::KrylovSolver& solver);
    Form examine(solve::Matrix& matrix, const std::string& name, solve::KrylovSolver& solver,
        const sph::PressureHierarchy* hierarchy);

    const Comm& comm_;
    const Input& input_;
    sph::IsphStep& step_;
    const PressureBenchRequest& request_;
    std::vector<double> b_, x_, y_, u_, v_;
    std::vector<Case> cases_;
    std::vector<Form> forms_;
    std::int64_t rows_ = 0, entries_ = 0, particles_ = 0;
};

// Puts the particles out of their lattice and gives them the pressure of their depth, by which the step separates
// the surface from the bulk.
void PressureBench::shake() {
    const auto& liquid = step_.liquid();
    const auto& constants = step_.setup().constants;
    auto x = on_host(liquid.position());
    auto p = on_host(liquid.pressure());
    const auto id = on_host(liquid.id());
    const auto& gravity = step_.setup().forces.gravity;
    for (int i = 0; i < liquid.store.owned(); ++i) {
        for (int k = 0; k < constants.dimensions; ++k) {
            x(i, k) += jitter * constants.spacing * noise(id(i), static_cast<unsigned>(k));
        }
        p(i) = constants.rest_density * std::abs(gravity[2]) * std::max(0.0, 1 - x(i, 2));
    }
    Kokkos::deep_copy(liquid.position(), x);
    Kokkos::deep_copy(liquid.pressure(), p);
    step_.start(sph::IsphStep::SolidVolumes::keep);
}

// The right-hand side of the pressure of the depth, and as much noise.
void PressureBench::fill_vectors(solve::Matrix& matrix) {
    const auto& liquid = step_.liquid();
    const auto row = on_host(liquid.row());
    const auto p = on_host(liquid.pressure());
    const auto id = on_host(liquid.id());
    const auto rows = static_cast<std::size_t>(matrix.rows());
    for (auto* vector : {&b_, &x_, &y_, &u_, &v_}) vector->resize(rows);
    for (int i = 0; i < liquid.store.owned(); ++i) {
        if (row(i) < 0) continue;
        const auto r = static_cast<std::size_t>(row(i) - matrix.first_row());
        x_[r] = p(i);
        u_[r] = noise(id(i), 3);
        v_[r] = noise(id(i), 4);
    }
    matrix.multiply(x_, b_);
    const double scale = std::sqrt(dot(comm_, b_, b_) / dot(comm_, u_, u_));
    for (std::size_t r = 0; r < rows; ++r) b_[r] += scale * u_[r];
}

double PressureBench::product_seconds(const solve::Matrix& matrix) {
    std::vector<double> seconds;
    for (int k = 0; k < products_per_case; ++k) {
        comm_.barrier();
        const auto start = Clock::now();
        matrix.multiply(u_, y_);
        seconds.push_back(comm_.max(seconds_since(start)));
    }
    return spread(std::move(seconds)).median;
}

Form PressureBench::examine(solve::Matrix& matrix, const std::string& name, solve::KrylovSolver& solver,
    const sph::PressureHierarchy* hierarchy) {
    Form form;
    form.preconditioner = name;
    solver.set_up(matrix);
    solver.precondition(u_, x_);
    solver.precondition(v_, y_);
    const double uu = dot(comm_, u_, x_), vv = dot(comm_, v_, y_);
    form.positive = uu > 0 && vv > 0;
    form.asymmetry = std::abs(dot(comm_, x_, v_) - dot(comm_, u_, y_)) / std::sqrt(std::abs(uu * vv));
    if (hierarchy != nullptr) {
        form.complexity = hierarchy->multilevel().operator_complexity();
        form.levels = hierarchy->multilevel().sizes();
    }
    return form;
}

// x += M (b - A x) from zero, M as it is set up.
History PressureBench::sweep(const solve::Matrix& matrix, solve::KrylovSolver& solver) {
    History out;
    std::fill(x_.begin(), x_.end(), 0.0);
    std::vector<double> r(b_.size()), z(b_.size());
    const auto start = Clock::now();
    for (int k = 0; k <= request_.sweeps; ++k) {
        matrix.multiply(x_, r);
        for (std::size_t i = 0; i < r.size(); ++i) r[i] = b_[i] - r[i];
        out.add(r, start);
        if (k == request_.sweeps) break;
        solver.precondition(r, z);
        for (std::size_t i = 0; i < r.size(); ++i) x_[i] += z[i];
    }
    out.sum_over(comm_, std::sqrt(dot(comm_, b_, b_)));
    return out;
}

void PressureBench::measure(solve::Matrix& matrix) {
    fill_vectors(matrix);
    rows_ = matrix.global_rows();
    entries_ = comm_.sum(matrix.entries());
    particles_ = comm_.sum(std::int64_t{step_.liquid().store.owned()});
    auto names = request_.preconditioners;
    if (names.empty()) names = {"multilevel", "multilevel_rediscretised", "jacobi"};
    auto residuals = request_.residuals;
    if (residuals.empty()) residuals = {1e-3, 1e-4, 1e-6};
    const auto& setup = step_.setup();
    for (const auto& name : names) {
        auto overrides = request_.overrides;
        overrides.push_back("method.pressure.preconditioner=" + name);
        const auto options = bench_scene(request_.particles, 1, overrides).method;
        const auto hierarchy = make_hierarchy(comm_, options, setup.constants, setup.domain, setup.grid);
        if (hierarchy) hierarchy->refer_to(step_.liquid(), step_.solid());
        solve::KrylovSolver solver(
            comm_, "pressure", krylov_options(options, setup.constants.dimensions, hierarchy.get()));
        forms_.push_back(examine(matrix, name, solver, hierarchy.get()));
        if (request_.sweeps > 0) forms_.back().sweeps = sweep(matrix, solver);
        for (const double residual : residuals) {
            Case one{name, residual, {}, 0, 0, 0, {}};
            matrix.values_changed(); // so that the set-up is paid each time
            std::fill(x_.begin(), x_.end(), 0.0);
            const double before = product_seconds(matrix);
            comm_.barrier();
            const auto start = Clock::now();
            // Stops by the residual alone: the measure is evaluated only.
            const auto listen = [&one, start](std::span<const double> r) {
                one.history.add(r, start);
                return 0.0;
            };
            one.report = solver.solve(matrix, b_, x_, solve::ConvergenceTest::measure(listen, 1, residual));
            one.seconds = comm_.max(seconds_since(start));
            one.history.sum_over(comm_, std::sqrt(dot(comm_, b_, b_)));
            one.set_up = comm_.max(one.report.set_up_seconds);
            one.product = 0.5 * (before + product_seconds(matrix));
            cases_.push_back(std::move(one));
        }
    }
}

std::string PressureBench::table() const {
    char line[200];
    std::string text;
    std::snprintf(line, sizeof line, "%lld liquid particles, %lld unknowns, %.1f entries a row, %d ranks\n\n",
        static_cast<long long>(particles_), static_cast<long long>(rows_),
        double(entries_) / double(std::max<std::int64_t>(1, rows_)), comm_.size());
    text += line;
    text += "preconditioner        residual  iterations  set-up [WU]  work [WU]  one WU [ms]\n";
    for (const auto& one : cases_) {
        std::snprintf(line, sizeof line, "%-20s %9.0e %11d %12.2f %10.1f %12.2f  %s\n", one.preconditioner.c_str(),
            one.residual, one.report.iterations, one.set_up_work(), one.work(), 1e3 * one.product,
            one.report.converged() ? "" : one.report.reason.c_str());
        text += line;
    }
    text += "\n";
    for (const auto& form : forms_) {
        std::snprintf(line, sizeof line, "%-20s asymmetry %.1e, %s, operator complexity %.3f",
            form.preconditioner.c_str(), form.asymmetry, form.positive ? "positive" : "NOT POSITIVE", form.complexity);
        text += line;
        for (std::size_t k = 0; k < form.levels.size(); ++k) {
            const auto& level = form.levels[k];
            text += (k == 0 ? "; rows (ranks) " : ", ") + std::to_string(level.rows) + " (" +
                    std::to_string(level.ranks) + ")";
        }
        text += "\n";
    }
    return text;
}

io::Value PressureBench::values() const {
    auto cases = io::Value::list({});
    for (const auto& one : cases_) {
        cases.add(io::Value::object({{"preconditioner", one.preconditioner}, {"residual", one.residual},
            {"converged", one.report.converged()}, {"iterations", std::int64_t{one.report.iterations}},
            {"set-up [WU]", one.set_up_work()}, {"work [WU]", one.work()}, {"seconds", one.seconds},
            {"set-up [s]", one.set_up}, {"one WU [s]", one.product}, {"history", one.history.values()}}));
    }
    auto forms = io::Value::list({});
    for (const auto& form : forms_) {
        forms.add(io::Value::object({{"preconditioner", form.preconditioner}, {"asymmetry", form.asymmetry},
            {"positive", form.positive}, {"operator complexity", form.complexity}, {"sweeps", form.sweeps.values()}}));
    }
    return io::Value::object(
        {{"bench", "pressure"}, {"ranks", std::int64_t{comm_.size()}}, {"liquid particles", particles_},
            {"rows", rows_}, {"entries", entries_}, {"solves", cases}, {"preconditioners", forms}});
}
} // namespace

ExitCode run_pressure_bench(const Comm& comm, const PressureBenchRequest& request) {
    Input input;
    Geometry geometry;
    comm.guard([&] {
        auto overrides = request.overrides;
        // The step's own solve is of no interest here.
        overrides.push_back("method.pressure.density_error=1e9");
        overrides.push_back("method.pressure.largest_residual=1");
        for (const auto& name : request.preconditioners) { // a wrong word is an error before anything is built
            (void)bench_scene(request.particles, 1, {"method.pressure.preconditioner=" + name});
        }
        input = bench_scene(request.particles, 1, overrides);
        check_supported(input);
        geometry = build_geometry(input);
        validate_geometry(input, geometry, comm);
    });
    auto solver = make_solver(comm, input, reference_speed(input, geometry), geometry);
    fill_solver(input, geometry, *solver);
    PressureBench bench(comm, input, *solver, request);
    bench.shake();
    solver->observe_matrix([&](solve::Matrix& matrix) { bench.measure(matrix); });
    solver->advance(time_step);
    comm.guard_root([&] {
        std::fputs(bench.table().c_str(), stdout);
        if (!request.json.empty()) io::write_json(request.json, bench.values());
    });
    return ExitCode::ok;
}

} // namespace treacle::app
