#pragma once
#include "search/cma_es/cma_state.hpp"
#include "search/problem/search.hpp"

namespace treacle::search {

// Limits of CmaStops; values are those of the objective.
struct CmaTolerances {
    double value = 1e-11;         // range of the best values of a while, and of the last generation, that ends a run
    double value_history = 1e-12; // likewise of the best values alone
    double condition = 1e14;      // of C
    double growth = 1e4; // of the largest deviation over that at the start: it was far too small, or it diverges
};

// Conditions that end a run of CMA-ES, of which the first that holds is named (Hansen 2016, appendix B.3).
class CmaStops {
public:
    // coordinate_tolerances: [n], in the coordinates of the state.
    CmaStops(CmaTolerances tolerances, std::vector<double> coordinate_tolerances);

    // After the state's update with these values.
    std::optional<Stop> after(const CmaState& state, std::span<const Value> values);

private:
    void remember(std::span<const Value> values);
    std::optional<Stop> of_values(const CmaState& state) const;
    std::optional<Stop> of_coordinates(const CmaState& state) const;
    bool stagnates(const CmaState& state) const;

    CmaTolerances tolerances_;
    std::vector<double> coordinates_;
    std::vector<double> best_, median_; // of the generations that had values
    double last_range_ = 0;             // of the values of the last generation
};

} // namespace treacle::search
