#include "identify/answer/search_space.hpp"

#include "base/text/error.hpp"
#include "identify/answer/identification.hpp"
#include "search/bracketing/bracketing.hpp"
#include "search/cma_es/cma_es.hpp"
#include "search/gradient/gauss_newton.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::identify {

double coordinate(const study::Parameter& parameter, double value) {
    return parameter.scale == study::Scale::log ? std::log(value) : value;
}
double value_of(const study::Parameter& parameter, double x) {
    const double value = parameter.scale == study::Scale::log ? std::exp(x) : x;
    return std::clamp(value, parameter.lower, parameter.upper);
}

std::vector<search::Axis> axes_of(const StudyFile& file) {
    std::vector<search::Axis> out;
    for (std::size_t k = 0; k < file.searched; ++k) {
        const auto& parameter = file.study.parameters[k];
        if (!parameter.has_range()) {
            throw InputError({parameter.where, parameter.name + " has no range",
                "`treacle identify` searches within ranges", "give it a `range`"});
        }
        if (parameter.key.starts_with("liquids.") && parameter.key.ends_with(".density")) {
            throw InputError({parameter.where, parameter.name + " cannot be searched",
                "silhouettes know the ratio of viscosity and density only: a flow "
                "twice as dense and twice as viscous looks the same",
                "weigh a measured volume of the liquid, and give the density under `measured` with its plus_minus"});
        }
        search::Axis axis;
        axis.lower = coordinate(parameter, parameter.lower);
        axis.upper = coordinate(parameter, parameter.upper);
        const auto start = parameter.number(parameter.start);
        axis.start = start ? coordinate(parameter, *start) : 0.5 * (axis.lower + axis.upper);
        axis.step = (axis.upper - axis.lower) / 4;
        const bool log = parameter.scale == study::Scale::log;
        axis.tolerance = file.search.tolerance * (log ? 1 : std::max(std::abs(axis.start), axis.step));
        out.push_back(axis);
    }
    if (out.empty()) {
        throw InputError({file.study.path.string(), "has no parameters", "there would be nothing to identify",
            "add one, for instance {key: liquids.syrup.viscosity, range: [0.1 Pa.s, 100 Pa.s], scale: log}"});
    }
    return out;
}

std::unique_ptr<search::Search> search_of(const StudyFile& file) {
    const auto axes = axes_of(file);
    search::Limits limits;
    limits.evaluations = file.search.evaluations;
    const auto seed = std::uint64_t(file.search.seed);
    const bool automatic = file.search.method == Method::automatic;
    if (file.search.method == Method::bracketing || (automatic && axes.size() == 1)) {
        if (axes.size() == 1) return std::make_unique<search::Bracketing>(axes.front(), limits);
        throw InputError(
            {file.study.path.string(), "search.method = bracketing, for " + std::to_string(axes.size()) + " parameters",
                "it brackets one", "write search: gauss_newton"});
    }
    if (file.search.method == Method::gauss_newton ||
        (automatic && file.search.objective == Objective::displacements)) {
        search::GaussNewtonOptions options;
        options.limits = limits;
        return std::make_unique<search::GaussNewton>(axes, options);
    }
    auto options =
        file.search.method == Method::dissertation ? search::CmaOptions::dissertation(seed) : search::CmaOptions{};
    options.seed = seed;
    options.limits.evaluations = limits.evaluations;
    return std::make_unique<search::CmaEs>(axes, options);
}

RangePrior range_prior(const StudyFile& file) {
    RangePrior out;
    if (file.searched < 2) return out;
    const auto axes = axes_of(file);
    out.lower = out.upper = Eigen::VectorXd(Eigen::Index(axes.size()));
    for (std::size_t k = 0; k < axes.size(); ++k) {
        out.lower[Eigen::Index(k)] = axes[k].lower;
        out.upper[Eigen::Index(k)] = axes[k].upper;
    }
    return out;
}

} // namespace treacle::identify
