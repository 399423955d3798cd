#pragma once
#include "search/cma_es/cma_state.hpp"
#include "search/cma_es/cma_stops.hpp"
#include "search/problem/box.hpp"
#include "search/problem/random.hpp"
#include "search/problem/search.hpp"

namespace treacle::search {

// Method by which candidates are kept within the bounds.
enum class BoundHandling {
    transform, // the search runs in a space without bounds (Box)
    resample,  // candidates beyond are drawn anew, up to 100 times, then mirrored at the bound: biased near it
};

// Options of CmaEs; the defaults are Hansen's, with the covariance's negative update.
struct CmaOptions {
    std::uint64_t seed = 1;     // of the counter-based random numbers: equal seeds draw equal candidates
    std::size_t population = 0; // 0: 4 + floor(3 ln n), 8 in one dimension
    bool active = true;         // bad candidates take away from the covariance (Jastrebski & Arnold 2006)
    BoundHandling bounds = BoundHandling::transform; // resampling is the dissertation's; it is biased near a bound
    int restarts = 0;                                // each with twice the population (IPOP, Auger & Hansen 2005)
    // Conditions that end one run (CmaStops), and those that end the whole search.
    CmaTolerances tolerances;
    Limits limits{}; // of all runs together

    // Section 6.5.5 of the dissertation, for axes without a logarithm: plain CMA-ES with resampling, 80 iterations.
    static CmaOptions dissertation(std::uint64_t seed);
};

// Covariance matrix adaptation (Hansen 2016). Tags (C1)-(C9): README. `ask` returns a whole generation.
class CmaEs : public Search {
public:
    explicit CmaEs(std::vector<Axis> axes, CmaOptions options = {});

    // The worst value among the parents of the last generation, its better half; none where not all of them were measured, so that cuts do not
    // close in.
    double cut(std::size_t) const override { return cut_; }
    Point centre() const override;
    Point spread() const override;
    const char* name() const override { return "cma-es"; }
    const CmaState& state() const { return state_; } // in steps from the preimage of the start
    // Candidates that `resample` rejected and drew again, through all runs [count]
    std::int64_t drawn_anew() const { return drawn_anew_; }
    int restarts() const { return restarts_; } // so far

protected:
    Task<void> method() override;
    // Values of a generation, of all candidates: measured ones here. candidates: in the state's coordinates.
    virtual Task<std::vector<Value>> values_of(const std::vector<std::vector<double>>& candidates);
    // Point that replaces the first candidate of the next generation, in the state's coordinates; none: no replacement.
    virtual std::optional<std::vector<double>> suggestion() const { return std::nullopt; }
    virtual void forget() {}                        // before a restart
    Point seen(const std::vector<double>& y) const; // in the axes' coordinates

private:
    Task<Stop> run();
    void begin_run();
    std::vector<double> drawn(std::uint32_t candidate); // in the state's coordinates
    bool within(const Point& x) const;
    std::vector<double> state_coordinates(const Point& x) const;
    void learn(const std::vector<std::vector<double>>& candidates, std::span<const Value> values);
    void keep_run();
    const CmaState& reported() const;
    Point mirrored(Point x) const;

    CmaOptions options_;
    Random random_;
    Box box_;
    std::vector<double> origin_; // preimage of the start
    CmaState state_;
    double cut_ = std::numeric_limits<double>::infinity();
    std::uint32_t generation_ = 0; // through all restarts
    std::int64_t drawn_anew_ = 0;
    int restarts_ = 0;
    double best_before_ = std::numeric_limits<double>::infinity(); // of the runs before the present one
    std::optional<CmaState> best_run_;                             // which had it
};

} // namespace treacle::search
