#pragma once
#include <stdexcept>
#include <string>
#include <vector>

namespace treacle {

// Exit codes of the program, the same on every rank.
enum class ExitCode : int {
    ok = 0,
    bad_input = 2,
    simulation_failed = 3,
    out_of_memory = 4,
    stopped = 5,
};

// Description of a fault, in the order in which a user reads it.
struct Diagnostic {
    std::string where;   // "scene.yaml:14" or a path; may be empty
    std::string problem; // "liquid.viscosity = -3 Pa s: must be > 0"
    std::string reason;  // "a Newtonian viscosity is positive"
    std::string cure;    // "honey is about 10 Pa s"

    // "where: problem; reason; cure." with empty parts left out, and no full stop after a question mark or another one.
    std::string text() const;
};

// An error that ends the program with a given exit code.
class Error : public std::runtime_error {
public:
    Error(ExitCode code, const std::string& text) : std::runtime_error(text), code_(code) {}
    ExitCode code() const { return code_; }

private:
    ExitCode code_;
};

// Bad input: one or several problems found together. Exit code 2.
class InputError : public Error {
public:
    explicit InputError(Diagnostic diagnostic);
    explicit InputError(std::vector<Diagnostic> diagnostics);
    const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }

private:
    std::vector<Diagnostic> diagnostics_;
};

// The simulation failed: non-finite values, a solver that did not converge, too many particles lost,
// a disk that is full. Exit code 3.
class SimulationError : public Error {
public:
    explicit SimulationError(const Diagnostic& diagnostic) : Error(ExitCode::simulation_failed, diagnostic.text()) {}
};

} // namespace treacle
