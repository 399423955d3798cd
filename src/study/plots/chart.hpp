#pragma once
#include <string>
#include <vector>

namespace treacle::study {

enum class AxisScale { linear, log };

struct ChartAxis {
    std::string label; // "viscosity [Pa.s]"
    AxisScale scale = AxisScale::linear;
};

struct ChartSeries {
    std::string name; // of the legend; empty: none
    std::vector<double> x, y; // points that are not finite are left out
    bool line = false; // joined in their order, else dots
};

// A picture of points over axes, as SVG.
struct Chart {
    std::string title;
    ChartAxis x, y;
    std::vector<ChartSeries> series;
    int width = 640, height = 420; // [pixels]
};
std::string svg(const Chart& chart);

// Round numbers that divide a span into about `count` parts; of a logarithmic one powers of ten, or 1, 2 and 5 times them.
std::vector<double> ticks(double low, double high, AxisScale scale, int count = 6);

} // namespace treacle::study
