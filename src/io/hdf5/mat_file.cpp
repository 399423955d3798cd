#include "io/hdf5/mat_file.hpp"

#include "base/text/error.hpp"
#include "io/hdf5/hdf5_handle.hpp"

namespace treacle::io {

namespace {
bool is_number(hid_t dataset) {
    const Handle type(H5Dget_type(dataset), H5Tclose, "read a type");
    const auto kind = H5Tget_class(type);
    return kind == H5T_INTEGER || kind == H5T_FLOAT;
}

int dimensions(hid_t dataset) {
    const Handle space(H5Dget_space(dataset), H5Sclose, "read a data space");
    return H5Sget_simple_extent_ndims(space);
}

herr_t keep_name(hid_t, const char* name, const H5L_info_t*, void* names) {
    static_cast<std::vector<std::string>*>(names)->emplace_back(name);
    return 0;
}

MatArray read_array(hid_t dataset, const std::string& name) {
    MatArray out;
    std::tie(out.rows, out.columns) = shape(dataset);
    out.values.resize(std::size_t(out.rows) * std::size_t(out.columns));
    if (!out.values.empty())
        check(H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, out.values.data()), "read " + name);
    return out;
}
} // namespace

bool is_hdf5(const std::filesystem::path& path) {
    quiet_hdf5();
    return H5Fis_hdf5(path.c_str()) > 0;
}

std::map<std::string, MatArray> read_mat(const std::filesystem::path& path) {
    std::map<std::string, MatArray> out;
    try {
        quiet_hdf5();
        const Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, "open " + path.string());
        std::vector<std::string> names;
        check(H5Literate(file, H5_INDEX_NAME, H5_ITER_INC, nullptr, keep_name, &names), "list " + path.string());
        for (const auto& name : names) {
            H5O_info_t info;
            check(H5Oget_info_by_name(file, name.c_str(), &info, H5P_DEFAULT), "look at " + name);
            if (info.type != H5O_TYPE_DATASET) continue;
            const Handle dataset(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose, "open " + name);
            const int rank = dimensions(dataset);
            if (is_number(dataset) && (rank == 1 || rank == 2)) out[name] = read_array(dataset, name);
        }
    } catch (const Hdf5Failure& failure) {
        throw InputError({path.string(), failure.what(), "a MATLAB 7.3 file is HDF5", "save it again with -v7.3"});
    }
    return out;
}

} // namespace treacle::io
