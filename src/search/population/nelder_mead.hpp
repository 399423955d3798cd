#pragma once
#include "search/problem/search.hpp"

namespace treacle::search {

// Conditions that end a simplex search, beside edges below the axes' tolerances.
struct NelderMeadOptions {
    double value_tolerance = 1e-11; // range of the vertices' values that ends the search together with small edges
    Limits limits{};                // of evaluations, generations and the objective
};

// The simplex method of Nelder & Mead 1965 with the coefficients that Gao & Han 2012 fit to the dimension. Vertices beyond a
// bound are put onto it.
class NelderMead : public Search {
public:
    explicit NelderMead(std::vector<Axis> axes, NelderMeadOptions options = {});

    // The other points that this step may request.
    std::vector<Point> speculate() const override { return others_; }
    // A reflected or contracted vertex counts only when it is better than the worst: no difference to the search.
    double cut(std::size_t) const override { return cut_; }
    Point spread() const override; // the farthest vertex from the best, along each axis
    const char* name() const override { return "nelder-mead"; }

protected:
    Task<void> method() override;

private:
    struct Vertex {
        Point x;
        Value f = Value::failed();
    };
    Task<void> begin();
    Task<void> replace_worst();
    Task<void> shrink();
    Task<Vertex> value_at(Point x, double cut);
    Point along(double factor) const; // centroid + factor (centroid - worst), within the bounds
    void sort();
    bool has_converged();

    NelderMeadOptions options_;
    std::vector<Vertex> simplex_; // from the best to the worst
    std::vector<Point> others_;
    double cut_ = std::numeric_limits<double>::infinity();
};

} // namespace treacle::search
