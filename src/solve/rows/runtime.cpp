#include "solve/rows/runtime.hpp"

#include "base/text/error.hpp"
#include "base/text/split.hpp"
#include "solve/rows/petsc.hpp"

#include <HYPRE_config.h>
#include <cctype>
#include <sstream>

namespace treacle::solve {

namespace {

// PETSc calls the handler once per level of its call stack; the first call has the cause.
std::string last_error;

PetscErrorCode remember(MPI_Comm, int line, const char* function, const char* file, PetscErrorCode code,
    PetscErrorType type, const char* message, void*) {
    if (type == PETSC_ERROR_INITIAL) {
        const char* general = nullptr;
        PetscErrorMessage(code, &general, nullptr);
        std::ostringstream text;
        text << (general ? general : "error") << ": " << (message ? message : "") << " (" << function << ", " << file
             << ":" << line << ")";
        last_error = text.str();
    }
    return code;
}

std::vector<std::string> words_of(const std::string& options) {
    auto words = split_words(options);
    if (!words.empty() && words.front().front() != '-') {
        throw InputError({"--petsc", "'" + words.front() + "' is not an option",
            "each PETSc option starts with '-' and has at most one value",
            "write for example --petsc \"-pressure_pc_type sor\""});
    }
    return words;
}

} // namespace

void check(PetscErrorCode code) {
    if (code == 0) return;
    const std::string text = last_error.empty() ? "code " + std::to_string(code) : last_error;
    last_error.clear();
    if (code == PETSC_ERR_MEM) {
        throw Error(ExitCode::out_of_memory,
            Diagnostic{"PETSc", "out of memory", text, "use more machines or a coarser spacing"}.text());
    }
    if (code == PETSC_ERR_ARG_UNKNOWN_TYPE || code == PETSC_ERR_USER_INPUT) {
        throw InputError({"PETSc", "an option has a value that PETSc does not know", text,
            "correct the options given by --petsc or PETSC_OPTIONS"});
    }
    throw SimulationError({"PETSc", "the linear algebra failed", text, ""});
}

SolveRuntime::SolveRuntime(const std::string& options) : words_(words_of(options)) {
    words_.insert(words_.begin(), {"treacle", "-no_signal_handler", "-skip_petscrc"});
    for (auto& word : words_) arguments_.push_back(word.data());
    arguments_.push_back(nullptr);
    int count = static_cast<int>(words_.size());
    char** arguments = arguments_.data();
    if (const auto code = PetscInitialize(&count, &arguments, nullptr, nullptr)) {
        throw SimulationError({"PETSc", "cannot start: code " + std::to_string(code), "", ""});
    }
    PetscPushErrorHandler(remember, nullptr);
}

SolveRuntime::~SolveRuntime() {
    PetscPopErrorHandler();
    PetscFinalize();
}

std::vector<std::string> SolveRuntime::unused_options() const {
    PetscInt count = 0;
    char** names = nullptr;
    char** values = nullptr;
    check(PetscOptionsLeftGet(nullptr, &count, &names, &values));
    std::vector<std::string> unused;
    for (PetscInt i = 0; i < count; ++i) {
        const std::string name = names[i];
        if (name == "no_signal_handler" || name == "skip_petscrc") continue;
        unused.push_back("-" + name + (values[i] ? std::string(" ") + values[i] : ""));
    }
    check(PetscOptionsLeftRestore(nullptr, &count, &names, &values));
    return unused;
}

std::string petsc_version() {
    PetscInt major = 0, minor = 0, patch = 0, release = 0;
    check(PetscGetVersionNumber(&major, &minor, &patch, &release));
    return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(patch);
}

std::string hypre_version() { return HYPRE_RELEASE_VERSION; }

} // namespace treacle::solve
