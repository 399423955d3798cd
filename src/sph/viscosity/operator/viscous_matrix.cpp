#include "sph/viscosity/operator/viscous_matrix.hpp"

#include "sph/model/rigid_motion.hpp"
#include "sph/model/symmetric.hpp"
#include "sph/viscosity/operator/viscous_loops.hpp"
#include "sph/viscosity/operator/viscous_rows.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::sph {

namespace {
double inner(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vec3 apply(const Symmetric& a, const Vec3& x) {
    Vec3 out;
    a.times(x.data(), out.data());
    return out;
}
void add_identity(double c, RowBlock& to) {
    for (std::size_t k = 0; k < 3; ++k) to[4 * k] += c;
}

// One particle in the sums of another one's stress: the force on it is Q e, and the gradient has u n^T of it.
struct Member {
    int particle;      // local number, ghosts included
    Vec3 force;        // e
    Vec3 pulled, seen; // B^+ e, B^+ n
};

// A neighbour in the sums of a particle beside another viscosity.
struct Neighbour {
    double w, h, x[3];
};

// The stress where only one neighbour's difference is u, or all are, those of the walls as well, if the particle itself moves.
void answer(const InterfaceLaw& law, const std::vector<Neighbour>& around, const Vec3& walls_pull, std::size_t moved,
    const double u[3], InterfaceStress& out) {
    InterfaceSums sums;
    const bool itself = moved == around.size();
    for (std::size_t k = 0; k < around.size(); ++k) {
        if (itself || k == moved) sums.add(around[k].w, around[k].h, law.shape.normal, around[k].x, u);
    }
    for (int k = 0; k < 3 && itself; ++k) {
        for (std::size_t l = 0; l < 3; ++l) sums.n[k][l] += u[k] * walls_pull[l];
    }
    double strained[3][3];
    law(sums, strained, out);
}
} // namespace

// On the host.
struct ViscousMatrix::Assembly {
    const ViscousContext& parts;
    const ViscousOperator& of;
    ViscosityForm form;
    Pairs liquid;
    ViscousWalls walls;
    Array<int>::HostMirror row;
    Array<double>::HostMirror viscous_coefficient, volume;
    Array6::HostMirror correction;
    Array<float>::HostMirror weights;
    Array<int>::HostMirror liquid_of;
    bool several;              // viscosities, where gradients are corrected
    Array3::HostMirror normal; // see ViscousInterface
    int owned, total;
    int first; // global number of this rank's first row
    std::vector<std::size_t> offsets;
    std::vector<Member> members;                           // of the stress of each owned particle
    std::vector<std::vector<std::pair<int, int>>> seen_by; // (whose stress, which member) of each particle
    // Derivatives, for the owned particles beside another viscosity, of the force on each member by the velocity of each, but for what
    // add_pairs() has of the pairs within their liquid; of all others none.
    std::vector<std::vector<RowBlock>> beside;
    std::vector<RowContribution> contributions; // to rows from elsewhere

    double contrast(int i, int j) const {
        return several && liquid_of(i) != liquid_of(j)
                   ? viscous_contrast(viscous_coefficient(i), viscous_coefficient(j))
                   : 0;
    }
    // 0 where blocks_beside() has what the stress of i does to the pair.
    double coefficient_within(int i, int j) const {
        return contrast(i, j) != 0 && is_normal(normal(i, 0), normal(i, 1), normal(i, 2)) ? 0 : viscous_coefficient(i);
    }
    template <class Visit>
    void each_pair(int i, const Visit& visit) const {
        std::int64_t k = liquid.offset(i);
        liquid.each(i, [&](int j, double dx, double dy, double dz, double) {
            visit(static_cast<double>(weights(k++)), j, dx, dy, dz);
        });
    }

    template <class Kernel>
    void find_members(const Kernel& kernel);
    void find_beside();
    std::vector<RowBlock> blocks_beside(int i, const InterfaceLaw& law) const;
    template <class Kernel>
    void add_pairs(const Kernel& kernel, int i, RowStorage& storage) const;
    void add_stresses(int i, RowStorage& storage) const;
    template <class Kernel>
    solve::BlockRows rows(const Kernel& kernel);
};

template <class Kernel>
void ViscousMatrix::Assembly::find_members(const Kernel& kernel) {
    const double rest = parts.constants.rest_volume;
    offsets.assign(1, 0);
    members.clear();
    seen_by.assign(static_cast<std::size_t>(total), {});
    for (int i = 0; i < owned; ++i) {
        const Symmetric fit = read_symmetric(correction, i);
        Vec3 force{0, 0, 0}, slope{0, 0, 0};
        const auto enter = [&](int particle, const Vec3& e, const Vec3& n) {
            auto& seen = seen_by[static_cast<std::size_t>(particle)];
            seen.emplace_back(i, static_cast<int>(members.size() - offsets.back()));
            members.push_back({particle, e, apply(fit, e), apply(fit, n)});
        };
        each_pair(i, [&](double w, int j, double dx, double dy, double dz) {
            const double volume_ratio = form == ViscosityForm::as_published ? volume(j) / rest : 1;
            const Vec3 e{w * dx, w * dy, w * dz};
            Vec3 to_other, slope_of_other;
            for (std::size_t k = 0; k < 3; ++k) {
                force[k] += e[k];
                slope[k] += volume_ratio * e[k];
                to_other[k] = -e[k];
                slope_of_other[k] = -volume_ratio * e[k];
            }
            enter(j, to_other, slope_of_other);
        });
        walls.pairs.each(i, [&](int s, double dx, double dy, double dz, double r2) {
            if (!walls.no_slip(s)) return;
            const double w = -walls.viscous_factor * walls.volume(s) * kernel.gradient(std::sqrt(r2)) *
                             walls.touch(s, dx, dy, dz).beta;
            const Vec3 x{dx, dy, dz};
            for (std::size_t k = 0; k < 3; ++k) {
                force[k] += w * x[k];
                slope[k] += w * x[k];
            }
        });
        enter(i, force, slope);
        offsets.push_back(members.size());
    }
}

void ViscousMatrix::Assembly::find_beside() {
    const ViscousInterface& between = of.interface();
    beside.assign(static_cast<std::size_t>(owned), {});
    if (between.count == 0) return;
    const auto rows_of = on_host(between.rows);
    const auto shapes = on_host(between.shapes);
    for (int row = 0; row < between.count; ++row) {
        const int i = rows_of(row);
        const InterfaceShape shape = read_shape(shapes, row);
        if (!shape.has_normal()) continue;
        const InterfaceLaw law{shape, read_symmetric(correction, i), viscous_coefficient(i), of.damping()};
        beside[static_cast<std::size_t>(i)] = blocks_beside(i, law);
    }
}

// The law's forces for unit velocities of the members, in the order of find_members(): the neighbours, then i.
std::vector<RowBlock> ViscousMatrix::Assembly::blocks_beside(int i, const InterfaceLaw& law) const {
    std::vector<Neighbour> around;
    Vec3 walls_pull = members[offsets[static_cast<std::size_t>(i) + 1] - 1].force; // less the liquid's part of sum w x
    each_pair(i, [&](double w, int j, double dx, double dy, double dz) {
        around.push_back({w, contrast(i, j), {dx, dy, dz}});
        for (std::size_t k = 0; k < 3; ++k) walls_pull[k] -= w * around.back().x[k];
    });
    const std::size_t own = around.size(), count = own + 1;
    std::vector<RowBlock> out(count * count);
    for (std::size_t moved = 0; moved < count; ++moved) {
        for (std::size_t l = 0; l < 3; ++l) {
            const auto add = [&](std::size_t member, const double force[3]) {
                for (std::size_t k = 0; k < 3; ++k) out[member * count + moved][3 * k + l] += force[k];
            };
            double u[3] = {0, 0, 0}, pulled[3];
            u[l] = moved == own ? 1 : -1;
            InterfacePull pull{};
            answer(law, around, walls_pull, moved, u, pull.stress);
            std::copy(std::begin(law.shape.normal), std::end(law.shape.normal), std::begin(pull.normal));
            times(pull.stress.q, walls_pull.data(), pulled);
            add(own, pulled);
            for (std::size_t k = 0; k < own; ++k) {
                const double still[3] = {0, 0, 0};
                double force[3] = {0, 0, 0};
                pull.damping = around[k].h != 0 ? law.damping * law.viscous_coefficient : 0;
                pull.add(around[k].w, around[k].h, around[k].x, moved == own || moved == k ? u : still, force);
                add(own, force);
                for (double& f : force) f = -f;
                add(k, force);
            }
        }
    }
    return out;
}

// What acts between two particles without a stress: the forms by pairs, and the damping of checkerboards.
template <class Kernel>
void ViscousMatrix::Assembly::add_pairs(const Kernel& kernel, int i, RowStorage& storage) const {
    const auto& constants = parts.constants;
    const double soft = pair_softening(constants.support);
    const auto pair = [&](double coefficients, double w, const Vec3& x) {
        RowBlock out{};
        const double r2 = inner(x, x);
        if (by_gradients(form)) {
            add_identity(of.damping() * coefficients * w, out);
        } else if (form == ViscosityForm::laplacian) {
            add_identity(coefficients * w * r2 / (r2 + soft), out);
        } else {
            const double c = (constants.dimensions + 2) * coefficients * w / (r2 + soft);
            for (std::size_t k = 0; k < 9; ++k) out[k] = c * x[k / 3] * x[k % 3];
        }
        return out;
    };
    const auto add = [](const RowBlock& from, double sign, RowBlock& to) {
        for (std::size_t k = 0; k < 9; ++k) to[k] += sign * from[k];
    };
    add_identity(relative_density(constants, parts.liquid)(i), storage.at(i));
    each_pair(i, [&](double w, int j, double dx, double dy, double dz) {
        const RowBlock one = pair(coefficient_within(i, j) + coefficient_within(j, i), w, {dx, dy, dz});
        add(one, 1, storage.at(i));
        add(one, -1, storage.at(j));
    });
    walls.pairs.each(i, [&](int s, double dx, double dy, double dz, double r2) {
        if (!walls.no_slip(s)) return;
        const double w = -walls.viscous_factor * walls.volume(s) * kernel.gradient(std::sqrt(r2));
        const double beta = walls.touch(s, dx, dy, dz).beta;
        const bool squared = by_gradients(form);
        add(pair((squared ? 1 : 2) * viscous_coefficient(i), w * beta * (squared ? beta : 1), {dx, dy, dz}), 1,
            storage.at(i));
    });
}

// Q_j e_i of all stresses of this rank that act on i: c [(g.b) P + g b^T - kappa g.e 1] u, g = B^+ n_k, b =
// B^+ e_i.
void ViscousMatrix::Assembly::add_stresses(int i, RowStorage& storage) const {
    for (const auto& [j, which] : seen_by[static_cast<std::size_t>(i)]) {
        const auto begin = offsets[static_cast<std::size_t>(j)], end = offsets[static_cast<std::size_t>(j) + 1];
        if (const auto& blocks = beside[static_cast<std::size_t>(j)]; !blocks.empty()) {
            for (auto k = begin; k < end; ++k) {
                RowBlock& to = storage.at(members[k].particle);
                const RowBlock& from = blocks[static_cast<std::size_t>(which) * (end - begin) + (k - begin)];
                for (std::size_t l = 0; l < 9; ++l) to[l] += from[l];
            }
            continue;
        }
        const Member& at = members[begin + static_cast<std::size_t>(which)];
        const Symmetric p = range_projector(read_symmetric(correction, j));
        const RowBlock projector{p.xx, p.xy, p.xz, p.xy, p.yy, p.yz, p.xz, p.yz, p.zz};
        const double c = viscous_coefficient(j), damping = 0.5 * of.damping();
        for (auto k = begin; k < end; ++k) {
            const Member& other = members[k];
            RowBlock& to = storage.at(other.particle);
            const double both = c * inner(other.seen, at.pulled);
            for (std::size_t l = 0; l < 9; ++l) {
                to[l] += both * projector[l] + c * (other.seen[l / 3] * at.pulled[l % 3]);
            }
            // Both ways, so that the entry across the diagonal is the same number.
            if (damping > 0)
                add_identity(-damping * c * (inner(other.seen, at.force) + inner(at.pulled, other.force)), to);
        }
    }
}

template <class Kernel>
solve::BlockRows ViscousMatrix::Assembly::rows(const Kernel& kernel) {
    if (by_gradients(form)) {
        find_members(kernel);
        find_beside();
    }
    RowStorage storage(total);
    if (by_gradients(form)) {
        for (int i = owned; i < total; ++i) {
            add_stresses(i, storage);
            storage.take([&](int particle, const RowBlock& values) {
                contributions.push_back({row(i), row(particle), values});
            });
        }
    }
    exchange_contributions(parts.comm, first, contributions);
    solve::BlockRows out;
    out.size = 3;
    out.first = first;
    std::vector<RowContribution> found;
    auto next = contributions.begin();
    for (int i = 0; i < owned; ++i) {
        add_pairs(kernel, i, storage);
        if (by_gradients(form)) add_stresses(i, storage);
        found.clear();
        storage.take([&](int particle, const RowBlock& values) { found.push_back({row(i), row(particle), values}); });
        for (; next != contributions.end() && next->row == row(i); ++next) found.push_back(*next);
        append_row(found, out);
    }
    return out;
}

namespace {
solve::KrylovOptions krylov_options(const ViscosityOptions& options) {
    solve::KrylovOptions out;
    out.max_iterations = options.max_iterations;
    if (options.solver == ViscositySolver::bicgstab) out.method = solve::Method::bicgstab;
    if (options.preconditioner == ViscosityPreconditioner::gamg) out.preconditioner = solve::Preconditioner::gamg;
    if (options.preconditioner == ViscosityPreconditioner::boomeramg)
        out.preconditioner = solve::Preconditioner::boomeramg;
    return out;
}

bool takes_the_matrix(const ViscosityOptions& options) {
    return options.preconditioner == ViscosityPreconditioner::gamg ||
           options.preconditioner == ViscosityPreconditioner::boomeramg;
}

void to_array(std::span<const double> from, const Array3& to) {
    const auto host = Kokkos::create_mirror_view(to);
    for (std::size_t k = 0; k < from.size(); ++k) host(k / 3, k % 3) = from[k];
    Kokkos::deep_copy(to, host);
}
void from_array(const Array3& from, std::span<double> to) {
    const auto host = on_host(from);
    for (std::size_t k = 0; k < to.size(); ++k) to[k] = host(k / 3, k % 3);
}

// Translations and rotations, which strain nothing.
std::vector<std::vector<double>> rigid_motions(const ParticleStore& store, int dimensions) {
    const auto x = on_host(store.position());
    const auto n = static_cast<std::size_t>(store.owned());
    std::vector<std::vector<double>> out(6, std::vector<double>(3 * n, 0.0));
    for (std::size_t i = 0; i < n; ++i) {
        const Vec3 at{x(i, 0), x(i, 1), x(i, 2)};
        for (int k = 0; k < 6; ++k) {
            const auto u = rigid_motion(k, at);
            std::copy(u.begin(), u.end(), out[static_cast<std::size_t>(k)].begin() + std::ptrdiff_t(3 * i));
        }
    }
    if (dimensions == 2) out = {out[0], out[1], out[5]};
    return out;
}
} // namespace

ViscousMatrix::ViscousMatrix(const Comm& comm, LiquidParticles& liquid, const ViscosityOptions& options)
    : comm_(comm), row_field_(liquid.store.add<Array<int>>("viscous_row", "", FieldRole::work)),
      options_(krylov_options(options)) {}

void ViscousMatrix::assemble(const ViscousContext& parts, const ViscousOperator& of) {
    const auto& store = parts.liquid.store;
    const auto numbers = store.get<Array<int>>(row_field_);
    const int first = static_cast<int>(comm_.exclusive_sum(std::int64_t(store.owned())));
    Kokkos::parallel_for(
        "treacle::viscous_rows", store.owned(), KOKKOS_LAMBDA(int i) { numbers(i) = first + i; });
    parts.halo.gather(store, {row_field_});
    Assembly assembly{parts, of, parts.options.viscosity.form, pairs(parts.neighbours.liquid, store, store),
        of.walls(parts, ViscousOperator::Walls::resting), on_host(numbers),
        on_host(of.viscous_coefficient(parts.liquid)), on_host(parts.liquid.volume()), on_host(of.correction()),
        on_host(of.weights()), on_host(parts.liquid.liquid()), of.interface().any,
        on_host(of.interface().any ? store.get<Array3>(of.interface().normal) : Array3()), store.owned(), store.total(),
        first, {}, {}, {}, {}, {}};
    with_kernel(parts.options.kernel, parts.constants.dimensions, parts.constants.support,
        [&](const auto& kernel) { matrix_.build(comm_, assembly.rows(kernel)); });
    auto& matrix = *matrix_.matrix();
    if (parts.options.viscosity.form == ViscosityForm::as_published) matrix.set_unsymmetric();
    if (takes_the_matrix(parts.options.viscosity))
        matrix.set_blocks(3, rigid_motions(store, parts.constants.dimensions));
}

solve::SolveReport ViscousMatrix::solve(
    const LiquidParticles& liquid, const Array3& r, double largest, const Preconditioner& own, const Array3& change) {
    const auto n = 3 * static_cast<std::size_t>(liquid.store.owned());
    right_hand_side_.resize(n);
    solution_.assign(n, 0.0);
    from_array(r, right_hand_side_);
    if (own) {
        options_.user.apply = [&](std::span<const double> from, std::span<double> to) {
            to_array(from, r);
            own(r, change);
            from_array(change, to);
        };
    }
    solve::KrylovSolver solver(comm_, "viscosity", options_);
    auto report =
        solver.solve(*matrix_.matrix(), right_hand_side_, solution_, solve::ConvergenceTest::residual(0, largest));
    to_array(solution_, change);
    options_.user = {};
    return report;
}

} // namespace treacle::sph
