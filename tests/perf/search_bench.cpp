// Evaluations that the searches of src/search need, as lines of CSV: "search_bench functions SEEDS" on smooth functions,
// "search_bench ladder FILE VISCOSITY SEEDS" on an objective that was tabled before.
#include "../unit/search/functions.hpp"
#include "search/bracketing/bracketing.hpp"
#include "search/cma_es/cma_es.hpp"
#include "search/cma_es/lq_cma_es.hpp"
#include "search/gradient/gradient_methods.hpp"
#include "search/population/nelder_mead.hpp"
#include "search/population/surrogate_search.hpp"
#include "search/population/swarm.hpp"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>

namespace {
using namespace treacle::search;

constexpr double function_target = 1e-9;

struct Problem {
    const char* name;
    double (*f)(const Point&);
    double start, step;
};

template <class Method>
void print_problem(const Problem& problem, const char* variant, bool active, std::uint64_t seeds) {
    for (const std::size_t n : {2, 5, 10})
        for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
            CmaOptions options;
            options.seed = seed;
            options.active = active;
            options.limits.target = function_target;
            Method search(axes(n, problem.start, problem.step), options);
            minimise(search, problem.f);
            std::printf("%s,%zu,%s,%lu,%ld,%d\n", problem.name, n, variant, static_cast<unsigned long>(seed),
                static_cast<long>(search.evaluations()), search.stopped()->kind == StopKind::target);
        }
}

void print_functions(std::uint64_t seeds) {
    std::printf("function,n,variant,seed,evaluations,reached\n");
    for (const Problem& problem : {Problem{"sphere", sphere, 1, 1}, Problem{"ellipsoid", ellipsoid, 1, 1},
             Problem{"rosenbrock", rosenbrock, 0, 0.5}}) {
        print_problem<CmaEs>(problem, "active", true, seeds);
        print_problem<CmaEs>(problem, "plain", false, seeds);
        print_problem<LqCmaEs>(problem, "lq", true, seeds);
    }
}

// An objective by the logarithm of the viscosity, at even distances; the nearest entry counts.
class Ladder {
public:
    explicit Ladder(const char* path) {
        std::ifstream file(path);
        for (double x = 0, f = 0; file >> x >> f;) {
            points_.push_back(x);
            values_.push_back(f);
        }
        if (points_.size() < 2) {
            std::fprintf(stderr,
                "search_bench: %s: no ladder; lines with the logarithm of a viscosity and a value are needed\n", path);
            std::exit(2);
        }
    }
    double lowest() const { return points_.front(); }
    double highest() const { return points_.back(); }
    double at(double x) const {
        const double k = (x - lowest()) / (points_[1] - points_[0]);
        const auto last = static_cast<double>(points_.size() - 1);
        return values_[static_cast<std::size_t>(std::clamp(std::round(k), 0.0, last))];
    }

private:
    std::vector<double> points_, values_;
};

constexpr Limits budget{.evaluations = 320}; // 80 generations of 4

struct Entry {
    const char* name;
    std::function<std::unique_ptr<Search>(const Axis&, std::uint64_t)> make;
    bool linear = false; // on the viscosity itself, as in section 6.5.5 of the dissertation
};

template <class Method>
std::unique_ptr<Search> gradient(const Axis& axis, std::uint64_t) {
    return std::make_unique<Method>(std::vector{axis}, GradientOptions{.limits = budget});
}

template <class Method>
std::unique_ptr<Search> cma(const Axis& axis, std::uint64_t seed) {
    CmaOptions options;
    options.seed = seed;
    options.limits = budget;
    return std::make_unique<Method>(std::vector{axis}, options);
}

std::vector<Entry> methods() {
    return {
        {"bracketing", [](const Axis& a, std::uint64_t) { return std::make_unique<Bracketing>(a, budget); }},
        {"surrogate",
            [](const Axis& a, std::uint64_t seed) {
                SurrogateOptions options;
                options.seed = seed;
                options.limits.evaluations = 60;
                return std::make_unique<SurrogateSearch>(std::vector{a}, options);
            }},
        {"cma-es", cma<CmaEs>},
        {"lq-cma-es", cma<LqCmaEs>},
        {"dissertation",
            [](const Axis& a, std::uint64_t seed) {
                CmaOptions options = CmaOptions::dissertation(seed);
                options.population = 4;
                return std::make_unique<CmaEs>(std::vector{a}, options);
            },
            true},
        {"nelder-mead",
            [](const Axis& a, std::uint64_t) {
                return std::make_unique<NelderMead>(std::vector{a}, NelderMeadOptions{.limits = budget});
            }},
        {"swarm",
            [](const Axis& a, std::uint64_t seed) {
                SwarmOptions options;
                options.seed = seed;
                options.limits = budget;
                return std::make_unique<Swarm>(std::vector{a}, options);
            }},
        {"l-bfgs", gradient<Lbfgs>},
        {"conjugate-gradients", gradient<ConjugateGradients>},
        {"momentum", gradient<MomentumDescent>},
    };
}

// Starts between 0.1 and 300 Pa s for logarithms; between 0 and 300 Pa s with deviations of 10 to 300 Pa s else.
Axis drawn_axis(const Ladder& ladder, std::uint64_t seed, bool linear) {
    const Random random(seed);
    const double u = random.uniform(Purpose::start, 0, 0, 0), v = random.uniform(Purpose::start, 0, 0, 1);
    Axis axis;
    if (linear) {
        axis.lower = 0;
        axis.start = 300 * u;
        axis.step = 10 + 290 * v;
        return axis;
    }
    axis.lower = ladder.lowest();
    axis.upper = ladder.highest();
    axis.start = std::log(0.1) + u * std::log(3000.0);
    axis.step = 2;
    axis.tolerance = 0.01;
    return axis;
}

// Evaluations until the best so far is within 2 % of the viscosity, and stays there; how many there were in all.
void print_ladder(const Ladder& ladder, double viscosity, std::uint64_t seeds) {
    std::printf("method,seed,evaluations,reached,found,all,stop\n");
    for (const Entry& entry : methods())
        for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
            const auto search = entry.make(drawn_axis(ladder, seed, entry.linear), seed);
            std::int64_t since = -1, asked = 0;
            double least = std::numeric_limits<double>::infinity(), found = 0;
            while (!search->stopped()) {
                const auto points = search->ask();
                if (points.empty()) break;
                std::vector<Value> values;
                for (const Point& x : points) {
                    const double eta = entry.linear ? x[0] : std::exp(x[0]);
                    const double f = ladder.at(std::log(std::max(eta, 1e-300)));
                    values.push_back(Value::measured(f));
                    ++asked;
                    if (f >= least) continue;
                    least = f;
                    found = eta;
                    const bool near = std::abs(eta / viscosity - 1) <= 0.02;
                    if (!near) since = -1;
                    if (near && since < 0) since = asked;
                }
                search->tell(values);
            }
            std::printf("%s,%lu,%ld,%d,%.6g,%ld,%s\n", entry.name, static_cast<unsigned long>(seed),
                static_cast<long>(since), since >= 0, found, static_cast<long>(asked), search->stopped()->name.c_str());
        }
}

int refuse() {
    std::fprintf(stderr, "usage: search_bench functions SEEDS | search_bench ladder FILE VISCOSITY SEEDS\n");
    return 2;
}
} // namespace

int main(int count, char** words) {
    if (count == 3 && std::strcmp(words[1], "functions") == 0) {
        print_functions(std::strtoull(words[2], nullptr, 10));
        return 0;
    }
    if (count != 5 || std::strcmp(words[1], "ladder") != 0) return refuse();
    print_ladder(Ladder(words[2]), std::strtod(words[3], nullptr), std::strtoull(words[4], nullptr, 10));
    return 0;
}
