#pragma once
#include "mpi/comm.hpp"

#include <hdf5.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

// Inside of the folder only: this header shows HDF5.
namespace treacle::io {

// Message of HDF5 on the innermost failure. The public functions turn it into an InputError when a file is read and
// into a SimulationError when one is written.
class Hdf5Failure : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

// Keeps HDF5 from printing, from now on: every failure is reported by us, and a damaged file that HDF5 1.10
// does not release would cause an error message at the end of the program.
void quiet_hdf5();

// Throws Hdf5Failure("cannot <verb>: <innermost reason>") for a negative status.
template <class Status>
Status check(Status status, const std::string& verb);
extern template herr_t check(herr_t, const std::string&);
extern template hid_t check(hid_t, const std::string&);

// An HDF5 identifier that is closed with its object.
class Handle {
public:
    using Close = herr_t (*)(hid_t);
    Handle() = default;
    Handle(hid_t id, Close close, const std::string& verb) : id_(check(id, verb)), close_(close) {}
    Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
    Handle& operator=(Handle&& other) noexcept {
        std::swap(id_, other.id_);
        std::swap(close_, other.close_);
        return *this;
    }
    ~Handle() {
        if (id_ >= 0) close_(id_);
    }
    operator hid_t() const { return id_; }
    // Closes now, and throws if that fails.
    void close(const std::string& verb) { check(close_(std::exchange(id_, -1)), verb); }

private:
    hid_t id_ = -1;
    Close close_ = nullptr;
};

// Ranks that open a file: this one alone, or all of a group together.
enum class Access { serial, collective };

// Access properties: without file locks (parallel file systems often lack them, and every file is written
// under a name of its own), collective over the group or of this rank alone.
Handle file_access(const Comm& comm, Access access);
// Collective: opens an existing file on all ranks. Throws on all ranks if one fails.
Handle open_collective(const Comm& comm, const std::string& path, unsigned flags);
Handle open_serial(const std::string& path);
// The rows that one rank holds of a dataset, as selections of the dataset and of memory.
struct RowSelection {
    Handle file;
    Handle memory;
};
RowSelection select_rows(hid_t dataset, std::int64_t first, std::int64_t rows, int components);
Handle transfer(bool collective);

// Adds a scalar to a file, group or dataset that has none of this name; it throws Hdf5Failure, as the readers do.
void write_attribute(hid_t object, const std::string& name, double value);
void write_attribute(hid_t object, const std::string& name, std::int64_t value);
void write_attribute(hid_t object, const std::string& name, std::uint64_t value);
// Fixed length, ASCII or UTF-8 bytes as they are; VTK does not read strings of variable length.
void write_attribute(hid_t object, const std::string& name, const std::string& value);
bool has_attribute(hid_t object, const std::string& name);
double read_double(hid_t object, const std::string& name);
std::int64_t read_integer(hid_t object, const std::string& name);
std::uint64_t read_unsigned(hid_t object, const std::string& name);
std::string read_text(hid_t object, const std::string& name);
// Names of the attributes of an object, sorted.
std::vector<std::string> attribute_names(hid_t object);
// Paths of all datasets below a group, relative to it, sorted.
std::vector<std::string> dataset_names(hid_t group);
// Rows and components of a dataset of one or two dimensions.
std::pair<std::int64_t, int> shape(hid_t dataset);

} // namespace treacle::io
