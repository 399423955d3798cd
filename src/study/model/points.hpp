#pragma once
#include "study/model/study.hpp"

namespace treacle::study {

// A value for each parameter of a study, in their order, as it stands in a scene: "12 Pa.s", "grid".
using Point = std::vector<std::string>;

// The points of a sweep, in the order of its design; a grid's last parameter varies fastest. Latin hypercube: McKay,
// Beckman & Conover 1979, a point in each of `runs` equal parts of every range; Sobol: Joe & Kuo 2008, from Boost.
// Throws InputError for a design that its parameters do not serve, and for a file that does not name them.
std::vector<Point> sweep_points(const Study& study);

} // namespace treacle::study
