#include "mpi/comm.hpp"

#include "base/text/error.hpp"
#include "mpi/native.hpp"

#include <cstdlib>
#include <exception>
#include <new>
#include <sys/stat.h>
#include <unistd.h>

namespace treacle {

namespace {
template <class T>
MPI_Datatype type();
template <>
MPI_Datatype type<double>() {
    return MPI_DOUBLE;
}
template <>
MPI_Datatype type<std::int64_t>() {
    return MPI_INT64_T;
}

template <class T>
T reduce(const Comm& comm, T value, MPI_Op op) {
    MPI_Allreduce(MPI_IN_PLACE, &value, 1, type<T>(), op, native(comm));
    return value;
}

template <class T>
void reduce(const Comm& comm, std::span<T> values, MPI_Op op) {
    MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), type<T>(), op, native(comm));
}

template <class T>
std::vector<T> gather_lists(const Comm& comm, std::span<const T> values) {
    const auto counts64 = comm.all_gather(static_cast<std::int64_t>(values.size()));
    std::vector<int> counts, starts;
    int total = 0;
    for (const auto count : counts64) {
        counts.push_back(static_cast<int>(count));
        starts.push_back(total);
        total += counts.back();
    }
    std::vector<T> all(static_cast<std::size_t>(total));
    MPI_Allgatherv(values.data(), static_cast<int>(values.size()), type<T>(), all.data(), counts.data(), starts.data(),
        type<T>(), native(comm));
    return all;
}

template <class T>
std::vector<T> gather_values(const Comm& comm, T value) {
    std::vector<T> all(static_cast<std::size_t>(comm.size()));
    MPI_Allgather(&value, 1, type<T>(), all.data(), 1, type<T>(), native(comm));
    return all;
}

Comm make(MPI_Comm comm, Comm (*build)(std::intptr_t, int, int)) {
    int rank = 0, size = 1;
    MPI_Comm_rank(comm, &rank);
    MPI_Comm_size(comm, &size);
    return build((std::intptr_t)comm, rank, size);
}
} // namespace

Comm Comm::world() {
    return make(MPI_COMM_WORLD, [](std::intptr_t h, int r, int s) { return Comm(h, r, s); });
}

Comm Comm::self() {
    return make(MPI_COMM_SELF, [](std::intptr_t h, int r, int s) { return Comm(h, r, s); });
}

Comm Comm::split(int colour) const {
    MPI_Comm group = MPI_COMM_NULL; // lives until MPI ends: groups are made once per study
    MPI_Comm_split(native(*this), colour, rank_, &group);
    return make(group, [](std::intptr_t h, int r, int s) { return Comm(h, r, s); });
}

void Comm::barrier() const { MPI_Barrier(native(*this)); }
double Comm::sum(double value) const { return reduce(*this, value, MPI_SUM); }
double Comm::min(double value) const { return reduce(*this, value, MPI_MIN); }
double Comm::max(double value) const { return reduce(*this, value, MPI_MAX); }
std::int64_t Comm::sum(std::int64_t value) const { return reduce(*this, value, MPI_SUM); }
std::int64_t Comm::max(std::int64_t value) const { return reduce(*this, value, MPI_MAX); }
void Comm::sum(std::span<double> values) const { reduce(*this, values, MPI_SUM); }
void Comm::max(std::span<double> values) const { reduce(*this, values, MPI_MAX); }
void Comm::sum(std::span<std::int64_t> values) const { reduce(*this, values, MPI_SUM); }
void Comm::max(std::span<std::int64_t> values) const { reduce(*this, values, MPI_MAX); }

std::int64_t Comm::exclusive_sum(std::int64_t value) const {
    std::int64_t before = 0;
    MPI_Exscan(&value, &before, 1, MPI_INT64_T, MPI_SUM, native(*this));
    return rank_ == 0 ? 0 : before;
}

bool Comm::any(bool value) const { return max(static_cast<std::int64_t>(value)) != 0; }

std::vector<std::int64_t> Comm::all_gather(std::int64_t value) const { return gather_values(*this, value); }
std::vector<double> Comm::all_gather(double value) const { return gather_values(*this, value); }
std::vector<double> Comm::all_gather(std::span<const double> values) const { return gather_lists(*this, values); }
std::vector<std::int64_t> Comm::all_gather(std::span<const std::int64_t> values) const {
    return gather_lists(*this, values);
}

std::string Comm::broadcast(const std::string& text, int root) const {
    std::int64_t length = static_cast<std::int64_t>(text.size());
    broadcast(std::span(&length, 1), root);
    std::string out = text;
    out.resize(static_cast<std::size_t>(length));
    MPI_Bcast(out.data(), static_cast<int>(length), MPI_CHAR, root, native(*this));
    return out;
}

void Comm::broadcast(std::span<double> values, int root) const {
    MPI_Bcast(values.data(), static_cast<int>(values.size()), MPI_DOUBLE, root, native(*this));
}

void Comm::broadcast(std::span<std::int64_t> values, int root) const {
    MPI_Bcast(values.data(), static_cast<int>(values.size()), MPI_INT64_T, root, native(*this));
}

void Comm::guard(const std::function<void()>& work) const {
    int code = 0;
    std::string text;
    try {
        work();
    } catch (const Error& error) {
        code = static_cast<int>(error.code());
        text = error.what();
    } catch (const std::bad_alloc&) {
        code = static_cast<int>(ExitCode::out_of_memory);
        text = "out of memory on rank " + std::to_string(rank_);
    } catch (const std::exception& error) {
        code = static_cast<int>(ExitCode::simulation_failed);
        text = error.what();
    }
    const auto codes = all_gather(static_cast<std::int64_t>(code));
    for (int r = 0; r < size_; ++r) {
        if (codes[static_cast<std::size_t>(r)] == 0) continue;
        throw Error(static_cast<ExitCode>(codes[static_cast<std::size_t>(r)]), broadcast(text, r));
    }
}

void Comm::guard_root(const std::function<void()>& work) const {
    guard([&] {
        if (is_root()) work();
    });
}

void Comm::abort(int code) const {
    MPI_Abort(native(*this), code);
    std::terminate();
}

namespace {
// Processes of Open MPI 4 that start alone and without its daemon take one name, and the first to end removes the folder in which
// the others have their files: opening a file fails. Each gets a folder of its own, named after its number so that those which
// killed processes have left are taken again. Empty where that is not so, and where no folder can be made.
std::filesystem::path folder_of_lone_process() {
    const char* alone = std::getenv("OMPI_MCA_ess_singleton_isolated");
    if (alone == nullptr || std::string(alone) == "0" || std::getenv("OMPI_COMM_WORLD_SIZE") != nullptr) return {};
    const char* variable = "OMPI_MCA_orte_tmpdir_base";
    const char* base = std::getenv(variable);
    std::error_code failed;
    std::filesystem::path out =
        base != nullptr ? std::filesystem::path(base) : std::filesystem::temp_directory_path(failed);
    if (failed) return {};
    out /= "treacle_mpi." + std::to_string(::geteuid()) + "." + std::to_string(::getpid());
    struct stat found {};
    if (::mkdir(out.c_str(), 0700) != 0 &&
        (::lstat(out.c_str(), &found) != 0 || !S_ISDIR(found.st_mode) || found.st_uid != ::geteuid()))
        return {};
    ::setenv(variable, out.c_str(), 1);
    return out;
}
} // namespace

MpiRuntime::MpiRuntime(int& argc, char**& argv) : folder_(folder_of_lone_process()) {
    int provided = 0;
    MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
}

MpiRuntime::~MpiRuntime() {
    MPI_Finalize();
    std::error_code ignored;
    if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
}

} // namespace treacle
