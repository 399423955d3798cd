#pragma once
#include <cstddef>
#include <vector>

namespace treacle::search {

// (L1a) Residuals along one axis, in units of their noise: each row a parabola through the three points nearest to the best one. The objective,
// the mean of their losses (Huber 1964), is then known between runs far better than by a parabola through its own values, which
// are those of squares far from the minimum and of absolute values further away.
class ResidualCurve {
public:
    // As many rows each time; not a number where a row cannot be compared.
    void add(double x, std::vector<double> residuals);
    // Three points with residuals, of which `best` is one.
    bool is_known(double best) const;
    // Minimiser of the objective between `lower` and `upper`, to a distance of `step`.
    double least(double best, double lower, double upper, double step) const;
    // Distance of the point next to `best`.
    double nearest(double best) const;

private:
    struct Point {
        double x;
        std::vector<double> residuals;
    };
    std::vector<const Point*> three(double best) const;

    std::vector<Point> points_;
};

} // namespace treacle::search
