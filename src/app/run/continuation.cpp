#include "app/run/continuation.hpp"

#include "base/options/options.hpp"
#include "base/text/error.hpp"
#include "io/manifest.hpp"
#include "scene/renamed_keys.hpp"

namespace treacle::app {

namespace {
bool begins(const std::string& path, const std::string& block) {
    return path == block || path.starts_with(block + ".");
}

// Why a key stays as it is while a run goes on; empty when it may change.
std::string reason_against(const std::string& path) {
    if (path == "output.name") return "the frames of a run go by one name";
    if (path == "time.end" || path == "max_lost_fraction" || begins(path, "output") || begins(path, "cameras"))
        return "";
    if (begins(path, "measurements")) return "they are the columns of measurements.csv";
    if (begins(path, "time")) return "the steps of a run follow one rule";
    return "the state of the checkpoint follows from it";
}
} // namespace

std::string state_hash(Input input) {
    const auto name = input.scene.output.name;
    input.scene.output = {};
    input.scene.output.name = name;
    input.scene.time.end = scene::Time{}.end;
    input.scene.cameras.clear();
    input.scene.max_lost_fraction = scene::Scene{}.max_lost_fraction;
    return io::text_hash(effective(input));
}

Input continued_input(const std::string& text, const std::string& name, const std::vector<Change>& changes) {
    auto document = Document::from_text(text, name);
    document.accept(scene::renamed_keys());
    Input before, after;
    parse(document, before);
    for (const auto& change : changes) document.set(change.assignment, change.origin);
    parse(document, after);
    std::vector<Diagnostic> refused;
    const auto refuse = [&](const Change& change, const std::string& reason) {
        refused.push_back({change.origin, "cannot change when a run goes on", reason,
            "change time.end, output, cameras or max_lost_fraction, or start anew with treacle run"});
    };
    for (const auto& change : changes) {
        const auto reason = reason_against(
            present_path(change.assignment.substr(0, change.assignment.find('=')), scene::renamed_keys()));
        if (!reason.empty()) refuse(change, reason);
    }
    // A whole block may have been given.
    if (refused.empty() && state_hash(before) != state_hash(after))
        refuse(changes.back(), reason_against("output.name"));
    if (!refused.empty()) throw InputError(refused);
    after.notes = document.notes();
    return after;
}

} // namespace treacle::app
