#include "rigid/friction_problem.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace treacle::rigid {

namespace {
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int rounds = 40;
constexpr int idle_rounds = 8; // in a row that do not halve the error, after which the iteration ends
constexpr int sweeps = 20;     // of Gauss-Seidel, a round
constexpr int guesses = 40;    // of who touches, a round
constexpr int at_once = 8;     // of these, all contacts together
constexpr int multipliers = 6; // steps
constexpr double soft = 1e-7;  // regularisation, over a row's own response

enum class State { open, sticks, slides };

// Error of a contact's impulse and velocity, and the state that follows from it.
struct Verdict {
    State state = State::open;
    double slip[2] = {0, 0}; // unit, the direction of the friction
    double wrong = 0;        // [m/s]
};

class FrictionSolver {
public:
    FrictionSolver(const FrictionProblem& problem, double tolerance)
        : p_(problem), tolerance_(tolerance), contacts_(problem.wanted.size()),
          own_(problem.rows.rowwise().squaredNorm()), impulse_(VectorXd::Zero(3 * contacts_)),
          motion_(VectorXd::Zero(problem.rows.cols())) {}

    VectorXd solve() {
        VectorXd best = impulse_;
        double least = wrong(), before = least;
        for (int round = 0, idle = 0; round < rounds && idle < idle_rounds && least > tolerance_; ++round) {
            for (int k = 0; k < sweeps; ++k) sweep();
            keep_better(best, least);
            const VectorXd swept = impulse_;
            verdicts_.clear();
            for (int k = 0; k < guesses && least > tolerance_; ++k) {
                guess(k < at_once ? Guess::all : Guess::worst);
                solve_directly();
                // Nothing but the guess of the states uses impulses that pull.
                const VectorXd found = impulse_;
                project();
                keep_better(best, least);
                set(found);
            }
            const bool better = least <= 0.5 * before;
            idle = better ? 0 : idle + 1;
            set(better ? best : swept);
            before = least;
        }
        return best;
    }

private:
    void set(const VectorXd& impulse) {
        impulse_ = impulse;
        motion_.noalias() = p_.rows.transpose() * impulse_;
    }
    void keep_better(VectorXd& best, double& least) const {
        const double now = wrong();
        if (!(now < least)) return;
        best = impulse_;
        least = now;
    }
    double velocity(Index row) const { return p_.velocity[row] + p_.rows.row(row).dot(motion_); }
    void change(Index row, double by) {
        impulse_[row] += by;
        motion_ += by * p_.rows.row(row).transpose();
    }

    void sweep() {
        for (Index i = 0; i < contacts_; ++i) {
            const Index n = 3 * i;
            if (!(own_[n] > 0)) continue;
            change(n, std::max(0.0, impulse_[n] + (p_.wanted[i] - velocity(n)) / own_[n]) - impulse_[n]);
            if (!rubs(i)) continue;
            double drag[2];
            for (int t = 0; t < 2; ++t) {
                const Index row = n + 1 + t;
                drag[t] = own_[row] > 0 ? impulse_[row] - velocity(row) / own_[row] : 0;
            }
            const double size = std::hypot(drag[0], drag[1]),
                         most = p_.friction[static_cast<std::size_t>(i)] * impulse_[n];
            for (int t = 0; t < 2; ++t)
                change(n + 1 + t, (size > most ? most / size : 1) * drag[t] - impulse_[n + 1 + t]);
        }
    }
    bool rubs(Index i) const { return p_.friction[static_cast<std::size_t>(i)] > 0 && across(i) > 0; }
    double across(Index i) const { return std::max(own_[3 * i + 1], own_[3 * i + 2]); }

    // By the natural map: how far the impulses are from what they would be after a step along the velocities and a projection.
    Verdict judge(Index i) const {
        Verdict out;
        const Index n = 3 * i;
        if (!(own_[n] > 0)) return out;
        const double pressed = impulse_[n] + (p_.wanted[i] - velocity(n)) / own_[n];
        out.state = pressed > 0 ? State::sticks : State::open;
        out.wrong = std::abs(std::max(0.0, pressed) - impulse_[n]) * own_[n];
        if (!rubs(i)) return out;
        double drag[2];
        for (int t = 0; t < 2; ++t) drag[t] = impulse_[n + 1 + t] - velocity(n + 1 + t) / across(i);
        const double size = std::hypot(drag[0], drag[1]), friction = p_.friction[static_cast<std::size_t>(i)];
        const double most = friction * std::max(0.0, impulse_[n]);
        if (size > most) {
            if (out.state == State::sticks) out.state = State::slides;
            for (int t = 0; t < 2; ++t) {
                out.slip[t] = drag[t] / size;
                drag[t] *= most / size;
            }
        }
        for (int t = 0; t < 2; ++t)
            out.wrong = std::max(out.wrong, std::abs(drag[t] - impulse_[n + 1 + t]) * across(i));
        return out;
    }
    double wrong() const {
        double most = 0;
        for (Index i = 0; i < contacts_; ++i) most = std::max(most, judge(i).wrong);
        return most;
    }
    // Impulses that neither pull nor rub more than they may.
    void project() {
        for (Index i = 0; i < contacts_; ++i) {
            const Index n = 3 * i;
            impulse_[n] = std::max(0.0, impulse_[n]);
            const double size = std::hypot(impulse_[n + 1], impulse_[n + 2]),
                         most = p_.friction[static_cast<std::size_t>(i)] * impulse_[n];
            if (size > most) impulse_.segment<2>(n + 1) *= most / size;
        }
        set(impulse_);
    }

    // A row that constrains its velocity to `target`, by impulses along `along`.
    struct ActiveRow {
        Index row;
        double target;
        VectorXd along;
        double multiplier;
    };
    std::vector<ActiveRow> active_rows() const {
        std::vector<ActiveRow> out;
        for (Index i = 0; i < contacts_; ++i) {
            const auto& verdict = verdicts_[static_cast<std::size_t>(i)];
            const Index n = 3 * i;
            if (verdict.state == State::open) continue;
            out.push_back({n, p_.wanted[i], p_.rows.row(n).transpose(), impulse_[n]});
            if (!rubs(i)) continue;
            for (int t = 0; t < 2; ++t) {
                if (verdict.state == State::slides) {
                    out[out.size() - 1].along +=
                        p_.friction[static_cast<std::size_t>(i)] * verdict.slip[t] * p_.rows.row(n + 1 + t).transpose();
                }
            }
            if (verdict.state == State::slides) continue;
            for (Index row = n + 1; row <= n + 2; ++row) {
                if (own_[row] > 0) out.push_back({row, 0, p_.rows.row(row).transpose(), impulse_[row]});
            }
        }
        return out;
    }

    // The states of all contacts anew, or that of the one whose state is most wrong, without which the iteration may
    // cycle.
    enum class Guess { all, worst };
    void guess(Guess which) {
        std::vector<Verdict> now;
        for (Index i = 0; i < contacts_; ++i) now.push_back(judge(i));
        if (which == Guess::worst && !verdicts_.empty()) {
            std::size_t worst = now.size();
            for (std::size_t i = 0; i < now.size(); ++i) {
                if (now[i].state != verdicts_[i].state && (worst == now.size() || now[i].wrong > now[worst].wrong))
                    worst = i;
            }
            for (std::size_t i = 0; i < now.size(); ++i) {
                if (now[i].state != verdicts_[i].state && i != worst) now[i] = verdicts_[i];
            }
        }
        verdicts_ = std::move(now);
    }

    // The impulses of the present states: of z the motion and l the multipliers z = sum b l, l' = l + (target - u(z)) / softness.
    void solve_directly() {
        auto active = active_rows();
        const Index m = p_.rows.cols();
        MatrixXd matrix = MatrixXd::Identity(m, m);
        for (const auto& entry : active)
            matrix.noalias() += entry.along * (p_.rows.row(entry.row) / (soft * own_[entry.row]));
        const Eigen::PartialPivLU<MatrixXd> factors(matrix);
        for (int k = 0; k < multipliers; ++k) {
            VectorXd right = VectorXd::Zero(m);
            for (const auto& entry : active) {
                right += (entry.multiplier + (entry.target - p_.velocity[entry.row]) / (soft * own_[entry.row])) *
                         entry.along;
            }
            const VectorXd z = factors.solve(right);
            double change = 0;
            for (auto& entry : active) {
                const double missing = entry.target - p_.velocity[entry.row] - p_.rows.row(entry.row).dot(z);
                entry.multiplier += missing / (soft * own_[entry.row]);
                change = std::max(change, std::abs(missing));
            }
            if (change <= 0.1 * tolerance_) break;
        }
        VectorXd impulse = VectorXd::Zero(3 * contacts_);
        for (const auto& entry : active) {
            impulse[entry.row] = entry.multiplier;
            const auto i = entry.row / 3;
            const auto& verdict = verdicts_[static_cast<std::size_t>(i)];
            if (entry.row % 3 != 0 || verdict.state != State::slides) continue;
            for (int t = 0; t < 2; ++t) {
                impulse[entry.row + 1 + t] =
                    p_.friction[static_cast<std::size_t>(i)] * verdict.slip[t] * entry.multiplier;
            }
        }
        set(impulse);
    }

    const FrictionProblem& p_;
    double tolerance_;
    Index contacts_;
    VectorXd own_;                  // [1/kg] a row's response to its own impulse
    VectorXd impulse_;              // l
    VectorXd motion_;               // G^T l
    std::vector<Verdict> verdicts_; // of the direct solution
};
} // namespace

VectorXd solve_friction(const FrictionProblem& problem, double tolerance) {
    return FrictionSolver(problem, tolerance).solve();
}

} // namespace treacle::rigid
