#pragma once
#include "search/problem/search.hpp"

namespace treacle::search {

// Options of the gradient methods; lengths are in steps of the axes.
struct GradientOptions {
    double difference = 0;   // to each side, in steps of the axis; 0: 1e-5, but no less than the tolerance
    std::size_t memory = 10; // pairs that L-BFGS keeps
    double rate = 0.1;       // momentum: length of the first move, in steps
    double momentum = 0.9;   // share of a move that the next one repeats
    Limits limits{};         // of evaluations (difference quotients included), generations and the objective
};

// Methods that follow gradients by central differences; the points of a gradient are requested at once. Everything is
// in steps of the axes.
class GradientSearch : public Search {
public:
    GradientSearch(std::vector<Axis> axes, GradientOptions options);

    // The gradient's points around the trial of a line search.
    std::vector<Point> speculate() const override;
    Point centre() const override { return here_.x; }
    Point spread() const override { return last_move_; }

protected:
    struct Iterate {
        Point x;
        Value f = Value::failed();
        std::vector<double> gradient; // [n] per step
    };

    // Goes to the start; false, and the search ends, where that has no value.
    Task<bool> begin();
    // Completes an iterate by its gradient, and by its value where that is not known.
    Task<void> look(Iterate& iterate);
    // Goes downhill along a direction, by a multiple of it that is returned; 0 where none that is long enough to matter is
    // better. `first` is the first trial's; `refined`: one more trial, at the vertex of the parabola.
    Task<double> line_search(const std::vector<double>& direction, double first, bool refined);
    // True, and the search ends, where the last move or all expected moves are below the tolerance.
    bool has_converged();
    void end_without_descent();
    std::vector<double> downhill() const;           // minus the gradient
    double distance_in_steps(const Point& x) const; // from the start
    Point moved(const Point& from, const std::vector<double>& direction, double length) const;

    const GradientOptions& options() const { return options_; }
    Iterate here_;
    Point last_move_; // [n] absolute, along the axes

private:
    Task<Value> value_at(Point x);
    void go_to(const Point& x, Value f);
    bool matters(const std::vector<double>& direction, double length) const;
    double difference(std::size_t i) const;
    std::vector<Point> around(const Point& x) const; // below and above along each axis

    GradientOptions options_;
    std::optional<Point> trial_;
};

} // namespace treacle::search
