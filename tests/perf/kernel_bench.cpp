// One kernel at a time, on one rank, over the particles of a dam break in motion. The argument of each
// benchmark is the number of particles in thousands.
#include "app/bench/bench_scene.hpp"
#include "app/setup/build_scene.hpp"
#include "kokkos/runtime.hpp"
#include "solve/rows/runtime.hpp"
#include "sph/forces/density.hpp"

#include <benchmark/benchmark.h>

#include <map>
#include <memory>

namespace {
using namespace treacle;

// A step's state, with lists, ghosts and matrix as the step left them.
struct Flow {
    app::Input input;
    std::unique_ptr<sph::IsphStep> solver;
    Halo halo;
    CellList cells;
    CellSort sort;

    explicit Flow(std::int64_t particles) : input(app::bench_scene(particles, 1)) {
        const auto geometry = app::build_geometry(input);
        solver = app::make_solver(Comm::self(), input, app::reference_speed(input, geometry), geometry);
        app::fill_solver(input, geometry, *solver);
        constexpr int disorder_steps = 15;
        for (int k = 0; k < disorder_steps; ++k) solver->advance(solver->stable_step(input.scene.time.cfl));
        solver->refresh();
        halo.connect(solver->decomposition());
        auto& store = solver->liquid().store;
        sort.sort(store, solver->setup().grid, occupied_cells(store, solver->setup().grid), cells);
        halo.rebuild(store, cells);
    }
    double particles() const { return double(solver->liquid().store.owned()); }
};

std::map<std::int64_t, std::unique_ptr<Flow>> flows;

Flow& flow(const benchmark::State& state) {
    auto& entry = flows[state.range(0)];
    if (!entry) entry = std::make_unique<Flow>(1000 * state.range(0));
    return *entry;
}

void tell(benchmark::State& state, double items) {
    state.SetItemsProcessed(static_cast<std::int64_t>(double(state.iterations()) * items));
}

void neighbour_search(benchmark::State& state) {
    auto& at = flow(state);
    NeighbourList list;
    const auto& store = at.solver->liquid().store;
    for (auto _ : state) {
        list.build(store, store, at.solver->setup().grid, at.cells, at.solver->setup().constants.support);
        Kokkos::fence();
    }
    tell(state, at.particles());
    state.counters["neighbours"] = double(list.size) / at.particles();
}

void density(benchmark::State& state) {
    auto& at = flow(state);
    const auto& setup = at.solver->setup();
    for (auto _ : state) {
        sph::compute_density(
            setup.options, setup.constants, at.solver->liquid(), at.solver->solid(), at.solver->neighbours());
        Kokkos::fence();
    }
    tell(state, at.particles());
}

void assemble(sph::PressureSystem& system, Flow& at) {
    const auto& setup = at.solver->setup();
    system.assemble(
        setup.options, setup.constants, Comm::self(), at.solver->liquid(), at.solver->neighbours(), at.halo);
    Kokkos::fence();
}

void assembly(benchmark::State& state) {
    auto& at = flow(state);
    sph::PressureSystem system;
    for (auto _ : state) assemble(system, at);
    tell(state, double(system.entries()));
}

void product(benchmark::State& state) {
    auto& at = flow(state);
    sph::PressureSystem system;
    assemble(system, at);
    const auto host = system.to_host();
    const solve::Matrix matrix(Comm::self(), system.blocks(host));
    const std::vector<double> given(static_cast<std::size_t>(system.rows()), 1.0);
    std::vector<double> result(given.size());
    for (auto _ : state) {
        matrix.multiply(given, result);
    }
    tell(state, double(system.entries()));
}

BENCHMARK(neighbour_search)->Arg(30)->Arg(300)->Unit(benchmark::kMillisecond);
BENCHMARK(density)->Arg(30)->Arg(300)->Unit(benchmark::kMillisecond);
BENCHMARK(assembly)->Arg(30)->Arg(300)->Unit(benchmark::kMillisecond);
BENCHMARK(product)->Arg(30)->Arg(300)->Unit(benchmark::kMillisecond);
} // namespace

int main(int argc, char** argv) {
    const MpiRuntime mpi(argc, argv);
    const KokkosRuntime kokkos(argc, argv);
    const solve::SolveRuntime petsc;
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    benchmark::RunSpecifiedBenchmarks();
    flows.clear();
    return 0;
}
