#include "grid/viscosity/viscous_problem.hpp"

#include "grid/pressure/resting_solids.hpp"

#include <algorithm>

namespace treacle::grid {

namespace {
solve::Preconditioner translate(Preconditioner kind) {
    switch (kind) {
    case Preconditioner::incomplete_cholesky: return solve::Preconditioner::ic0;
    case Preconditioner::jacobi: return solve::Preconditioner::jacobi;
    case Preconditioner::gamg: return solve::Preconditioner::gamg;
    case Preconditioner::multilevel:
    case Preconditioner::boomeramg: break; // the caller's own
    }
    return solve::KrylovOptions().preconditioner;
}

void gather_faces(const FaceField& velocity, const Array<int>& face_of, int n, const Array<double>& x) {
    Kokkos::parallel_for(
        "treacle::viscous_guess", n, KOKKOS_LAMBDA(int r) { x(r) = velocity.axis[face_of(r) % 3](face_of(r) / 3); });
}

void scatter_faces(const Array<double>& x, const Array<int>& face_of, int n, const FaceField& velocity) {
    Kokkos::parallel_for(
        "treacle::viscous_result", n, KOKKOS_LAMBDA(int r) { velocity.axis[face_of(r) % 3](face_of(r) / 3) = x(r); });
}

void prescribe_faces(const ViscousFaces& faces, const CellBox& owned, const FaceField& velocity) {
    Kokkos::parallel_for(
        "treacle::prescribed_faces", static_cast<int>(owned.size()), KOKKOS_LAMBDA(int n) {
            int c[3];
            owned.cell(n, c);
            const int i = faces.window.index(c[0], c[1], c[2]);
            for (int a = 0; a < faces.dimensions; ++a) {
                if (faces.role[a](i) == prescribed_face) velocity.axis[a](i) = faces.solid.axis[a](i);
            }
        });
}
} // namespace

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

ViscousProblem::ViscousProblem(const Comm& comm, const ViscosityOptions& options, Coupling coupling)
    : comm_(comm), options_(options), coupling_(coupling), multilevel_(comm, {}),
      components_(comm, "viscosity", solve::Preconditioner::boomeramg), solver_(comm, "viscosity", krylov()) {}

solve::KrylovOptions ViscousProblem::krylov() {
    solve::KrylovOptions out;
    out.max_iterations = options_.max_iterations;
    out.preconditioner = translate(options_.preconditioner);
    if (options_.preconditioner == Preconditioner::multilevel) {
        out.user.set_up = [this](solve::Matrix& a) {
            multilevel_.set_up(a, {dimensions_, dx_, cells_, positions_, axes_, aside_}, border());
            mechanisms_.build(comm_, parts_.faces(), system_, system_.owned());
            auto taken = aside_;
            mechanisms_.mark(taken);
            soft_pairs_.build(a.blocks(), taken);
        };
        out.user.apply = [this](std::span<const double> r, std::span<double> z) {
            multilevel_.apply(r, z);
            mechanisms_.add(r, z);
            soft_pairs_.add(r, z);
        };
    } else if (options_.preconditioner == Preconditioner::boomeramg) {
        out.user.set_up = [this](solve::Matrix& a) { components_.set_up(a, axes_, dimensions_); };
        out.user.apply = [this](std::span<const double> r, std::span<double> z) { components_.apply(r, z); };
    }
    return out;
}

solve::BorderedBodies ViscousProblem::border() const {
    solve::BorderedBodies out;
    out.count = coupled_;
    if (coupled_ == 0) return out;
    out.add = [this](std::span<const double> q, std::span<double> y) { bodies_.add_coupling(q, y); };
    out.project = [this](std::span<const double> x) { return bodies_.project(x); };
    out.block = block_;
    return out;
}

// Description of the rows for the preconditioners; those of bodies are nothing but a block of their own.
void ViscousProblem::describe_rows(const MacGrid& grid) {
    dx_ = grid.dx;
    dimensions_ = grid.dimensions;
    cells_.assign(3 * rows(), 0);
    positions_.assign(3 * rows(), 0.0);
    axes_.assign(rows(), 0);
    aside_.assign(rows(), 1);
    const auto face_of = on_host(system_.face_of());
    for (std::size_t r = 0; r < faces(); ++r) {
        const int axis = face_of(r) % 3;
        parts_.faces().window.cell(face_of(r) / 3, &cells_[3 * r]);
        grid.face(axis, &cells_[3 * r], &positions_[3 * r]);
        axes_[r] = static_cast<signed char>(axis);
        aside_[r] = 0;
    }
}

void ViscousProblem::make_matrix() {
    block_ = coupled_ > 0 ? bodies_.block(dt_) : std::vector<double>();
    if (system_.extra() > 0) {
        for (int r = 0; r < coupled_; ++r) {
            for (int c = 0; c < coupled_; ++c)
                system_.extra_entry(r, c) = block_[static_cast<std::size_t>(r * coupled_ + c)];
        }
    }
    matrix_.emplace(comm_, system_.blocks());
    if (coupled_ > 0)
        matrix_->set_matrix_free_term([this](std::span<const double> from, std::span<double> to) { couple(from, to); });
}

// y += C L q on the faces, L^T C^T x on the rows of the bodies, which stand behind the faces of rank 0: one sum.
void ViscousProblem::couple(std::span<const double> from, std::span<double> to) {
    const auto n = faces(), m = static_cast<std::size_t>(coupled_);
    auto shared = bodies_.project(from.first(n));
    shared.resize(2 * m, 0.0);
    if (comm_.is_root())
        std::copy(
            from.begin() + static_cast<std::ptrdiff_t>(n), from.end(), shared.begin() + static_cast<std::ptrdiff_t>(m));
    comm_.sum(std::span(shared));
    bodies_.add_coupling(std::span(shared).last(m), to.first(n));
    if (!comm_.is_root()) return;
    for (std::size_t k = 0; k < m; ++k) to[n + k] += shared[k];
}

void ViscousProblem::update_faces(const ViscousScene& scene, const rigid::RigidBodies& bodies, double dt) {
    update_motion(bodies, scene.grid, motion_);
    parts_.build(scene, options_, motion_, dt);
}

void ViscousProblem::build(
    const ViscousScene& scene, const FaceField& velocity, const rigid::RigidBodies& bodies, double dt) {
    dt_ = dt;
    before_ = body_velocities(bodies);
    has_moving_bodies_ = bodies.any_moves();
    answers_ = coupling_ != Coupling::one_way && bodies.any_dynamic();
    matrix_.reset();
    update_faces(scene, bodies, dt);
    if (has_moving_bodies_) bodies_.prepare(bodies);
    coupled_ = answers_ && coupling_ == Coupling::strong ? bodies_.unknowns() : 0;
    system_.assemble(comm_, scene.halo, parts_.faces(), coupled_);
    if (has_moving_bodies_) bodies_.build(comm_, scene, parts_.faces(), system_, motion_, velocity);
    describe_rows(scene.grid);
    make_matrix();
    reserve(faces_, faces());
}

void ViscousProblem::right_hand_side(const FaceField& velocity, std::span<double> b) {
    system_.right_hand_side(parts_.faces(), velocity, faces_);
    const auto host = on_host(faces_);
    std::copy_n(host.data(), faces(), b.begin());
    if (system_.extra() == 0) return;
    const auto by_bodies = bodies_.right_hand_side(before_);
    std::copy(by_bodies.begin(), by_bodies.end(), b.begin() + static_cast<std::ptrdiff_t>(faces()));
}

void ViscousProblem::read(const FaceField& velocity, std::span<double> x) {
    gather_faces(velocity, system_.face_of(), system_.faces(), faces_);
    const auto host = on_host(faces_);
    std::fill(x.begin(), x.end(), 0.0);
    std::copy_n(host.data(), faces(), x.begin());
}

void ViscousProblem::write(std::span<const double> x, const FaceField& velocity) {
    auto host = Kokkos::create_mirror_view(faces_);
    std::copy_n(x.begin(), faces(), host.data());
    Kokkos::deep_copy(faces_, host);
    scatter_faces(faces_, system_.face_of(), system_.faces(), velocity);
}

std::vector<double> ViscousProblem::motions(std::span<const double> x) const {
    std::vector<double> q(static_cast<std::size_t>(coupled_), 0.0);
    if (coupled_ == 0) return q;
    if (comm_.is_root()) std::copy_n(x.begin() + static_cast<std::ptrdiff_t>(faces()), q.size(), q.begin());
    comm_.broadcast(std::span(q));
    return q;
}

std::vector<double> ViscousProblem::changes(std::span<const double> q) const {
    return bodies_.moved(std::vector<double>(before_.size(), 0.0), q);
}

std::vector<double> ViscousProblem::push(
    std::span<const double> x, std::span<const double> others, rigid::RigidBodies& bodies) {
    const auto u = x.first(faces());
    auto q = motions(x);
    if (coupled_ == 0) {
        auto loads = bodies_.loads(comm_, u, before_);
        for (std::size_t k = 0; k < others.size(); ++k) loads[k] += others[k];
        q = bodies_.answer(loads, dt_);
    }
    auto loads = bodies_.loads(comm_, u, bodies_.moved(before_, q));
    auto all = loads;
    for (std::size_t k = 0; k < others.size(); ++k) all[k] += others[k];
    bodies.push(all, dt_);
    return loads;
}

// All solids move as given here, so that their velocities stand where those of sides do.
void ViscousProblem::load_resting(const ViscousScene& scene, std::span<const double> u, const FaceField& velocity) {
    const auto& resting = *scene.resting;
    auto faces = parts_.faces();
    for (int a = 0; a < 3; ++a) {
        faces.bend.axis[a] = faces.solid.axis[a];
        faces.wall_bend[a] = faces.wall[a];
    }
    if (faces.slips) {
        resting.renumber(faces.slip_body, static_cast<std::size_t>(faces.window.size()), resting_number_);
        faces.slip_body = resting_number_;
    }
    const ViscousScene of_resting{scene.grid, scene.halo, scene.fractions, resting.body_fractions(), scene.viscosity,
        scene.density, scene.slip, scene.pressure_faces, scene.strains};
    resting_.prepare(resting.count());
    resting_.build(comm_, of_resting, faces, system_, resting.motion(), velocity);
    resting_loads_ = resting_.loads(comm_, u, std::vector<double>(6 * resting.count(), 0.0));
}

std::vector<double> ViscousProblem::apply(const ViscousScene& scene, std::span<const double> x,
    std::span<const double> others, const FaceField& velocity, rigid::RigidBodies& bodies) {
    std::vector<double> loads(before_.size(), 0.0);
    if (answers_)
        loads = push(x, others, bodies);
    else if (has_moving_bodies_)
        loads = bodies_.loads(comm_, x.first(faces()), before_);
    if (coupled_ > 0) {
        update_motion(bodies, scene.grid, motion_);
        if (!scene.halo.window().empty()) parts_.move_solids(scene, motion_);
    }
    if (scene.resting) load_resting(scene, x.first(faces()), velocity);
    write(x, velocity);
    prescribe_faces(parts_.faces(), scene.halo.owned(), velocity);
    return loads;
}

std::size_t ViscousProblem::bytes() const {
    return parts_.bytes() + system_.bytes() + bodies_.bytes() + resting_.bytes() + multilevel_.bytes() +
           mechanisms_.bytes() + soft_pairs_.bytes() + components_.bytes() +
           8 * (faces_.span() + positions_.capacity()) + 4 * cells_.capacity() + axes_.capacity() + aside_.capacity();
}

} // namespace treacle::grid
