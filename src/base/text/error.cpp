#include "base/text/error.hpp"

#include <utility>

namespace treacle {

std::string Diagnostic::text() const {
    std::string out = where.empty() ? problem : where + ": " + problem;
    for (const auto* part : {&reason, &cure}) {
        if (!part->empty()) out += "; " + *part;
    }
    return out.ends_with('?') || out.ends_with('.') ? out : out + ".";
}

namespace {
std::string join(const std::vector<Diagnostic>& diagnostics) {
    std::string out;
    for (const auto& diagnostic : diagnostics) out += (out.empty() ? "" : "\n") + diagnostic.text();
    return out;
}
} // namespace

InputError::InputError(Diagnostic diagnostic) : InputError(std::vector<Diagnostic>{std::move(diagnostic)}) {}

InputError::InputError(std::vector<Diagnostic> diagnostics)
    : Error(ExitCode::bad_input, join(diagnostics)), diagnostics_(std::move(diagnostics)) {}

} // namespace treacle
