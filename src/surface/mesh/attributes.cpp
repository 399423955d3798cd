#include "surface/mesh/attributes.hpp"

#include "surface/field/node_field.hpp"

namespace treacle::surface {

namespace {
struct Particles {
    Array3 velocity;
    Array<double> pressure;
    Array<int> liquid;
    Array<double> scalar[most_scalars];
    int scalars;
    bool has_velocity, has_pressure, has_liquid;
};

Particles views(const ParticleStore& store, const Sources& sources) {
    Particles out{};
    out.has_velocity = sources.velocity >= 0;
    out.has_pressure = sources.pressure >= 0;
    out.has_liquid = sources.liquid >= 0;
    if (out.has_velocity) out.velocity = store.get<Array3>(sources.velocity);
    if (out.has_pressure) out.pressure = store.get<Array<double>>(sources.pressure);
    if (out.has_liquid) out.liquid = store.get<Array<int>>(sources.liquid);
    out.scalars = static_cast<int>(sources.scalars.size());
    for (std::size_t k = 0; k < sources.scalars.size(); ++k)
        out.scalar[k] = store.get<Array<double>>(sources.scalars[k]);
    return out;
}
// Weighted sums over the particles around a vertex.
struct VertexSums {
    double weight = 0, velocity[3] = {0, 0, 0}, pressure = 0, liquids[most_liquids] = {}, scalars[most_scalars] = {};

    KOKKOS_INLINE_FUNCTION void add(const Particles& from, int row, double w) {
        weight += w;
        if (from.has_velocity) {
            for (int k = 0; k < 3; ++k) velocity[k] += w * from.velocity(row, k);
        }
        for (int k = 0; k < from.scalars; ++k) scalars[k] += w * from.scalar[k](row);
        if (from.has_pressure) pressure += w * from.pressure(row);
        if (from.has_liquid) liquids[math::min(math::max(from.liquid(row), 0), most_liquids - 1)] += w;
    }
    // The one with most weight.
    KOKKOS_INLINE_FUNCTION int liquid() const {
        int which = 0;
        for (int k = 1; k < most_liquids; ++k) {
            if (liquids[k] > liquids[which]) which = k;
        }
        return which;
    }
};

struct AttributeLoop {
    Particles from;
    Lattice lattice;
    Points points;
    double widths[2]; // of the kernel, the second where the first reaches nothing [m]
    int per_tile;
    std::int64_t vertices;
    Array<double> position, velocity, pressure, scalars;
    Array<int> liquid;

    KOKKOS_INLINE_FUNCTION void add_around(int v, double h, VertexSums& sums) const {
        const int dimensions = lattice.dimensions;
        double x[3] = {0, 0, 0}, to_h[3] = {0, 0, 0};
        int first[3] = {0, 0, 0}, last[3] = {0, 0, 0};
        for (int k = 0; k < dimensions; ++k) {
            x[k] = (position(3 * std::int64_t(v) + k) - lattice.grid.origin[k]) / lattice.step[k];
            to_h[k] = lattice.step[k] / h;
            const double support = 2 / to_h[k];
            first[k] = static_cast<int>(math::floor((x[k] - support) / 2));
            last[k] = static_cast<int>(math::floor((x[k] + support) / 2));
        }
        for (int bz = first[2]; bz <= last[2]; ++bz) {
            for (int by = first[1]; by <= last[1]; ++by) {
                for (int tx = first[0] >> 2; tx <= last[0] >> 2; ++tx) {
                    const int t[3] = {tx, by >> 2, dimensions == 3 ? bz >> 2 : 0};
                    if (!points.window.contains(t)) continue;
                    const int tile = points.tile(points.window.index(t[0], t[1], t[2]));
                    if (tile < 0) continue;
                    const int row =
                        tile * per_tile + bins_edge * ((by & 3) + bins_edge * (dimensions == 3 ? bz & 3 : 0));
                    const int begin = points.begin(row + math::max(first[0] - 4 * tx, 0));
                    const int end = points.begin(row + math::min(last[0] - 4 * tx, 3) + 1);
                    for (int i = begin; i < end; ++i) {
                        if (points.original(i) == 0) continue;
                        double w = cubic_spline((x[0] - points.position[0](i)) * to_h[0]) *
                                   cubic_spline((x[1] - points.position[1](i)) * to_h[1]);
                        if (dimensions == 3) w *= cubic_spline((x[2] - points.position[2](i)) * to_h[2]);
                        if (w != 0) sums.add(from, points.row(i), w);
                    }
                }
            }
        }
    }
    KOKKOS_INLINE_FUNCTION void operator()(int v) const {
        VertexSums sums;
        for (int attempt = 0; attempt < 2 && sums.weight == 0; ++attempt) add_around(v, widths[attempt], sums);
        const double sum = sums.weight;
        for (int k = 0; k < 3; ++k) velocity(3 * std::int64_t(v) + k) = sum > 0 ? sums.velocity[k] / sum : 0;
        for (int k = 0; k < from.scalars; ++k) scalars(k * vertices + v) = sum > 0 ? sums.scalars[k] / sum : 0;
        pressure(v) = sum > 0 ? sums.pressure / sum : 0;
        liquid(v) = sums.liquid();
    }
};
} // namespace

void Attributes::interpolate(const Patch& patch, const SourceParticles& sources, const Lattice& lattice,
    const Points& points, const Options& options) {
    const auto n = static_cast<std::size_t>(patch.vertices);
    reserve(velocity_, 3 * n);
    reserve(pressure_, n);
    reserve(liquid_, n);
    reserve(scalars_, sources.fields.scalars.size() * n);
    const AttributeLoop loop{views(sources.store, sources.fields), lattice, points,
        {0.8 * options.spacing, options.kernel_width * options.spacing}, lattice.bins_per_tile(), patch.vertices,
        patch.position, velocity_, pressure_, scalars_, liquid_};
    Kokkos::parallel_for("treacle::surface_attributes", patch.vertices, loop);
}

} // namespace treacle::surface
