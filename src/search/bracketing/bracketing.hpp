#pragma once
#include "search/bracketing/brent.hpp"
#include "search/problem/residual_curve.hpp"

namespace treacle::search {

// One parameter, as the logarithm of a viscosity: the start and a step to both of its sides at once, then ever longer
// steps downhill until a minimum is between, then Brent's method; where residuals are given, the least value of their
// curve within the bracket comes before Brent's points, as long as it leads downhill. Where the least value is at a
// bound, the stop states it.
class Bracketing : public Search {
public:
    explicit Bracketing(const Axis& axis, const Limits& limits = {});

    bool uses_residuals() const override { return true; }
    void tell_residuals(std::vector<std::vector<double>> residuals) override { told_ = std::move(residuals); }
    // The next point should this one be as good as expected, and should it be worse; further steps downhill.
    std::vector<Point> speculate() const override;
    Point spread() const override; // half the bracket
    const char* name() const override { return "bracketing"; }

protected:
    Task<void> method() override;

private:
    Task<void> look_around();
    Task<bool> go_downhill();
    Task<void> refine();
    // Values of points in turn, whose residuals go into the curve.
    Task<std::vector<Value>> values_of(std::vector<Point> points);
    std::optional<double> curve_vertex() const; // none where the curve is not known
    std::size_t least() const;
    std::optional<double> downhill() const;
    std::optional<double> gap_at_bound() const;
    std::optional<double> further(double before, double from) const; // none at a bound
    void say_converged();

    std::vector<Sample> samples_; // in the order of x
    std::optional<Brent> brent_;  // once there is a bracket
    std::vector<std::vector<double>> told_;
    ResidualCurve curve_;
    bool downhill_ = true; // the curve's last point was better than all before
    bool led_ = false;     // the best point is one of the curve
};

} // namespace treacle::search
