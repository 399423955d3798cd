#pragma once
#include "search/problem/search.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

namespace treacle::search {

using Function = std::function<double(const Point&)>;

inline double sphere(const Point& x) {
    double sum = 0;
    for (const double c : x) sum += c * c;
    return sum;
}

// Axes from 1 to 1e6.
inline double ellipsoid(const Point& x) {
    double sum = 0;
    for (std::size_t i = 0; i < x.size(); ++i)
        sum += std::pow(1e6, x.size() > 1 ? double(i) / double(x.size() - 1) : 0) * x[i] * x[i];
    return sum;
}

inline double rosenbrock(const Point& x) {
    double sum = 0;
    for (std::size_t i = 0; i + 1 < x.size(); ++i)
        sum += 100 * std::pow(x[i + 1] - x[i] * x[i], 2) + std::pow(1 - x[i], 2);
    return sum;
}

inline std::vector<Axis> axes(std::size_t n, double start, double step) {
    Axis axis;
    axis.start = start;
    axis.step = step;
    return std::vector<Axis>(n, axis);
}

inline std::vector<Value> values_of(const std::vector<Point>& points, const Function& f) {
    std::vector<Value> out;
    for (const Point& x : points) out.push_back(Value::measured(f(x)));
    return out;
}

// Every point requested until the search has stopped.
inline std::vector<Point> minimise(Search& search, const Function& f) {
    std::vector<Point> asked;
    while (!search.stopped()) {
        const auto points = search.ask();
        if (points.empty()) break;
        asked.insert(asked.end(), points.begin(), points.end());
        search.tell(values_of(points, f));
    }
    return asked;
}

template <class T>
T median(std::vector<T> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

} // namespace treacle::search
