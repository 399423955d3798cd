#pragma once
#include "search/problem/matrix.hpp"

#include <vector>

namespace treacle::search {

// Constants of CMA-ES by dimension and population. Tags: README.
struct CmaConstants {
    std::size_t n = 1, lambda = 4, mu = 2;
    std::vector<double> weights; // [lambda] of the ranks; the first mu are positive and sum to 1
    double mu_eff = 1; // variance-effective number of parents: (sum w)^2 / sum w^2 of the positive weights, 1 to mu
    double c_sigma = 0, d_sigma = 1; // step size: memory of its path, damping
    double c_c = 0;                  // covariance: memory of its path
    double c_1 = 0, c_mu = 0;        // weight of the path, and of the candidates
    double chi = 1;                  // expected length of a standard normal vector

    // lambda 0: 4 + floor(3 ln n), but 8 in one dimension. Without `active` the weights of the worse half are 0.
    static CmaConstants standard(std::size_t dimensions, std::size_t population, bool active);
    static std::size_t standard_population(std::size_t n); // 4 + floor(3 ln n); 8 for n = 1
};

// Mean, step size and covariance of CMA-ES, and their update from the ranks of candidates. Independent of functions,
// bounds and random numbers.
class CmaState {
public:
    CmaState(std::vector<double> mean, double sigma, CmaConstants constants);

    // (C2) of a standard normal vector.
    std::vector<double> candidate(const std::vector<double>& normal) const;
    // (C3)-(C9) The candidates from the best to the worst; only the first `valued` of them have a value.
    void update(const std::vector<std::vector<double>>& ranked, std::size_t valued);

    const CmaConstants& constants() const { return constants_; } // fixed since the construction
    // [n] weighted mean of the last parents, in the state's coordinates
    const std::vector<double>& mean() const { return mean_; }
    double sigma() const { return sigma_; }              // step size, in the state's coordinates
    double deviation(std::size_t i) const;               // sigma sqrt(C_ii)
    double distance(const std::vector<double>& x) const; // from the mean, in deviations (Mahalanobis)
    // Component i of the covariance's path p_c times sigma
    double path(std::size_t i) const { return sigma_ * path_c_[i]; }
    const SymmetricEigen& axes() const { return eigen_; }    // of C
    const Matrix& covariance() const { return covariance_; } // C [n][n], symmetric; the distribution has sigma^2 C
    int updates() const { return updates_; }                 // generations so far [count]

private:
    std::vector<double> recombined(const std::vector<std::vector<double>>& ranked, std::size_t valued) const;
    std::vector<double> whitened(const std::vector<double>& y) const; // C^-1/2 y
    void update_step_size(const std::vector<double>& move);
    bool path_is_short() const;
    void update_covariance(const std::vector<std::vector<double>>& steps, const std::vector<double>& move);

    CmaConstants constants_;
    std::vector<double> mean_;
    double sigma_;
    std::vector<double> path_sigma_, path_c_;
    Matrix covariance_;
    SymmetricEigen eigen_;
    int updates_ = 0;
};

} // namespace treacle::search
