#pragma once
#include "search/problem/search.hpp"

namespace treacle::search {

// One evaluation of the objective.
struct Sample {
    double x = 0;              // in the coordinate of the axis
    Value f = Value::failed(); // any kind: bounds and failures as well
};

// The least value of a function of one variable within a bracket (Brent 1973, chapter 5), with a second model: beside the
// parabola through the three best values (L1) stands the corner of two lines through four neighbours (L2), which an
// objective that sums absolute differences has. The next point is that of the model that was nearer to the last value;
// where neither may be used, by Brent's rules, it is that of the golden section. Points lie on a lattice of half the tolerance
// around the origin. Values that are bounds or failures move the bracket but enter no model.
class Brent {
public:
    // Samples in ascending order of x, at least one. The best one and its neighbours are the bracket; at an end of the
    // range the best one is a bound of it. tolerance: of x. origin: a point of the lattice.
    Brent(std::vector<Sample> samples, double tolerance, double origin);

    bool converged() const;                     // Brent's test: |x - middle| <= 2 tolerance - half the bracket's width
    double next() const { return propose().x; } // on the lattice, within the bracket
    void accept(Value f) { accept(propose(), f); }                 // the value at next()
    void accept(double x, Value f) { accept({x, last_step_}, f); } // at another point within the bracket
    double on_lattice(double u) const;                             // nearest lattice point: origin + k tolerance / 2
    // Sample with the least value so far; bounds and failures in the order of ranking()
    const Sample& best() const { return x_; }
    double lower() const { return lower_; } // end of the bracket, in the coordinate of the axis
    double upper() const { return upper_; } // end of the bracket, in the coordinate of the axis
    // Prediction of the better model at next(); failed where there is none.
    Value expected() const;

private:
    enum class Model { parabola, corner };
    struct Proposal {
        double x = 0;
        double bound = 0; // of the step after next, by Brent's rule
    };
    struct Vertex {
        double x = 0, f = 0;
    };
    Proposal propose() const;
    void accept(const Proposal& proposal, Value f);
    bool allowed(double u) const;
    std::optional<Vertex> vertex(Model model) const;
    std::optional<Vertex> parabola_vertex() const;
    std::optional<Vertex> corner_vertex() const;
    std::optional<double> expectation(Model model, double u) const;
    void judge_models(double u, double f);
    std::vector<Sample> measured() const;

    double tolerance_, origin_;
    double lower_ = 0, upper_ = 0;
    Sample x_, w_, v_; // the best, the next best and the one before
    double step_before_last_ = 0, last_step_ = 0;
    Model better_ = Model::parabola;
    std::vector<Sample> samples_; // all, in the order of x
};

} // namespace treacle::search
