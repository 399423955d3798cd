#include "search/bracketing/brent.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::search {

namespace {
constexpr double golden = 0.3819660112501051; // (3 - sqrt 5) / 2

struct Line {
    double x, f, slope;
    Line(const Sample& a, const Sample& b) : x(a.x), f(a.f.value()), slope((b.f.value() - a.f.value()) / (b.x - a.x)) {}
    double at(double u) const { return f + slope * (u - x); }
};

double meeting(const Line& a, const Line& b) {
    return (b.f - b.slope * b.x - a.f + a.slope * a.x) / (a.slope - b.slope);
}
} // namespace

Brent::Brent(std::vector<Sample> samples, double tolerance, double origin)
    : tolerance_(tolerance), origin_(origin), samples_(std::move(samples)) {
    std::vector<Value> values;
    for (const Sample& sample : samples_) values.push_back(sample.f);
    const auto order = ranking(values);
    const std::size_t best = order[0];
    x_ = samples_[best];
    w_ = samples_[order[std::min<std::size_t>(1, order.size() - 1)]];
    v_ = samples_[order[std::min<std::size_t>(2, order.size() - 1)]];
    lower_ = best > 0 ? samples_[best - 1].x : x_.x;
    upper_ = best + 1 < samples_.size() ? samples_[best + 1].x : x_.x;
    step_before_last_ = last_step_ = upper_ - lower_;
}

bool Brent::converged() const {
    return std::abs(x_.x - 0.5 * (lower_ + upper_)) <= 2 * tolerance_ - 0.5 * (upper_ - lower_) + 1e-9 * tolerance_;
}

double Brent::on_lattice(double u) const {
    const double spacing = 0.5 * tolerance_;
    return origin_ + spacing * std::round((u - origin_) / spacing);
}

// Brent's conditions: within the bracket, and less than half the step before the last.
bool Brent::allowed(double u) const {
    return u > lower_ && u < upper_ && std::abs(u - x_.x) < 0.5 * std::abs(step_before_last_);
}

Brent::Proposal Brent::propose() const {
    const double middle = 0.5 * (lower_ + upper_);
    const double longer = x_.x < middle ? upper_ - x_.x : lower_ - x_.x;
    double step = golden * longer, bound = longer;
    if (const auto at = vertex(better_); at && allowed(at->x)) {
        bound = last_step_;
        step = at->x - x_.x;
        if (at->x - lower_ < 2 * tolerance_ || upper_ - at->x < 2 * tolerance_)
            step = std::copysign(tolerance_, middle - x_.x);
    }
    if (std::abs(step) < tolerance_) step = std::copysign(tolerance_, step);
    return {std::clamp(on_lattice(x_.x + step), lower_, upper_), bound};
}

void Brent::accept(const Proposal& proposal, Value f) {
    const Sample u{proposal.x, f};
    if (f.is_measured()) judge_models(u.x, f.value());
    step_before_last_ = proposal.bound;
    last_step_ = u.x - x_.x;
    const auto above = std::find_if(samples_.begin(), samples_.end(), [&](const Sample& s) { return s.x > u.x; });
    samples_.insert(above, u);
    if (!(x_.f < u.f)) {
        (u.x >= x_.x ? lower_ : upper_) = x_.x;
        v_ = w_;
        w_ = x_;
        x_ = u;
    } else {
        (u.x < x_.x ? lower_ : upper_) = u.x;
        if (!(w_.f < u.f) || w_.x == x_.x) {
            v_ = w_;
            w_ = u;
        } else if (!(v_.f < u.f) || v_.x == x_.x || v_.x == w_.x) {
            v_ = u;
        }
    }
}

std::optional<Brent::Vertex> Brent::vertex(Model model) const {
    return model == Model::parabola ? parabola_vertex() : corner_vertex();
}

// (L1)
std::optional<Brent::Vertex> Brent::parabola_vertex() const {
    for (const Sample* s : {&x_, &w_, &v_})
        if (!s->f.is_measured()) return std::nullopt;
    const double r = (x_.x - w_.x) * (x_.f.value() - v_.f.value()), q = (x_.x - v_.x) * (x_.f.value() - w_.f.value());
    const double above = (x_.x - v_.x) * q - (x_.x - w_.x) * r, below = 2 * (q - r);
    const double u = x_.x - above / below;
    if (!std::isfinite(u)) return std::nullopt;
    return Vertex{u, expectation(Model::parabola, u).value_or(x_.f.value())};
}

std::vector<Sample> Brent::measured() const {
    std::vector<Sample> out;
    for (const Sample& s : samples_)
        if (s.f.is_measured()) out.push_back(s);
    return out;
}

// (L2) The corner lies between the best point and the neighbour on one of its sides: of both the lower one.
std::optional<Brent::Vertex> Brent::corner_vertex() const {
    const auto known = measured();
    const auto at = std::find_if(known.begin(), known.end(), [&](const Sample& s) { return s.x == x_.x; });
    const auto i = static_cast<std::size_t>(at - known.begin());
    std::optional<Vertex> out;
    const auto consider = [&](std::size_t first) {
        const Line left(known[first], known[first + 1]), right(known[first + 2], known[first + 3]);
        const double u = meeting(left, right);
        if (!(left.slope < 0 && right.slope > 0) || u < known[first + 1].x || u > known[first + 2].x) return;
        if (!out || left.at(u) < out->f) out = Vertex{u, left.at(u)};
    };
    if (at == known.end()) return out;
    if (i >= 2 && i + 1 < known.size()) consider(i - 2);
    if (i >= 1 && i + 2 < known.size()) consider(i - 1);
    return out;
}

std::optional<double> Brent::expectation(Model model, double u) const {
    if (model == Model::corner) {
        const auto corner = corner_vertex();
        if (!corner) return std::nullopt;
        const auto known = measured();
        const bool left = u < corner->x;
        const auto next = std::find_if(known.begin(), known.end(), [&](const Sample& s) { return s.x > corner->x; });
        const auto k = next - known.begin();
        if (left ? k < 2 : k + 2 > static_cast<std::ptrdiff_t>(known.size())) return std::nullopt;
        return left ? Line(*(next - 2), *(next - 1)).at(u) : Line(*next, *(next + 1)).at(u);
    }
    if (x_.x == w_.x || w_.x == v_.x || x_.x == v_.x) return std::nullopt;
    const Line chord(x_, w_);
    const double bend = (Line(w_, v_).slope - chord.slope) / (v_.x - x_.x); // Newton's form
    return chord.at(u) + bend * (u - x_.x) * (u - w_.x);
}

// The model that was nearer to a new value is used next.
void Brent::judge_models(double u, double f) {
    const bool fits = x_.f.is_measured() && w_.f.is_measured() && v_.f.is_measured();
    const auto parabola = fits ? expectation(Model::parabola, u) : std::nullopt;
    const auto corner = expectation(Model::corner, u);
    if (!parabola || !corner) {
        better_ = Model::parabola;
        return;
    }
    better_ = std::abs(*corner - f) < std::abs(*parabola - f) ? Model::corner : Model::parabola;
}

Value Brent::expected() const {
    const auto at = vertex(better_);
    const auto value = at ? expectation(better_, next()) : std::nullopt;
    return value ? Value::measured(*value) : Value::failed();
}

} // namespace treacle::search
