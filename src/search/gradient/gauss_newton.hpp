#pragma once
#include "search/problem/matrix.hpp"
#include "search/problem/search.hpp"

namespace treacle::search {

// Options of GaussNewton, in units of the residuals' noise and shares of the objective.
struct GaussNewtonOptions {
    double bend = 3;     // noises beyond which residuals count linearly (Huber 1964)
    double flat = 0.005; // share of the objective: smaller gains end the search
    double noise = 0.2;  // objective below which residuals are within their noise, and the share is of this
    Limits limits{};     // of evaluations, generations and the objective
};

// Gauss-Newton within a trust region, on residuals that have no derivatives (the idea of DFO-LS, Cartis et al. 2019).
// Runs along each axis come first; then the derivatives are those of a weighted regression through all points near the
// best one, and where these are undetermined, those of before (multisecant, Fang & Saad 2009). Each round requests the
// best move, and beside it for a longer one where the radius binds, or for a point where the derivatives are known
// least. The gain of a move must exceed a cost of its length, so that a search along a flat valley ends where it is.
// Everything is in steps of the axes.
class GaussNewton : public Search {
public:
    explicit GaussNewton(std::vector<Axis> axes, GaussNewtonOptions options = {});

    bool uses_residuals() const override { return true; }
    void tell_residuals(std::vector<std::vector<double>> residuals) override { told_ = std::move(residuals); }
    Point spread() const override;
    const char* name() const override { return "gauss-newton"; }

protected:
    Task<void> method() override;

private:
    struct Trial {
        Point x;
        double value;
        std::vector<double> residuals; // [m]
    };
    struct Move {
        std::vector<double> d; // [n] steps
        double gain = 0;       // share of the objective that the model predicts
        bool binding = false;  // as long as the radius
    };
    Task<void> gather(std::vector<Point> points);
    std::vector<Point> first_points() const;
    void update_model();
    Move best_move(double radius) const;
    // Directions along which the points hardly determine the derivatives, as points beside x; the least determined one
    // first.
    std::vector<Point> unknown_beside(const Point& x, double least) const;
    double worth(double value) const; // the least gain that counts, as a share of the objective
    bool has_settled(const Move& move) const;
    void end_settled(const Move& move);
    void adapt_radius(const Move& move, const Trial& before, std::size_t first_new);
    double loss(std::span<const double> d) const; // sum over rows of the model
    Matrix normal_equations(std::span<const double> d, std::vector<double>& slope) const;
    Point moved(const Point& x, std::span<const double> d) const;
    std::vector<double> in_steps(const Point& from, const Point& to) const;
    const Trial& best_trial() const;

    GaussNewtonOptions options_;
    std::vector<std::vector<double>> told_;
    std::vector<Trial> trials_;        // with values
    std::vector<std::size_t> numbers_; // of the trials that the newest points became; none: trials_.size() of then
    std::vector<double> r_;            // [m] residuals of the best trial; 0 in rows that are left out
    Matrix j_;                         // [m][n] their derivatives by steps
    Matrix known_;                     // [n][n] information of the points on the derivatives
    double radius_ = 1;
    int idle_ = 0; // rounds without a gain that counts
};

} // namespace treacle::search
