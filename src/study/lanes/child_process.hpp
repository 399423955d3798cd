#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <sys/types.h>
#include <vector>

namespace treacle::study {

// End of a program.
struct Ending {
    int exit_code = 0;
    int signal = 0; // that ended it; 0: none
};

// Order in which the kernel ends programs when memory runs out: of -1000 (never) to 1000 (first).
constexpr int run_oom_score = 500, expendable_oom_score = 900;

// Set in the environment of a child: what it starts in turn should end with it (end_with_parent).
constexpr const char* lane_variable = "TREACLE_LANE";

// In a process below a ChildProcess, whatever launcher stands between: the kernel ends it when its parent ends.
void end_with_parent();

// A program started by this one, in a process group of its own, which ends with this process whatever ends that. Its
// environment has no word of a job step or of MPI ranks that this process may be part of, so that it starts as from a
// terminal; it goes before other programs when memory runs out. Needs a process with one thread and without MPI.
class ChildProcess {
public:
    // Output and errors go into `log`, which is replaced; `added` are variables of the environment, "NAME=value". Throws
    // SimulationError when the program cannot be started.
    ChildProcess(const std::vector<std::string>& command, const std::filesystem::path& log,
        const std::vector<std::string>& added = {}, int oom_score = run_oom_score);
    // Ends it, with all that it has started.
    ~ChildProcess();
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;

    // Ending of the program; nothing while it runs. Does not block.
    const std::optional<Ending>& poll();
    // Sends SIGTERM to it and all that it has started.
    void ask_to_end();
    // Ends it and all that it has started at once (SIGKILL).
    void kill();
    // Memory that it and all that it has started hold [bytes].
    double resident_bytes() const;

private:
    std::vector<pid_t> family() const; // with its descendants
    void signal_all(int signal);

    pid_t pid_ = 0;
    std::optional<Ending> ending_;
};

// The program that a name stands for, on the PATH where the name is no path; empty: none.
std::filesystem::path find_program(const std::string& name);

// "ended with exit code 3", "was ended by signal 9 (Killed)"
std::string describe(const Ending& ending);

// The names of environment variables that a child must not inherit: those of ranks of MPI and of Slurm's job steps.
bool is_of_a_launcher(const std::string& name);

} // namespace treacle::study
