#include "app/export/manual.hpp"

#include "app/input/input.hpp"
#include "base/options/options.hpp"
#include "io/manifest.hpp"
#include "kokkos/runtime.hpp"
#include "solve/rows/runtime.hpp"

namespace treacle::app {

namespace {

// 30401 is 3.4.1.
std::string kokkos_text() {
    const int version = kokkos_version();
    return std::to_string(version / 10000) + "." + std::to_string(version / 100 % 100) + "." +
           std::to_string(version % 100) + " (" + execution_space_name() + ")";
}

} // namespace

std::string version_text() {
    const auto build = io::build_info();
    std::string out = "treacle " + build.version + "\n";
    const auto row = [&](std::string name, const std::string& value) {
        name.resize(12, ' ');
        out += "  " + name + value + "\n";
    };
    row("sources", build.commit + (build.state == "unknown" ? "" : ", " + build.state));
    row("compiler", build.compiler + ", " + build.type + (build.flags.empty() ? "" : ", " + build.flags));
    row("Kokkos", kokkos_text());
    for (const auto& [name, version] : io::library_versions()) row(name, version);
    row("PETSc", solve::petsc_version());
    row("HYPRE", solve::hypre_version());
    return out;
}

std::string schema_text(const std::string& key) { return manual(Input{}, key); }
std::string schema_json() { return json_schema(Input{}); }

} // namespace treacle::app
