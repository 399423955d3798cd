#include "app/render/liquid_picture.hpp"

#include "mpi/exchange.hpp"

namespace treacle::app {

namespace {
SurfaceChoice choice_of(const RunView& run, const std::string& field) {
    SurfaceChoice choice{.options = surface_options(run.input), .images = true};
    if (field != no_field) choice.scalars.push_back(field);
    return choice;
}
} // namespace

LiquidPainter::LiquidPainter(
    const Comm& comm, const RunView& run, const video::LiquidScene& scene, const std::string& field)
    : comm_(comm), scene_(scene), surface_(comm, run, choice_of(run, field)) {}

std::optional<LiquidPicture> LiquidPainter::draw(std::size_t frame, int to) {
    const auto& mesh = surface_.build(frame);
    const auto& rows = surface_.rows();
    LiquidPicture picture{video::LiquidView(scene_), rows.time, rows.total, surface_.solids(), "", false, false};
    video::LiquidMesh part{mesh.vertices, mesh.normals, mesh.liquid, {}, mesh.triangles};
    video::LiquidPoints points{rows.positions, {}, {}};
    if (const auto* liquid = rows.find("liquid")) points.liquid = std::get<std::vector<std::int64_t>>(liquid->values);
    if (!surface_.fields().empty()) {
        const auto& field = surface_.fields().front();
        part.values = mesh.scalars.empty() ? std::span<const double>() : std::span<const double>(mesh.scalars.front());
        points.values = field.values;
        picture.title = field.title;
        for (const double value : field.values) {
            picture.has_lower = picture.has_lower || value < scene_.range.low;
            picture.has_higher = picture.has_higher || value > scene_.range.high;
        }
        picture.has_lower = comm_.any(picture.has_lower);
        picture.has_higher = comm_.any(picture.has_higher);
    }
    comm_.guard([&] {
        picture.view.add(part);
        picture.view.add(points);
    });
    std::vector<Message> messages;
    if (comm_.rank() != to) messages.push_back({to, picture.view.pack()});
    for (const auto& message : exchange_sparse(comm_, messages)) picture.view.merge(message.bytes);
    if (comm_.rank() != to) return std::nullopt;
    return picture;
}

} // namespace treacle::app
