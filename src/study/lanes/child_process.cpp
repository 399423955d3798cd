#include "study/lanes/child_process.hpp"

#include "base/text/error.hpp"

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <sstream>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace treacle::study {

namespace {
std::vector<std::string> clean_environment(const std::vector<std::string>& added) {
    std::vector<std::string> out;
    for (char** entry = environ; *entry != nullptr; ++entry) {
        const std::string text = *entry;
        if (!is_of_a_launcher(text.substr(0, text.find('=')))) out.push_back(text);
    }
    out.push_back(std::string(lane_variable) + "=1");
    out.push_back("OMPI_MCA_ess_singleton_isolated=1"); // a run on one rank starts sooner without a daemon, unused here
    out.insert(out.end(), added.begin(), added.end());
    return out;
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
    std::vector<char*> out;
    out.reserve(texts.size() + 1);
    for (auto& text : texts) out.push_back(text.data());
    out.push_back(nullptr);
    return out;
}

// Program that a child becomes, and the files that it writes to.
struct ChildStart {
    char* const* arguments;
    char* const* environment;
    int log, report;
    int oom_score;
    pid_t parent;
};

// After vfork, in the child, which has the memory of its parent: only calls that are safe there, and everything allocated before.
[[noreturn]] void become(const ChildStart& start) {
    ::setpgid(0, 0);
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != start.parent) ::_exit(127); // it went before the line above
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
    std::signal(SIGPIPE, SIG_DFL);
    const int score = ::open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
    if (score >= 0) {
        char text[8];
        int length = 0;
        for (int power = 100; power > 0; power /= 10) text[length++] = char('0' + start.oom_score / power % 10);
        if (::write(score, text, std::size_t(length)) < 0) {
        } // allowed to fail: it is a hint
        ::close(score);
    }
    const int nothing = ::open("/dev/null", O_RDONLY);
    ::dup2(nothing, 0);
    ::dup2(start.log, 1);
    ::dup2(start.log, 2);
    ::execvpe(start.arguments[0], start.arguments, start.environment);
    const int error = errno;
    if (::write(start.report, &error, sizeof error) < 0) {
    }
    ::_exit(127);
}

double resident_of(pid_t pid) {
    std::ifstream file("/proc/" + std::to_string(pid) + "/statm");
    double all = 0, resident = 0;
    file >> all >> resident;
    return resident * double(::sysconf(_SC_PAGESIZE));
}

void add_children(pid_t pid, std::vector<pid_t>& out) {
    const auto task = "/proc/" + std::to_string(pid) + "/task/";
    std::error_code ignored;
    for (const auto& thread : std::filesystem::directory_iterator(task, ignored)) {
        std::ifstream file(thread.path() / "children");
        for (pid_t child; file >> child;) {
            out.push_back(child);
            add_children(child, out);
        }
    }
}
} // namespace

bool is_of_a_launcher(const std::string& name) {
    for (const char* kept : {"OMPI_ALLOW_", "OMPI_MCA_rmaps_base_oversubscribe", "OMPI_MCA_hwloc_base_binding_policy",
             "OMPI_MCA_mpi_yield_when_idle", "OMPI_MCA_btl", "OMPI_MCA_mtl", "OMPI_MCA_pml"}) {
        if (name.starts_with(kept)) return false;
    }
    for (const char* prefix :
        {"OMPI_", "PMIX_", "PMI_", "PRTE_", "ORTE_", "HYDRA_", "MPIEXEC_", "SLURM_STEP", "SLURM_PROCID",
            "SLURM_LOCALID", "SLURM_TASK_PID", "SLURM_GTIDS", "SLURM_SRUN", "SLURM_LAUNCH_NODE", "SLURM_CPU_BIND"}) {
        if (name.starts_with(prefix)) return true;
    }
    return false;
}

ChildProcess::ChildProcess(const std::vector<std::string>& command, const std::filesystem::path& log,
    const std::vector<std::string>& added, int oom_score) {
    auto words = command;
    auto variables = clean_environment(added);
    const auto arguments = pointers(words), environment = pointers(variables);
    const int file = ::open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (file < 0)
        throw SimulationError(
            {log.string(), "cannot be written", std::strerror(errno), "free some space, or check the folder"});
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) {
        ::close(file);
        throw SimulationError({command.front(), "cannot be started", std::strerror(errno), "close other programs"});
    }
    const ChildStart start{arguments.data(), environment.data(), file, ends[1], oom_score, ::getpid()};
    // The page tables of a program with hundreds of libraries take longer to copy than a run takes to be written down.
    const pid_t child = ::vfork();
    if (child == 0) become(start);
    pid_ = child;
    int error = pid_ < 0 ? errno : 0;
    ::close(ends[1]);
    ::close(file);
    // Closed by a successful start without a word.
    if (pid_ > 0 && ::read(ends[0], &error, sizeof error) > 0) ::waitpid(pid_, nullptr, 0);
    ::close(ends[0]);
    if (error != 0) {
        pid_ = 0;
        throw SimulationError(
            {command.front(), "cannot be started", std::strerror(error), "check that the program is there"});
    }
    ::setpgid(pid_, pid_); // here too, since the child may not have run yet
}

ChildProcess::~ChildProcess() {
    if (pid_ == 0 || poll()) return;
    kill();
    ::waitpid(pid_, nullptr, 0);
}

const std::optional<Ending>& ChildProcess::poll() {
    int status = 0;
    if (!ending_ && ::waitpid(pid_, &status, WNOHANG) == pid_) {
        ending_ = WIFSIGNALED(status) ? Ending{0, WTERMSIG(status)} : Ending{WEXITSTATUS(status), 0};
        ::kill(-pid_, SIGKILL); // what it may have left behind
    }
    return ending_;
}

std::vector<pid_t> ChildProcess::family() const {
    std::vector<pid_t> out{pid_};
    add_children(pid_, out);
    return out;
}

// A launcher gives its ranks process groups of their own.
void ChildProcess::signal_all(int signal) {
    if (ending_) return;
    for (const auto pid : family()) ::kill(pid, signal);
    ::kill(-pid_, signal);
}

void ChildProcess::ask_to_end() {
    if (!ending_) ::kill(pid_, SIGTERM); // a launcher passes it on
}

void ChildProcess::kill() { signal_all(SIGKILL); }

double ChildProcess::resident_bytes() const {
    double sum = 0;
    for (const auto pid : family()) sum += resident_of(pid);
    return sum;
}

void end_with_parent() {
    if (std::getenv(lane_variable) != nullptr) ::prctl(PR_SET_PDEATHSIG, SIGKILL);
}

std::filesystem::path find_program(const std::string& name) {
    const auto runs = [](const std::filesystem::path& path) {
        return ::access(path.c_str(), X_OK) == 0 && std::filesystem::is_regular_file(path);
    };
    if (name.find('/') != std::string::npos) return runs(name) ? std::filesystem::path(name) : std::filesystem::path();
    const char* path = std::getenv("PATH");
    std::istringstream folders(path == nullptr ? "" : path);
    for (std::string folder; std::getline(folders, folder, ':');) {
        if (runs(std::filesystem::path(folder) / name)) return std::filesystem::path(folder) / name;
    }
    return {};
}

std::string describe(const Ending& ending) {
    if (ending.signal == 0) return "ended with exit code " + std::to_string(ending.exit_code);
    return "was ended by signal " + std::to_string(ending.signal) + " (" + ::strsignal(ending.signal) + ")";
}

} // namespace treacle::study
