#pragma once
#include "search/population/gaussian_process.hpp"
#include "search/problem/random.hpp"
#include "search/problem/search.hpp"

namespace treacle::search {

// Options of SurrogateSearch.
struct SurrogateOptions {
    std::uint64_t seed = 1;    // of the hypercube and of the choice's random starts
    std::size_t first = 0;     // points of the first batch; 0: 2 n + 2
    std::size_t batch = 1;     // points of a later one, fixed by the study and not by its lanes
    double improvement = 1e-5; // over the range of values: an expected one below this ends the search
    Limits limits{};           // of evaluations, generations and the objective
};

// Efficient global optimisation (Jones et al. 1998): a Gaussian process through what was measured, and the next point
// at the largest expected improvement (E1). The first batch is the start and a Latin hypercube within two steps of it,
// followed by nearer ones while too few have values; further points of a batch are chosen as if those before had their
// expected values. Failed runs and bounds enter no fit: where they are, the choice assumes the worst value, or the
// bound.
class SurrogateSearch : public Search {
public:
    explicit SurrogateSearch(std::vector<Axis> axes, SurrogateOptions options = {});

    Point centre() const override; // the measured point of the least expected value
    Point spread() const override; // of the last batch from the centre
    const char* name() const override { return "surrogate"; }
    const std::optional<GaussianProcess>& model() const { return model_; } // in steps from the start

protected:
    Task<void> method() override;

private:
    struct Choice {
        Point x;
        double improvement = 0; // expected
    };
    std::vector<Point> hypercube(const Point& middle, double steps) const;
    std::vector<Point> next_points() const;
    void take(const std::vector<Point>& points, std::span<const Value> values);
    void fit();
    GaussianProcess with_believed() const;
    Choice choose(const GaussianProcess& model, std::uint32_t number) const;
    Point refined(const GaussianProcess& model, const Point& from) const;
    double expected_improvement(const GaussianProcess& model, const Point& x) const;
    std::vector<Axis> domain() const;
    Point drawn(const std::vector<Axis>& within, std::uint32_t number, std::uint32_t k) const;
    std::vector<double> scaled(const Point& x) const;
    bool is_known(const Point& x) const; // to the tolerance

    SurrogateOptions options_;
    Random random_;
    std::vector<Point> measured_, others_;
    std::vector<double> values_;
    std::vector<Value> other_values_; // failed, or bounds
    std::optional<GaussianProcess> model_;
    Point centre_, last_;
    std::uint32_t batches_ = 0;
};

} // namespace treacle::search
