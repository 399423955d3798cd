#include "app/render/scene_surface.hpp"

#include "app/setup/geometry.hpp"
#include "base/text/error.hpp"
#include "surface/mesh/mirror.hpp"

namespace treacle::app {

surface::Domain surface_domain(const Input& input) {
    const auto& domain = input.scene.domain;
    surface::Domain out;
    out.dimensions = domain.dimensions;
    out.min = domain.min;
    out.max = domain.max;
    for (std::size_t k = 0; k < 6; ++k) {
        const auto kind = domain.faces[k].kind;
        out.sides[k] = kind == scene::BoundaryKind::wall       ? surface::Side::wall
                       : kind == scene::BoundaryKind::periodic ? surface::Side::periodic
                                                               : surface::Side::open;
    }
    return out;
}

surface::Options surface_options(const Input& input) {
    surface::Options out;
    out.spacing = particle_spacing(input);
    return out;
}

namespace {
surface::Options with_scalars(const SurfaceChoice& choice) {
    auto options = choice.options;
    options.scalars = static_cast<int>(choice.scalars.size());
    return options;
}

surface::Domain domain_of(const Input& input, const SurfaceChoice& choice) {
    const auto whole = surface_domain(input);
    return choice.box ? surface::cropped(whole, (*choice.box)[0], (*choice.box)[1]) : whole;
}
} // namespace

SceneSurface::SceneSurface(const Comm& comm, const RunView& run, const SurfaceChoice& choice)
    : comm_(comm), run_(run), scalars_(choice.scalars),
      mesher_(comm, domain_of(run.input, choice), with_scalars(choice)), moving_(comm, run),
      images_(choice.images && !run.input.scene.domain.mirrors().empty()) {}

const surface::Mesh& SceneSurface::build(std::size_t frame) {
    if (built_ == frame) return *mesh_;
    built_.reset();
    mesh_ = &build_anew(frame);
    built_ = frame;
    return *mesh_;
}

const surface::Mesh& SceneSurface::build_anew(std::size_t frame) {
    const auto path = run_.frame(frame);
    rows_ = io::read_frame(comm_, path);
    const auto& rows = rows_;
    surface::ParticleRows particles;
    particles.position = rows.positions;
    const auto reals = [&](const char* name) -> std::span<const double> {
        const auto* column = rows.find(name);
        return column ? std::span<const double>(std::get<std::vector<double>>(column->values))
                      : std::span<const double>();
    };
    const auto integers = [&](const char* name) -> std::span<const std::int64_t> {
        const auto* column = rows.find(name);
        return column ? std::span<const std::int64_t>(std::get<std::vector<std::int64_t>>(column->values))
                      : std::span<const std::int64_t>();
    };
    particles.id = integers("id");
    if (!rows.find("id")) throw InputError({path.string(), "has no field id", "particles are ordered by it", ""});
    particles.velocity = reals("velocity");
    particles.pressure = reals("pressure");
    particles.liquid = integers("liquid");
    fields_.clear();
    for (const auto& name : scalars_) fields_.push_back(scalar_field(rows, name));
    for (const auto& field : fields_) particles.scalars.emplace_back(field.values);
    solids_ = moving_.at(rows.step);
    const auto& mesh = mesher_.build(particles, solids_);
    if (!images_) return mesh;
    drawn_ = mesh;
    const auto mirrors = run_.input.scene.domain.mirrors();
    surface::add_images(drawn_, mirrors);
    add_images(rows_, mirrors);
    for (std::size_t i = 0; i < scalars_.size(); ++i) fields_[i] = scalar_field(rows_, scalars_[i]);
    return drawn_;
}

} // namespace treacle::app
