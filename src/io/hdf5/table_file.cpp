#include "io/hdf5/table_file.hpp"

#include "base/text/error.hpp"
#include "base/text/file.hpp"
#include "io/hdf5/hdf5_handle.hpp"

namespace treacle::io {

namespace {
std::string dataset_name(std::string name) {
    for (auto at = name.find('/'); at != std::string::npos; at = name.find('/', at)) name.replace(at, 1, " per ");
    return name;
}

void write_column(hid_t file, const std::string& name, hid_t type, std::size_t rows, const void* values) {
    const hsize_t size = rows;
    const Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose, "make a data space");
    const Handle made(H5Dcreate2(file, dataset_name(name).c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
        H5Dclose, "create dataset " + name);
    if (rows > 0) check(H5Dwrite(made, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), "write dataset " + name);
}

void write_texts(hid_t file, const std::string& name, const std::vector<std::string>& texts) {
    const Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "make a text type");
    check(H5Tset_size(type, H5T_VARIABLE), "make a text type");
    check(H5Tset_cset(type, H5T_CSET_UTF8), "make a text type");
    std::vector<const char*> pointers;
    pointers.reserve(texts.size());
    for (const auto& text : texts) pointers.push_back(text.c_str());
    write_column(file, name, type, texts.size(), pointers.data());
}
} // namespace

void write_table_file(const std::filesystem::path& path, const TableFile& table) {
    auto temporary = path;
    temporary += ".tmp";
    try {
        quiet_hdf5();
        Handle file(H5Fcreate(temporary.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose,
            "create " + temporary.string());
        for (const auto& [name, values] : table.numbers)
            write_column(file, name, H5T_NATIVE_DOUBLE, values.size(), values.data());
        for (const auto& [name, texts] : table.texts) write_texts(file, name, texts);
        file.close("write " + temporary.string());
    } catch (const Hdf5Failure& failure) {
        std::error_code ignored;
        std::filesystem::remove(temporary, ignored);
        throw SimulationError({path.string(), failure.what(), "", "free some space, or check the folder"});
    }
    sync_and_rename(temporary, path);
}

} // namespace treacle::io
