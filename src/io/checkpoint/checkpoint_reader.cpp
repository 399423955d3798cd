#include "base/text/error.hpp"
#include "io/checkpoint/checkpoint.hpp"
#include "io/checkpoint/checkpoint_format.hpp"
#include "io/hdf5/hdf5_handle.hpp"

#include <nlohmann/json.hpp>

#include <map>
#include <numeric>

namespace treacle::io {

namespace {
using Array = std::variant<std::vector<double>, std::vector<std::int64_t>>;

struct ArrayInfo {
    std::size_t type = 0; // index into Array
    int components = 1;
    std::int64_t total = 0;
    std::uint64_t checksum = 0;
    std::vector<std::int64_t> rows; // of each rank of the writer
};

// Everything but the distributed values. Rank 0 alone reads the file and broadcasts.
struct Contents {
    int ranks = 0;
    std::map<std::string, AttributeValue> attributes;
    std::map<std::string, Array> replicated;
    std::map<std::string, ArrayInfo> distributed;
};

[[noreturn]] void damaged(const std::filesystem::path& path, const std::string& reason) {
    throw InputError(Diagnostic{path.string(), "not a whole checkpoint", reason, "resume from an older one"});
}

Handle open_dataset(hid_t file, const std::string& path) {
    return {H5Dopen2(file, path.c_str(), H5P_DEFAULT), H5Dclose, "open " + path};
}

template <class T>
hid_t memory_type() {
    return std::is_same_v<T, double> ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT64;
}

std::size_t type_index(hid_t dataset) {
    const Handle type(H5Dget_type(dataset), H5Tclose, "read a type");
    return H5Tget_class(type) == H5T_INTEGER ? 1 : 0;
}

template <class T>
std::vector<T> read_whole(hid_t file, const std::string& path) {
    const auto dataset = open_dataset(file, path);
    const auto [rows, components] = shape(dataset);
    std::vector<T> values(static_cast<std::size_t>(rows * components));
    if (!values.empty())
        check(H5Dread(dataset, memory_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), "read " + path);
    if (checkpoint::checksum(std::span<const T>(values), 0) != read_unsigned(dataset, "checksum"))
        throw Hdf5Failure(path + ": the checksum is wrong");
    return values;
}

AttributeValue read_value(hid_t group, const std::string& name) {
    const Handle opened(H5Aopen(group, name.c_str(), H5P_DEFAULT), H5Aclose, "open attribute " + name);
    const Handle type(H5Aget_type(opened), H5Tclose, "read the type of attribute " + name);
    if (H5Tget_class(type) == H5T_STRING) return read_text(group, name);
    if (H5Tget_class(type) == H5T_INTEGER) return read_integer(group, name);
    return read_double(group, name);
}

std::vector<std::string> names_below(hid_t file, const std::string& group_name) {
    if (H5Lexists(file, group_name.c_str(), H5P_DEFAULT) <= 0) return {};
    const Handle group(H5Gopen2(file, group_name.c_str(), H5P_DEFAULT), H5Gclose, "open " + group_name);
    return dataset_names(group);
}

ArrayInfo read_info(hid_t file, const std::string& name, int ranks) {
    const auto dataset = open_dataset(file, "distributed/" + name);
    ArrayInfo info;
    info.type = type_index(dataset);
    std::tie(info.total, info.components) = shape(dataset);
    info.checksum = read_unsigned(dataset, "checksum");
    info.rows = read_whole<std::int64_t>(file, "rows/" + name);
    if (static_cast<int>(info.rows.size()) != ranks ||
        std::accumulate(info.rows.begin(), info.rows.end(), std::int64_t{0}) != info.total)
        throw Hdf5Failure(name + ": the rows of the ranks do not add up");
    return info;
}

Contents read_contents(const std::filesystem::path& path) {
    const auto file = open_serial(path.string());
    if (!has_attribute(file, "format") || read_text(file, "format") != checkpoint::format)
        throw Hdf5Failure("it is no checkpoint of this program");
    const auto version = read_integer(file, "format_version");
    if (version != checkpoint::format_version)
        throw Hdf5Failure("it has format version " + std::to_string(version) + ", this program reads " +
                          std::to_string(checkpoint::format_version));
    Contents contents;
    contents.ranks = static_cast<int>(read_integer(file, "ranks"));
    const Handle group(H5Gopen2(file, "attributes", H5P_DEFAULT), H5Gclose, "open the attributes");
    for (const auto& name : attribute_names(group)) contents.attributes[name] = read_value(group, name);
    for (const auto& name : names_below(file, "replicated")) {
        const auto full = "replicated/" + name;
        if (type_index(open_dataset(file, full)) == 1)
            contents.replicated[name] = read_whole<std::int64_t>(file, full);
        else
            contents.replicated[name] = read_whole<double>(file, full);
    }
    for (const auto& name : names_below(file, "distributed"))
        contents.distributed[name] = read_info(file, name, contents.ranks);
    return contents;
}

using nlohmann::json;

// CBOR keeps every bit of a number but those of a NaN; JSON text would not.
template <class Variant>
json pack(const Variant& value) {
    return std::visit([&](const auto& v) { return json{value.index(), v}; }, value);
}

template <class Variant, std::size_t I = 0>
Variant unpack(const json& packed) {
    if (packed[0].get<std::size_t>() == I) return packed[1].get<std::variant_alternative_t<I, Variant>>();
    if constexpr (I + 1 < std::variant_size_v<Variant>) return unpack<Variant, I + 1>(packed);
    throw std::logic_error("an unknown type of value");
}

std::string pack_contents(const Contents& contents) {
    json out = {contents.ranks, json::object(), json::object(), json::object()};
    for (const auto& [name, value] : contents.attributes) out[1][name] = pack(value);
    for (const auto& [name, value] : contents.replicated) out[2][name] = pack(value);
    for (const auto& [name, info] : contents.distributed)
        out[3][name] = {info.type, info.components, info.total, info.checksum, info.rows};
    std::string bytes;
    json::to_cbor(out, bytes);
    return bytes;
}

Contents unpack_contents(const std::string& bytes) {
    const json in = json::from_cbor(bytes);
    Contents contents;
    contents.ranks = in[0];
    for (const auto& [name, value] : in[1].items()) contents.attributes[name] = unpack<AttributeValue>(value);
    for (const auto& [name, value] : in[2].items()) contents.replicated[name] = unpack<Array>(value);
    for (const auto& [name, info] : in[3].items())
        contents.distributed[name] = {info[0], info[1], info[2], info[3], info[4].get<std::vector<std::int64_t>>()};
    return contents;
}
} // namespace

struct CheckpointReader::State {
    Comm comm;
    std::filesystem::path path;
    Contents contents;
    Handle file;

    [[noreturn]] void missing(const std::string& what) const {
        throw InputError(Diagnostic{path.string(), "this checkpoint has no " + what,
            "it comes from another scene or another version", "start the run anew"});
    }
    const ArrayInfo& info(const std::string& name) const {
        const auto found = contents.distributed.find(name);
        if (found == contents.distributed.end()) missing("array '" + name + "'");
        return found->second;
    }
    std::int64_t first_row(const ArrayInfo& info, int rank) const {
        if (comm.size() == contents.ranks)
            return std::accumulate(info.rows.begin(), info.rows.begin() + rank, std::int64_t{0});
        return info.total * rank / comm.size();
    }
    template <class T>
    std::vector<T> read(const std::string& name, const ArrayInfo& info) const;
};

template <class T>
std::vector<T> CheckpointReader::State::read(const std::string& name, const ArrayInfo& info) const {
    quiet_hdf5();
    const auto first = first_row(info, comm.rank());
    const auto rows = first_row(info, comm.rank() + 1) - first;
    std::vector<T> values;
    Handle dataset, list;
    RowSelection selection;
    comm.guard([&] { dataset = open_dataset(file, "distributed/" + name); });
    comm.guard([&] {
        values.resize(static_cast<std::size_t>(rows * info.components));
        selection = select_rows(dataset, first, rows, info.components);
        list = transfer(true);
    });
    comm.guard([&] {
        if (info.total > 0)
            check(H5Dread(dataset, memory_type<T>(), selection.memory, selection.file, list, values.data()),
                "read " + name);
    });
    const auto own = checkpoint::checksum(std::span<const T>(values), first * info.components);
    const auto sum = static_cast<std::uint64_t>(comm.sum(static_cast<std::int64_t>(own)));
    if (sum != info.checksum) damaged(path, name + ": the checksum is wrong");
    return values;
}

CheckpointReader::CheckpointReader(const Comm& comm, const std::filesystem::path& path)
    : state_(new State{comm, path, {}, {}}) {
    quiet_hdf5();
    std::string bytes;
    comm.guard_root([&] {
        try {
            bytes = pack_contents(read_contents(path));
        } catch (const Hdf5Failure& failure) {
            damaged(path, failure.what());
        }
    });
    state_->contents = unpack_contents(comm.broadcast(bytes));
    state_->file = open_collective(comm, path.string(), H5F_ACC_RDONLY);
}

CheckpointReader::~CheckpointReader() = default;
CheckpointReader::CheckpointReader(CheckpointReader&&) noexcept = default;

int CheckpointReader::writer_ranks() const { return state_->contents.ranks; }
bool CheckpointReader::has_attribute(const std::string& name) const {
    return state_->contents.attributes.contains(name);
}
bool CheckpointReader::has_distributed(const std::string& name) const {
    return state_->contents.distributed.contains(name);
}
bool CheckpointReader::has_replicated(const std::string& name) const {
    return state_->contents.replicated.contains(name);
}

std::vector<std::string> CheckpointReader::distributed_names() const {
    std::vector<std::string> names;
    for (const auto& [name, info] : state_->contents.distributed) names.push_back(name);
    return names;
}

std::vector<std::string> CheckpointReader::attribute_names() const {
    std::vector<std::string> names;
    for (const auto& [name, value] : state_->contents.attributes) names.push_back(name);
    return names;
}

AttributeValue CheckpointReader::attribute(const std::string& name) const {
    const auto found = state_->contents.attributes.find(name);
    if (found == state_->contents.attributes.end()) state_->missing("attribute '" + name + "'");
    return found->second;
}

template <class T>
T CheckpointReader::attribute(const std::string& name) const {
    const auto value = attribute(name);
    if (!std::holds_alternative<T>(value)) state_->missing("attribute '" + name + "' of the wanted type");
    return std::get<T>(value);
}

template <class T>
std::vector<T> CheckpointReader::replicated(const std::string& name) const {
    const auto found = state_->contents.replicated.find(name);
    if (found == state_->contents.replicated.end() || !std::holds_alternative<std::vector<T>>(found->second))
        state_->missing("array '" + name + "' of the wanted type");
    return std::get<std::vector<T>>(found->second);
}

std::int64_t CheckpointReader::total_rows(const std::string& name) const { return state_->info(name).total; }

template <class T>
Rows<T> CheckpointReader::distributed(const std::string& name) const {
    const auto& info = state_->info(name);
    if (info.type != (std::is_same_v<T, double> ? 0 : 1)) state_->missing("array '" + name + "' of the wanted type");
    return {info.components, info.total, state_->read<T>(name, info)};
}

void CheckpointReader::verify(const std::string& name) const {
    const auto& info = state_->info(name);
    info.type == 0 ? (void)state_->read<double>(name, info) : (void)state_->read<std::int64_t>(name, info);
}

template double CheckpointReader::attribute<double>(const std::string&) const;
template std::int64_t CheckpointReader::attribute<std::int64_t>(const std::string&) const;
template std::string CheckpointReader::attribute<std::string>(const std::string&) const;
template std::vector<double> CheckpointReader::replicated<double>(const std::string&) const;
template std::vector<std::int64_t> CheckpointReader::replicated<std::int64_t>(const std::string&) const;
template Rows<double> CheckpointReader::distributed<double>(const std::string&) const;
template Rows<std::int64_t> CheckpointReader::distributed<std::int64_t>(const std::string&) const;

std::string validate_checkpoint(const Comm& comm, const std::filesystem::path& path) {
    try {
        const CheckpointReader reader(comm, path);
        for (const auto& name : reader.distributed_names()) reader.verify(name);
        return "";
    } catch (const Error& error) {
        return error.what();
    }
}

} // namespace treacle::io
