#include "study/model/run_record.hpp"

#include <array>
#include <utility>

namespace treacle::study {

namespace {
constexpr std::array<std::pair<RunStatus, const char*>, 8> words{
    {{RunStatus::done, "done"}, {RunStatus::stopped_early, "stopped early"}, {RunStatus::failed, "failed"},
        {RunStatus::bad_input, "bad input"}, {RunStatus::out_of_memory, "out of memory"}, {RunStatus::killed, "killed"},
        {RunStatus::timed_out, "timed out"}, {RunStatus::hung, "hung"}}};
} // namespace

std::string word(RunStatus status) {
    for (const auto& [one, text] : words) {
        if (one == status) return text;
    }
    return "";
}

bool is_failure(RunStatus status) { return status != RunStatus::done && status != RunStatus::stopped_early; }

std::optional<RunStatus> run_status(const std::string& text) {
    for (const auto& [one, known] : words) {
        if (known == text) return one;
    }
    return {};
}

} // namespace treacle::study
