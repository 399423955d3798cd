#include "study/plots/plots.hpp"

#include "base/text/csv_reader.hpp"
#include "base/text/file.hpp"
#include "study/plots/chart.hpp"

#include <algorithm>
#include <cctype>

namespace treacle::study {

namespace {
std::string file_word(const std::string& name) {
    std::string out;
    for (const char c : without_unit(name)) out += std::isalnum(static_cast<unsigned char>(c)) || c == '-' ? c : '_';
    return out;
}

// The runs of each scene are dots of one colour.
std::vector<ChartSeries> series_of(const Study& study, const Table& table, const std::string& x, const std::string& y) {
    const auto xs = numbers_of(table, x), ys = numbers_of(table, y);
    if (study.scenes.size() == 1) return {{"", xs, ys, false}};
    std::vector<ChartSeries> out;
    const auto index = std::size_t(std::ranges::find(table.header, "scene") - table.header.begin());
    for (const auto& scene : study.scenes) {
        out.push_back({scene.name, {}, {}, false});
        for (std::size_t i = 0; i < table.rows.size(); ++i) {
            if (table.rows[i][index] != scene.name) continue;
            out.back().x.push_back(xs[i]);
            out.back().y.push_back(ys[i]);
        }
    }
    return out;
}
} // namespace

std::vector<std::string> write_plots(const std::filesystem::path& folder, const Study& study, const Table& table) {
    std::vector<std::string> names;
    for (const auto& parameter : study.parameters) {
        const auto values = numbers_of(table, parameter.column());
        if (std::ranges::none_of(values, [](double v) { return v == v; })) continue;
        for (const auto& figure : table.figures) {
            Chart chart;
            chart.title = study.title;
            chart.x = {parameter.column(), parameter.scale == Scale::log ? AxisScale::log : AxisScale::linear};
            chart.y.label = figure;
            chart.series = series_of(study, table, parameter.column(), figure);
            names.push_back(file_word(figure) + "_over_" + file_word(parameter.name) + ".svg");
            std::filesystem::create_directories(folder);
            write_file_atomically(folder / names.back(), svg(chart));
        }
    }
    return names;
}

} // namespace treacle::study
