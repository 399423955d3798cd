#include "app/render/surface_fields.hpp"

#include "app/input/option_values.hpp"
#include "base/text/error.hpp"
#include "base/text/text.hpp"

namespace treacle::app {

namespace {
[[noreturn]] void refuse(
    const std::string& name, const std::string& problem, const std::string& reason, const std::string& cure) {
    throw InputError({"--fields " + name, problem, reason, cure});
}
} // namespace

SurfaceFields::SurfaceFields(const std::string& list, const io::Frame& frame, io::SurfaceFormat format) {
    if (list == "none") return;
    if (list.empty()) {
        normals_ = true;
        for (const char* name : {"velocity", "pressure", "liquid"}) {
            if (format != io::SurfaceFormat::obj && frame.find(name)) want(name, frame);
        }
        return;
    }
    for (const auto& name : split_at(list, ',')) {
        if (name == "normal") {
            normals_ = true;
            continue;
        }
        if (format == io::SurfaceFormat::obj)
            refuse(name, "has no place in obj", "it holds positions and normals", "write ply or vtp with --format");
        want(name, frame);
    }
}

void SurfaceFields::want(const std::string& name, const io::Frame& frame) {
    const auto* column = frame.find(name);
    if (column == nullptr) {
        const auto field = scalar_field(frame, name); // throws for what there is not
        const auto bracket = field.title.find(" [");
        const auto unit =
            bracket == std::string::npos ? "" : field.title.substr(bracket + 2, field.title.size() - bracket - 3);
        wanted_.push_back({name, unit, 1, scalars_.size()});
        scalars_.push_back(name);
    } else if (name == "liquid") {
        wanted_.push_back({name, "", 1, 0, true});
    } else if (std::holds_alternative<std::vector<std::int64_t>>(column->values)) {
        refuse(name, "is a whole number", "vertices take means of the particles around them", "leave it out");
    } else {
        if (column->components != 1 && column->components != 3)
            refuse(name, "has " + std::to_string(column->components) + " components", "",
                "name the components that are wanted: " + name + "_0");
        wanted_.push_back({name, column->unit == "1" ? "" : column->unit, column->components, scalars_.size()});
        constexpr const char* axes[] = {"_x", "_y", "_z"};
        for (int k = 0; k < column->components; ++k)
            scalars_.push_back(column->components == 3 ? name + axes[k] : name);
    }
    if (scalars_.size() > surface::most_scalars)
        refuse(name, "is one too many", "vertices take up to 16 numbers", "leave some out");
}

io::SurfacePart SurfaceFields::part_of(const surface::Mesh& mesh, double time) {
    const auto owned = static_cast<std::size_t>(mesh.owned);
    io::SurfacePart out;
    out.dimensions = mesh.dimensions;
    out.time = time;
    out.vertices = std::span(mesh.vertices).first(3 * owned);
    out.has_normals = normals_;
    if (normals_) out.normals = std::span(mesh.normals).first(3 * owned);
    vectors_.assign(wanted_.size(), {});
    for (std::size_t w = 0; w < wanted_.size(); ++w) {
        const auto& wanted = wanted_[w];
        auto& field = out.fields.emplace_back(
            io::SurfaceField{wanted.name, wanted.unit, wanted.components, {}, {}, wanted.whole});
        if (wanted.whole) {
            field.integers = std::span(mesh.liquid).first(owned);
            continue;
        }
        for (std::size_t v = 0; v < owned; ++v) {
            for (int k = 0; k < wanted.components; ++k)
                vectors_[w].push_back(mesh.scalars[wanted.scalar + static_cast<std::size_t>(k)][v]);
        }
        field.reals = vectors_[w];
    }
    for (const auto& triangle : mesh.triangles) {
        auto& numbers = out.triangles.emplace_back(std::array<std::int64_t, 3>{-1, -1, -1});
        for (std::size_t k = 0; k < static_cast<std::size_t>(mesh.dimensions); ++k) {
            numbers[k] = mesh.global[static_cast<std::size_t>(triangle[k])];
        }
    }
    return out;
}

} // namespace treacle::app
