#include "sph/pressure/solid_rows.hpp"

#include "kokkos/scan.hpp"
#include "sph/pressure/laplacian.hpp"
#include "sph/pressure/pressure_system.hpp"
#include "sph/pressure/row_writer.hpp"

namespace treacle::sph {

namespace {
// Role, diagonal and hold of a solid particle.
template <class Kernel>
struct SolidRoleLoop {
    LaplacianWeight<Kernel> laplacian;
    Pairs liquid, solid;
    Array<double> solid_volume, diagonal;
    Array<int> liquid_role, role;

    KOKKOS_INLINE_FUNCTION void operator()(int s, std::int64_t& count) const {
        double sum = 0;
        bool wet = false;
        liquid.each(s, [&](int i, double, double, double, double r2) {
            sum += laplacian.weight(solid_volume(s) + laplacian.volume(i), r2, math::sqrt(r2));
            wet = wet || liquid_role(i) == Role::poisson;
        });
        solid.each(s, [&](int t, double, double, double, double r2) {
            sum += laplacian.weight(solid_volume(s) + solid_volume(t), r2, math::sqrt(r2));
        });
        role(s) = wet ? Role::poisson : Role::dirichlet;
        diagonal(s) = sum;
        count += static_cast<std::int64_t>(wet);
    }
};

// The fraction of its diagonal by which an unknown solid particle is coupled to particles at p = 0.
template <class Kernel>
struct SolidDirichletLoop {
    LaplacianWeight<Kernel> laplacian;
    Pairs liquid, solid;
    Array<double> solid_volume, diagonal, dirichlet_fraction;
    Array<int> liquid_role, role;

    KOKKOS_INLINE_FUNCTION void operator()(int s) const {
        double sum = 0;
        liquid.each(s, [&](int i, double, double, double, double r2) {
            if (liquid_role(i) == Role::poisson) return;
            sum += laplacian.weight(solid_volume(s) + laplacian.volume(i), r2, math::sqrt(r2));
        });
        solid.each(s, [&](int t, double, double, double, double r2) {
            if (role(t) == Role::poisson) return;
            sum += laplacian.weight(solid_volume(s) + solid_volume(t), r2, math::sqrt(r2));
        });
        dirichlet_fraction(s) = role(s) == Role::poisson ? sum / diagonal(s) : 1.0;
    }
};

template <class Kernel>
struct LiquidDirichletLoop {
    LaplacianWeight<Kernel> laplacian;
    Pairs solid;
    Array<double> solid_volume, dirichlet_fraction, wall_term;

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        double sum = 0;
        solid.each(i, [&](int s, double, double, double, double r2) {
            sum += dirichlet_fraction(s) * laplacian.weight(laplacian.volume(i) + solid_volume(s), r2, math::sqrt(r2));
        });
        wall_term(i) += sum;
    }
};

// One row of the joint system, of a liquid or a solid particle. Both ends of a pair compute the same a_ij: the sum of
// the volumes and the square of the distance do not depend on the order.
template <class Kernel>
struct JointLoop {
    LaplacianWeight<Kernel> laplacian;
    Pairs liquid, solid; // around the particles whose rows these are
    Array<int> row, liquid_row, solid_row;
    Array<double> volume, solid_volume;
    PressureSystem::Block own, other;
    Array<double> diagonal;
    PressureSystem::HaloColumnMap column_map;
    int first, rows;

    KOKKOS_INLINE_FUNCTION bool mine(int column) const { return column >= first && column < first + rows; }

    template <class Visit>
    KOKKOS_INLINE_FUNCTION void each_unknown(int i, const Visit& visit) const {
        liquid.each(i, [&](int j, double, double, double, double r2) {
            if (liquid_row(j) >= 0) visit(liquid_row(j), laplacian.volume(j), r2);
        });
        solid.each(i, [&](int s, double, double, double, double r2) {
            if (solid_row(s) >= 0) visit(solid_row(s), solid_volume(s), r2);
        });
    }
    KOKKOS_INLINE_FUNCTION void count(int i) const {
        if (row(i) < 0) return;
        int here = 1, there = 0; // the diagonal
        each_unknown(i, [&](int column, double, double) { ++(mine(column) ? here : there); });
        own.offset(row(i) - first) = here;
        other.offset(row(i) - first) = there;
    }
    KOKKOS_INLINE_FUNCTION void fill(int i) const {
        if (row(i) < 0) return;
        const int r = row(i) - first;
        RowWriter here{own.column.data() + own.offset(r), own.value.data() + own.offset(r)};
        RowWriter there{other.column.data() + other.offset(r), other.value.data() + other.offset(r)};
        here.add(r, diagonal(i));
        each_unknown(i, [&](int c, double v, double r2) {
            const double a = -laplacian.weight(volume(i) + v, r2, math::sqrt(r2));
            if (mine(c)) {
                here.add(c - first, a);
            } else {
                there.add(column_map(c), a);
            }
        });
    }
};

// By themselves, since nvcc takes no kernel in a generic lambda.
template <class Kernel>
void count_rows(const char* label, int size, const JointLoop<Kernel>& loop) {
    Kokkos::parallel_for(
        label, size, KOKKOS_LAMBDA(int i) { loop.count(i); });
}
template <class Kernel>
void fill_rows(const char* label, int size, const JointLoop<Kernel>& loop) {
    Kokkos::parallel_for(
        label, size, KOKKOS_LAMBDA(int i) { loop.fill(i); });
}

int number(const Array<int>& role, const Array<int>& row, int n, int first) {
    int rows = 0;
    Kokkos::parallel_scan(
        "treacle::number_joint_rows", n,
        KOKKOS_LAMBDA(int i, int& sum, bool last) {
            const bool unknown = role(i) == Role::poisson;
            if (last) row(i) = unknown ? first + sum : -1;
            sum += static_cast<int>(unknown);
        },
        rows);
    return rows;
}

// Guess and source of the rows of a store.
void write_vectors(int n, int first, const Array<int>& row, const Array<double>& pressure, const Array<double>& guess) {
    Kokkos::parallel_for(
        "treacle::joint_guess", n, KOKKOS_LAMBDA(int i) {
            if (row(i) >= 0) guess(row(i) - first) = pressure(i);
        });
}
} // namespace

std::int64_t SolidRows::predict(const SphOptions& options, const Constants& constants,
    LiquidParticles& liquid_particles, SolidParticles& solid_particles, const Neighbourhood& neighbours,
    Halo& solid_halo) const {
    const auto& l = liquid_particles;
    const auto& s = solid_particles;
    const auto wet = pairs(liquid, s.store, l.store), dry = pairs(solid, s.store, s.store);
    std::int64_t unknowns = 0;
    with_kernel(options.kernel, constants.dimensions, constants.support, [&](const auto& kernel) {
        using Kernel = std::decay_t<decltype(kernel)>;
        const auto laplacian = laplacian_weight(kernel, constants, l);
        Kokkos::parallel_reduce("treacle::solid_roles", s.store.owned(),
            SolidRoleLoop<Kernel>{laplacian, wet, dry, s.volume(), s.diagonal(), l.role(), s.role()}, unknowns);
        solid_halo.gather(s.store, {s.role_field()});
        Kokkos::parallel_for("treacle::solid_dirichlet_fractions", s.store.owned(),
            SolidDirichletLoop<Kernel>{
                laplacian, wet, dry, s.volume(), s.diagonal(), s.dirichlet_fraction(), l.role(), s.role()});
        solid_halo.gather(s.store, {s.dirichlet_fraction_field()});
        Kokkos::parallel_for("treacle::liquid_dirichlet_fractions", l.store.owned(),
            LiquidDirichletLoop<Kernel>{laplacian, pairs(neighbours.solid, l.store, s.store), s.volume(),
                s.dirichlet_fraction(), l.wall_term()});
    });
    return unknowns;
}

void PressureSystem::number_joint_rows(const Comm& comm, const CoupledParticles& joint) {
    const auto& l = joint.liquid;
    const auto& s = joint.solid;
    const int n = l.store.owned(), walls = s.store.owned();
    const int wet = number(l.role(), l.row(), n, 0);
    rows_ = wet + number(s.role(), s.row(), walls, 0);
    first_row_ = comm.exclusive_sum(static_cast<std::int64_t>(rows_));
    global_rows_ = comm.sum(static_cast<std::int64_t>(rows_));
    number(l.role(), l.row(), n, static_cast<int>(first_row_));
    number(s.role(), s.row(), walls, static_cast<int>(first_row_) + wet);
    joint.halo.gather(l.store, {l.row_field()});
    joint.solid_halo.gather(s.store, {s.row_field()});
}

void PressureSystem::assemble_with_solids(
    const SphOptions& options, const Constants& constants, const Comm& comm, const CoupledParticles& joint) {
    number_joint_rows(comm, joint);
    const auto& l = joint.liquid;
    const auto& s = joint.solid;
    connect_halo(comm, {{l.store, l.row()}, {s.store, s.row()}});
    const int n = l.store.owned(), walls = s.store.owned(), first = static_cast<int>(first_row_);
    const auto n_rows = static_cast<std::size_t>(rows_);
    for (auto* block : {&own_, &other_}) reserve(block->offset, n_rows + 1);
    reserve(right_hand_side_, n_rows);
    reserve(solution_, n_rows);
    with_kernel(options.kernel, constants.dimensions, constants.support, [&](const auto& kernel) {
        using Kernel = std::decay_t<decltype(kernel)>;
        const auto laplacian = laplacian_weight(kernel, constants, l);
        const auto rows_of_liquid = [&] {
            return JointLoop<Kernel>{laplacian, pairs(joint.neighbours.liquid, l.store, l.store),
                pairs(joint.neighbours.solid, l.store, s.store), l.row(), l.row(), s.row(), l.volume(), s.volume(),
                own_, other_, l.diagonal(), column_map_, first, rows_};
        };
        const auto rows_of_solid = [&] {
            return JointLoop<Kernel>{laplacian, pairs(joint.around.liquid, s.store, l.store),
                pairs(joint.around.solid, s.store, s.store), s.row(), l.row(), s.row(), s.volume(), s.volume(), own_,
                other_, s.diagonal(), column_map_, first, rows_};
        };
        count_rows("treacle::count_liquid_rows", n, rows_of_liquid());
        count_rows("treacle::count_solid_rows", walls, rows_of_solid());
        own_entries_ = counts_to_offsets(own_.offset, rows_);
        other_entries_ = counts_to_offsets(other_.offset, rows_);
        for (const auto& [block, entries] : {std::pair(&own_, own_entries_), std::pair(&other_, other_entries_)}) {
            reserve(block->column, static_cast<std::size_t>(entries));
            reserve(block->value, static_cast<std::size_t>(entries));
        }
        fill_rows("treacle::fill_liquid_rows", n, rows_of_liquid());
        fill_rows("treacle::fill_solid_rows", walls, rows_of_solid());
    });
    Kokkos::deep_copy(right_hand_side_, 0.0); // of solids: they are compressed by nothing but the terms of their rows
    write_vectors(n, first, l.row(), l.source(), right_hand_side_);
    write_vectors(n, first, l.row(), l.pressure(), solution_);
    write_vectors(walls, first, s.row(), s.pressure(), solution_);
}

void PressureSystem::store_solid_pressure(SolidParticles& solid) const {
    const auto row = solid.row();
    const auto p = solid.pressure(), x = solution_;
    const int first = static_cast<int>(first_row_);
    Kokkos::parallel_for(
        "treacle::store_solid_pressure", solid.store.owned(),
        KOKKOS_LAMBDA(int s) { p(s) = row(s) >= 0 ? math::max(0.0, x(row(s) - first)) : 0.0; });
}

} // namespace treacle::sph
