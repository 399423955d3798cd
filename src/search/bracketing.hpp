#pragma once
#include "search/brent.hpp"

namespace treacle::search {

// One parameter, as the logarithm of a viscosity: the start and a step to both of its sides at once, then ever longer steps
// downhill until a minimum is between, then Brent's method. Where the least value is at a bound, the stop says so.
class Bracketing : public Search {
public:
    explicit Bracketing(const Axis& axis, const Limits& limits = {});

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
    std::size_t least() const;
    std::optional<double> downhill() const;
    std::optional<double> gap_at_bound() const;
    std::optional<double> further(double before, double from) const; // none at a bound
    void say_converged();

    std::vector<Sample> samples_; // in the order of x
    std::optional<Brent> brent_; // once there is a bracket
};

} // namespace treacle::search
