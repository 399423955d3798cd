#pragma once
#include <string>
#include <vector>

namespace treacle::study {

// Spacing of values along an axis; log leaves out those that are not above 0.
enum class AxisScale { linear, log };

// One axis of a chart; its ends follow from the series.
struct ChartAxis {
    std::string label;                   // "viscosity [Pa.s]"
    AxisScale scale = AxisScale::linear; // of the values
};

// Points of one colour; x and y have one length.
struct ChartSeries {
    std::string name;         // of the legend; empty: none
    std::vector<double> x, y; // points that are not finite are left out
    bool line = false;        // joined in their order, else dots
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
