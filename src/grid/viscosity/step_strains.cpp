#include "grid/viscosity/step_strains.hpp"

namespace treacle::grid {

namespace {
constexpr double most_turn = 0.5;     // of a solid's normal over a cell, up to which its surface is resolved
constexpr double least_square = 0.25; // of the slope of a distance, below which it is that of no surface

KOKKOS_INLINE_FUNCTION int pair_of(int a, int b) { return a == b ? a : a + b == 1 ? 3 : a + b == 3 ? 4 : 5; }

// dt/2, such that (dt/2) sym(L^2) is exact for a rotation by the angle 2 atan(t), with t^2 = dt^2 |L|^2 / 8; less where paths bend
// by themselves.
KOKKOS_INLINE_FUNCTION double half_step(const SmallMatrix& middle, double dt) {
    return 0.5 * dt / (1 + dt * dt * middle.squares() / 8) * (1 - bending_weight(middle, dt));
}

KOKKOS_INLINE_FUNCTION void strains_of(const SmallMatrix& square, double factor, double out[6]) {
    for (int a = 0; a < 3; ++a) {
        for (int b = a; b < 3; ++b) out[pair_of(a, b)] = 0.5 * factor * (square.at[a][b] + square.at[b][a]);
    }
}

struct CentreLoop {
    MacGrid grid;
    CellBox window, box;
    std::ptrdiff_t stride[3];
    FaceField velocity, mass;
    Array<double> fluid;
    Array<int> number;
    DistanceSampler solid;
    BodyMotion motion;
    double before, dt;
    Array<double> slip;
    Array<double> out[6], path[6];

    KOKKOS_INLINE_FUNCTION bool sticks(int solid) const {
        return solid == Solids::nothing || !(slip(Solids::slot(solid)) > 0);
    }

    // u_a rises by this from face i to face j, over dx; false where particles reach only one of them.
    KOKKOS_INLINE_FUNCTION bool rise(int a, std::ptrdiff_t i, std::ptrdiff_t j, double& sum) const {
        if (!(mass.axis[a](i) > 0) || !(mass.axis[a](j) > 0)) return false;
        sum += (velocity.axis[a](j) - velocity.axis[a](i)) / grid.dx;
        return true;
    }
    KOKKOS_INLINE_FUNCTION SmallMatrix gradient(std::ptrdiff_t i) const {
        SmallMatrix out;
        for (int a = 0; a < grid.dimensions; ++a) {
            for (int b = 0; b < grid.dimensions; ++b) {
                double sum = 0;
                int count = 0;
                if (a == b) {
                    count = rise(a, i, i + stride[a], sum) ? 1 : 0;
                } else {
                    for (int corner = 0; corner < 4; ++corner) {
                        const auto upper = i + (corner & 1 ? stride[a] : 0) + (corner & 2 ? stride[b] : 0);
                        count += rise(a, upper - stride[b], upper, sum) ? 1 : 0;
                    }
                }
                out.at[a][b] = count > 0 ? sum / count : 0.0;
            }
        }
        return out;
    }
    // Mean velocity of a cell's faces that particles reach.
    KOKKOS_INLINE_FUNCTION void mean(std::ptrdiff_t i, double u[3]) const {
        for (int a = 0; a < 3; ++a) {
            u[a] = 0;
            int count = 0;
            for (int side = 0; side < 2 && a < grid.dimensions; ++side) {
                const auto j = i + side * stride[a];
                if (!(mass.axis[a](j) > 0)) continue;
                u[a] += velocity.axis[a](j);
                ++count;
            }
            u[a] /= count > 0 ? count : 1;
        }
    }
    // Velocities of the liquid in cell c against the centre of a solid and against the solid there, and the solid's spin.
    struct Passing {
        double off[3], past[3], spin[3] = {0, 0, 0};

        KOKKOS_INLINE_FUNCTION double swept(const double v[3], int a) const { // spin x v
            const int b = (a + 1) % 3, d = (a + 2) % 3;
            return spin[b] * v[d] - spin[d] * v[b];
        }
    };
    KOKKOS_INLINE_FUNCTION Passing passing(int of, const double x[3], std::ptrdiff_t i) const {
        double u[3], moved[3];
        mean(i, u);
        motion.velocity(of, x, moved, false);
        Passing out;
        for (int k = 0; k < 3; ++k) {
            const double centre = of >= 0 ? motion.frame(BodyMotion::width * of + 3 + k) : 0.0;
            out.spin[k] = of >= 0 ? motion.frame(BodyMotion::width * of + 6 + k) : 0.0;
            out.off[k] = u[k] - centre;
            out.past[k] = u[k] - moved[k];
        }
        return out;
    }
    // a across a surface of normal n, which is made one, by how the surface turns and is bent; false where the cells do not resolve that.
    KOKKOS_INLINE_FUNCTION bool bend_across(const Passing& liquid, const double x[3], double n[3], double& sum) const {
        double turns[3][3], square = 0, curvature = 0;
        solid.gradient(x, n);
        solid.second_derivatives(x, turns);
        for (int a = 0; a < 3; ++a) {
            square += n[a] * n[a];
            for (int k = 0; k < 3; ++k) curvature += turns[a][k] * turns[a][k];
        }
        if (!(square > least_square) || !(curvature * grid.dx * grid.dx < most_turn * most_turn)) return false;
        const double size = math::sqrt(square);
        sum = 0;
        for (int a = 0; a < 3; ++a) {
            n[a] /= size;
            sum += n[a] * (liquid.swept(liquid.off, a) + liquid.swept(liquid.past, a));
            for (int k = 0; k < 3; ++k) sum -= liquid.past[a] * turns[a][k] * liquid.past[k] / size;
        }
        return true;
    }
    // dt a/2 beside a solid. Around edges from the gradient of the liquid's velocity, which may go on straight there.
    KOKKOS_INLINE_FUNCTION void bend_along(
        int of, const int c[3], const SmallMatrix& middle, double factor, std::ptrdiff_t i) const {
        double x[3], n[3], across = 0;
        grid.centre(c, x);
        const auto liquid = passing(of, x, i);
        const bool resolved = bend_across(liquid, x, n, across);
        for (int a = 0; a < grid.dimensions; ++a) {
            double sum = liquid.swept(liquid.off, a);
            for (int k = 0; k < 3; ++k) sum += middle.at[a][k] * liquid.past[k];
            path[a](i) = factor * (resolved ? across * n[a] : sum);
        }
    }
    KOKKOS_INLINE_FUNCTION void operator()(int n) const {
        int c[3];
        box.cell(n, c);
        const auto i = window.index(c[0], c[1], c[2]);
        double liquid[6], of_solid[6] = {0, 0, 0, 0, 0, 0};
        const auto middle = carried_gradient(gradient(i), -0.5 * before);
        const double factor = half_step(middle, dt);
        strains_of(middle.times(middle), factor, liquid);
        const int nearest = number(FineNodes::per_cell * i + (grid.dimensions == 2 ? 3 : 7));
        double fraction = fluid(i);
        if (fraction > 0 && fraction < 1) bend_along(nearest, c, middle, factor, i);
        if (!sticks(nearest)) fraction = 1;
        if (fraction < 1 && nearest >= 0) motion.strains(nearest, of_solid);
        for (int k = 0; k < 6; ++k) out[k](i) = fraction * liquid[k] + (1 - fraction) * of_solid[k];
        for (int a = 0; a < 3; ++a) path[3 + a](i) = liquid[a];
    }
};

// The mean of the centres around an edge, doubled.
struct EdgeLoop {
    CellBox window, box;
    std::ptrdiff_t first, second;
    Array<double> centre, out;

    KOKKOS_INLINE_FUNCTION void operator()(int n) const {
        int c[3];
        box.cell(n, c);
        const auto i = window.index(c[0], c[1], c[2]);
        out(i) = 0.5 * (centre(i) + centre(i - first) + centre(i - second) + centre(i - first - second));
    }
};

CellBox within(CellBox window, int layers, int dimensions) {
    for (int k = 0; k < dimensions; ++k) {
        window.lo[k] += layers;
        window.hi[k] -= layers;
    }
    return window;
}

void clear(Array<double>& array, std::size_t n) {
    reserve(array, n);
    Kokkos::deep_copy(array, 0.0);
}
} // namespace

void StepStrains::find(const Scene& scene) {
    const CellBox window = scene.halo.window();
    const int dimensions = scene.grid.dimensions;
    const auto n = static_cast<std::size_t>(window.size());
    for (auto& component : centre_) clear(component, n);
    for (auto& component : path_) clear(component, n);
    for (int e = dimensions == 2 ? 2 : 0; e < 3; ++e) clear(shear_.axis[e], n);
    if (scene.halo.owned().empty()) return;
    CentreLoop loop{scene.grid, window, within(window, 1, dimensions), {1, 1, 1}, scene.velocity, scene.mass,
        scene.fractions.cell_fluid, scene.solids.number(), scene.solids.sampler(), scene.solids.motion(), scene.before,
        scene.dt, scene.slip, {}, {}};
    for (int k = 1; k < 3; ++k) loop.stride[k] = loop.stride[k - 1] * (window.hi[k - 1] - window.lo[k - 1]);
    for (int k = 0; k < 6; ++k) loop.out[k] = centre_[k], loop.path[k] = path_[k];
    Kokkos::parallel_for("treacle::step_strains", static_cast<int>(loop.box.size()), loop);
    for (int a = 0; a < 3; ++a) normal_[a] = centre_[a];
    const CellBox inner = within(window, 2, dimensions);
    for (int e = dimensions == 2 ? 2 : 0; e < 3; ++e) {
        const int a = (e + 1) % 3, b = (e + 2) % 3;
        Kokkos::parallel_for("treacle::step_shear", static_cast<int>(inner.size()),
            EdgeLoop{window, inner, loop.stride[a], loop.stride[b], centre_[pair_of(math::min(a, b), math::max(a, b))],
                shear_.axis[e]});
    }
}

void StepStrains::add_flux(
    const MacGrid& grid, const CellHalo& halo, const FaceField& open, const Array<double>& inflow) const {
    const CellBox window = halo.window(), owned = halo.owned();
    std::ptrdiff_t stride[3] = {1, 1, 1};
    for (int k = 1; k < 3; ++k) stride[k] = stride[k - 1] * (window.hi[k - 1] - window.lo[k - 1]);
    for (int a = 0; a < grid.dimensions; ++a) {
        const auto area = open.axis[a], path = path_[a], rise = path_[3 + a];
        const auto step = stride[a];
        const double half = 0.5 * grid.dx;
        Kokkos::parallel_for(
            "treacle::bent_flux", static_cast<int>(owned.size()), KOKKOS_LAMBDA(int n) {
                int c[3];
                owned.cell(n, c);
                const int i = window.index(c[0], c[1], c[2]);
                const double lower = area(i), upper = area(i + step);
                inflow(i) -= (upper - lower) * path(i) + (upper + lower) * half * rise(i);
            });
    }
}

std::size_t StepStrains::bytes() const {
    std::size_t numbers = 0;
    for (const auto& component : path_) numbers += component.span();
    for (const auto& component : centre_) numbers += component.span();
    for (const auto& edge : shear_.axis) numbers += edge.span();
    return 8 * numbers;
}

} // namespace treacle::grid
