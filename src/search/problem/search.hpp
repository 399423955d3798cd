#pragma once
#include "search/problem/task.hpp"

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace treacle::search {

using Point = std::vector<double>; // [n] in the coordinates of the axes

// One coordinate of a search, scaled before: the logarithm of a viscosity, not the viscosity.
struct Axis {
    double lower = -std::numeric_limits<double>::infinity(); // included; -infinity: none
    double upper = std::numeric_limits<double>::infinity();  // included; infinity: none
    double start = 0;                                        // first guess, within the bounds
    double step = 1;      // initial standard deviation of the search around the start
    double tolerance = 0; // a change too small to matter; 0: 1e-11 steps
    double smallest() const { return tolerance > 0 ? tolerance : 1e-11 * step; }
};

// The outcome of a candidate. Searches make it as small as they can.
class Value {
public:
    // Not finite: failed.
    static Value measured(double value);
    // A run that was ended early, when its objective had reached this already. It ranks as its bound, behind a
    // measured value of the same size, and enters no fit.
    static Value at_least(double bound);
    // Ranks behind everything.
    static Value failed() { return {}; }

    bool is_measured() const { return kind_ == Kind::measured; } // false for bounds and for failures
    bool is_failed() const { return kind_ == Kind::failed; }     // true for what never got a value; not for bounds
    double value() const { return value_; }                      // the value or the bound; infinite where failed
    bool operator<(const Value& other) const;

private:
    enum class Kind { measured, at_least, failed };
    Value() = default;
    Kind kind_ = Kind::failed;
    double value_ = std::numeric_limits<double>::infinity();
};

// Indices of the values from the best to the worst; ties, exact ones among them, in the order of the candidates.
std::vector<std::size_t> ranking(std::span<const Value> values);

// Class of the condition that ended a search; Stop::name has the condition itself.
enum class StopKind {
    target,    // the target value is reached
    converged, // the answer is within the tolerances
    stalled,   // no progress can be expected
    budget,    // evaluations or generations are used up
    failed,    // no candidate had a value
};

// Condition that ended a search.
struct Stop {
    StopKind kind = StopKind::converged;
    std::string name; // one word, such as "tolx"
    std::string text; // a sentence for the report
};

// Best measured candidate of a search.
struct Best {
    Point point;                 // in the coordinates of the axes
    double value = 0;            // of the objective
    std::int64_t evaluation = 0; // its number, from 0
};

// Ends of any search, beside those of its method.
struct Limits {
    std::int64_t evaluations = std::numeric_limits<std::int64_t>::max(); // never exceeded
    int generations = std::numeric_limits<int>::max();
    double target = -std::numeric_limits<double>::infinity(); // a value at which the search may end
};

// A search returns points (`ask`) and takes their values (`tell`). It depends on its axes, options and the values
// alone, never on time or the order in which runs end: after the same values it returns the same points, bit for bit,
// so that a journal of values is all that its state needs.
//
//   while (!search.stopped()) {
//       const auto& points = search.ask();   // run them, in any order
//       search.tell(values);                 // in the order of the points
//   }
class Search {
public:
    virtual ~Search() = default;
    Search(const Search&) = delete;
    Search& operator=(const Search&) = delete;

    // Points whose values are needed next. They can be run at once, and lie within the bounds. The same until
    // `tell`; empty once stopped.
    const std::vector<Point>& ask();
    // Residuals of each point, whose mean loss its value is, in units of their noise; passed before the values, to
    // searches that use them. All points have as many; not a number where one cannot be compared, none where the run
    // failed.
    virtual bool uses_residuals() const { return false; }
    virtual void tell_residuals(std::vector<std::vector<double>>) {}
    // One value a point, in their order.
    void tell(std::span<const Value> values);
    // Candidates for the generation after this one, the likeliest first: work for lanes that would idle. Their values
    // are not passed to `tell`: they stay in the study's cache until `ask` returns the point, and the search is the
    // same with or without.
    virtual std::vector<Point> speculate() const { return {}; }
    // A run of the k-th point of `ask` may end early once its objective is above this; infinite: it may not.
    // Computed at `ask`, from closed generations only.
    virtual double cut(std::size_t) const { return std::numeric_limits<double>::infinity(); }

    const std::optional<Stop>& stopped() const { return stop_; } // none while `ask` still returns points
    const std::optional<Best>& best() const { return best_; }    // of measured values
    virtual Point centre() const;         // best estimate of the answer; the best point where the method has no other
    virtual Point spread() const = 0;     // [n] extent of the search around the centre, along each axis
    virtual const char* name() const = 0; // as in the study's file and the report

    std::int64_t evaluations() const { return evaluations_; } // values passed to `tell`
    int generations() const { return generations_; }          // calls of `tell`
    const std::vector<Axis>& axes() const { return axes_; }   // in the order of a Point's coordinates
    std::size_t dimensions() const { return axes_.size(); }   // n, the length of every Point

protected:
    // Throws InputError for an axis whose start is not within its bounds or whose step is not positive.
    Search(std::vector<Axis> axes, const Limits& limits);

    // The method, from top to bottom: it suspends at `co_await evaluate(points)` until `tell`, and ends with `end`.
    virtual Task<void> method() = 0;
    void end(StopKind kind, std::string name, std::string text);

    class Evaluation {
    public:
        explicit Evaluation(Search& search) : search_(search) {}
        bool await_ready() const noexcept { return false; }
        void await_suspend(std::coroutine_handle<> caller) noexcept { search_.waiting_ = caller; }
        std::vector<Value> await_resume() noexcept { return std::move(search_.values_); }

    private:
        Search& search_;
    };
    Evaluation evaluate(std::vector<Point> points);

    Point start() const;
    // The nearest point within the bounds.
    Point clamped(Point point) const;

private:
    void advance();
    void look_at_limits();

    std::vector<Axis> axes_;
    Limits limits_;
    std::optional<Task<void>> task_;
    std::coroutine_handle<> waiting_;
    std::vector<Point> points_;
    std::vector<Value> values_;
    std::optional<Stop> stop_;
    std::optional<Best> best_;
    std::int64_t evaluations_ = 0;
    int generations_ = 0;
};

} // namespace treacle::search
