#include "search/cma_es/cma_state.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::search {

namespace {
double square(double x) { return x * x; }

double effective(std::span<const double> weights) {
    double sum = 0, squares = 0;
    for (const double w : weights) {
        sum += w;
        squares += w * w;
    }
    return sum * sum / squares;
}

// (C1) Positive weights sum to 1, negative ones to as much as keeps C positive definite and its trace in balance.
void weigh(CmaConstants& c, std::span<const double> raw, bool active) {
    const double n = double(c.n);
    double positive = 0, negative = 0;
    for (std::size_t i = 0; i < c.mu; ++i) positive += raw[i];
    for (std::size_t i = c.mu; i < c.lambda; ++i) negative -= raw[i];
    c.weights.assign(c.lambda, 0.0);
    for (std::size_t i = 0; i < c.mu; ++i) c.weights[i] = raw[i] / positive;
    if (!active || c.c_mu == 0 || negative == 0) return;
    const double mu_eff_negative = effective(raw.subspan(c.mu));
    const double total =
        std::min({1 + c.c_1 / c.c_mu, 1 + 2 * mu_eff_negative / (c.mu_eff + 2), (1 - c.c_1 - c.c_mu) / (n * c.c_mu)});
    for (std::size_t i = c.mu; i < c.lambda; ++i) c.weights[i] = total * raw[i] / negative;
}
} // namespace

std::size_t CmaConstants::standard_population(std::size_t n) {
    if (n == 1) return 8; // 4, of which 2 are parents, follow noise and exact ties
    return 4 + static_cast<std::size_t>(3 * std::log(double(n)));
}

CmaConstants CmaConstants::standard(std::size_t dimensions, std::size_t population, bool active) {
    CmaConstants c;
    c.n = dimensions;
    c.lambda = population > 0 ? population : standard_population(dimensions);
    c.mu = c.lambda / 2;
    const double n = double(c.n), lambda = double(c.lambda);
    std::vector<double> raw;
    for (std::size_t i = 0; i < c.lambda; ++i) raw.push_back(std::log((lambda + 1) / 2) - std::log(double(i + 1)));
    c.mu_eff = effective(std::span(raw).first(c.mu));
    c.c_sigma = (c.mu_eff + 2) / (n + c.mu_eff + 3);
    c.d_sigma = 1 + 2 * std::max(0.0, std::sqrt((c.mu_eff - 1) / (n + 1)) - 1) + c.c_sigma;
    c.c_c = (4 + c.mu_eff / n) / (n + 4 + 2 * c.mu_eff / n);
    if (c.n > 1) { // in one dimension C repeats what sigma is
        c.c_1 = 2 * std::min(1.0, lambda / 6) / (square(n + 1.3) + c.mu_eff);
        c.c_mu = std::min(1 - c.c_1, 2 * (0.25 + c.mu_eff + 1 / c.mu_eff - 2) / (square(n + 2) + c.mu_eff));
    }
    c.chi = c.n == 1 ? std::sqrt(2 / std::acos(-1.0)) : std::sqrt(n) * (1 - 1 / (4 * n) + 1 / (21 * n * n));
    weigh(c, raw, active);
    return c;
}

CmaState::CmaState(std::vector<double> mean, double sigma, CmaConstants constants)
    : constants_(std::move(constants)), mean_(std::move(mean)), sigma_(sigma), path_sigma_(mean_.size(), 0.0),
      path_c_(mean_.size(), 0.0), covariance_(Matrix::identity(mean_.size())), eigen_(symmetric_eigen(covariance_)) {}

double CmaState::deviation(std::size_t i) const { return sigma_ * std::sqrt(covariance_(i, i)); }

std::vector<double> CmaState::candidate(const std::vector<double>& normal) const {
    std::vector<double> scaled(normal);
    for (std::size_t j = 0; j < scaled.size(); ++j) scaled[j] *= std::sqrt(eigen_.values[j]);
    auto x = multiply(eigen_.vectors, scaled);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = mean_[i] + sigma_ * x[i];
    return x;
}

std::vector<double> CmaState::whitened(const std::vector<double>& y) const {
    auto along = multiply_transposed(eigen_.vectors, y);
    for (std::size_t j = 0; j < along.size(); ++j) along[j] /= std::sqrt(eigen_.values[j]);
    return multiply(eigen_.vectors, along);
}

double CmaState::distance(const std::vector<double>& x) const {
    std::vector<double> y(x);
    for (std::size_t i = 0; i < y.size(); ++i) y[i] = (y[i] - mean_[i]) / sigma_;
    return norm(whitened(y));
}

// (C3) The weight of parents without a value goes to the others.
std::vector<double> CmaState::recombined(const std::vector<std::vector<double>>& ranked, std::size_t valued) const {
    const std::size_t parents = std::min(constants_.mu, valued);
    double weight = 0;
    for (std::size_t k = 0; k < parents; ++k) weight += constants_.weights[k];
    std::vector<double> mean(mean_.size(), 0.0);
    for (std::size_t k = 0; k < parents; ++k)
        for (std::size_t i = 0; i < mean.size(); ++i)
            mean[i] += constants_.weights[k] / weight * (ranked[k][i] - mean_[i]);
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += mean_[i];
    return mean;
}

void CmaState::update(const std::vector<std::vector<double>>& ranked, std::size_t valued) {
    const auto before = mean_;
    mean_ = recombined(ranked, valued); // (C3)
    std::vector<double> move(mean_.size());
    for (std::size_t i = 0; i < move.size(); ++i) move[i] = (mean_[i] - before[i]) / sigma_;
    std::vector<std::vector<double>> steps(ranked);
    for (auto& step : steps)
        for (std::size_t i = 0; i < step.size(); ++i) step[i] = (step[i] - before[i]) / sigma_;
    ++updates_;
    update_step_size(move);         // (C4), (C5)
    update_covariance(steps, move); // (C6)-(C9)
    eigen_ = symmetric_eigen(covariance_);
}

void CmaState::update_step_size(const std::vector<double>& move) {
    const auto& c = constants_;
    const auto white = whitened(move);
    const double weight = std::sqrt(c.c_sigma * (2 - c.c_sigma) * c.mu_eff);
    for (std::size_t i = 0; i < white.size(); ++i)
        path_sigma_[i] = (1 - c.c_sigma) * path_sigma_[i] + weight * white[i]; // (C4)
    const double change = c.c_sigma / c.d_sigma * (norm(path_sigma_) / c.chi - 1);
    sigma_ *= std::exp(std::min(1.0, change)); // (C5)
}

// (C6) h_sigma: a path that grows fast must not stretch C as well.
bool CmaState::path_is_short() const {
    const auto& c = constants_;
    const double grown = std::sqrt(1 - std::pow(1 - c.c_sigma, 2 * updates_));
    return norm(path_sigma_) / grown < (1.4 + 2 / (double(c.n) + 1)) * c.chi;
}

void CmaState::update_covariance(const std::vector<std::vector<double>>& steps, const std::vector<double>& move) {
    const auto& c = constants_;
    const std::size_t n = mean_.size();
    const bool h = path_is_short();
    const double weight = h ? std::sqrt(c.c_c * (2 - c.c_c) * c.mu_eff) : 0.0;
    for (std::size_t i = 0; i < n; ++i) path_c_[i] = (1 - c.c_c) * path_c_[i] + weight * move[i]; // (C7)
    if (c.c_1 + c.c_mu == 0) return;
    std::vector<double> weights(c.weights); // (C8) a bad step takes away no more than C has along it
    double total = 0;
    for (std::size_t k = 0; k < weights.size(); ++k) {
        total += c.weights[k];
        if (weights[k] < 0) weights[k] *= double(n) / (square(norm(whitened(steps[k]))) + 1e-300);
    }
    const double lost = h ? 0.0 : c.c_1 * c.c_c * (2 - c.c_c);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j <= i; ++j) {
            double sum = (1 - c.c_1 - c.c_mu * total + lost) * covariance_(i, j) + c.c_1 * path_c_[i] * path_c_[j];
            for (std::size_t k = 0; k < steps.size(); ++k) sum += c.c_mu * weights[k] * steps[k][i] * steps[k][j];
            covariance_(i, j) = covariance_(j, i) = sum; // (C9)
        }
    }
}

} // namespace treacle::search
