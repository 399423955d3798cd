#include "search/problem/random.hpp"

#include <cmath>
#include <numbers>
#include <span>

namespace treacle::search {

namespace {
struct Wide {
    std::uint32_t high, low;
};

Wide product(std::uint32_t a, std::uint32_t b) {
    const std::uint64_t wide = std::uint64_t{a} * b;
    return {static_cast<std::uint32_t>(wide >> 32), static_cast<std::uint32_t>(wide)};
}

double polynomial(std::span<const double> coefficients, double x) {
    double sum = 0;
    for (std::size_t k = coefficients.size(); k-- > 0;) sum = sum * x + coefficients[k];
    return sum;
}

struct Rational {
    std::array<double, 8> above, below;
    double operator()(double x) const { return polynomial(above, x) / polynomial(below, x); }
};

constexpr Rational middle{
    {3.3871328727963666080e0, 1.3314166789178437745e+2, 1.9715909503065514427e+3, 1.3731693765509461125e+4,
        4.5921953931549871457e+4, 6.7265770927008700853e+4, 3.3430575583588128105e+4, 2.5090809287301226727e+3},
    {1, 4.2313330701600911252e+1, 6.8718700749205790830e+2, 5.3941960214247511077e+3, 2.1213794301586595867e+4,
        3.9307895800092710610e+4, 2.8729085735721942674e+4, 5.2264952788528545610e+3}};
constexpr Rational near_tail{
    {1.42343711074968357734e0, 4.63033784615654529590e0, 5.76949722146069140550e0, 3.64784832476320460504e0,
        1.27045825245236838258e0, 2.41780725177450611770e-1, 2.27238449892691845833e-2, 7.74545014278341407640e-4},
    {1, 2.05319162663775882187e0, 1.67638483018380384940e0, 6.89767334985100004550e-1, 1.48103976427480074590e-1,
        1.51986665636164571966e-2, 5.47593808499534494600e-4, 1.05075007164441684324e-9}};
constexpr Rational far_tail{
    {6.65790464350110377720e0, 5.46378491116411436990e0, 1.78482653991729133580e0, 2.96560571828504891230e-1,
        2.65321895265761230930e-2, 1.24266094738807843860e-3, 2.71155556874348757815e-5, 2.01033439929228813265e-7},
    {1, 5.99832206555887937690e-1, 1.36929880922735805310e-1, 1.48753612908506148525e-2, 7.86869131145613259100e-4,
        1.84631831751005468180e-5, 1.42151175831644588870e-7, 2.04426310338993978564e-15}};
} // namespace

std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> c, std::array<std::uint32_t, 2> key) {
    for (int round = 0; round < 10; ++round) {
        const Wide a = product(0xD2511F53, c[0]), b = product(0xCD9E8D57, c[2]);
        c = {b.high ^ c[1] ^ key[0], b.low, a.high ^ c[3] ^ key[1], a.low};
        key[0] += 0x9E3779B9;
        key[1] += 0xBB67AE85;
    }
    return c;
}

double Random::uniform(
    Purpose purpose, std::uint32_t generation, std::uint32_t candidate, std::uint32_t coordinate) const {
    const auto bits = philox({generation, candidate, coordinate, static_cast<std::uint32_t>(purpose)}, key_);
    const std::uint64_t wide = std::uint64_t{bits[0]} << 32 | bits[1];
    return (static_cast<double>(wide >> 12) + 0.5) * 0x1p-52;
}

double Random::normal(
    Purpose purpose, std::uint32_t generation, std::uint32_t candidate, std::uint32_t coordinate) const {
    return normal_quantile(uniform(purpose, generation, candidate, coordinate));
}

double normal_quantile(double p) {
    const double q = p - 0.5;
    if (std::abs(q) <= 0.425) return q * middle(0.180625 - q * q);
    const double r = std::sqrt(-std::log(q < 0 ? p : 1 - p));
    const double size = r <= 5 ? near_tail(r - 1.6) : far_tail(r - 5);
    return q < 0 ? -size : size;
}

double normal_density(double x) { return std::exp(-0.5 * x * x) / std::sqrt(2 * std::numbers::pi); }

double normal_distribution(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

} // namespace treacle::search
