#include "grid/viscosity/wall_momentum.hpp"

#include "grid/viscosity/viscous_parts.hpp"

namespace treacle::grid {

namespace {
constexpr double least_solid = 1e-6; // share of a face's cube

struct LossLoop {
    using value_type = double[];
    using size_type = std::size_t;
    size_type value_count; // 6 a solid
    MacGrid grid;
    CellBox owned;
    PressureFaces faces;
    FaceField wet, fluid, before, after;
    BodyFractions body_fractions[3];
    BodyMotion motion;
    ViscousFaces viscous;
    bool closed, solved, together;
    double mass; // of a full cube [kg], of a 2D scene [kg/m]

    KOKKOS_INLINE_FUNCTION void init(value_type sum) const {
        for (size_type k = 0; k < value_count; ++k) sum[k] = 0;
    }
    KOKKOS_INLINE_FUNCTION void join(value_type sum, const value_type other) const {
        for (size_type k = 0; k < value_count; ++k) sum[k] += other[k];
    }
    // Mass of the liquid at a face that solids constrain, over that of a full cube.
    KOKKOS_INLINE_FUNCTION double constrained_fraction(int a, std::size_t i) const {
        const bool is_closed = !(faces.open(a, i) > 0);
        if (is_closed != closed) return 0;
        if (closed) {
            const int role = solved ? viscous.role[a](i) : int(inactive_face);
            const bool counted =
                role == prescribed_face || (together && role == unknown_face && viscous.mass.axis[a](i) > 0);
            return counted ? 0.0 : wet.axis[a](i);
        }
        const double fraction = faces.effective_area_fraction(a, i);
        return fraction < 0 ? 0.0 : wet.axis[a](i) - fraction;
    }
    KOKKOS_INLINE_FUNCTION void operator()(int n, value_type sum) const {
        int c[3];
        owned.cell(n, c);
        const auto i = static_cast<std::size_t>(faces.window.index(c[0], c[1], c[2]));
        for (int a = 0; a < faces.dimensions; ++a) {
            const double solid = 1 - fluid.axis[a](i), change = before.axis[a](i) - after.axis[a](i);
            if (!(solid > least_solid) || body_fractions[a].first(i) == body_fractions[a].first(i + 1) || change == 0)
                continue;
            const double lost = mass * constrained_fraction(a, i) * change / solid;
            double x[3], arm[3];
            grid.face(a, c, x);
            for (int k = body_fractions[a].first(i); k < body_fractions[a].first(i + 1); ++k) {
                motion.arm(body_fractions[a].body(k), x, arm);
                add_load(a, arm, body_fractions[a].fraction(k) * lost, sum + 6 * body_fractions[a].body(k));
            }
        }
    }
};
} // namespace

void WallMomentum::add(const Scene& scene, Which which, const FaceField& velocity) {
    if (scene.owned.empty()) return;
    const auto& body_fractions = scene.resting.body_fractions();
    LossLoop loop{lost_.size(), scene.grid, scene.owned, scene.faces, scene.fractions.face_liquid_clipped,
        scene.fractions.face_fluid, before_, velocity, {body_fractions[0], body_fractions[1], body_fractions[2]},
        scene.resting.motion(), scene.viscous ? *scene.viscous : ViscousFaces(), which == Which::closed,
        scene.viscous != nullptr, scene.together, scene.density * cube_volume(scene.grid)};
    std::vector<double> sums(lost_.size(), 0.0);
    using Sums = Kokkos::View<double*, Kokkos::HostSpace, Kokkos::MemoryTraits<Kokkos::Unmanaged>>;
    Kokkos::parallel_reduce(
        "treacle::wall_momentum", static_cast<int>(scene.owned.size()), loop, Sums(sums.data(), sums.size()));
    for (std::size_t k = 0; k < sums.size(); ++k) lost_[k] += sums[k];
}

std::vector<double> WallMomentum::loads(const Comm& comm, double dt) const {
    auto out = lost_;
    comm.sum(std::span(out));
    for (double& load : out) load /= dt;
    return out;
}

} // namespace treacle::grid
