#pragma once
#include "search/gradient/gradient_search.hpp"

#include <deque>

namespace treacle::search {

// Limited-memory BFGS (Nocedal & Wright, algorithm 7.4) with a backtracking line search.
class Lbfgs : public GradientSearch {
public:
    explicit Lbfgs(std::vector<Axis> axes, GradientOptions options = {}) : GradientSearch(std::move(axes), options) {}
    const char* name() const override { return "l-bfgs"; }

protected:
    Task<void> method() override;

private:
    struct Pair {
        std::vector<double> move, change; // of the place and of its gradient
        double along = 0;                 // their product
    };
    std::vector<double> direction() const;
    void remember(const Iterate& before);
    std::deque<Pair> pairs_; // the newest last
};

// Nonlinear conjugate gradients, Polak & Ribiere's beta if positive (Nocedal & Wright, 5.2).
class ConjugateGradients : public GradientSearch {
public:
    explicit ConjugateGradients(std::vector<Axis> axes, GradientOptions options = {})
        : GradientSearch(std::move(axes), options) {}
    const char* name() const override { return "conjugate-gradients"; }

protected:
    Task<void> method() override;
};

// Gradient descent with momentum (Polyak 1964): each move is a share of the one before, less the gradient times a rate.
class MomentumDescent : public GradientSearch {
public:
    explicit MomentumDescent(std::vector<Axis> axes, GradientOptions options = {})
        : GradientSearch(std::move(axes), options) {}
    const char* name() const override { return "momentum"; }

protected:
    Task<void> method() override;
};

} // namespace treacle::search
