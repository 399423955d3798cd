#include "app/study/split_sweep.hpp"

#include "app/study/forward.hpp"
#include "app/study/run_collectively.hpp"
#include "base/text/log.hpp"
#include "mpi/mailbox.hpp"
#include "study/lanes/forward_files.hpp"

#include <chrono>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <sstream>

namespace treacle::app {

namespace {
constexpr std::int64_t none_left = 0; // in the place of a run's number

// Message of a group to rank 0 that requests its next run: the outcome of the last one.
struct Ended {
    std::int64_t number = none_left; // none_left: there was none
    int code = 0;
    double seconds = 0;
    int group = 0;

    std::string text() const {
        std::ostringstream out;
        out << number << ' ' << code << ' ' << seconds << ' ' << group;
        return out.str();
    }
    static Ended read(const std::string& text) {
        Ended out;
        std::istringstream(text) >> out.number >> out.code >> out.seconds >> out.group;
        return out;
    }
};

// Rank 0's side: the pending runs, and the journal.
class HandOut {
public:
    HandOut(study::StudyRuns& runs, std::vector<std::int64_t> all, bool retry_failed, int groups, Log& log)
        : runs_(runs), all_(std::move(all)), waiting_(runs.longest_first(runs.waiting(all_, retry_failed))),
          groups_(groups), log_(log) {}

    // The next run's number, its folder written; none_left when there is none or the study is to stop.
    std::int64_t next(const Ended& last) {
        if (last.number != none_left) settle(last);
        if (stopped_ || next_ == waiting_.size()) return none_left;
        const auto number = waiting_[next_++];
        runs_.write_request(number);
        under_way_[number] = std::chrono::steady_clock::now();
        return number;
    }
    // For people and programs that watch the study.
    void report() {
        std::vector<study::LaneProgress> running;
        for (const auto& [number, start] : under_way_) {
            running.push_back(
                {number, 0, 0, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()});
        }
        runs_.report(all_, waiting_.size(), std::move(running), groups_);
    }
    bool stopped() const { return stopped_; }

private:
    void settle(const Ended& last) {
        under_way_.erase(last.number);
        if (static_cast<ExitCode>(last.code) == ExitCode::stopped) {
            stopped_ = true; // it has no outcome and is done again
            return;
        }
        study::LaneResult result;
        result.number = last.number;
        result.ending.exit_code = last.code;
        result.seconds = last.seconds;
        result.lane = last.group;
        runs_.finish(result);
        log_.line(
            "run " + std::to_string(last.number) + " " + study::word(runs_.journal().outcome(last.number)->status));
    }

    study::StudyRuns& runs_;
    std::vector<std::int64_t> all_, waiting_;
    std::map<std::int64_t, std::chrono::steady_clock::time_point> under_way_; // since when
    std::size_t next_ = 0;
    int groups_;
    bool stopped_ = false;
    Log& log_;
};

class Groups {
public:
    Groups(const Comm& comm, int ranks)
        : comm_(comm), group_(comm.split(comm.rank() / ranks)), ranks_(ranks), mail_(comm),
          open_(comm.size() / ranks - 1) {}

    // `hand_out` on rank 0 alone.
    void work(HandOut* hand_out, const std::filesystem::path& folder) {
        Ended last;
        last.group = comm_.rank() / ranks_;
        for (;;) {
            std::int64_t number = group_.is_root() ? ask(hand_out, last) : none_left;
            group_.broadcast(std::span(&number, 1));
            if (number == none_left) break;
            const auto begin = std::chrono::steady_clock::now();
            const auto serve = [&] {
                if (hand_out) answer(*hand_out);
            };
            const auto code = run_collectively(group_, [&] {
                return forward_run(
                    group_, folder / "runs" / study::request_folder(number), {LogOutput::disabled, serve});
            });
            last.number = number;
            last.code = static_cast<int>(code);
            last.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        }
        while (hand_out && open_ > 0) {
            reply(*hand_out, mail_.wait());
            hand_out->report();
        }
    }

private:
    std::int64_t ask(HandOut* hand_out, const Ended& last) {
        if (hand_out) return hand_out->next(last);
        mail_.send(0, last.text());
        return std::stoll(mail_.wait().text);
    }
    void answer(HandOut& hand_out) {
        while (const auto letter = mail_.poll()) reply(hand_out, *letter);
        hand_out.report();
    }
    void reply(HandOut& hand_out, const Mailbox::Letter& letter) {
        const auto number = hand_out.next(Ended::read(letter.text));
        if (number == none_left) --open_;
        mail_.send(letter.rank, std::to_string(number));
    }

    Comm comm_, group_;
    int ranks_;
    Mailbox mail_;
    int open_; // groups that have not got none_left yet
};

// Study and hand-out, on rank 0 alone.
struct Desk {
    Desk(const study::Study& study, const std::vector<study::Candidate>& candidates,
        const std::filesystem::path& folder, const SweepRequest& request, int groups)
        : runs(study,
              {folder, this_program(),
                  [this, &study, folder] { write_tables(folder, table_of(study, runs.journal(), numbers)); }},
              log),
          numbers(ask_once(runs, candidates)), hand_out(runs, numbers, request.retry_failed, groups, log) {
        log.line(std::to_string(numbers.size()) + " runs on " + std::to_string(groups) + " groups of ranks in " +
                 folder.string());
    }
    Log log{LogOutput::enabled};
    study::StudyRuns runs;
    std::vector<std::int64_t> numbers;
    HandOut hand_out;
};
} // namespace

ExitCode sweep_on_groups(const Comm& comm, const SweepRequest& request) {
    identify::StudyFile file;
    std::vector<study::Candidate> candidates;
    const auto& study = file.study;
    comm.guard([&] {
        file = load_checked_study(request.study, request.overrides);
        if (comm.size() % study.runs.ranks == 0) return;
        throw InputError({study.path.string() + ": runs.ranks = " + std::to_string(study.runs.ranks),
            "does not divide the " + std::to_string(comm.size()) + " ranks of the program",
            "each run has a group of ranks to itself", "start a multiple of runs.ranks"});
    });
    const auto folder = study_folder(study.path, request.out);
    std::unique_ptr<Desk> desk;
    comm.guard_root([&] {
        candidates = sweep_candidates(file);
        desk = std::make_unique<Desk>(study, candidates, folder, request, comm.size() / study.runs.ranks);
    });
    Groups(comm, study.runs.ranks).work(desk ? &desk->hand_out : nullptr, folder);
    std::int64_t code = 0;
    comm.guard_root([&] {
        code = std::int64_t(write_results(study, desk->runs.journal(), desk->numbers, folder, desk->log));
        if (desk->hand_out.stopped()) code = std::int64_t(ExitCode::stopped);
    });
    comm.broadcast(std::span(&code, 1));
    return static_cast<ExitCode>(code);
}

} // namespace treacle::app
