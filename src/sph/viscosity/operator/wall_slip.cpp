#include "sph/viscosity/operator/wall_slip.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::sph {

namespace {
// A solid particle that less than this share of a lattice's liquid wets holds what there is less.
constexpr double least_wetting = 0.5;
// Particles are not taken to be nearer to a surface than that many spacings.
constexpr double least_height = 0.1;
// Fraction of a particle's volume, as in a corner of three walls.
constexpr double least_volume = 0.125;

template <class Kernel>
struct SlipLoop {
    Kernel kernel;
    Pairs pairs;
    MomentReferencePoints points;
    Array<double> slip, viscous_coefficient;
    Array<double> volume, wetting;
    Array<int> body;
    Array3 normal;
    double rest_volume, area, packing, depth, least, lowest;

    KOKKOS_INLINE_FUNCTION double weight(double r2) const { return -rest_volume * kernel.gradient(math::sqrt(r2)); }
    // visit(s, area, height) with the part of the solid particle's area that particle i has.
    template <class Visit>
    KOKKOS_INLINE_FUNCTION void each_area(int i, const Visit& visit) const {
        pairs.each(i, [&](int s, double dx, double dy, double dz, double r2) {
            if (slip(body(s)) == 0) return;
            const double own = volume(s) / (points.moves(body(s)) ? points.scale(body(s)) : packing);
            const double height = normal(s, 0) * dx + normal(s, 1) * dy + normal(s, 2) * dz - depth;
            visit(s, area * own * weight(r2) / math::max(wetting(s), least), math::max(height, lowest));
        });
    }
    // visit(s, c) with dt/m times the drag coefficient between particle i and the solid particle.
    template <class Visit>
    KOKKOS_INLINE_FUNCTION void each(int i, const Visit& visit) const {
        const double c = viscous_coefficient(i) / rest_volume;
        each_area(i, [&](int s, double part, double height) { visit(s, c * part / (slip(body(s)) + height)); });
    }
};

template <class Kernel>
struct WettingLoop : SlipLoop<Kernel> {
    using Base = SlipLoop<Kernel>;
    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        Base::pairs.each(i, [&](int s, double, double, double, double r2) {
            if (Base::slip(Base::body(s)) > 0) Kokkos::atomic_add(&Base::wetting(s), Base::weight(r2));
        });
    }
};

template <class Kernel>
struct DragLoop : SlipLoop<Kernel> {
    using Base = SlipLoop<Kernel>;
    Array<double> drag, rest; // what is left of the share
    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        double sum = 0, sheared = 0;
        Base::each(i, [&](int, double c) { sum += c; });
        Base::each_area(i, [&](int, double part, double height) { sheared += part * height; });
        drag(i) = sum;
        rest(i) *= math::max(1 - sheared / Base::rest_volume, least_volume);
    }
};

template <class Kernel>
struct SlipForceLoop : SlipLoop<Kernel> {
    using Base = SlipLoop<Kernel>;
    Array4 u;
    Array<double> motion;
    Array3 product;
    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        const auto& x = Base::pairs.of;
        const double position[3] = {x(i, 0), x(i, 1), x(i, 2)};
        double sum[3] = {0, 0, 0};
        Base::each(i, [&](int s, double c) {
            double wall[3];
            Base::points.velocity(motion, Base::body(s), position, wall);
            for (int k = 0; k < 3; ++k) sum[k] += c * (u(i, k) - wall[k]);
        });
        for (int k = 0; k < 3; ++k) product(i, k) += sum[k];
    }
};

template <class Kernel>
struct SlipLoadLoop : SlipLoop<Kernel>, LoadReduction {
    using Base = SlipLoop<Kernel>;
    Array4 u;
    Array<double> motion;
    double scale;
    KOKKOS_INLINE_FUNCTION void operator()(int i, value_type sum) const {
        const auto& x = Base::pairs.of;
        const double position[3] = {x(i, 0), x(i, 1), x(i, 2)};
        Base::each(i, [&](int s, double c) {
            const int body = Base::body(s);
            double wall[3], force[3];
            Base::points.velocity(motion, body, position, wall);
            for (int k = 0; k < 3; ++k) force[k] = scale * c * (u(i, k) - wall[k]);
            Base::points.add(sum + 6 * body, body, position, force);
        });
    }
};

template <class Kernel>
struct SlipStiffnessLoop : SlipLoop<Kernel>, LoadReduction {
    using Base = SlipLoop<Kernel>;
    KOKKOS_INLINE_FUNCTION void operator()(int i, value_type sum) const {
        const auto& x = Base::pairs.of;
        const double position[3] = {x(i, 0), x(i, 1), x(i, 2)};
        Base::each(i, [&](int s, double c) { Base::points.add_stiffness(sum, Base::body(s), position, c); });
    }
};

// Calls work(loop) with the common part of the loops.
template <class Work>
void with_slip(const ViscousScene& scene, const MomentReferencePoints& points, const Array<double>& slip,
    const Array<double>& viscous_coefficient, const Work& work) {
    const auto& c = scene.constants;
    const auto& solid = scene.solid;
    const double area = std::pow(c.spacing, c.dimensions - 1) / c.wall_volume;
    with_kernel(scene.options.kernel, c.dimensions, c.support, [&](const auto& kernel) {
        using Kernel = std::decay_t<decltype(kernel)>;
        work(SlipLoop<Kernel>{kernel, pairs(scene.neighbours.solid, scene.liquid.store, solid.store), points, slip,
            viscous_coefficient, solid.volume(), solid.wetting(), solid.body(), solid.normal(), c.rest_volume, area,
            c.wall_packing, c.wall_depth, least_wetting * c.wall_kernel_sum, least_height * c.spacing});
    });
}
} // namespace

WallSlip::WallSlip(const std::vector<double>& lengths)
    : any_(std::ranges::any_of(lengths, [](double b) { return b > 0; })), slip_(upload(lengths)) {}

void WallSlip::prepare(
    const ViscousScene& scene, const MomentReferencePoints& points, const Array<double>& viscous_coefficient) {
    if (!any_) return;
    points_ = points;
    const int n = scene.liquid.store.owned();
    reserve(viscous_coefficient_, static_cast<std::size_t>(n));
    const auto rows = Kokkos::make_pair(0, n);
    Kokkos::deep_copy(Kokkos::subview(viscous_coefficient_, rows), Kokkos::subview(viscous_coefficient, rows));
    const auto& store = scene.solid.store;
    Kokkos::deep_copy(scene.solid.wetting(), 0.0);
    with_slip(scene, points_, slip_, viscous_coefficient_, [&](const auto& loop) {
        using Kernel = std::decay_t<decltype(loop.kernel)>;
        Kokkos::parallel_for("treacle::wall_kernel_sum", n, WettingLoop<Kernel>{loop});
    });
    if (scene.solid_halo) {
        scene.solid_halo->scatter(store, {scene.solid.wetting_field()});
        scene.solid_halo->gather(store, {scene.solid.wetting_field()});
    }
    reserve(drag_, static_cast<std::size_t>(n));
    with_slip(scene, points_, slip_, viscous_coefficient_, [&](const auto& loop) {
        using Kernel = std::decay_t<decltype(loop.kernel)>;
        Kokkos::parallel_for("treacle::wall_drag", n, DragLoop<Kernel>{loop, drag_, viscous_coefficient});
    });
}

void WallSlip::add(const ViscousScene& scene, const Array3& product) const {
    const auto drag = drag_;
    const auto u = scene.liquid.motion;
    Kokkos::parallel_for(
        "treacle::wall_slip", scene.liquid.store.owned(), KOKKOS_LAMBDA(int i) {
            for (int k = 0; k < 3; ++k) product(i, k) += drag(i) * u(i, k);
        });
}

void WallSlip::add(const ViscousScene& scene, const Array<double>& motion, const Array3& product) const {
    with_slip(scene, points_, slip_, viscous_coefficient_, [&](const auto& loop) {
        using Kernel = std::decay_t<decltype(loop.kernel)>;
        Kokkos::parallel_for("treacle::moving_wall_slip", scene.liquid.store.owned(),
            SlipForceLoop<Kernel>{loop, scene.liquid.motion, motion, product});
    });
}

void WallSlip::add_loads(const ViscousScene& scene, const Array<double>& motion, double scale, BodyLoads& loads) const {
    BodyLoads own(loads.size(), 0.0);
    with_slip(scene, points_, slip_, viscous_coefficient_, [&](const auto& loop) {
        using Kernel = std::decay_t<decltype(loop.kernel)>;
        Kokkos::parallel_reduce("treacle::wall_slip_loads", scene.liquid.store.owned(),
            SlipLoadLoop<Kernel>{loop, {own.size()}, scene.liquid.motion, motion, scale}, host_sums(own));
    });
    for (std::size_t k = 0; k < loads.size(); ++k) loads[k] += own[k];
}

void WallSlip::add_stiffness(const ViscousScene& scene, std::vector<double>& stiffness) const {
    std::vector<double> own(stiffness.size(), 0.0);
    with_slip(scene, points_, slip_, viscous_coefficient_, [&](const auto& loop) {
        using Kernel = std::decay_t<decltype(loop.kernel)>;
        Kokkos::parallel_reduce("treacle::wall_slip_stiffness", scene.liquid.store.owned(),
            SlipStiffnessLoop<Kernel>{loop, {own.size()}}, host_sums(own));
    });
    for (std::size_t k = 0; k < stiffness.size(); ++k) stiffness[k] += own[k];
}

} // namespace treacle::sph
