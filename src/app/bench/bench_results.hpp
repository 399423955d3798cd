#pragma once
#include "app/bench/bench_machine.hpp"
#include "io/value.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace treacle::app {

// Median and range of a quantity over the measured steps.
struct Spread {
    double median = 0, min = 0, max = 0; // unit of the values; 0 without values
};
Spread spread(std::vector<double> values);

// Contents and cost of one measured step; seconds are those of the slowest rank.
struct StepSample {
    double product = 0;         // one product with the step's pressure matrix, the median of several [s]
    std::vector<double> phases; // in the order of BenchResults::phases [s]
    double step = 0;            // [s]
    int iterations = 0;         // of the pressure solve
    double products = 0;        // of the pressure solve
    double set_up = 0;          // of its preconditioner [s]
    double imbalance = 1;       // most over mean liquid particles per rank
    Triad::Bandwidth triad;

    // Sums over the ranks.
    double liquid = 0, rows = 0, entries = 0; // particles; rows and stored entries of the matrix
    double liquid_pairs = 0, solid_pairs = 0; // entries of the neighbour lists
};

// Least bytes that a phase moves between memory and processor, by its name: every array that it needs once,
// what it does not need never. 0 for a phase without such a bound.
double least_bytes(const std::string& phase, const StepSample& sample);
// The same of a product.
double product_bytes(const StepSample& sample);

// All that a benchmark finds out.
struct BenchResults {
    std::string kind;
    int ranks = 1, threads = 1; // threads per rank
    std::int64_t liquid = 0, solid = 0;
    int disorder_steps = 0;
    Machine machine;
    std::vector<std::string> phases;
    std::vector<StepSample> steps;
    double peak_bytes = 0;    // summed over the ranks, beyond what they held before there were particles
    double counted_bytes = 0; // of the solver's own arrays, summed over the ranks
};

// Text for the terminal, and the same numbers for a JSON file in SI.
std::string bench_table(const BenchResults& figures);
io::Value bench_values(const BenchResults& figures);
// JSON without line ends.
std::string one_line(const io::Value& value);

} // namespace treacle::app
