#include "app/bench/bench.hpp"

#include "app/bench/bench_results.hpp"
#include "app/bench/bench_scene.hpp"
#include "app/run/time_loop.hpp"
#include "app/setup/build_scene.hpp"
#include "base/text/clock.hpp"

#include <algorithm>
#include <cstdio>

namespace treacle::app {

namespace {
constexpr int disorder_steps = 15;
constexpr int products_per_step = 11;

constexpr const char* kind_word(BenchKind kind) {
    switch (kind) {
    case BenchKind::kernels: return "kernels";
    case BenchKind::strong: return "strong";
    case BenchKind::weak: return "weak";
    }
    return "";
}

// The steps of a run, with measurements in the middle of each: the machine may be faster a minute later.
class Measurement {
public:
    Measurement(const Comm& comm, const Input& input, sph::IsphStep& solver)
        : comm_(comm), input_(input), solver_(solver) {}

    void step() { solver_.advance(time_step()); }
    StepSample measured_step();
    std::vector<std::string> phases() const;

private:
    double time_step() const {
        const auto& time = input_.scene.time;
        return time.rule == scene::StepRule::fixed ? time.step : solver_.stable_step(time.cfl);
    }
    double product_seconds(const solve::Matrix& matrix);
    void count(StepSample& sample) const;

    const Comm& comm_;
    const Input& input_;
    sph::IsphStep& solver_;
    Triad triad_;
    std::vector<double> given_, result_;
};

std::vector<std::string> Measurement::phases() const {
    std::vector<std::string> names;
    for (const auto& phase : solver_.timers().phases()) names.push_back(phase.name);
    return names;
}

double Measurement::product_seconds(const solve::Matrix& matrix) {
    const auto rows = static_cast<std::size_t>(matrix.rows());
    given_.assign(rows, 1.0);
    result_.resize(rows);
    std::vector<double> seconds;
    for (int k = 0; k < products_per_step; ++k) {
        comm_.barrier();
        const auto start = Clock::now();
        matrix.multiply(given_, result_);
        seconds.push_back(comm_.max(seconds_since(start)));
    }
    return spread(std::move(seconds)).median;
}

void Measurement::count(StepSample& sample) const {
    const auto& system = solver_.system();
    std::vector<double> sums{double(solver_.liquid().store.owned()), double(system.rows()), double(system.entries()),
        double(solver_.neighbours().liquid.size), double(solver_.neighbours().solid.size)};
    comm_.sum(std::span(sums));
    sample.liquid = sums[0];
    sample.rows = sums[1];
    sample.entries = sums[2];
    sample.liquid_pairs = sums[3];
    sample.solid_pairs = sums[4];
}

StepSample Measurement::measured_step() {
    StepSample sample;
    double aside = 0;
    solver_.observe_matrix([&](const solve::Matrix& matrix) {
        const auto start = Clock::now();
        sample.product = product_seconds(matrix);
        sample.triad = triad_.measure(comm_);
        count(sample);
        aside = seconds_since(start);
    });
    const double dt = time_step();
    solver_.timers().reset();
    solver_.timers().wait_before([this] { comm_.barrier(); });
    comm_.barrier();
    const auto start = Clock::now();
    const auto report = solver_.advance(dt);
    std::vector<double> slowest{seconds_since(start) - aside, report.pressure.set_up_seconds};
    solver_.observe_matrix(nullptr);
    solver_.timers().wait_before(nullptr);
    for (const auto& phase : solver_.timers().phases()) slowest.push_back(phase.seconds);
    comm_.max(std::span(slowest));
    sample.step = slowest[0];
    sample.set_up = slowest[1];
    sample.phases.assign(slowest.begin() + 2, slowest.end());
    sample.iterations = report.pressure.iterations;
    sample.products = double(report.pressure.products);
    sample.imbalance = report.imbalance;
    return sample;
}

struct BenchCase {
    Input input;
    Geometry geometry;
};

BenchCase prepare(const Comm& comm, const BenchRequest& request) {
    BenchCase out;
    comm.guard([&] {
        if (request.scene.empty()) {
            const int sections = request.kind == BenchKind::weak ? comm.size() : 1;
            out.input = bench_scene(request.particles, sections, request.overrides);
        } else if (request.kind == BenchKind::weak) {
            throw InputError({request.scene.string(), "a scene of one size cannot be given to bench weak",
                "its liquid grows with the number of ranks", "leave out --scene, or use bench strong"});
        } else {
            out.input = load_scene({request.scene, request.overrides, {}, {}, {}});
        }
        check_supported(out.input);
        out.geometry = build_geometry(out.input);
        validate_geometry(out.input, out.geometry, comm);
        check_time_step(out.input);
    });
    return out;
}
} // namespace

ExitCode run_bench(const Comm& comm, const BenchRequest& request) {
    const auto [input, geometry] = prepare(comm, request);
    auto solver = make_solver(comm, input, reference_speed(input, geometry), geometry);
    Measurement measurement(comm, input, *solver);
    const double before = peak_memory();
    fill_solver(input, geometry, *solver);

    BenchResults figures;
    figures.kind = kind_word(request.kind);
    figures.ranks = comm.size();
    figures.threads = Execution().concurrency();
    figures.liquid = comm.sum(static_cast<std::int64_t>(solver->liquid().store.owned()));
    figures.solid = comm.sum(static_cast<std::int64_t>(solver->solid().store.owned()));
    figures.disorder_steps = disorder_steps;
    figures.machine = describe_machine();
    for (int k = 0; k < disorder_steps; ++k) measurement.step();
    for (int k = 0; k < request.steps; ++k) figures.steps.push_back(measurement.measured_step());
    figures.phases = measurement.phases();
    figures.peak_bytes = comm.sum(peak_memory() - before);
    figures.counted_bytes = comm.sum(double(solver->bytes()));

    comm.guard_root([&] {
        std::fputs(bench_table(figures).c_str(), stdout);
        const auto values = bench_values(figures);
        if (request.kind != BenchKind::kernels) std::printf("%s\n", one_line(values).c_str());
        if (!request.json.empty()) io::write_json(request.json, values);
    });
    return ExitCode::ok;
}

} // namespace treacle::app
