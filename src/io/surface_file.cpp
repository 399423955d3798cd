#include "io/surface_file.hpp"

#include "base/text/error.hpp"
#include "io/parallel_file.hpp"

#include <bit>
#include <charconv>
#include <limits>

namespace treacle::io {

static_assert(std::endian::native == std::endian::little, "binary exports are written as they lie in memory");

namespace {
std::string digits(double value) {
    char text[64];
    return {text, std::to_chars(text, text + sizeof text, value).ptr};
}
std::string short_digits(double value) {
    char text[64];
    return {text, std::to_chars(text, text + sizeof text, static_cast<float>(value)).ptr};
}

std::size_t count(const SurfacePart& part) { return part.vertices.size() / 3; }

// "velocity_x" of a vector, "pressure" of a number.
std::string component_name(const SurfaceField& field, int k) {
    constexpr const char* axes[] = {"_x", "_y", "_z"};
    return field.components == 3 ? field.name + axes[k] : field.name;
}

void put_vector(Stretch& to, std::span<const double> values, std::size_t row) {
    for (std::size_t k = 0; k < 3; ++k) to.put(static_cast<float>(values[3 * row + k]));
}

std::vector<Stretch> ply(const Comm& comm, const std::filesystem::path& path, const SurfacePart& part,
    std::int64_t vertices, std::int64_t triangles) {
    if (vertices > std::numeric_limits<std::int32_t>::max()) {
        throw InputError(Diagnostic{
            path.string(), "the surface does not fit into ply", "it has more than 2^31 - 1 vertices", "export to vtp"});
    }
    std::vector<Stretch> out(3);
    if (comm.is_root()) {
        std::string head = "ply\nformat binary_little_endian 1.0\ncomment time " + digits(part.time) + " s\n";
        for (const auto& field : part.fields) {
            if (!field.unit.empty()) head += "comment unit " + field.name + " " + field.unit + "\n";
        }
        head +=
            "element vertex " + std::to_string(vertices) + "\nproperty float x\nproperty float y\nproperty float z\n";
        if (part.has_normals) head += "property float nx\nproperty float ny\nproperty float nz\n";
        for (const auto& field : part.fields) {
            for (int k = 0; k < field.components; ++k) {
                head += std::string("property ") + (field.whole ? "int " : "float ") + component_name(field, k) + "\n";
            }
        }
        head += "element ";
        head += part.dimensions == 3 ? "face " : "edge ";
        head += std::to_string(triangles) + "\n";
        head += part.dimensions == 3 ? "property list uchar int vertex_indices\n"
                                     : "property int vertex1\nproperty int vertex2\n";
        out[0].put(head + "end_header\n");
    }
    for (std::size_t v = 0; v < count(part); ++v) {
        put_vector(out[1], part.vertices, v);
        if (part.has_normals) put_vector(out[1], part.normals, v);
        for (const auto& field : part.fields) {
            const auto width = static_cast<std::size_t>(field.components);
            for (std::size_t k = 0; k < width; ++k) {
                if (field.whole)
                    out[1].put(static_cast<std::int32_t>(field.integers[width * v + k]));
                else
                    out[1].put(static_cast<float>(field.reals[width * v + k]));
            }
        }
    }
    for (const auto& triangle : part.triangles) {
        if (part.dimensions == 3) out[2].put(static_cast<unsigned char>(3));
        for (std::size_t k = 0; k < static_cast<std::size_t>(part.dimensions); ++k)
            out[2].put(static_cast<std::int32_t>(triangle[k]));
    }
    return out;
}

std::string vertex_line(const char* name, std::span<const double> values, std::size_t row) {
    std::string text = name;
    for (std::size_t k = 0; k < 3; ++k) text += " " + short_digits(values[3 * row + k]);
    return text + "\n";
}

std::vector<Stretch> obj(const Comm& comm, const SurfacePart& part) {
    std::vector<Stretch> out(4);
    if (comm.is_root()) out[0].put("# time " + digits(part.time) + " s\n");

    for (std::size_t v = 0; v < count(part); ++v) {
        out[1].put(vertex_line("v", part.vertices, v));
        if (part.has_normals) out[2].put(vertex_line("vn", part.normals, v));
    }
    for (const auto& triangle : part.triangles) {
        std::string text = part.dimensions == 3 ? "f" : "l";
        for (std::size_t k = 0; k < static_cast<std::size_t>(part.dimensions); ++k) {
            const auto number = std::to_string(triangle[k] + 1);
            text += " " + (part.dimensions == 3 && part.has_normals ? number + "//" + number : number);
        }
        out[3].put(text + "\n");
    }
    return out;
}

// The arrays of a VTP file's appended part: each is its size in bytes and then the values.
class VtpArrays {
public:
    VtpArrays(const Comm& comm, std::string& head) : comm_(comm), head_(head) {}

    template <class Fill>
    void add(const char* type, const char* name, int components, const char* unit, const Fill& fill) {
        Stretch values;
        fill(values);
        const auto bytes = static_cast<std::uint64_t>(comm_.sum(static_cast<std::int64_t>(values.bytes.size())));
        head_ += std::string("<DataArray type=\"") + type + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
                 std::to_string(components) + "\" format=\"appended\" offset=\"" + std::to_string(offset_) + "\"" +
                 (*unit ? std::string(" unit=\"") + unit + "\"" : std::string()) + "/>\n";
        offset_ += sizeof(std::uint64_t) + bytes;
        auto& size = stretches.emplace_back();
        if (comm_.is_root()) size.put(bytes);
        stretches.push_back(std::move(values));
    }

    std::vector<Stretch> stretches;

private:
    Comm comm_;
    std::string& head_;
    std::uint64_t offset_ = 0;
};

std::vector<Stretch> vtp(const Comm& comm, const SurfacePart& part, std::int64_t vertices, std::int64_t triangles) {
    const std::string lines = part.dimensions == 3 ? "0" : std::to_string(triangles);
    const std::string polys = part.dimensions == 3 ? std::to_string(triangles) : "0";
    std::string head =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
        "header_type=\"UInt64\">\n<PolyData>\n<FieldData>\n<DataArray type=\"Float64\" Name=\"TimeValue\" "
        "NumberOfTuples=\"1\" format=\"ascii\">" +
        digits(part.time) + "</DataArray>\n</FieldData>\n<Piece NumberOfPoints=\"" + std::to_string(vertices) +
        "\" NumberOfVerts=\"0\" NumberOfLines=\"" + lines + "\" NumberOfStrips=\"0\" NumberOfPolys=\"" + polys +
        "\">\n<Points>\n";
    VtpArrays arrays(comm, head);
    const auto reals = [](std::span<const double> values) {
        return [values](Stretch& to) {
            for (const double value : values) to.put(static_cast<float>(value));
        };
    };
    arrays.add("Float32", "position", 3, "m", reals(part.vertices));
    const char* cells = part.dimensions == 3 ? "Polys" : "Lines";
    head += std::string("</Points>\n<") + cells + ">\n";
    arrays.add("Int64", "connectivity", 1, "", [&](Stretch& to) {
        for (const auto& triangle : part.triangles) {
            for (std::size_t k = 0; k < static_cast<std::size_t>(part.dimensions); ++k) to.put(triangle[k]);
        }
    });
    const auto first = comm.exclusive_sum(static_cast<std::int64_t>(part.triangles.size()));
    arrays.add("Int64", "offsets", 1, "", [&](Stretch& to) {
        for (std::size_t t = 1; t <= part.triangles.size(); ++t)
            to.put(part.dimensions * (first + static_cast<std::int64_t>(t)));
    });
    head += std::string("</") + cells + ">\n<PointData" + (part.has_normals ? " Normals=\"normal\"" : "") + ">\n";
    if (part.has_normals) arrays.add("Float32", "normal", 3, "", reals(part.normals));
    for (const auto& field : part.fields) {
        if (!field.whole) {
            arrays.add("Float32", field.name.c_str(), field.components, field.unit.c_str(), reals(field.reals));
            continue;
        }
        arrays.add("Int32", field.name.c_str(), field.components, field.unit.c_str(), [&](Stretch& to) {
            for (const int value : field.integers) to.put(static_cast<std::int32_t>(value));
        });
    }
    head += "</PointData>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_";
    Stretch begin, end;
    if (comm.is_root()) {
        begin.put(head);
        end.put(std::string("\n</AppendedData>\n</VTKFile>\n"));
    }
    arrays.stretches.insert(arrays.stretches.begin(), std::move(begin));
    arrays.stretches.push_back(std::move(end));
    return std::move(arrays.stretches);
}
} // namespace

SurfaceFormat surface_format(const std::string& name) {
    for (const auto format : {SurfaceFormat::ply, SurfaceFormat::obj, SurfaceFormat::vtp}) {
        if (format_name(format) == name) return format;
    }
    throw InputError(
        Diagnostic{"--format " + name, "unknown format of surfaces", "", "the formats are ply, obj and vtp"});
}

std::string format_name(SurfaceFormat format) {
    return format == SurfaceFormat::ply ? "ply" : format == SurfaceFormat::obj ? "obj" : "vtp";
}

void write_surface(const Comm& comm, const std::filesystem::path& path, const SurfacePart& part, SurfaceFormat format) {
    const auto vertices = comm.sum(static_cast<std::int64_t>(count(part)));
    const auto triangles = comm.sum(static_cast<std::int64_t>(part.triangles.size()));
    switch (format) {
    case SurfaceFormat::ply: return write_parallel(comm, path, ply(comm, path, part, vertices, triangles));
    case SurfaceFormat::obj: return write_parallel(comm, path, obj(comm, part));
    case SurfaceFormat::vtp: return write_parallel(comm, path, vtp(comm, part, vertices, triangles));
    }
}

} // namespace treacle::io
