#pragma once
#include "identify/estimate/residual_rows.hpp"

namespace treacle::identify {

// (I3) The parameters of a linear model r + G x whose reweighted squares are least within the priors.
struct Fit {
    Vector x, left, weights;
    Matrix inverse;            // of G^T W G + P
    std::vector<double> noise; // per experiment, in usual ones
};

// Options of a fit; parameters are the first columns, views follow.
struct FitOptions {
    bool usual_noise = false;     // that of the residuals otherwise
    double bend = 3;              // noises beyond which a residual counts linearly (Huber 1964)
    std::vector<double> dilution; // per experiment: how many correlated segments count as one
    Eigen::Index parameters = 0;  // columns before those of the views
    Vector pull = {};             // slope of what is known beside the residuals; empty: none
};

// Linear model r + G x of the residuals.
struct LinearModel {
    const Vector& r;           // [rows]
    const Matrix& g;           // [rows][columns]
    const Vector& size;        // [rows] weights before those of Huber
    const Matrix& information; // [columns][columns] of the priors
};

// Fit of the model to the rows of the layout, by rounds of reweighting.
Fit fit(const LinearModel& model, const Layout& layout, const FitOptions& options);

} // namespace treacle::identify
