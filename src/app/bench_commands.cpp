#include "app/subcommands.hpp"

#include "app/bench/bench.hpp"
#include "app/bench/bench_pressure.hpp"
#include "app/bench/bench_viscosity.hpp"

#include <memory>

namespace treacle::app {

namespace {
struct BenchWords {
    std::string kind, scene;
    BenchRequest request;
    PressureBenchRequest pressure;
    ViscosityBenchRequest viscosity;
};

void add_dam_break(CLI::App& app, BenchWords& words) {
    auto* particles = app.add_option(
        "--particles", words.request.particles, "About; of a dam break (default 300000); weak: per rank");
    particles->check(CLI::Range(std::int64_t{1000}, std::int64_t{4'000'000'000}))->type_name("NUMBER");
    app.add_option("--steps", words.request.steps, "Measured steps (default 8)")
        ->check(CLI::Range(1, 100000))
        ->type_name("NUMBER");
    app.add_option("--scene", words.scene, "A scene of your own in place of the dam break")
        ->excludes(particles)
        ->type_name("SCENE");
}

void add_solves(CLI::App& app, BenchWords& words) {
    add_repeated(app, "--preconditioner", words.pressure.preconditioners,
        "One or several; pressure: default multilevel, multilevel_rediscretised, jacobi; viscosity: multilevel, "
        "boomeramg.");
    app.add_option("--residual", words.pressure.residuals,
           "Relative; pressure: one or several, default 1e-3 1e-4 1e-6; viscosity: the first, default 1e-8")
        ->check(CLI::Range(1e-14, 1.0))
        ->type_name("NUMBER");
    app.add_option(
           "--sweeps", words.pressure.sweeps, "pressure: also the preconditioner by itself, x += M r, that many times")
        ->check(CLI::Range(1, 10000))
        ->type_name("NUMBER");
    app.add_option(
           "--cells", words.viscosity.cells, "viscosity: along each side of the cube, one or several; default 96")
        ->check(CLI::Range(8, 1000))
        ->type_name("NUMBER");
    app.add_option(
           "--repeats", words.viscosity.repeats, "viscosity: solves of each case, whose median counts; default 1")
        ->check(CLI::Range(1, 1000))
        ->type_name("NUMBER");
    app.add_option("--stiffness", words.viscosity.stiffness,
           "viscosity: nu dt/dx2, one or several, in place of 1e3 and 1e5 Pa s with dt 0.01 s")
        ->check(CLI::PositiveNumber)
        ->type_name("NUMBER");
}

BenchKind scene_bench_kind(const std::string& word) {
    if (word == "weak") return BenchKind::weak;
    return word == "strong" ? BenchKind::strong : BenchKind::kernels;
}

ExitCode run(const Comm& comm, const BenchWords& words) {
    auto request = words.request;
    if (words.kind == "pressure") {
        auto pressure = words.pressure;
        pressure.particles = request.particles;
        pressure.overrides = request.overrides;
        pressure.json = request.json;
        return run_pressure_bench(comm, pressure);
    }
    if (words.kind == "viscosity") {
        auto viscosity = words.viscosity;
        viscosity.preconditioners = words.pressure.preconditioners;
        if (!words.pressure.residuals.empty()) viscosity.residual = words.pressure.residuals.front();
        viscosity.json = request.json;
        return run_viscosity_bench(comm, viscosity);
    }
    request.kind = scene_bench_kind(words.kind);
    if (!words.scene.empty()) request.scene = find_scene(comm, words.scene);
    return run_bench(comm, request);
}
} // namespace

void add_bench(CLI::App& program, Chosen& chosen) {
    auto words = std::make_shared<BenchWords>();
    auto& app = *program.add_subcommand("bench", "What a step costs on this machine, under mpirun on all ranks.");
    app.add_option("kind", words->kind,
           "kernels: each phase against a product with the pressure matrix; strong or weak: the same, for "
           "comparing numbers of ranks, with JSON in the last line; pressure: iterations and work of the "
           "pressure solve by preconditioner and residual; viscosity: of the viscous solve of method: grid")
        ->required()
        ->check(CLI::IsMember({"kernels", "strong", "weak", "pressure", "viscosity"}))
        ->type_name("KIND");
    add_dam_break(app, *words);
    add_solves(app, *words);
    add_repeated(app, "--set", words->request.overrides, "Override a key of the scene: a.b.c=value.");
    app.add_option("--json", words->request.json, "Write the figures into this file")->type_name("FILE");
    add_petsc(app, chosen);
    app.callback([words, &chosen] {
        chosen.make = [words]() -> Command { return [words](const Comm& comm) { return run(comm, *words); }; };
    });
}

} // namespace treacle::app
