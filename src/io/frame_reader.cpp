#include "io/frame.hpp"

#include "base/text/error.hpp"
#include "io/hdf5/hdf5_handle.hpp"

namespace treacle::io {

namespace {
const std::string fields_group = "VTKHDF/PointData";

template <class T>
std::vector<T> read_rows(hid_t dataset, std::int64_t first, std::int64_t rows, int components, hid_t type) {
    std::vector<T> values(static_cast<std::size_t>(rows) * static_cast<std::size_t>(components));
    const auto selection = select_rows(dataset, first, rows, components);
    check(H5Dread(dataset, type, selection.memory, selection.file, H5P_DEFAULT, values.data()), "read values");
    return values;
}

Handle open_dataset(hid_t file, const std::string& path) {
    return {H5Dopen2(file, path.c_str(), H5P_DEFAULT), H5Dclose, "open " + path};
}

bool has_link(hid_t file, const std::string& path) { return H5Lexists(file, path.c_str(), H5P_DEFAULT) > 0; }

struct RowRange {
    int rank = 0;
    int ranks = 1;
    std::int64_t first(std::int64_t total) const { return total * rank / ranks; }
    std::int64_t rows(std::int64_t total) const { return total * (rank + 1) / ranks - first(total); }
};

FrameColumn read_column(hid_t file, const std::string& name, std::int64_t total, const RowRange& range) {
    const auto dataset = open_dataset(file, fields_group + "/" + name);
    const auto [rows, components] = shape(dataset);
    if (rows != total) throw Hdf5Failure("field " + name + " has another number of particles than Points");
    FrameColumn column{name, "", components, {}};
    if (has_attribute(dataset, "unit")) column.unit = read_text(dataset, "unit");
    const Handle type(H5Dget_type(dataset), H5Tclose, "read the type of " + name);
    const auto first = range.first(total), count = range.rows(total);
    if (H5Tget_class(type) == H5T_INTEGER)
        column.values = read_rows<std::int64_t>(dataset, first, count, components, H5T_NATIVE_INT64);
    else
        column.values = read_rows<double>(dataset, first, count, components, H5T_NATIVE_DOUBLE);
    return column;
}

Frame read_range(const std::filesystem::path& path, const RowRange& range) {
    quiet_hdf5();
    try {
        const auto file = open_serial(path.string());
        const Handle group(H5Gopen2(file, "VTKHDF", H5P_DEFAULT), H5Gclose, "open the group VTKHDF");
        Frame frame;
        if (has_attribute(group, "time")) frame.time = read_double(group, "time");
        if (has_attribute(group, "step")) frame.step = read_integer(group, "step");
        const auto points = open_dataset(file, "VTKHDF/Points");
        const auto [total, components] = shape(points);
        if (components != 3) throw Hdf5Failure("Points has not three components");
        const Handle type(H5Dget_type(points), H5Tclose, "read the type of Points");
        frame.precision = H5Tget_size(type) > sizeof(float) ? Precision::float64 : Precision::float32;
        frame.total = total;
        frame.positions = read_rows<double>(points, range.first(total), range.rows(total), 3, H5T_NATIVE_DOUBLE);
        if (!has_link(file, fields_group)) return frame;
        const Handle fields(H5Gopen2(file, fields_group.c_str(), H5P_DEFAULT), H5Gclose, "open the fields");
        for (const auto& name : dataset_names(fields)) frame.fields.push_back(read_column(file, name, total, range));
        return frame;
    } catch (const Hdf5Failure& failure) {
        throw InputError(Diagnostic{path.string(), "not a readable frame", failure.what(),
            "frames are the .hdf files that a run writes into frames/"});
    }
}
} // namespace

const FrameColumn* Frame::find(const std::string& name) const {
    for (const auto& field : fields)
        if (field.name == name) return &field;
    return nullptr;
}

Frame read_frame(const std::filesystem::path& path) { return read_range(path, {}); }

Frame read_frame(const Comm& comm, const std::filesystem::path& path) {
    Frame frame;
    comm.guard([&] { frame = read_range(path, {comm.rank(), comm.size()}); });
    return frame;
}

} // namespace treacle::io
