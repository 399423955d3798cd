#include "app/command_line.hpp"
#include "app/study/run_collectively.hpp"
#include "app/study_commands.hpp"
#include "base/text/floating_point_traps.hpp"
#include "kokkos/runtime.hpp"
#include "solve/rows/runtime.hpp"

#include <csignal>
#include <cstdio>
#include <cstring>
#include <new>
#include <optional>

namespace {

using namespace treacle;

// Kokkos takes options of its own, and its own --help.
void split_arguments(int argc, char** argv, std::vector<std::string>& ours, std::vector<char*>& of_kokkos) {
    for (int i = 0; i < argc; ++i) {
        const bool kokkos = std::strncmp(argv[i], "--kokkos-", 9) == 0;
        if (kokkos || i == 0) of_kokkos.push_back(argv[i]);
        if (!kokkos) ours.emplace_back(argv[i]);
    }
    of_kokkos.push_back(nullptr);
}

void warn_of_unused(const Comm& comm, const solve::SolveRuntime& petsc) {
    if (!comm.is_root()) return;
    for (const auto& option : petsc.unused_options()) {
        std::fprintf(stderr, "warning: nothing has asked for the PETSc option %s\n", option.c_str());
    }
}

ExitCode run_program(const Comm& comm, const std::vector<std::string>& arguments) {
    app::CommandLine line;
    std::optional<solve::SolveRuntime> petsc;
    const auto code = app::run_collectively(comm, [&] {
        line = app::read_command_line(arguments);
        petsc.emplace(line.petsc);
#ifdef TREACLE_TRAP
        trap_non_finite(); // of the computation alone: libraries probe the arithmetic when they start
#endif
        return ExitCode::ok;
    });
    if (code != ExitCode::ok) return code;
    return app::run_collectively(comm, [&] {
        const auto result = line.command(comm);
        if (!line.petsc.empty()) warn_of_unused(comm, *petsc);
        return result;
    });
}

// A study outside of MPI starts each of its runs as a process of its own. Nothing when the command needs MPI, or is
// started on ranks.
std::optional<ExitCode> run_alone(const std::vector<std::string>& arguments) {
    if (app::started_on_ranks() || !app::may_go_alone(arguments)) return {};
    try {
        const auto line = app::read_command_line(arguments);
        if (!line.alone) return {};
        return line.alone();
    } catch (const Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return error.code();
    } catch (const std::bad_alloc&) {
        std::fprintf(stderr, "out of memory\n");
        return ExitCode::out_of_memory;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return ExitCode::simulation_failed;
    }
}

} // namespace

int main(int argc, char** argv) {
    std::signal(SIGPIPE, SIG_IGN); // a reader of the output that goes away does not end a run
    if (const auto code = run_alone({argv, argv + argc})) return static_cast<int>(*code);
    const MpiRuntime mpi(argc, argv);
    const Comm comm = Comm::world();
    std::vector<std::string> arguments;
    std::vector<char*> of_kokkos;
    split_arguments(argc, argv, arguments, of_kokkos);
    int count = static_cast<int>(of_kokkos.size()) - 1;
    const KokkosRuntime kokkos(count, of_kokkos.data());
    return static_cast<int>(run_program(comm, arguments));
}
