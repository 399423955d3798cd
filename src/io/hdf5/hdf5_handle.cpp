#include "io/hdf5/hdf5_handle.hpp"

#include "mpi/native.hpp"

#include <algorithm>
#include <filesystem>
#include <semaphore.h>

namespace treacle::io {

namespace {
herr_t keep_innermost(unsigned, const H5E_error2_t* error, void* text) {
    *static_cast<std::string*>(text) = error->desc ? error->desc : "";
    return 0;
}

std::string innermost_reason() {
    std::string text;
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_DOWNWARD, keep_innermost, &text);
    H5Eclear2(H5E_DEFAULT);
    return text.empty() ? "HDF5 gave no reason" : text;
}

Handle attribute(hid_t object, const std::string& name) {
    return {H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose, "open attribute " + name};
}

void write_scalar(hid_t object, const std::string& name, hid_t type, const void* value) {
    const Handle space(H5Screate(H5S_SCALAR), H5Sclose, "make a data space");
    const Handle made(
        H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, "create attribute " + name);
    check(H5Awrite(made, type, value), "write attribute " + name);
}

template <class T>
T read_scalar(hid_t object, const std::string& name, hid_t type) {
    T value{};
    const auto opened = attribute(object, name);
    const Handle space(H5Aget_space(opened), H5Sclose, "open attribute " + name);
    if (H5Sget_simple_extent_npoints(space) != 1) throw Hdf5Failure("attribute " + name + " is not a scalar");
    check(H5Aread(opened, type, &value), "read attribute " + name);
    return value;
}
} // namespace

template <class Status>
Status check(Status status, const std::string& verb) {
    if (status < 0) throw Hdf5Failure("cannot " + verb + ": " + innermost_reason());
    return status;
}
template herr_t check(herr_t, const std::string&);
template hid_t check(hid_t, const std::string&);

void quiet_hdf5() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

Handle file_access(const Comm& comm, Access access) {
    Handle list(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "make access properties");
#if H5_VERSION_GE(1, 10, 7)
    check(H5Pset_file_locking(list, false, true), "switch file locks off");
#endif
    if (access == Access::collective) {
        check(H5Pset_fapl_mpio(list, native(comm), MPI_INFO_NULL), "use parallel input and output");
        check(H5Pset_all_coll_metadata_ops(list, true), "read metadata collectively");
        check(H5Pset_coll_metadata_write(list, true), "write metadata collectively");
    }
    return list;
}

namespace {
// Open MPI 4 guards a pointer into the file, which is not shared here, by a semaphore of the machine named after the
// file alone: one that a killed run has left closed stops every later run that opens a file of that name, for ever.
// Without its name it stops no run; those that have it open keep it. (Its other ways of sharing put files beside the
// file.)
void forget_semaphore_of(const std::string& path) {
    sem_unlink(("/OMPIO_" + std::filesystem::path(path).filename().string()).c_str());
}
} // namespace

Handle open_collective(const Comm& comm, const std::string& path, unsigned flags) {
    Handle file;
    comm.guard([&] {
        const auto list = file_access(comm, Access::collective);
        forget_semaphore_of(path);
        file = Handle(H5Fopen(path.c_str(), flags, list), H5Fclose, "open " + path);
    });
    return file;
}

Handle open_serial(const std::string& path) {
    const auto list = file_access(Comm::self(), Access::serial);
    // A failed read of a damaged object may leave it open inside of HDF5: it goes with the file.
    check(H5Pset_fclose_degree(list, H5F_CLOSE_STRONG), "close all with the file");
    return {H5Fopen(path.c_str(), H5F_ACC_RDONLY, list), H5Fclose, "open " + path};
}

RowSelection select_rows(hid_t dataset, std::int64_t first, std::int64_t rows, int components) {
    const hsize_t start[2] = {static_cast<hsize_t>(first), 0};
    const hsize_t count[2] = {static_cast<hsize_t>(rows), static_cast<hsize_t>(components)};
    RowSelection out;
    out.file = Handle(H5Dget_space(dataset), H5Sclose, "open a data space");
    const int rank = check(H5Sget_simple_extent_ndims(out.file), "read a data space");
    out.memory = Handle(H5Screate_simple(rank, count, nullptr), H5Sclose, "make a data space");
    if (rows == 0) {
        check(H5Sselect_none(out.file), "select rows");
        check(H5Sselect_none(out.memory), "select rows");
    } else {
        check(H5Sselect_hyperslab(out.file, H5S_SELECT_SET, start, nullptr, count, nullptr), "select rows");
    }
    return out;
}

Handle transfer(bool collective) {
    Handle list(H5Pcreate(H5P_DATASET_XFER), H5Pclose, "make transfer properties");
    check(H5Pset_dxpl_mpio(list, collective ? H5FD_MPIO_COLLECTIVE : H5FD_MPIO_INDEPENDENT), "set transfer properties");
    return list;
}

void write_attribute(hid_t object, const std::string& name, double value) {
    write_scalar(object, name, H5T_NATIVE_DOUBLE, &value);
}
void write_attribute(hid_t object, const std::string& name, std::int64_t value) {
    write_scalar(object, name, H5T_NATIVE_INT64, &value);
}
void write_attribute(hid_t object, const std::string& name, std::uint64_t value) {
    write_scalar(object, name, H5T_NATIVE_UINT64, &value);
}

void write_attribute(hid_t object, const std::string& name, const std::string& value) {
    const Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "make a string type");
    // HDF5 has no strings of length zero: the empty one is a single null, which reads back as empty.
    check(H5Tset_size(type, std::max<std::size_t>(value.size(), 1)), "make a string type");
    check(H5Tset_strpad(type, H5T_STR_NULLPAD), "make a string type");
    write_scalar(object, name, type, value.c_str());
}

bool has_attribute(hid_t object, const std::string& name) { return H5Aexists(object, name.c_str()) > 0; }

double read_double(hid_t object, const std::string& name) {
    return read_scalar<double>(object, name, H5T_NATIVE_DOUBLE);
}
std::int64_t read_integer(hid_t object, const std::string& name) {
    return read_scalar<std::int64_t>(object, name, H5T_NATIVE_INT64);
}
std::uint64_t read_unsigned(hid_t object, const std::string& name) {
    return read_scalar<std::uint64_t>(object, name, H5T_NATIVE_UINT64);
}

std::string read_text(hid_t object, const std::string& name) {
    const auto opened = attribute(object, name);
    const Handle type(H5Aget_type(opened), H5Tclose, "read the type of attribute " + name);
    if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) > 0)
        throw Hdf5Failure("attribute " + name + " is not a string of fixed length");
    std::string text(H5Tget_size(type), '\0');
    check(H5Aread(opened, type, text.data()), "read attribute " + name);
    text.erase(std::find(text.begin(), text.end(), '\0'), text.end());
    return text;
}

std::vector<std::string> attribute_names(hid_t object) {
    std::vector<std::string> names;
    const auto add = [](hid_t, const char* name, const H5A_info_t*, void* list) -> herr_t {
        static_cast<std::vector<std::string>*>(list)->emplace_back(name);
        return 0;
    };
    check(H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, nullptr, add, &names), "list the attributes");
    std::sort(names.begin(), names.end());
    return names;
}

std::vector<std::string> dataset_names(hid_t group) {
    std::vector<std::string> links, names;
    const auto add = [](hid_t, const char* name, const H5L_info_t*, void* list) -> herr_t {
        static_cast<std::vector<std::string>*>(list)->emplace_back(name);
        return 0;
    };
    check(H5Lvisit(group, H5_INDEX_NAME, H5_ITER_INC, add, &links), "list the datasets");
    for (const auto& link : links) {
        const Handle object(H5Oopen(group, link.c_str(), H5P_DEFAULT), H5Oclose, "open " + link);
        if (H5Iget_type(object) == H5I_DATASET) names.push_back(link);
    }
    std::sort(names.begin(), names.end());
    return names;
}

std::pair<std::int64_t, int> shape(hid_t dataset) {
    const Handle space(H5Dget_space(dataset), H5Sclose, "open a data space");
    const int rank = check(H5Sget_simple_extent_ndims(space), "read a data space");
    if (rank < 1 || rank > 2) throw Hdf5Failure("a dataset has " + std::to_string(rank) + " dimensions");
    hsize_t size[2] = {0, 1};
    check(H5Sget_simple_extent_dims(space, size, nullptr), "read a data space");
    return {static_cast<std::int64_t>(size[0]), static_cast<int>(size[1])};
}

} // namespace treacle::io
