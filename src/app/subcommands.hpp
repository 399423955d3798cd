#pragma once
#include "app/input/input.hpp"
#include "base/text/error.hpp"
#include "mpi/comm.hpp"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace treacle::app {

// Arguments that an option collects, in their order.
using Words = std::vector<std::string>;
// A command that is ready to run on all ranks. Collective; throws Error.
using Command = std::function<ExitCode(const Comm&)>;

// Result that a subcommand fills in; `make` turns it into the command when all is read.
struct Chosen {
    std::string petsc;
    std::function<Command()> make;
    std::function<ExitCode()> alone; // in the place of the command, without MPI
};

// A command that prints a text.
Command print(const std::string& text);

// A scene's file, or the scene.yaml in a folder. Collective.
std::filesystem::path find_scene(const Comm& comm, const std::string& name);

// Words of a subcommand that reads a scene.
struct SourceWords {
    std::string scene;
    Words overrides, data, materials;

    // Collective: finds the scene's file. Throws InputError.
    InputSource source(const Comm& comm) const;
};

// An option that takes one value each time, so that what follows is not taken for another one.
void add_repeated(CLI::App& app, const std::string& name, Words& values, const std::string& doc);
void add_source(CLI::App& app, SourceWords& words);
void add_materials(CLI::App& app, SourceWords& words);
void add_petsc(CLI::App& app, Chosen& chosen);

// Subcommands, each added to the program.
void add_run(CLI::App& program, Chosen& chosen, const Words& arguments);
void add_resume(CLI::App& program, Chosen& chosen, const Words& arguments);
void add_check(CLI::App& program, Chosen& chosen);
void add_manuals(CLI::App& program, Chosen& chosen);
void add_info(CLI::App& program, Chosen& chosen);
void add_export(CLI::App& program, Chosen& chosen);
void add_render(CLI::App& program, Chosen& chosen);
void add_bench(CLI::App& program, Chosen& chosen);
void add_calibrate(CLI::App& program, Chosen& chosen);

} // namespace treacle::app
