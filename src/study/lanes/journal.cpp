#include "study/lanes/journal.hpp"

#include "base/text/error.hpp"
#include "base/text/file.hpp"

#include <nlohmann/json.hpp>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <unistd.h>

namespace treacle::study {

namespace {
using Json = nlohmann::ordered_json;

// JSON has no numbers that are not finite; they stand there as null.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
double number(const Json& value) { return value.is_null() ? std::nan("") : value.get<double>(); }

Json json_of(const RunRequest& run) {
    Json out{{"asked", run.number}, {"scene", run.scene}, {"values", run.values}, {"key", run.key}};
    if (!run.changes.empty()) out["changes"] = run.changes;
    return out;
}

Json json_of(const RunOutcome& outcome) {
    Json figures = Json::object();
    for (const auto& figure : outcome.figures) figures[figure.name] = number(figure.value);
    Json out{{"ended", outcome.number}, {"status", word(outcome.status)}};
    if (!outcome.reason.empty()) out["reason"] = outcome.reason;
    if (outcome.status == RunStatus::stopped_early) out["bound"] = number(outcome.bound);
    out["figures"] = figures;
    out["seconds"] = number(outcome.seconds);
    out["peak_bytes"] = number(outcome.peak_bytes);
    out["bytes"] = number(outcome.bytes);
    out["lane"] = outcome.lane;
    out["started"] = outcome.started;
    out["host"] = outcome.host;
    if (!outcome.folder.empty()) out["folder"] = outcome.folder;
    return out;
}

RunOutcome outcome_of(const Json& line) {
    RunOutcome out;
    out.number = line.at("ended").get<std::int64_t>();
    const auto status = run_status(line.at("status").get<std::string>());
    if (!status) throw std::runtime_error("its status is unknown");
    out.status = *status;
    out.reason = line.value("reason", "");
    if (out.status == RunStatus::stopped_early) out.bound = number(line.at("bound"));
    for (const auto& [name, value] : line.at("figures").items()) out.figures.push_back({name, number(value)});
    out.seconds = number(line.at("seconds"));
    out.peak_bytes = number(line.at("peak_bytes"));
    out.bytes = number(line.at("bytes"));
    out.lane = line.at("lane").get<int>();
    out.started = line.at("started").get<std::string>();
    out.host = line.at("host").get<std::string>();
    out.folder = line.value("folder", "");
    return out;
}

// Invalid UTF-8, of a file name for instance, must not keep an outcome from being written.
std::string text_of(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }
} // namespace

std::string Journal::load() {
    std::ifstream file(path_, std::ios::binary);
    std::string whole, line;
    for (int count = 1; std::getline(file, line) && !file.eof(); ++count) {
        read_line(line, count);
        whole += line + "\n";
    }
    return whole;
}

void Journal::read_line(const std::string& line, int count) {
    try {
        const auto json = Json::parse(line);
        if (json.contains("journal")) {
            owner_ = {json.at("study").get<std::string>(), json.at("program").get<std::string>()};
        } else if (json.contains("asked")) {
            RunRequest run{json.at("asked").get<std::int64_t>(), json.at("scene").get<std::string>(),
                json.at("values").get<Point>(), json.at("key").get<std::string>(),
                json.value("changes", std::vector<std::string>())};
            if (run.number != std::int64_t(runs_.size()) + 1) throw std::runtime_error("its number is out of order");
            numbers_[run.key] = run.number;
            runs_.push_back(std::move(run));
        } else if (json.contains("dropped")) {
            outcomes_.erase(json.at("dropped").get<std::int64_t>());
        } else {
            auto outcome = outcome_of(json);
            if (outcome.number < 1 || outcome.number > std::int64_t(runs_.size()))
                throw std::runtime_error("there is no run of its number");
            outcomes_[outcome.number] = std::move(outcome);
        }
    } catch (const std::exception& error) {
        throw InputError({path_.string() + ":" + std::to_string(count), "cannot be read", error.what(),
            "the file was changed by something else: mend the line, or give the study another folder with --out"});
    }
}

Journal Journal::read(const std::filesystem::path& folder) {
    Journal journal(folder / file_name);
    if (!std::filesystem::exists(journal.path_)) {
        throw InputError(
            {folder.string(), "is not the folder of a study", std::string("it has no ") + file_name, "check its name"});
    }
    journal.load();
    return journal;
}

Journal Journal::open(const std::filesystem::path& folder, const JournalOwner& owner) {
    Journal journal(folder / file_name);
    auto whole = journal.load();
    if (whole.empty()) {
        whole = text_of({{"journal", 1}, {"study", owner.study}, {"program", owner.program}}) + "\n";
        journal.owner_ = owner;
    }
    const auto where = journal.path_.string() + ":1";
    if (journal.owner_.study != owner.study) {
        throw InputError({where, "is the journal of another study",
            "its scenes or the keys of its parameters are others", "give this study another folder with --out"});
    }
    if (journal.owner_.program != owner.program) {
        throw InputError({where, "was written by " + journal.owner_.program,
            "this program is " + owner.program + ", whose results may differ",
            "give the study another folder with --out"});
    }
    std::error_code ignored;
    if (std::filesystem::file_size(journal.path_, ignored) != whole.size() || ignored)
        write_file_atomically(journal.path_, whole);
    journal.file_.reset(std::fopen(journal.path_.c_str(), "a"));
    if (!journal.file_) {
        throw SimulationError(
            {journal.path_.string(), "cannot be written", std::strerror(errno), "check its permissions"});
    }
    return journal;
}

const RunRequest* Journal::find(const std::string& key) const {
    const auto found = numbers_.find(key);
    return found == numbers_.end() ? nullptr : &runs_[std::size_t(found->second - 1)];
}

const RunOutcome* Journal::outcome(std::int64_t number) const {
    const auto found = outcomes_.find(number);
    return found == outcomes_.end() ? nullptr : &found->second;
}

void Journal::append(const std::string& line) {
    if (std::fwrite(line.data(), 1, line.size(), file_.get()) == line.size()) return;
    throw SimulationError({path_.string(), "cannot be written", std::strerror(errno),
        "free some space; the study goes on where it stopped"});
}

const RunRequest& Journal::ask(
    const std::string& scene, const Point& values, const std::string& key, const std::vector<std::string>& changes) {
    runs_.push_back({std::int64_t(runs_.size()) + 1, scene, values, key, changes});
    numbers_[key] = runs_.back().number;
    append(text_of(json_of(runs_.back())) + "\n");
    return runs_.back();
}

void Journal::finish(const RunOutcome& outcome) {
    append(text_of(json_of(outcome)) + "\n");
    sync();
    outcomes_[outcome.number] = outcome;
}

void Journal::drop(std::int64_t number) {
    append(text_of({{"dropped", number}}) + "\n");
    outcomes_.erase(number);
}

void Journal::sync() {
    if (std::fflush(file_.get()) == 0 && ::fsync(::fileno(file_.get())) == 0) return;
    throw SimulationError({path_.string(), "cannot be written", std::strerror(errno),
        "free some space; the study goes on where it stopped"});
}

} // namespace treacle::study
