#include "io/export.hpp"

#include "base/text/error.hpp"
#include "base/text/file.hpp"

#include <bit>
#include <charconv>
#include <cstring>
#include <fstream>
#include <limits>

namespace treacle::io {

static_assert(std::endian::native == std::endian::little, "binary exports are written as they lie in memory");

namespace {
enum class Number { float32, float64, int32, int64 };

// One array of the file: positions are the first.
struct Column {
    std::string name;
    std::string unit;
    int components;
    const std::variant<std::vector<double>, std::vector<std::int64_t>>* field; // null for positions
    const std::vector<double>* positions;
    Number stored;

    const std::vector<double>* reals() const { return positions ? positions : std::get_if<std::vector<double>>(field); }
    const std::vector<std::int64_t>& integers() const { return std::get<std::vector<std::int64_t>>(*field); }
};

std::vector<Column> columns_of(const Frame& frame) {
    const Number real = frame.precision == Precision::float32 ? Number::float32 : Number::float64;
    std::vector<Column> columns = {{"position", "m", 3, nullptr, &frame.positions, real}};
    for (const auto& f : frame.fields)
        columns.push_back(
            {f.name, f.unit, f.components, &f.values, nullptr, f.values.index() == 0 ? real : Number::int64});
    return columns;
}

std::string component_name(const Column& column, int c) {
    if (column.components == 1) return column.name;
    if (column.components <= 3) return column.name + "_" + "xyz"[c];
    return column.name + "_" + std::to_string(c);
}

template <class T>
void put(std::ostream& out, T value) {
    out.write(reinterpret_cast<const char*>(&value), sizeof value);
}

void put_number(std::ostream& out, const Column& column, std::size_t i) {
    const auto* reals = column.reals();
    switch (column.stored) {
    case Number::float32: return put(out, static_cast<float>((*reals)[i]));
    case Number::float64: return put(out, reals ? (*reals)[i] : static_cast<double>(column.integers()[i]));
    case Number::int32: return put(out, static_cast<std::int32_t>(column.integers()[i]));
    case Number::int64: return put(out, column.integers()[i]);
    }
}

std::string digits(double value, Number stored) {
    char text[64];
    const auto end = stored == Number::float32 ? std::to_chars(text, text + sizeof text, static_cast<float>(value)).ptr
                                               : std::to_chars(text, text + sizeof text, value).ptr;
    return {text, end};
}

void write_csv(std::ostream& out, const Frame& frame) {
    const auto columns = columns_of(frame);
    std::string line;
    for (const auto& column : columns)
        for (int c = 0; c < column.components; ++c) {
            if (!line.empty()) line += ',';
            line +=
                (column.positions ? std::string(1, "xyz"[c]) : component_name(column, c)) + " [" + column.unit + "]";
        }
    out << line << '\n';
    for (std::size_t p = 0; p < static_cast<std::size_t>(frame.size()); ++p) {
        line.clear();
        for (const auto& column : columns)
            for (int c = 0; c < column.components; ++c) {
                const auto i = p * static_cast<std::size_t>(column.components) + static_cast<std::size_t>(c);
                if (!line.empty()) line += ',';
                line +=
                    column.reals() ? digits((*column.reals())[i], column.stored) : std::to_string(column.integers()[i]);
            }
        out << line << '\n';
    }
}

// The widest type of PLY that holds the integers exactly.
Number ply_type(const std::filesystem::path& path, const Column& column) {
    if (column.reals()) return column.stored;
    constexpr std::int64_t exact = std::int64_t{1} << 53;
    Number type = Number::int32;
    for (const auto value : column.integers()) {
        if (value > exact || value < -exact)
            throw InputError(Diagnostic{path.string(), "field " + column.name + " does not fit into ply",
                "its integers exceed 2^53", "export to vtp or csv"});
        if (value > std::numeric_limits<std::int32_t>::max() || value < std::numeric_limits<std::int32_t>::min())
            type = Number::float64;
    }
    return type;
}

const char* ply_name(Number stored) {
    if (stored == Number::float32) return "float";
    return stored == Number::float64 ? "double" : "int";
}

void write_ply(const std::filesystem::path& path, std::ostream& out, const Frame& frame) {
    auto columns = columns_of(frame);
    out << "ply\nformat binary_little_endian 1.0\ncomment time " << digits(frame.time, Number::float64) << " s\n";
    for (auto& column : columns) {
        column.stored = ply_type(path, column);
        out << "comment unit " << column.name << " " << column.unit << '\n';
    }
    out << "element vertex " << frame.size() << '\n';
    for (const auto& column : columns)
        for (int c = 0; c < column.components; ++c) {
            out << "property " << ply_name(column.stored) << ' '
                << (column.positions ? std::string(1, "xyz"[c]) : component_name(column, c)) << '\n';
        }
    out << "end_header\n";
    for (std::size_t p = 0; p < static_cast<std::size_t>(frame.size()); ++p)
        for (const auto& column : columns)
            for (int c = 0; c < column.components; ++c)
                put_number(out, column, p * static_cast<std::size_t>(column.components) + static_cast<std::size_t>(c));
}

std::string xml_text(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if (c == '&')
            out += "&amp;";
        else if (c == '<')
            out += "&lt;";
        else if (c == '"')
            out += "&quot;";
        else
            out += c;
    }
    return out;
}

// Places the arrays of the appended part: each is its size in bytes and then the values.
class Appended {
public:
    explicit Appended(std::ostream& out) : out_(out) {}
    void declare(const std::string& type, const std::string& name, int components, std::uint64_t bytes,
        const std::string& unit = "") {
        out_ << "<DataArray type=\"" << type << "\" Name=\"" << xml_text(name) << "\" NumberOfComponents=\""
             << components << "\" format=\"appended\" offset=\"" << offset_ << '"';
        if (!unit.empty()) out_ << " unit=\"" << xml_text(unit) << '"';
        out_ << "/>\n";
        offset_ += sizeof(std::uint64_t) + bytes;
    }

private:
    std::ostream& out_;
    std::uint64_t offset_ = 0;
};

struct VtkType {
    const char* name;
    std::uint64_t bytes;
};
VtkType vtk_type(Number number) {
    if (number == Number::float32) return {"Float32", 4};
    if (number == Number::float64) return {"Float64", 8};
    return {"Int64", 8};
}

std::uint64_t byte_count(const Column& column, std::uint64_t n) {
    return n * static_cast<std::uint64_t>(column.components) * vtk_type(column.stored).bytes;
}

void write_vtp(std::ostream& out, const Frame& frame) {
    const auto columns = columns_of(frame);
    const auto n = static_cast<std::uint64_t>(frame.size());
    Appended appended(out);
    const auto declare = [&](const Column& column) {
        appended.declare(
            vtk_type(column.stored).name, column.name, column.components, byte_count(column, n), column.unit);
    };
    out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
           "header_type=\"UInt64\">\n<PolyData>\n<FieldData>\n<DataArray type=\"Float64\" Name=\"TimeValue\" "
           "NumberOfTuples=\"1\" format=\"ascii\">"
        << digits(frame.time, Number::float64) << "</DataArray>\n</FieldData>\n<Piece NumberOfPoints=\"" << n
        << "\" NumberOfVerts=\"" << n << "\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n<Points>\n";
    declare(columns[0]);
    out << "</Points>\n<Verts>\n";
    appended.declare("Int64", "connectivity", 1, n * 8);
    appended.declare("Int64", "offsets", 1, n * 8);
    out << "</Verts>\n<PointData>\n";
    for (std::size_t i = 1; i < columns.size(); ++i) declare(columns[i]);
    out << "</PointData>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_";

    const auto put_column = [&](const Column& column) {
        put(out, byte_count(column, n));
        for (std::size_t i = 0; i < n * static_cast<std::size_t>(column.components); ++i) put_number(out, column, i);
    };
    put_column(columns[0]);
    put(out, n * 8);
    for (std::uint64_t p = 0; p < n; ++p) put(out, p);
    put(out, n * 8);
    for (std::uint64_t p = 0; p < n; ++p) put(out, p + 1);
    for (std::size_t i = 1; i < columns.size(); ++i) put_column(columns[i]);
    out << "\n</AppendedData>\n</VTKFile>\n";
}

void write_stream(const std::filesystem::path& path, std::ostream& out, const Frame& frame, ExportFormat format) {
    switch (format) {
    case ExportFormat::ply: return write_ply(path, out, frame);
    case ExportFormat::vtp: return write_vtp(out, frame);
    case ExportFormat::csv: return write_csv(out, frame);
    }
}
} // namespace

ExportFormat export_format(const std::string& name) {
    for (const auto format : {ExportFormat::ply, ExportFormat::vtp, ExportFormat::csv})
        if (format_name(format) == name) return format;
    const bool obj = name == "obj";
    throw InputError(Diagnostic{"--to " + name, obj ? "particles are not written as obj" : "unknown format",
        obj ? "obj knows no velocity and no other field of a particle" : "", "the formats are ply, vtp and csv"});
}

std::string format_name(ExportFormat format) {
    switch (format) {
    case ExportFormat::ply: return "ply";
    case ExportFormat::vtp: return "vtp";
    case ExportFormat::csv: return "csv";
    }
    return "";
}

void export_particles(const std::filesystem::path& path, const Frame& frame, ExportFormat format) {
    auto temporary = path;
    temporary += ".tmp";
    try {
        std::ofstream out(temporary, std::ios::binary);
        write_stream(path, out, frame, format);
        out.close();
        if (!out)
            throw SimulationError({path.string(), "cannot write this file", std::strerror(errno),
                "free some space or choose another folder with --out"});
        sync_and_rename(temporary, path);
    } catch (...) {
        std::error_code ignored;
        std::filesystem::remove(temporary, ignored);
        throw;
    }
}

} // namespace treacle::io
