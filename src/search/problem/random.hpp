#pragma once
#include <array>
#include <cstdint>

namespace treacle::search {

// Philox 4x32-10 (Salmon et al. 2011): a bijection of the counter that the key picks.
std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key);

// Purpose of a random number. Numbers of different purposes are independent.
enum class Purpose : std::uint32_t { candidate, start, swarm_start, swarm_own, swarm_best, model };

// Random numbers without a state: each is a function of the seed, the purpose and where it is used.
class Random {
public:
    explicit Random(std::uint64_t seed)
        : key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)} {}

    // In (0, 1), odd multiples of 2^-53.
    double uniform(Purpose purpose, std::uint32_t generation, std::uint32_t candidate, std::uint32_t coordinate) const;
    // Normal number of mean 0 and variance 1.
    double normal(Purpose purpose, std::uint32_t generation, std::uint32_t candidate, std::uint32_t coordinate) const;

private:
    std::array<std::uint32_t, 2> key_;
};

// The number below which a standard normal variable is with a probability in (0, 1) (Wichura 1988, AS 241, PPND16):
// right to 1e-16 of its size, and apart from the logarithm in its tails the same bits on every machine.
double normal_quantile(double probability);
double normal_density(double x);
double normal_distribution(double x);

} // namespace treacle::search
