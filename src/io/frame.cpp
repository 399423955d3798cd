#include "io/frame.hpp"

#include "base/text/error.hpp"
#include "io/hdf5/hdf5_file.hpp"
#include "io/series.hpp"

#include <algorithm>
#include <cstdio>
#include <numeric>
#include <set>

namespace treacle::io {

struct FrameWriter::State {
    Comm comm;
    std::filesystem::path folder;
    std::string name;
    Precision precision;
    std::vector<SeriesEntry> entries; // the same on every rank

    std::filesystem::path index() const { return folder / (name + series_suffix); }
};

namespace {
constexpr std::uint8_t vertex_cell = 1; // VTK_VERTEX

std::string frame_file(const std::string& name, std::int64_t step) {
    char number[32];
    std::snprintf(number, sizeof number, "_%06lld.hdf", static_cast<long long>(step));
    return name + number;
}

// The arrays that make a cloud of points an UnstructuredGrid: one partition per rank with particles,
// since readers fail on empty ones; a single empty partition when there are no particles at all.
struct VertexCells {
    std::vector<std::int64_t> count; // of this partition; empty on ranks without one
    std::vector<std::int64_t> connectivity;
    std::vector<std::int64_t> offsets;
    std::vector<std::uint8_t> types;
};

VertexCells vertex_cells(const Comm& comm, std::int64_t n) {
    VertexCells cells;
    const bool nothing = comm.sum(n) == 0;
    if (n == 0 && !(nothing && comm.is_root())) return cells;
    const auto size = static_cast<std::size_t>(n);
    cells.count = {n};
    cells.connectivity.resize(size);
    std::iota(cells.connectivity.begin(), cells.connectivity.end(), 0);
    cells.offsets.resize(size + 1);
    std::iota(cells.offsets.begin(), cells.offsets.end(), 0);
    cells.types.assign(size, vertex_cell);
    return cells;
}

void check_block(const ParticleBlock& block) {
    if (block.positions.size() % 3 != 0) throw std::logic_error("positions: three values for each particle");
    const auto n = block.positions.size() / 3;
    std::set<std::string> names;
    for (const auto& field : block.fields) {
        const auto size = std::visit([](const auto& values) { return values.size(); }, field.values);
        if (field.components < 1 || size != n * static_cast<std::size_t>(field.components))
            throw std::logic_error("field " + field.name + ": one value for each particle and component");
        if (field.name.empty() || field.name.find('/') != std::string::npos || !names.insert(field.name).second)
            throw std::logic_error("field '" + field.name + "': empty, with a slash, or twice");
    }
}

Stored stored_as(const FieldValues& values, Precision precision) {
    return precision == Precision::float32 && values.index() == 0 ? Stored::float32 : Stored::as_given;
}

void write_unit(hid_t file, const std::string& path, const std::string& unit) {
    const Handle dataset(H5Dopen2(file, path.c_str(), H5P_DEFAULT), H5Dclose, "open " + path);
    write_attribute(dataset, "unit", unit);
}

void describe_frame(hid_t file, std::int64_t step, double time, const ParticleBlock& block) {
    const Handle group(H5Gopen2(file, "VTKHDF", H5P_DEFAULT), H5Gclose, "open the group VTKHDF");
    const std::int64_t version[2] = {1, 0};
    const hsize_t two = 2;
    const Handle space(H5Screate_simple(1, &two, nullptr), H5Sclose, "make a data space");
    const Handle made(H5Acreate2(group, "Version", H5T_NATIVE_INT64, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
        "create attribute Version");
    check(H5Awrite(made, H5T_NATIVE_INT64, version), "write attribute Version");
    write_attribute(group, "Type", std::string("UnstructuredGrid"));
    write_attribute(group, "time", time);
    write_attribute(group, "time_unit", std::string("s"));
    write_attribute(group, "step", step);
    write_unit(file, "VTKHDF/Points", "m");
    for (const auto& field : block.fields) write_unit(file, "VTKHDF/PointData/" + field.name, field.unit);
}
} // namespace

FrameWriter::FrameWriter(
    const Comm& comm, const std::filesystem::path& folder, const std::string& name, Precision precision)
    : state_(std::make_unique<State>(State{comm, folder, name, precision, {}})) {
    comm.guard_root([&] { std::filesystem::create_directories(folder); });
}

FrameWriter::~FrameWriter() = default;
FrameWriter::FrameWriter(FrameWriter&&) noexcept = default;

void FrameWriter::resume(double time) {
    auto& s = *state_;
    std::vector<SeriesEntry> kept;
    std::string names;
    s.comm.guard_root([&] {
        if (!std::filesystem::exists(s.index())) return;
        std::vector<SeriesEntry> dropped;
        for (const auto& entry : read_series(s.index())) (entry.time <= time ? kept : dropped).push_back(entry);
        write_series(s.index(), kept);
        for (const auto& entry : dropped) std::filesystem::remove(s.folder / entry.file);
        for (const auto& entry : kept) names += entry.file + '\n';
    });
    std::vector<double> times;
    times.reserve(kept.size());
    for (const auto& entry : kept) times.push_back(entry.time);
    times = s.comm.all_gather(times); // rank 0 alone has any
    names = s.comm.broadcast(names);
    s.entries.clear();
    for (const auto t : times) {
        const auto end = names.find('\n');
        s.entries.push_back({names.substr(0, end), t});
        names.erase(0, end + 1);
    }
}

std::filesystem::path FrameWriter::write(std::int64_t step, double time, const ParticleBlock& block) {
    auto& s = *state_;
    s.comm.guard([&] { check_block(block); });
    const auto cells = vertex_cells(s.comm, static_cast<std::int64_t>(block.positions.size() / 3));
    const std::string file = frame_file(s.name, step);

    FilePlan plan;
    plan.path = s.folder / file;
    const std::span<const std::int64_t> count = cells.count;
    const Stored real = s.precision == Precision::float32 ? Stored::float32 : Stored::as_given;
    plan.datasets = {{"VTKHDF/NumberOfPoints", count}, {"VTKHDF/NumberOfCells", count},
        {"VTKHDF/NumberOfConnectivityIds", count}, {"VTKHDF/Points", block.positions, 3, real},
        {"VTKHDF/Types", std::span(cells.types)}, {"VTKHDF/Connectivity", std::span(cells.connectivity)},
        {"VTKHDF/Offsets", std::span(cells.offsets)}};
    for (const auto& field : block.fields)
        plan.datasets.push_back(
            {"VTKHDF/PointData/" + field.name, field.values, field.components, stored_as(field.values, s.precision)});
    plan.describe = [&](hid_t out) { describe_frame(out, step, time, block); };
    write_hdf5(s.comm, plan);

    std::erase_if(s.entries, [&](const auto& entry) { return entry.file == file; });
    s.entries.push_back({file, time});
    s.comm.guard_root([&] { write_series(s.index(), s.entries); });
    return plan.path;
}

} // namespace treacle::io
