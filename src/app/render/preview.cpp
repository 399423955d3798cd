#include "app/render/preview.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::app {

namespace {

constexpr double most_particles = 1e6;

// Marks of the lattice points of one liquid that are taken, over the box of indices that it fills and one more on each
// side.
class Occupancy {
public:
    using Index = std::array<std::int64_t, 3>;

    Occupancy(const scene::Lattice& lattice, const std::vector<Vec3>& points) : dimensions_(lattice.dimensions) {
        for (const auto& x : points) indices_.push_back(index_of(lattice, x));
        Index high = low_ = indices_.front();
        for (const auto& i : indices_) {
            for (std::size_t k = 0; k < 3; ++k) {
                low_[k] = std::min(low_[k], i[k] - 1);
                high[k] = std::max(high[k], i[k] + 1);
            }
        }
        for (std::size_t k = 0; k < 3; ++k) size_[k] = high[k] - low_[k] + 1;
        taken_.assign(static_cast<std::size_t>(size_[0] * size_[1] * size_[2]), 0);
        for (const auto& i : indices_) taken_[slot_of(i)] = 1;
    }

    double thin_fraction() const {
        std::vector<char> thick(taken_.size(), 0);
        for (const auto& i : indices_) {
            bool full = true;
            around(i, [&](std::size_t p) { full = full && taken_[p]; });
            if (full) around(i, [&](std::size_t p) { thick[p] = 1; });
        }
        const auto thin = std::ranges::count_if(indices_, [&](const Index& i) { return !thick[slot_of(i)]; });
        return static_cast<double>(thin) / static_cast<double>(indices_.size());
    }

private:
    static Index index_of(const scene::Lattice& lattice, const Vec3& x) {
        Index index{0, 0, 0};
        for (std::size_t k = 0; k < static_cast<std::size_t>(lattice.dimensions); ++k) {
            index[k] = std::llround((x[k] - lattice.min[k]) / lattice.spacing - 0.5);
        }
        return index;
    }

    std::size_t slot_of(const Index& i) const {
        return static_cast<std::size_t>(i[0] - low_[0] + size_[0] * (i[1] - low_[1] + size_[1] * (i[2] - low_[2])));
    }

    template <class Visit>
    void around(const Index& i, const Visit& visit) const {
        const std::int64_t depth = dimensions_ == 3 ? 1 : 0;
        for (std::int64_t c = -depth; c <= depth; ++c) {
            for (std::int64_t b = -1; b <= 1; ++b) {
                for (std::int64_t a = -1; a <= 1; ++a) visit(slot_of({i[0] + a, i[1] + b, i[2] + c}));
            }
        }
    }

    int dimensions_;
    Index low_{}, size_{};
    std::vector<Index> indices_;
    std::vector<char> taken_;
};

// Sides for a coarser lattice, which need not fit a periodic edge; such sides have no particles either way.
void open_periodic_sides(scene::WallSampling& walls) {
    for (auto& side : walls.sides) {
        if (side == scene::Side::periodic) side = scene::Side::open;
    }
}

void add_solids(const Geometry& geometry, double spacing, Preview& preview) {
    auto walls = geometry.walls;
    walls.lattice = preview.lattice;
    if (preview.coarsening > 1) open_periodic_sides(walls);
    const auto samples = scene::sample_domain_walls(walls);
    for (std::size_t i = 0; i < samples.positions.size(); ++i)
        preview.solids.add(samples.positions[i], SolidKind::wall);
    for (std::size_t b = 0; b < geometry.bodies.size(); ++b) {
        auto sampling = body_sampling(geometry, b);
        sampling.spacing = spacing;
        const auto surface = scene::sample_surface(geometry.bodies[b], sampling);
        preview.thin_solid += surface.thin;
        const auto kind = geometry.bodies[b].inverted() ? SolidKind::hollow : SolidKind::body;
        for (const auto& x : surface.positions) preview.solids.add(x, kind);
    }
}

} // namespace

Preview make_preview(const Input& input, const Geometry& geometry) {
    const auto counts = estimate_particles(input, geometry);
    Preview preview;
    const double ratio = static_cast<double>(counts.liquid + counts.solid) / most_particles;
    if (ratio > 1) preview.coarsening = std::pow(ratio, 1.0 / input.scene.domain.dimensions);
    preview.lattice = geometry.lattice;
    preview.lattice.spacing *= preview.coarsening;
    preview.liquid = scene::fill_volume(liquid_fill(input, geometry, preview.lattice));
    add_solids(geometry, preview.lattice.spacing, preview);
    const bool exact = preview.coarsening == 1;
    preview.liquid_count = exact ? preview.liquid.positions.size() : counts.liquid;
    preview.solid_count = exact ? preview.solids.count() : counts.solid;
    return preview;
}

video::Image draw_preview(const Input& input, const Preview& preview) {
    const auto& scene = input.scene;
    std::vector<double> positions;
    for (const auto& x : preview.liquid.positions) positions.insert(positions.end(), x.begin(), x.end());
    video::RenderRequest picture;
    picture.domain = domain_box(scene.domain);
    picture.view = view_of(find_camera(scene, ""), scene.domain, {});
    picture.caption = video::caption_of(scene.title, 0, preview.liquid_count);
    auto& liquid = picture.layers.emplace_back();
    liquid.positions = positions;
    liquid.radius = preview.lattice.spacing / 2;
    add_solid_layers(preview.solids, preview.lattice.spacing, picture.layers);
    return video::render_frame(picture);
}

std::vector<double> thin_fractions(const Preview& preview, std::size_t liquids) {
    if (preview.coarsening > 1) return {};
    std::vector<std::vector<Vec3>> points(liquids);
    for (std::size_t i = 0; i < preview.liquid.positions.size(); ++i) {
        points[static_cast<std::size_t>(preview.liquid.liquids[i])].push_back(preview.liquid.positions[i]);
    }
    std::vector<double> fractions;
    fractions.reserve(points.size());
    for (const auto& part : points)
        fractions.push_back(part.empty() ? 0 : Occupancy(preview.lattice, part).thin_fraction());
    return fractions;
}

} // namespace treacle::app
