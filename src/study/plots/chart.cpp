#include "study/plots/chart.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

namespace treacle::study {

namespace {
constexpr std::array colours{"#1f5fa8", "#c8502d", "#3b8c4a", "#8a55a6", "#a6842b", "#4a4a4a"};

std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) {
        switch (c) {
        case '<': out += "&lt;"; break;
        case '>': out += "&gt;"; break;
        case '&': out += "&amp;"; break;
        case '"': out += "&quot;"; break;
        default: out += c;
        }
    }
    return out;
}

std::string number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.5g", value);
    return text;
}

std::string pixel(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.1f", value);
    return text;
}

// A span of an axis, and its place in the picture.
struct Span {
    double low = 0, high = 1;
    AxisScale scale = AxisScale::linear;
    double first = 0, last = 1; // [pixels]

    double at(double value) const {
        const bool log = scale == AxisScale::log;
        const double a = log ? std::log(low) : low, b = log ? std::log(high) : high;
        return first + (last - first) * ((log ? std::log(value) : value) - a) / (b - a);
    }
    bool shows(double value) const { return std::isfinite(value) && (scale == AxisScale::linear || value > 0); }
};

// Room for the legend to the right of the axes [pixels]: a box, and the longest name in letters of 12 pixels; 0 without names.
double legend_width(const Chart& chart) {
    constexpr double box = 22, letter = 7.5;
    std::size_t longest = 0;
    for (const auto& series : chart.series) longest = std::max(longest, series.name.size());
    return longest > 0 ? box + letter * double(longest) : 0;
}

Span span_of(const ChartAxis& axis, const std::vector<const std::vector<double>*>& lists) {
    Span span;
    span.scale = axis.scale;
    span.low = std::numeric_limits<double>::infinity();
    span.high = -span.low;
    for (const auto* list : lists) {
        for (const double value : *list) {
            if (!span.shows(value)) continue;
            span.low = std::min(span.low, value);
            span.high = std::max(span.high, value);
        }
    }
    if (!(span.low <= span.high)) span.low = axis.scale == AxisScale::log ? 0.1 : 0, span.high = 1;
    if (axis.scale == AxisScale::log) {
        const double margin = span.high > span.low ? std::pow(span.high / span.low, 0.04) : 2;
        span.low /= margin;
        span.high *= margin;
    } else {
        const double margin =
            span.high > span.low ? 0.04 * (span.high - span.low) : std::max(0.5, 0.05 * std::abs(span.low));
        span.low -= margin;
        span.high += margin;
    }
    return span;
}
} // namespace

std::vector<double> ticks(double low, double high, AxisScale scale, int count) {
    std::vector<double> out;
    if (scale == AxisScale::log) {
        const int first = int(std::floor(std::log10(low))), last = int(std::ceil(std::log10(high)));
        const int every = std::max(1, (last - first) / count);
        const bool fine = last - first <= 2;
        for (int power = first; power <= last; power += every) {
            for (const double digit : {1.0, 2.0, 5.0}) {
                const double value = digit * std::pow(10.0, power);
                if ((digit == 1 || fine) && value >= low && value <= high) out.push_back(value);
            }
        }
        if (out.size() >= 2) return out;
        out.clear();
    }
    const double raw = (high - low) / count, power = std::pow(10.0, std::floor(std::log10(raw)));
    double step = 10 * power;
    for (const double digit : {5.0, 2.0, 1.0}) {
        if (digit * power >= raw) step = digit * power;
    }
    for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k)
        out.push_back(k == 0 ? 0 : k * step);
    return out;
}

std::string svg(const Chart& chart) {
    std::vector<const std::vector<double>*> xs, ys;
    for (const auto& series : chart.series) {
        xs.push_back(&series.x);
        ys.push_back(&series.y);
    }
    auto x = span_of(chart.x, xs), y = span_of(chart.y, ys);
    x.first = 78;
    x.last = chart.width - 18.0 - legend_width(chart);
    y.first = chart.height - 52.0;
    y.last = 34;
    std::string out = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + std::to_string(chart.width) +
                      "\" height=\"" + std::to_string(chart.height) +
                      "\" font-family=\"sans-serif\" font-size=\"12\">\n"
                      "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
    const auto text = [&](double px, double py, const std::string& anchor, const std::string& words,
                          const std::string& more = "") {
        out += "<text x=\"" + pixel(px) + "\" y=\"" + pixel(py) + "\" text-anchor=\"" + anchor + "\" fill=\"#222\"" +
               more + ">" + escaped(words) + "</text>\n";
    };
    const auto line = [&](double x0, double y0, double x1, double y1, const std::string& colour) {
        out += "<line x1=\"" + pixel(x0) + "\" y1=\"" + pixel(y0) + "\" x2=\"" + pixel(x1) + "\" y2=\"" + pixel(y1) +
               "\" stroke=\"" + colour + "\"/>\n";
    };
    for (const double tick : ticks(x.low, x.high, x.scale)) {
        line(x.at(tick), y.first, x.at(tick), y.last, "#e4e4e4");
        text(x.at(tick), y.first + 17, "middle", number(tick));
    }
    for (const double tick : ticks(y.low, y.high, y.scale)) {
        line(x.first, y.at(tick), x.last, y.at(tick), "#e4e4e4");
        text(x.first - 6, y.at(tick) + 4, "end", number(tick));
    }
    line(x.first, y.first, x.last, y.first, "#222");
    line(x.first, y.first, x.first, y.last, "#222");
    text((x.first + x.last) / 2, chart.height - 14.0, "middle", chart.x.label);
    const auto middle = pixel((y.first + y.last) / 2);
    text(16, (y.first + y.last) / 2, "middle", chart.y.label, " transform=\"rotate(-90 16 " + middle + ")\"");
    text((x.first + x.last) / 2, 20, "middle", chart.title, " font-weight=\"bold\"");
    double entries = 0; // of the legend, to the right of the axes, where nothing is drawn
    for (std::size_t k = 0; k < chart.series.size(); ++k) {
        const auto& series = chart.series[k];
        const std::string colour = colours[k % colours.size()];
        std::string path, dots;
        for (std::size_t i = 0; i < series.x.size(); ++i) {
            if (!x.shows(series.x[i]) || !y.shows(series.y[i])) continue;
            const auto px = pixel(x.at(series.x[i])), py = pixel(y.at(series.y[i]));
            path += (path.empty() ? "" : " ") + px + "," + py;
            dots += "<circle cx=\"" + px + "\" cy=\"" + py + "\" r=\"3\" fill=\"" + colour + "\"/>\n";
        }
        out += series.line ? "<polyline points=\"" + path + "\" fill=\"none\" stroke=\"" + colour +
                                 "\" stroke-width=\"1.6\"/>\n"
                           : dots;
        if (series.name.empty()) continue;
        out += "<rect x=\"" + pixel(x.last + 12) + "\" y=\"" + pixel(y.last + 6 + 18 * entries) +
               "\" width=\"10\" height=\"10\" fill=\"" + colour + "\"/>\n";
        text(x.last + 28, y.last + 15 + 18 * entries, "start", series.name);
        ++entries;
    }
    return out + "</svg>\n";
}

} // namespace treacle::study
