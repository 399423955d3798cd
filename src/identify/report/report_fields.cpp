#include "identify/report/report_fields.hpp"

#include "base/text/file.hpp"
#include "identify/compare/sheet_comparison.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

namespace treacle::identify {

namespace {
constexpr std::size_t most_fields = 4;
constexpr std::size_t most_arrows = 1200;  // of a field
constexpr double panel = 260, margin = 18; // [px]
constexpr double difference_factor = 5;

struct Box {
    double left = 1e300, right = -1e300, low = 1e300, high = -1e300; // [m]
    double speed = 0;                                                // [m/s] the largest measured

    void add(const ComparedVector& one) {
        left = std::min(left, one.measured.x);
        right = std::max(right, one.measured.x);
        low = std::min(low, one.measured.y);
        high = std::max(high, one.measured.y);
        speed = std::max(speed, std::hypot(one.measured.u, one.measured.v));
    }
};

std::string line(double x, double y, double u, double v, const char* colour) {
    char text[160];
    std::snprintf(text, sizeof text,
        "<path d=\"M%.1f %.1fl%.1f %.1f\" stroke=\"%s\"/><circle cx=\"%.1f\" cy=\"%.1f\" r=\"0.8\" fill=\"%s\"/>\n", x,
        y, u, -v, colour, x, y, colour);
    return text;
}

std::string picture(const std::vector<const ComparedVector*>& vectors, const Box& box) {
    const double size = std::max({box.right - box.left, box.high - box.low, 1e-12}), scale = panel / size;
    const double width = scale * (box.right - box.left) + margin, height = scale * (box.high - box.low);
    const auto stride = std::max<std::size_t>(1, vectors.size() / most_arrows);
    // The fastest arrow is as long as a dozen windows of a field that fills the panel.
    const double length = box.speed > 0 ? panel / 12 / box.speed : 0;
    char head[256];
    std::snprintf(head, sizeof head,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\" font-family=\"sans-serif\" "
        "font-size=\"11\">\n<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n",
        3 * width + margin, height + 3 * margin);
    std::string out = head;
    const char* titles[3] = {"measured", "simulated", "difference x 5"};
    for (int k = 0; k < 3; ++k) {
        char title[120];
        std::snprintf(title, sizeof title, "<text x=\"%.0f\" y=\"13\">%s</text>\n", margin + k * width, titles[k]);
        out += title;
        for (std::size_t i = 0; i < vectors.size(); i += stride) {
            const auto& one = *vectors[i];
            const double x = margin + k * width + scale * (one.measured.x - box.left),
                         y = 2 * margin + scale * (box.high - one.measured.y);
            const double u = k == 0 ? one.measured.u : k == 1 ? one.u : difference_factor * (one.u - one.measured.u);
            const double v = k == 0 ? one.measured.v : k == 1 ? one.v : difference_factor * (one.v - one.measured.v);
            if (std::isfinite(u) && std::isfinite(v))
                out += line(x, y, length * u, length * v, k == 2 ? "#b03020" : "#204080");
        }
    }
    return out + "</svg>\n";
}
} // namespace

namespace {

std::string file_suffix(int number) {
    char text[32];
    std::snprintf(text, sizeof text, "_%06d.svg", number);
    return text;
}

std::vector<int> keys_of(const std::map<int, std::vector<const ComparedVector*>>& fields) {
    std::vector<int> out;
    out.reserve(fields.size());
    for (const auto& [number, vectors] : fields) out.push_back(number);
    return out;
}

} // namespace

std::vector<ReportPicture> write_field_pictures(
    const std::filesystem::path& folder, const Experiment& experiment, const std::filesystem::path& run) {
    const auto vectors = read_vectors(run, experiment.name);
    std::map<int, std::vector<const ComparedVector*>> fields;
    Box box;
    for (const auto& one : vectors) {
        fields[one.field].push_back(&one);
        box.add(one);
    }
    const auto numbers = keys_of(fields);
    std::vector<ReportPicture> out;
    const auto count = std::min(most_fields, numbers.size());
    for (std::size_t k = 0; k < count; ++k) {
        const int number = numbers[count == 1 ? 0 : k * (numbers.size() - 1) / (count - 1)];
        out.push_back({experiment.name + file_suffix(number), experiment.name + ", field " + std::to_string(number)});
        write_file_atomically(folder / out.back().file, picture(fields[number], box));
    }
    return out;
}

} // namespace treacle::identify
