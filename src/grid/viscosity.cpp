#include "grid/viscosity.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "grid/viscous_bodies.hpp"
#include "solve/component_split.hpp"
#include "solve/rigid_multilevel.hpp"

#include <algorithm>
#include <optional>

namespace treacle::grid {

namespace {
solve::KrylovOptions krylov_options(const ViscosityOptions& options) {
    solve::KrylovOptions out;
    out.max_iterations = options.max_iterations;
    switch (options.preconditioner) {
    case Preconditioner::incomplete_cholesky:
        out.preconditioner = solve::Preconditioner::ic0;
        break;
    case Preconditioner::jacobi:
        out.preconditioner = solve::Preconditioner::jacobi;
        break;
    case Preconditioner::gamg:
        out.preconditioner = solve::Preconditioner::gamg;
        break;
    case Preconditioner::multilevel:
    case Preconditioner::boomeramg: // the caller's own, below
        break;
    }
    return out;
}

std::vector<double> body_velocities(const rigid::RigidBodies& bodies) {
    std::vector<double> out;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        const auto& v = bodies.velocity(b);
        const auto w = bodies.spin(b);
        out.insert(out.end(), v.begin(), v.end());
        out.insert(out.end(), w.begin(), w.end());
    }
    return out;
}

void gather_faces(const FaceField& velocity, const Array<int>& place_of, int n, const Array<double>& x) {
    Kokkos::parallel_for("treacle::viscous_guess", n,
                         KOKKOS_LAMBDA(int r) { x(r) = velocity.axis[place_of(r) % 3](place_of(r) / 3); });
}

void scatter_faces(const Array<double>& x, const Array<int>& place_of, int n, const FaceField& velocity) {
    Kokkos::parallel_for("treacle::viscous_result", n,
                         KOKKOS_LAMBDA(int r) { velocity.axis[place_of(r) % 3](place_of(r) / 3) = x(r); });
}

void hold_faces(const ViscousFaces& faces, const CellBox& owned, const FaceField& velocity) {
    Kokkos::parallel_for("treacle::held_faces", static_cast<int>(owned.size()), KOKKOS_LAMBDA(int n) {
        int c[3];
        owned.cell(n, c);
        const int i = faces.window.index(c[0], c[1], c[2]);
        for (int a = 0; a < faces.dimensions; ++a) {
            if (faces.role[a](i) == held_face) velocity.axis[a](i) = faces.solid.axis[a](i);
        }
    });
}
} // namespace

struct Viscosity::State {
    const Comm& comm;
    const ViscosityOptions& options;
    solve::RigidMultilevel multilevel;
    solve::ComponentSplit components;
    solve::KrylovSolver solver;
    BodyMotion motion;
    ViscousParts parts;
    ViscousSystem system;
    ViscousBodies bodies;
    std::optional<solve::Matrix> matrix;
    std::vector<double> b, x, scratch;
    std::vector<double> block; // of the bodies
    Array<double> faces{"treacle::viscous_faces", 0};
    double dx = 0;
    int dimensions = 3, coupled = 0; // coupled: unknowns of the bodies
    std::vector<int> cells;
    std::vector<double> places;
    std::vector<signed char> axes;
    std::vector<unsigned char> aside;

    State(const Comm& group, const ViscosityOptions& given)
        : comm(group), options(given), multilevel(group, {}), components(group, "viscosity", solve::Preconditioner::boomeramg),
          solver(group, "viscosity", with_own(krylov_options(given))) {}

    solve::KrylovOptions with_own(solve::KrylovOptions out);
    solve::RigidBorder border() const;
    void describe_rows(const MacGrid& grid);
    void make_matrix(double dt);
    void load_vectors(const FaceField& velocity, std::span<const double> v);
    void choose_guess();
    void couple(std::span<const double> x, std::span<double> y);
    std::span<double> own_faces(std::vector<double>& vector) { return std::span(vector).first(static_cast<std::size_t>(system.faces())); }
};

solve::KrylovOptions Viscosity::State::with_own(solve::KrylovOptions out) {
    if (options.preconditioner == Preconditioner::multilevel) {
        out.user.set_up = [this](solve::Matrix& a) { multilevel.set_up(a, {dimensions, dx, cells, places, axes, aside}, border()); };
        out.user.apply = [this](std::span<const double> r, std::span<double> z) { multilevel.apply(r, z); };
    } else if (options.preconditioner == Preconditioner::boomeramg) {
        out.user.set_up = [this](solve::Matrix& a) { components.set_up(a, axes, dimensions); };
        out.user.apply = [this](std::span<const double> r, std::span<double> z) { components.apply(r, z); };
    }
    return out;
}

solve::RigidBorder Viscosity::State::border() const {
    solve::RigidBorder out;
    out.count = coupled;
    if (coupled == 0) return out;
    out.add = [this](std::span<const double> q, std::span<double> y) { bodies.add_coupling(q, y); };
    out.project = [this](std::span<const double> x) { return bodies.project(x); };
    out.block = block;
    return out;
}

// What the rows are, for the preconditioners; those of bodies are nothing but a block of their own.
void Viscosity::State::describe_rows(const MacGrid& grid) {
    dx = grid.dx;
    dimensions = grid.dimensions;
    const auto n = static_cast<std::size_t>(system.faces()), rows = static_cast<std::size_t>(system.rows());
    cells.assign(3 * rows, 0);
    places.assign(3 * rows, 0.0);
    axes.assign(rows, 0);
    aside.assign(rows, 1);
    const auto place_of = on_host(system.place_of());
    for (std::size_t r = 0; r < n; ++r) {
        const int axis = place_of(r) % 3;
        parts.faces().window.cell(place_of(r) / 3, &cells[3 * r]);
        grid.face(axis, &cells[3 * r], &places[3 * r]);
        axes[r] = static_cast<signed char>(axis);
        aside[r] = 0;
    }
}

void Viscosity::State::make_matrix(double dt) {
    block = coupled > 0 ? bodies.block(dt) : std::vector<double>();
    if (system.extra() > 0) {
        for (int r = 0; r < coupled; ++r) {
            for (int c = 0; c < coupled; ++c) system.extra_entry(r, c) = block[static_cast<std::size_t>(r * coupled + c)];
        }
    }
    matrix.emplace(comm, system.blocks());
    if (coupled > 0) matrix->set_addition([this](std::span<const double> from, std::span<double> to) { couple(from, to); });
}

// y += C L q on the faces, L^T C^T x on the rows of the bodies, which stand behind the faces of rank 0: one sum.
void Viscosity::State::couple(std::span<const double> from, std::span<double> to) {
    const auto n = static_cast<std::size_t>(system.faces()), m = static_cast<std::size_t>(coupled);
    auto shared = bodies.project(from.first(n));
    shared.resize(2 * m, 0.0);
    if (comm.is_root()) std::copy(from.begin() + static_cast<std::ptrdiff_t>(n), from.end(), shared.begin() + static_cast<std::ptrdiff_t>(m));
    comm.sum(std::span(shared));
    bodies.add_coupling(std::span(shared).last(m), to.first(n));
    if (!comm.is_root()) return;
    for (std::size_t k = 0; k < m; ++k) to[n + k] += shared[k];
}

void Viscosity::State::load_vectors(const FaceField& velocity, std::span<const double> v) {
    const auto n = static_cast<std::size_t>(system.faces());
    b.assign(static_cast<std::size_t>(system.rows()), 0.0);
    x.assign(b.size(), 0.0);
    reserve(faces, n);
    system.right_hand_side(parts.faces(), velocity, faces);
    auto host = on_host(faces);
    std::copy_n(host.data(), n, b.begin());
    gather_faces(velocity, system.place_of(), system.faces(), faces);
    host = on_host(faces);
    std::copy_n(host.data(), n, x.begin());
    if (system.extra() == 0) return;
    const auto pushed = bodies.right_hand_side(v);
    std::copy(pushed.begin(), pushed.end(), b.begin() + static_cast<std::ptrdiff_t>(n));
}

// The velocities of before, unless nothing at all has the smaller residual: what is not smooth strains a stiff liquid.
void Viscosity::State::choose_guess() {
    std::vector<double>& product = scratch;
    product.resize(x.size());
    matrix->multiply(x, product);
    std::array<double, 2> squares{0, 0};
    for (std::size_t k = 0; k < x.size(); ++k) {
        squares[0] += (b[k] - product[k]) * (b[k] - product[k]);
        squares[1] += b[k] * b[k];
    }
    comm.sum(std::span<double>(squares));
    if (!(squares[0] < squares[1])) std::fill(x.begin(), x.end(), 0.0);
}

Viscosity::Viscosity(const Comm& comm, ViscosityOptions options, Coupling coupling)
    : comm_(comm), options_(options), coupling_(coupling) {}
Viscosity::~Viscosity() = default;

ViscosityReport Viscosity::solve(const ViscousScene& scene, const FaceField& velocity, rigid::RigidBodies& bodies, double dt) {
    if (!state_) state_ = std::make_unique<State>(comm_, options_);
    auto& s = *state_;
    const auto before = body_velocities(bodies);
    const bool answers = coupling_ != Coupling::one_way && bodies.any_dynamic();
    s.matrix.reset();
    update_motion(bodies, scene.grid, s.motion);
    s.parts.build(scene, options_, s.motion, dt);
    if (answers) s.bodies.prepare(bodies);
    s.coupled = answers && coupling_ == Coupling::strong ? s.bodies.unknowns() : 0;
    s.system.assemble(comm_, scene.halo, s.parts.faces(), s.coupled);
    if (answers) s.bodies.build(comm_, scene, s.parts.faces(), s.system, s.motion, velocity);
    s.describe_rows(scene.grid);
    s.make_matrix(dt);
    s.load_vectors(velocity, before);
    s.choose_guess();
    ViscosityReport report;
    report.unknowns = s.system.global_rows() - s.coupled;
    report.entries = comm_.sum(s.matrix->entries());
    report.solve = s.solver.solve(*s.matrix, s.b, s.x, solve::ConvergenceTest::residual(options_.residual));
    if (!report.solve.converged()) {
        throw SimulationError({"method.viscosity", report.solve.reason,
                               "the viscous system of " + std::to_string(report.unknowns) + " faces has not been solved: relative residual " +
                                   format_number(report.solve.relative_residual) + " after " +
                                   std::to_string(report.solve.iterations) + " iterations",
                               "take a smaller time step, another preconditioner, or a larger residual"});
    }
    const auto n = static_cast<std::size_t>(s.system.faces());
    if (answers) {
        std::vector<double> q(static_cast<std::size_t>(s.bodies.unknowns()), 0.0);
        if (s.coupled > 0) {
            if (comm_.is_root()) std::copy(s.x.begin() + static_cast<std::ptrdiff_t>(n), s.x.end(), q.begin());
            comm_.broadcast(std::span(q));
        } else {
            q = s.bodies.answer(s.bodies.loads(comm_, s.own_faces(s.x), before), dt);
        }
        bodies.push(s.bodies.loads(comm_, s.own_faces(s.x), s.bodies.moved(before, q)), dt);
        if (s.coupled > 0) {
            update_motion(bodies, scene.grid, s.motion);
            if (n > 0 || !scene.halo.window().empty()) s.parts.move_solids(scene, s.motion);
        }
    }
    auto host = Kokkos::create_mirror_view(s.faces);
    std::copy_n(s.x.begin(), n, host.data());
    Kokkos::deep_copy(s.faces, host);
    scatter_faces(s.faces, s.system.place_of(), s.system.faces(), velocity);
    hold_faces(s.parts.faces(), scene.halo.owned(), velocity);
    return report;
}

solve::Matrix* Viscosity::matrix() { return state_ && state_->matrix ? &*state_->matrix : nullptr; }
std::span<const double> Viscosity::right_hand_side() const { return state_ ? std::span<const double>(state_->b) : std::span<const double>(); }

std::size_t Viscosity::bytes() const {
    if (!state_) return 0;
    const auto& s = *state_;
    return s.parts.bytes() + s.system.bytes() + s.bodies.bytes() + s.multilevel.bytes() + s.components.bytes() +
           8 * (s.b.capacity() + s.x.capacity() + s.scratch.capacity() + s.faces.span() + s.places.capacity()) + 4 * s.cells.capacity() +
           s.axes.capacity() + s.aside.capacity();
}

} // namespace treacle::grid
