#include "io/hdf5/hdf5_file.hpp"

#include "base/text/error.hpp"
#include "base/text/file.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <system_error>
#include <unistd.h>

namespace treacle::io {

namespace {
constexpr std::int64_t bytes_of_metadata = 65536;
constexpr std::int64_t bytes_per_dataset = 4096;

hid_t type_of(const Dataset& dataset) {
    if (dataset.stored == Stored::float32) return H5T_NATIVE_FLOAT;
    const hid_t types[] = {H5T_NATIVE_DOUBLE, H5T_NATIVE_INT64, H5T_NATIVE_INT32, H5T_NATIVE_UINT8};
    return types[dataset.values.index()];
}

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& verb, const std::string& reason) {
    throw SimulationError({path.string(), "cannot " + verb, reason, "free some space or choose another folder"});
}

enum class Reserved { yes, unknown };

// Reserves the blocks of a file; where the file system cannot, checks its free space.
Reserved reserve(const std::filesystem::path& path, std::int64_t bytes) {
    const int file = ::open(path.c_str(), O_RDWR | O_CREAT, 0644);
    if (file < 0) fail(path, "create", std::strerror(errno));
    const int error = ::fallocate(file, 0, 0, bytes) == 0 ? 0 : errno;
    ::close(file);
    if (error == 0) return Reserved::yes;
    if (error != EOPNOTSUPP && error != ENOSYS)
        fail(path, "reserve " + std::to_string(bytes) + " bytes", std::strerror(error));
    std::error_code unknown;
    const auto space = std::filesystem::space(path, unknown);
    // A capacity of zero: unknown to the file system.
    if (!unknown && space.capacity > 0 && space.available < static_cast<std::uintmax_t>(bytes))
        fail(path, "reserve " + std::to_string(bytes) + " bytes",
            "only " + std::to_string(space.available) + " bytes are free");
    return Reserved::unknown;
}

struct Extent {
    std::int64_t first = 0; // of this rank
    std::int64_t rows = 0;  // of this rank
    std::int64_t total = 0; // of all ranks
};

std::vector<Extent> extents_of(const Comm& comm, const FilePlan& plan) {
    std::vector<Extent> extents;
    for (const auto& dataset : plan.datasets) {
        const auto rows = row_count(dataset);
        extents.push_back({comm.exclusive_sum(rows), rows, comm.sum(rows)});
    }
    return extents;
}

void create_dataset(hid_t file, const Dataset& dataset, std::int64_t total) {
    const hsize_t size[2] = {static_cast<hsize_t>(total), static_cast<hsize_t>(dataset.components)};
    const int rank = dataset.components == 1 ? 1 : 2;
    const Handle space(H5Screate_simple(rank, size, nullptr), H5Sclose, "make a data space");
    const Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose, "make link properties");
    check(H5Pset_create_intermediate_group(links, 1), "make link properties");
    const Handle list(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "make dataset properties");
    check(H5Pset_obj_track_times(list, false), "make dataset properties");
    check(H5Pset_alloc_time(list, H5D_ALLOC_TIME_EARLY), "make dataset properties");
    check(H5Pset_fill_time(list, H5D_FILL_TIME_NEVER), "make dataset properties");
    const Handle made(H5Dcreate2(file, dataset.path.c_str(), type_of(dataset), space, links, list, H5P_DEFAULT),
        H5Dclose, "create " + dataset.path);
}

// On rank 0 alone. The file has its full size at the end, without the values.
Reserved create_file(const std::filesystem::path& path, const FilePlan& plan, const std::vector<Extent>& extents) {
    std::int64_t bytes = bytes_of_metadata;
    for (std::size_t i = 0; i < extents.size(); ++i)
        bytes += bytes_per_dataset + extents[i].total * plan.datasets[i].components *
                                         static_cast<std::int64_t>(H5Tget_size(type_of(plan.datasets[i])));
    std::filesystem::remove(path);
    reserve(path, bytes);

    const auto access = file_access(Comm::self(), Access::serial);
    if (plan.metadata == Metadata::checked)
        check(H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V18), "choose the format");
    Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access), H5Fclose, "create the file");
    for (std::size_t i = 0; i < extents.size(); ++i) create_dataset(file, plan.datasets[i], extents[i].total);
    plan.describe(file);
    file.close("close the new file");
    return reserve(path, static_cast<std::int64_t>(std::filesystem::file_size(path)));
}

// Memory in the type of the file: a conversion inside of HDF5 would break up the collective transfer.
const void* stored_form(const Dataset& dataset, std::vector<float>& singles) {
    return std::visit(
        [&](const auto& values) -> const void* {
            if (dataset.stored == Stored::as_given) return values.data();
            singles.assign(values.begin(), values.end());
            return singles.data();
        },
        dataset.values);
}

void write_values(const Comm& comm, hid_t file, const Dataset& dataset, const Extent& extent, bool collective) {
    if (extent.total == 0) return;
    std::vector<float> singles;
    Handle opened, list;
    RowSelection rows;
    const void* memory = nullptr;
    comm.guard(
        [&] { opened = Handle(H5Dopen2(file, dataset.path.c_str(), H5P_DEFAULT), H5Dclose, "open " + dataset.path); });
    comm.guard([&] {
        rows = select_rows(opened, extent.first, extent.rows, dataset.components);
        list = transfer(collective);
        memory = stored_form(dataset, singles);
    });
    comm.guard([&] {
        check(H5Dwrite(opened, type_of(dataset), rows.memory, rows.file, list, memory), "write " + dataset.path);
    });
}

void write_temporary(const Comm& comm, const std::filesystem::path& temporary, const FilePlan& plan) {
    const auto extents = extents_of(comm, plan);
    std::int64_t reserved = 0;
    comm.guard_root([&] { reserved = create_file(temporary, plan, extents) == Reserved::yes; });
    // A write may still fail on one rank where space cannot be reserved: that rank then writes without the others.
    const bool collective = comm.any(reserved != 0);

    auto file = open_collective(comm, temporary.string(), H5F_ACC_RDWR);
    for (std::size_t i = 0; i < extents.size(); ++i) write_values(comm, file, plan.datasets[i], extents[i], collective);
    comm.guard([&] { check(H5Fflush(file, H5F_SCOPE_GLOBAL), "flush the file"); });
    comm.guard([&] { file.close("close the file"); });
}

// The paths, types and components must agree, or the collective calls would not.
void check_plan(const Comm& comm, const FilePlan& plan) {
    std::string signature;
    comm.guard([&] {
        for (const auto& dataset : plan.datasets) {
            signature += dataset.path + ' ' + std::to_string(dataset.components) + ' ' +
                         std::to_string(dataset.values.index()) + '\n';
            const auto size = std::visit([](const auto& values) { return values.size(); }, dataset.values);
            if (dataset.components < 1 || size % static_cast<std::size_t>(dataset.components) != 0)
                throw std::logic_error(dataset.path + ": the number of values is no multiple of the components");
        }
    });
    const auto of_root = comm.broadcast(signature);
    comm.guard([&] {
        if (signature != of_root) throw std::logic_error("the ranks write different datasets");
    });
}
} // namespace

std::int64_t row_count(const Dataset& dataset) {
    return std::visit([](const auto& values) { return static_cast<std::int64_t>(values.size()); }, dataset.values) /
           dataset.components;
}

void write_hdf5(const Comm& comm, const FilePlan& plan) {
    quiet_hdf5();
    auto temporary = plan.path;
    temporary += ".tmp";
    try {
        check_plan(comm, plan);
        write_temporary(comm, temporary, plan);
        comm.guard_root([&] { sync_and_rename(temporary, plan.path); });
    } catch (const Error& error) {
        comm.guard_root([&] {
            std::error_code ignored;
            std::filesystem::remove(temporary, ignored);
        });
        if (error.code() != ExitCode::simulation_failed) throw;
        throw SimulationError({plan.path.string(), "cannot write this file", error.what(), ""});
    }
}

} // namespace treacle::io
