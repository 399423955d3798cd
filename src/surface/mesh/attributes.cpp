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
    for (std::size_t k = 0; k < sources.scalars.size(); ++k) out.scalar[k] = store.get<Array<double>>(sources.scalars[k]);
    return out;
}
} // namespace

void Attributes::interpolate(const Patch& patch, const ParticleStore& store, const Sources& sources,
                             const Lattice& lattice, const Points& points, const Options& options) {
    const auto n = static_cast<std::size_t>(patch.vertices);
    reserve(velocity_, 3 * n);
    reserve(pressure_, n);
    reserve(liquid_, n);
    reserve(scalars_, sources.scalars.size() * n);
    const auto from = views(store, sources);
    const auto position = patch.position, out_velocity = velocity_, out_pressure = pressure_;
    const auto out_scalars = scalars_;
    const std::int64_t vertices = patch.vertices;
    const auto out_liquid = liquid_;
    const auto l = lattice;
    const auto p = points;
    const auto px = p.place[0], py = p.place[1], pz = p.place[2];
    const int dimensions = lattice.dimensions, per_tile = lattice.bins_per_tile();
    const double widths[2] = {0.8 * options.spacing, options.kernel_width * options.spacing};
    Kokkos::parallel_for("treacle::surface_attributes", patch.vertices, KOKKOS_LAMBDA(int v) {
        double sum = 0, u[3] = {0, 0, 0}, pressure = 0, weights[most_liquids] = {}, scalars[most_scalars] = {};
        for (int attempt = 0; attempt < 2 && sum == 0; ++attempt) {
        double x[3] = {0, 0, 0}, to_h[3] = {0, 0, 0};
        const double h = widths[attempt];
        int first[3] = {0, 0, 0}, last[3] = {0, 0, 0};
        for (int k = 0; k < dimensions; ++k) {
            x[k] = (position(3 * std::int64_t(v) + k) - l.grid.origin[k]) / l.step[k];
            to_h[k] = l.step[k] / h;
            const double support = 2 / to_h[k];
            first[k] = static_cast<int>(math::floor((x[k] - support) / 2));
            last[k] = static_cast<int>(math::floor((x[k] + support) / 2));
        }
        for (int bz = first[2]; bz <= last[2]; ++bz) {
            for (int by = first[1]; by <= last[1]; ++by) {
                for (int tx = first[0] >> 2; tx <= last[0] >> 2; ++tx) {
                    const int t[3] = {tx, by >> 2, dimensions == 3 ? bz >> 2 : 0};
                    if (!p.window.contains(t)) continue;
                    const int tile = p.tile(p.window.index(t[0], t[1], t[2]));
                    if (tile < 0) continue;
                    const int row = tile * per_tile + bins_edge * ((by & 3) + bins_edge * (dimensions == 3 ? bz & 3 : 0));
                    const int begin = p.begin(row + math::max(first[0] - 4 * tx, 0));
                    const int end = p.begin(row + math::min(last[0] - 4 * tx, 3) + 1);
                    for (int i = begin; i < end; ++i) {
                        if (p.original(i) == 0) continue;
                        double w = cubic_spline((x[0] - px(i)) * to_h[0]) * cubic_spline((x[1] - py(i)) * to_h[1]);
                        if (dimensions == 3) w *= cubic_spline((x[2] - pz(i)) * to_h[2]);
                        if (w == 0) continue;
                        const int r = p.row(i);
                        sum += w;
                        if (from.has_velocity) {
                            for (int k = 0; k < 3; ++k) u[k] += w * from.velocity(r, k);
                        }
                        for (int k = 0; k < from.scalars; ++k) scalars[k] += w * from.scalar[k](r);
                        if (from.has_pressure) pressure += w * from.pressure(r);
                        if (from.has_liquid) weights[math::min(math::max(from.liquid(r), 0), most_liquids - 1)] += w;
                    }
                }
            }
        }
        }
        int which = 0;
        for (int k = 1; k < most_liquids; ++k) {
            if (weights[k] > weights[which]) which = k;
        }
        for (int k = 0; k < 3; ++k) out_velocity(3 * std::int64_t(v) + k) = sum > 0 ? u[k] / sum : 0;
        for (int k = 0; k < from.scalars; ++k) out_scalars(k * vertices + v) = sum > 0 ? scalars[k] / sum : 0;
        out_pressure(v) = sum > 0 ? pressure / sum : 0;
        out_liquid(v) = which;
    });
}

} // namespace treacle::surface
