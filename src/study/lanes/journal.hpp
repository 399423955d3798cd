#pragma once
#include "study/model/run_record.hpp"

#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>

namespace treacle::study {

// Owner of a journal.
struct JournalOwner {
    std::string study;   // hash of the study's scenes and parameters
    std::string program; // version and sources of the program that its results come from
};

// The memory of a study: a JSON object a line, appended and synced, never rewritten. First the owner; then the runs in
// the order of the requests, and their outcomes as they came in. Of several outcomes of a run the last holds,
// unless it was dropped later.
// A last line that was cut off is dropped. Of one process.
class Journal {
public:
    // Goes on with `folder`/journal.jsonl or begins it. Throws InputError with file:line for a journal of another study or
    // program, and for a line that cannot be read; SimulationError when it cannot be written.
    static Journal open(const std::filesystem::path& folder, const JournalOwner& owner);
    // For reading, whoever owns it.
    static Journal read(const std::filesystem::path& folder);

    const std::vector<RunRequest>& runs() const { return runs_; } // run number k stands at k - 1
    const JournalOwner& owner() const { return owner_; }          // first line of the file
    // Run of a key, valid until the next ask(); null: never asked for.
    const RunRequest* find(const std::string& key) const;
    const RunOutcome* outcome(std::int64_t number) const; // null: none, or dropped

    // Numbers the run and writes it down; call sync() before anything depends on it.
    const RunRequest& ask(const std::string& scene, const Point& values, const std::string& key,
        const std::vector<std::string>& changes = {});
    // Writes an outcome down and syncs.
    void finish(const RunOutcome& outcome);
    // The run has no outcome any more; the lines of those that it had stay.
    void drop(std::int64_t number);
    void sync();

    static constexpr const char* file_name = "journal.jsonl"; // in the study's folder

private:
    struct Close {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };
    explicit Journal(std::filesystem::path path) : path_(std::move(path)) {}
    std::string load(); // the lines that are whole
    void read_line(const std::string& line, int count);
    void append(const std::string& line);

    std::filesystem::path path_;
    std::unique_ptr<std::FILE, Close> file_;
    JournalOwner owner_;
    std::vector<RunRequest> runs_;
    std::map<std::string, std::int64_t> numbers_; // by key
    std::map<std::int64_t, RunOutcome> outcomes_;
};

} // namespace treacle::study
