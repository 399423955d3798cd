#include "io/checkpoint/checkpoint.hpp"

#include "io/checkpoint/checkpoint_format.hpp"
#include "io/hdf5/hdf5_file.hpp"

#include <list>
#include <set>

namespace treacle::io {

struct CheckpointWriter::State {
    Comm comm;
    std::filesystem::path path;
    std::vector<std::pair<std::string, AttributeValue>> attributes;
    std::vector<Dataset> replicated;
    std::vector<Dataset> distributed;
    std::list<std::variant<std::vector<double>, std::vector<std::int64_t>>> kept;
    std::set<std::string> names;

    void claim(const std::string& path_in_file) {
        if (!names.insert(path_in_file).second) throw std::logic_error(path_in_file + " is written twice");
    }
    void add_replicated(const std::string& name, const Values& values) {
        claim("replicated/" + name);
        replicated.push_back({"replicated/" + name, values});
    }
    void add_distributed(const std::string& name, int components, const Values& values) {
        claim("distributed/" + name);
        distributed.push_back({"distributed/" + name, values, components});
    }
};

namespace {
std::uint64_t checksum_of(const Dataset& dataset, std::int64_t first_value) {
    if (const auto* reals = std::get_if<std::span<const double>>(&dataset.values))
        return checkpoint::checksum(*reals, first_value);
    return checkpoint::checksum(std::get<std::span<const std::int64_t>>(dataset.values), first_value);
}

// Checksum of the whole array, on every rank.
std::uint64_t checksum_of(const Comm& comm, const Dataset& dataset) {
    const auto first = comm.exclusive_sum(row_count(dataset)) * dataset.components;
    return static_cast<std::uint64_t>(comm.sum(static_cast<std::int64_t>(checksum_of(dataset, first))));
}

void write_checksum(hid_t file, const std::string& path, std::uint64_t sum) {
    const Handle dataset(H5Dopen2(file, path.c_str(), H5P_DEFAULT), H5Dclose, "open " + path);
    write_attribute(dataset, "checksum", sum);
}

void describe_checkpoint(hid_t file, int ranks, const std::vector<std::pair<std::string, AttributeValue>>& values) {
    write_attribute(file, "format", checkpoint::format);
    write_attribute(file, "format_version", checkpoint::format_version);
    write_attribute(file, "ranks", static_cast<std::int64_t>(ranks));
    const Handle group(H5Gcreate2(file, "attributes", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose,
        "create the group of attributes");
    for (const auto& [name, value] : values)
        std::visit([&, &key = name](const auto& v) { write_attribute(group, key, v); }, value);
}
} // namespace

CheckpointWriter::CheckpointWriter(const Comm& comm, const std::filesystem::path& path)
    : state_(new State{comm, path, {}, {}, {}, {}, {}}) {}
CheckpointWriter::~CheckpointWriter() = default;

void CheckpointWriter::attribute(const std::string& name, const AttributeValue& value) {
    state_->claim("attributes/" + name);
    state_->attributes.emplace_back(name, value);
}

void CheckpointWriter::replicated(const std::string& name, std::span<const double> values) {
    state_->add_replicated(name, values);
}
void CheckpointWriter::replicated(const std::string& name, std::span<const std::int64_t> values) {
    state_->add_replicated(name, values);
}
void CheckpointWriter::distributed(const std::string& name, int components, std::span<const double> values) {
    state_->add_distributed(name, components, values);
}
void CheckpointWriter::distributed(const std::string& name, int components, std::span<const std::int64_t> values) {
    state_->add_distributed(name, components, values);
}
void CheckpointWriter::distributed(const std::string& name, int components, std::vector<double>&& values) {
    const auto& kept = state_->kept.emplace_back(std::move(values));
    state_->add_distributed(name, components, std::span(std::get<0>(kept)));
}
void CheckpointWriter::distributed(const std::string& name, int components, std::vector<std::int64_t>&& values) {
    const auto& kept = state_->kept.emplace_back(std::move(values));
    state_->add_distributed(name, components, std::span(std::get<1>(kept)));
}

void CheckpointWriter::commit() {
    auto& s = *state_;
    s.comm.guard_root([&] { std::filesystem::create_directories(s.path.parent_path()); });
    FilePlan plan;
    plan.path = s.path;
    plan.metadata = Metadata::checked;
    for (auto dataset : s.replicated) {
        if (!s.comm.is_root()) std::visit([](auto& values) { values = {}; }, dataset.values);
        plan.datasets.push_back(dataset);
    }
    plan.datasets.insert(plan.datasets.end(), s.distributed.begin(), s.distributed.end());

    std::vector<std::pair<std::string, std::uint64_t>> sums;
    for (const auto& dataset : plan.datasets) sums.emplace_back(dataset.path, checksum_of(s.comm, dataset));

    std::list<std::int64_t> rows; // of this rank, one entry for each distributed array
    for (const auto& dataset : s.distributed) {
        const auto& own = rows.emplace_back(row_count(dataset));
        const auto path = "rows/" + dataset.path.substr(std::string("distributed/").size());
        plan.datasets.push_back({path, std::span<const std::int64_t>(&own, 1)});
        sums.emplace_back(path, checksum_of(s.comm, plan.datasets.back()));
    }
    plan.describe = [&](hid_t file) {
        describe_checkpoint(file, s.comm.size(), s.attributes);
        for (const auto& [path, sum] : sums) write_checksum(file, path, sum);
    };
    write_hdf5(s.comm, plan);
}

} // namespace treacle::io
