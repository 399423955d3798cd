#include "grid/viscosity/viscous_bodies.hpp"

#include "grid/viscosity/viscous_body_loops.hpp"
#include "kokkos/scan.hpp"

#include <algorithm>

namespace treacle::grid {

namespace {
std::size_t at(int body) { return 6 * static_cast<std::size_t>(body); }
} // namespace

void ViscousBodies::prepare(const rigid::RigidBodies& bodies) {
    size_ = 6 * bodies.size();
    columns_.clear();
    if (bodies.any_dynamic()) columns_ = bodies.mobility().columns();
}

void ViscousBodies::prepare(std::size_t solids) {
    size_ = 6 * solids;
    columns_.clear();
}

void ViscousBodies::list(
    const ViscousScene& scene, const ViscousFaces& faces, const CellBox& owned, const BodyMotion& motion) {
    const auto& body_fractions = scene.body_fractions;
    const OwnedFaces all{owned, faces.window, faces.dimensions};
    ListLoop loop{
        faces, all, {body_fractions[0], body_fractions[1], body_fractions[2]}, motion, scene.grid, {}, {}, {}, false};
    for (auto* part : {&stress_coupling_, &slip_coupling_, &moved_}) {
        reserve(part->first, static_cast<std::size_t>(all.count()) + 1);
        reserve(part->last, static_cast<std::size_t>(all.count()));
    }
    loop.pulled = stress_coupling_;
    loop.slipped = slip_coupling_;
    loop.moved = moved_;
    Kokkos::parallel_for("treacle::count_viscous_bodies", all.count(), loop);
    for (auto* part : {&stress_coupling_, &slip_coupling_, &moved_}) {
        const auto entries = static_cast<std::size_t>(counts_to_offsets(part->first, all.count()));
        reserve(part->body, entries);
        reserve(part->u, 6 * entries);
    }
    loop.pulled = stress_coupling_;
    loop.slipped = slip_coupling_;
    loop.moved = moved_;
    loop.write = true;
    Kokkos::parallel_for("treacle::list_viscous_bodies", all.count(), loop);
    reserve(given_pull_, static_cast<std::size_t>(all.count()));
    Kokkos::parallel_for("treacle::given_pull", all.count(), GivenLoop{faces, all, moved_, given_pull_});
}

void ViscousBodies::add_stiffness(int b, const double* left, int other, const double* right, double factor) {
    for (std::size_t k = 0; k < 6; ++k) {
        for (std::size_t l = 0; l < 6; ++l)
            stiffness_[(at(b) + k) * size_ + at(other) + l] += factor * left[k] * right[l];
    }
}

void ViscousBodies::list_surfaces(
    const ViscousScene& scene, const ViscousFaces& faces, const CellBox& owned, const BodyMotion& motion) {
    SurfaceLoop loop{faces, owned, motion, scene.grid, {}, false};
    const int cells = static_cast<int>(owned.size());
    reserve(surface_.first, static_cast<std::size_t>(cells) + 1);
    loop.surface = surface_;
    Kokkos::parallel_for("treacle::count_slip_surfaces", cells, loop);
    const auto entries = static_cast<std::size_t>(counts_to_offsets(surface_.first, cells));
    reserve(surface_.body, entries);
    reserve(surface_.u, 6 * entries);
    loop.surface = surface_;
    loop.write = true;
    Kokkos::parallel_for("treacle::list_slip_surfaces", cells, loop);
}

// Resistance of slip surfaces to their own bodies' motion.
void ViscousBodies::sum_slip(const ViscousFaces& faces, const CellBox& owned) {
    const auto first = on_host(surface_.first), body = on_host(surface_.body);
    const auto u = on_host(surface_.u);
    Array<double>::HostMirror traction[6];
    for (int k = 0; k < 6; ++k) traction[k] = on_host(faces.traction[k]);
    Array<double>::HostMirror bend[3];
    for (int k = 0; k < faces.dimensions; ++k) bend[k] = on_host(faces.wall_bend[k]);
    for (int n = 0; n < owned.size(); ++n) {
        const int at = first(n);
        if (first(n + 1) == at) continue;
        int c[3];
        owned.cell(n, c);
        const int i = faces.window.index(c[0], c[1], c[2]);
        for (int a = 0; a < faces.dimensions; ++a) {
            for (int b = 0; b < faces.dimensions; ++b) {
                const double k = traction[ViscousFaces::component(a, b)](i);
                add_stiffness(body(at), u.data() + 6 * (at + a), body(at), u.data() + 6 * (at + b), k);
                for (std::size_t l = 0; l < 6; ++l)
                    prescribed_load_[6 * static_cast<std::size_t>(body(at)) + l] -=
                        k * bend[b](i) * u(6 * static_cast<std::size_t>(at + a) + l);
            }
        }
    }
}

// On the host, where the solver is, in the order of the faces.
void ViscousBodies::sum_faces(
    const ViscousFaces& faces, const ViscousSystem& system, const CellBox& owned, const FaceField& velocity) {
    struct Host {
        Array<int>::HostMirror first, last, body;
        Array<double>::HostMirror u;
        explicit Host(const List& list)
            : first(on_host(list.first)), last(on_host(list.last)), body(on_host(list.body)), u(on_host(list.u)) {}
        const double* at(int k) const { return u.data() + 6 * static_cast<std::size_t>(k); }
    };
    const Host pulled(stress_coupling_), slipped(slip_coupling_), moved(moved_);
    const auto pull = on_host(given_pull_);
    const auto couple = [&](int row, double fraction, int body, const double* pull) {
        Entry entry{row, body, {}};
        for (int l = 0; l < 6; ++l) entry.u[l] = fraction * pull[l];
        coupling_.push_back(entry);
    };
    const OwnedFaces all{owned, faces.window, faces.dimensions};
    for (int a = 0; a < faces.dimensions; ++a) {
        const auto role = on_host(faces.role[a]), row = on_host(system.row_of(a));
        const auto fraction = on_host(faces.fraction.axis[a]), mass = on_host(faces.mass.axis[a]),
                   u = on_host(velocity.axis[a]);
        const auto bend = on_host(faces.bend.axis[a]);
        for (int n = a; n < all.count(); n += faces.dimensions) {
            if (pulled.first(n) == pulled.last(n) && moved.first(n) == moved.last(n) &&
                slipped.first(n) == slipped.last(n))
                continue;
            int axis, c[3];
            const auto i = all.index(n, axis, c);
            const int local = row(i) - static_cast<int>(system.first_row());
            for (int k = pulled.first(n); k < pulled.last(n); ++k) {
                const double* const pull = pulled.at(k);
                if (role(i) == unknown_face) couple(local, fraction(i), pulled.body(k), pull);
                for (int m = moved.first(n); m < moved.last(n); ++m)
                    add_stiffness(moved.body(m), moved.at(m), pulled.body(k), pull, 1);
            }
            for (int k = slipped.first(n); k < slipped.last(n); ++k) {
                const double* const pull = slipped.at(k);
                if (role(i) == unknown_face) couple(local, fraction(i), slipped.body(k), pull);
                for (std::size_t l = 0; l < 6; ++l) prescribed_load_[at(slipped.body(k)) + l] -= bend(i) * pull[l];
                for (int m = moved.first(n); m < moved.last(n); ++m) {
                    add_stiffness(moved.body(m), moved.at(m), slipped.body(k), pull, 1);
                    add_stiffness(slipped.body(k), pull, moved.body(m), moved.at(m), 1);
                }
            }
            const double given = pull(n) + (role(i) == prescribed_face ? mass(i) * (u(i) - bend(i)) : 0.0);
            for (int m = moved.first(n); m < moved.last(n); ++m) {
                for (std::size_t l = 0; l < 6; ++l) prescribed_load_[at(moved.body(m)) + l] += given * moved.at(m)[l];
            }
            if (role(i) != prescribed_face) continue;
            for (int m = moved.first(n); m < moved.last(n); ++m) {
                for (int k = moved.first(n); k < moved.last(n); ++k)
                    add_stiffness(moved.body(m), moved.at(m), moved.body(k), moved.at(k), mass(i));
            }
        }
    }
}

void ViscousBodies::build(const Comm& comm, const ViscousScene& scene, const ViscousFaces& faces,
    const ViscousSystem& system, const BodyMotion& motion, const FaceField& velocity) {
    coupling_.clear();
    stiffness_.assign(size_ * size_, 0.0);
    prescribed_load_.assign(size_, 0.0);
    const auto& owned = scene.halo.owned();
    if (!owned.empty()) {
        list(scene, faces, owned, motion);
        sum_faces(faces, system, owned, velocity);
        if (faces.slips) {
            list_surfaces(scene, faces, owned, motion);
            sum_slip(faces, owned);
        }
    }
    comm.sum(std::span(stiffness_));
    comm.sum(std::span(prescribed_load_));
}

std::vector<double> ViscousBodies::block(double dt) const {
    const std::size_t n = columns_.size();
    std::vector<double> out(n * n, 0.0), image(size_);
    for (std::size_t c = 0; c < n; ++c) {
        for (std::size_t k = 0; k < size_; ++k) {
            image[k] = 0;
            for (std::size_t l = 0; l < size_; ++l) image[k] += stiffness_[k * size_ + l] * columns_[c][l];
        }
        for (std::size_t r = 0; r < n; ++r) {
            for (std::size_t k = 0; k < size_; ++k) out[r * n + c] += columns_[r][k] * image[k];
        }
        out[c * n + c] += 1 / dt;
    }
    return out;
}

std::vector<double> ViscousBodies::right_hand_side(std::span<const double> velocities) const {
    auto out = prescribed_load_;
    for (std::size_t k = 0; k < size_; ++k) {
        for (std::size_t l = 0; l < size_; ++l) out[k] -= stiffness_[k * size_ + l] * velocities[l];
    }
    return forces(out);
}

std::vector<double> ViscousBodies::moved(std::span<const double> velocities, std::span<const double> q) const {
    std::vector<double> out(velocities.begin(), velocities.end());
    for (std::size_t c = 0; c < q.size(); ++c) {
        for (std::size_t k = 0; k < size_; ++k) out[k] += columns_[c][k] * q[c];
    }
    return out;
}

void ViscousBodies::add_coupling(std::span<const double> q, std::span<double> y) const {
    const auto v = moved(std::vector<double>(size_, 0.0), q);
    for (const auto& entry : coupling_) {
        double sum = 0;
        for (std::size_t l = 0; l < 6; ++l) sum += entry.u[l] * v[at(entry.body) + l];
        y[static_cast<std::size_t>(entry.row)] += sum;
    }
}

namespace {
template <class Entries>
std::vector<double> pull_of(const Entries& entries, std::size_t size, std::span<const double> x) {
    std::vector<double> out(size, 0.0);
    for (const auto& entry : entries) {
        for (std::size_t l = 0; l < 6; ++l)
            out[at(entry.body) + l] += entry.u[l] * x[static_cast<std::size_t>(entry.row)];
    }
    return out;
}
} // namespace

std::vector<double> ViscousBodies::forces(std::span<const double> loads) const {
    std::vector<double> out(columns_.size(), 0.0);
    for (std::size_t c = 0; c < out.size(); ++c) {
        for (std::size_t k = 0; k < size_; ++k) out[c] += columns_[c][k] * loads[k];
    }
    return out;
}

std::vector<double> ViscousBodies::project(std::span<const double> x) const {
    return forces(pull_of(coupling_, size_, x));
}

std::vector<double> ViscousBodies::loads(
    const Comm& comm, std::span<const double> u, std::span<const double> velocities) const {
    auto out = pull_of(coupling_, size_, u);
    comm.sum(std::span(out));
    for (std::size_t k = 0; k < size_; ++k) {
        out[k] = prescribed_load_[k] - out[k];
        for (std::size_t l = 0; l < size_; ++l) out[k] -= stiffness_[k * size_ + l] * velocities[l];
    }
    return out;
}

std::vector<double> ViscousBodies::answer(std::span<const double> loads, double dt) const {
    const std::size_t n = columns_.size();
    auto a = block(dt); // Cholesky in place, lower
    auto q = forces(loads);
    for (std::size_t r = 0; r < n; ++r) {
        for (std::size_t c = 0; c <= r; ++c) {
            double sum = a[r * n + c];
            for (std::size_t k = 0; k < c; ++k) sum -= a[r * n + k] * a[c * n + k];
            a[r * n + c] = r == c ? math::sqrt(sum) : sum / a[c * n + c];
        }
        for (std::size_t k = 0; k < r; ++k) q[r] -= a[r * n + k] * q[k];
        q[r] /= a[r * n + r];
    }
    for (std::size_t r = n; r-- > 0;) {
        for (std::size_t k = r + 1; k < n; ++k) q[r] -= a[k * n + r] * q[k];
        q[r] /= a[r * n + r];
    }
    return q;
}

std::size_t ViscousBodies::bytes() const {
    std::size_t total =
        8 * (stiffness_.capacity() + prescribed_load_.capacity()) + sizeof(Entry) * coupling_.capacity();
    for (const auto* part : {&stress_coupling_, &slip_coupling_, &moved_}) {
        total += 4 * (part->first.span() + part->last.span() + part->body.span()) + 8 * part->u.span();
    }
    return total;
}

} // namespace treacle::grid
