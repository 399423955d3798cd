#include "rigid/contact.hpp"
#include "rigid/friction_problem.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::rigid {

namespace {
constexpr double settled = 1e-9;    // error of velocities, over that by gravity and the largest speed
constexpr double taken_back = 0.2;  // of an overlap, per step
constexpr double tolerated = 0.005; // overlap, in spacings, that keeps contacts closed
constexpr double shifted = 1e-8;    // error of shifts, in spacings
// Below this fraction of the free bodies' response, joints count as constraining them.
constexpr double constrained = 1e-9;

using Eigen::Index;

class Solver {
public:
    Solver(const std::vector<Contact>& contacts, std::vector<SolverBody>& bodies,
        const ConstrainedInverseMass& together, double spacing)
        : contacts_(contacts), bodies_(bodies), columns_(together.columns()), spacing_(spacing) {
        const auto n = static_cast<Index>(contacts.size());
        problem_.rows.resize(3 * n, static_cast<Index>(columns_.size()));
        problem_.velocity.resize(3 * n);
        problem_.wanted.resize(n);
        for (std::size_t i = 0; i < contacts.size(); ++i) prepare(i);
    }

    void solve(double speed) {
        for (const auto& body : bodies_) speed = std::max(speed, length(body.velocity));
        const Eigen::VectorXd impulses = solve_friction(problem_, settled * speed);
        for (std::size_t i = 0; i < contacts_.size(); ++i) give(i, impulses.segment<3>(3 * static_cast<Index>(i)));
        part();
    }

private:
    void prepare(std::size_t i) {
        const auto& contact = contacts_[i];
        const Vec3 relative = velocity(contact);
        const double approach = dot(relative, contact.normal);
        // Along the sliding, so that the friction of a sliding body points against it.
        const Vec3 sliding = relative - approach * contact.normal;
        const double speed = length(sliding);
        const Vec3 first = speed > 1e-12 ? (1 / speed) * sliding : any_perpendicular(contact.normal);
        directions_.push_back({contact.normal, first, cross(contact.normal, first)});
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3& direction = directions_.back()[k];
            const auto row = 3 * static_cast<Index>(i) + static_cast<Index>(k);
            problem_.rows.row(row) = row_of(contact, direction);
            problem_.velocity[row] = dot(relative, direction);
        }
        problem_.wanted[static_cast<Index>(i)] = contact.wanted;
        problem_.friction.push_back(contact.friction);
    }

    // Effect of an impulse along the direction, in the independent motions; zero where joints hold what it would move.
    Eigen::RowVectorXd row_of(const Contact& contact, const Vec3& direction) const {
        Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(static_cast<Index>(columns_.size()));
        double alone = 0;
        const auto add = [&](std::size_t body, const Vec3& arm, double sign) {
            const Vec3 moment = cross(arm, direction);
            for (std::size_t c = 0; c < columns_.size(); ++c) {
                const double* v = &columns_[c][6 * body];
                row[static_cast<Index>(c)] +=
                    sign * (dot({v[0], v[1], v[2]}, direction) + dot({v[3], v[4], v[5]}, moment));
            }
            const auto& response = bodies_[body].response;
            alone += dot(direction, response.linear * direction) + dot(moment, response.angular * moment);
        };
        add(contact.body, contact.arm, 1);
        if (contact.other >= 0) add(static_cast<std::size_t>(contact.other), contact.other_arm, -1);
        if (row.squaredNorm() <= constrained * alone) row.setZero();
        return row;
    }

    Vec3 velocity(const Contact& contact) const {
        const auto& body = bodies_[contact.body];
        Vec3 out = body.velocity + cross(body.spin, contact.arm);
        if (contact.other >= 0) {
            const auto& other = bodies_[static_cast<std::size_t>(contact.other)];
            out = out - other.velocity - cross(other.spin, contact.other_arm);
        }
        return out;
    }

    void give(std::size_t i, const Eigen::Vector3d& sizes) {
        Vec3 impulse{0, 0, 0};
        for (std::size_t k = 0; k < 3; ++k) impulse = impulse + sizes[static_cast<Index>(k)] * directions_[i][k];
        const auto receive = [&](SolverBody& body, const Vec3& arm, const Vec3& received) {
            body.impulse = body.impulse + received;
            body.angular_impulse = body.angular_impulse + cross(arm, received);
        };
        const auto& contact = contacts_[i];
        receive(bodies_[contact.body], contact.arm, impulse);
        if (contact.other >= 0) receive(bodies_[static_cast<std::size_t>(contact.other)], contact.other_arm, -impulse);
    }

    // Shifts of the poses, as impulses without friction give velocities: of an overlap a share is taken back, and others do not
    // become larger than what is tolerated.
    void part() {
        const double rest = tolerated * spacing_;
        bool any = false;
        for (std::size_t i = 0; i < contacts_.size(); ++i) {
            const double overlap = -contacts_[i].gap - rest;
            problem_.wanted[static_cast<Index>(i)] = overlap > 0 ? taken_back * overlap : overlap;
            any = any || overlap > 0;
        }
        if (!any) return;
        problem_.velocity.setZero();
        problem_.friction.assign(contacts_.size(), 0.0);
        const Eigen::VectorXd z = problem_.rows.transpose() * solve_friction(problem_, shifted * spacing_);
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            for (std::size_t c = 0; c < columns_.size(); ++c) {
                const double* v = &columns_[c][6 * b];
                const double size = z[static_cast<Index>(c)];
                bodies_[b].shift = bodies_[b].shift + size * Vec3{v[0], v[1], v[2]};
                bodies_[b].twist = bodies_[b].twist + size * Vec3{v[3], v[4], v[5]};
            }
        }
    }

    const std::vector<Contact>& contacts_;
    std::vector<SolverBody>& bodies_;
    std::vector<std::vector<double>> columns_;
    double spacing_;
    std::vector<std::array<Vec3, 3>> directions_; // normal and tangents
    FrictionProblem problem_;
};
} // namespace

void solve_contacts(const std::vector<Contact>& contacts, std::vector<SolverBody>& bodies,
    const ConstrainedInverseMass& together, double speed, double spacing) {
    Solver(contacts, bodies, together, spacing).solve(speed);
}

} // namespace treacle::rigid
