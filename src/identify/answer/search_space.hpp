#pragma once
#include "identify/experiment/study_file.hpp"
#include "search/problem/search.hpp"

#include <memory>
#include <vector>

namespace treacle::identify {

// The search's coordinate of a parameter's value, its logarithm on a logarithmic scale, and back; the value within its range.
double coordinate(const study::Parameter& parameter, double value);
double value_of(const study::Parameter& parameter, double x);

// The axes of the searched parameters. Throws InputError without a parameter, and for one without a range or on which
// silhouettes do not depend.
std::vector<search::Axis> axes_of(const StudyFile& file);

// The search of a study's method. Throws InputError as axes_of(), and for a method that does not suit the number of
// parameters.
std::unique_ptr<search::Search> search_of(const StudyFile& file);

} // namespace treacle::identify
