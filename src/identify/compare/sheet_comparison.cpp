#include "identify/compare/sheet_comparison.hpp"

#include "base/text/csv.hpp"
#include "base/text/csv_reader.hpp"

#include <cmath>
#include <limits>

namespace treacle::identify {

namespace {
double dot(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Measured components and their derivative by a turn of the sheet about the middle of its vectors.
struct Middle {
    double x = 0, y = 0; // [m]
};

Middle middle_of(const ObservedField& field) {
    Middle out;
    for (const auto& one : field.vectors) {
        out.x += one.x / double(field.vectors.size());
        out.y += one.y / double(field.vectors.size());
    }
    return out;
}

const std::vector<std::string> vector_columns{
    "field", "x [m]", "y [m]", "measured u [m/s]", "measured v [m/s]", "simulated u [m/s]", "simulated v [m/s]"};
std::filesystem::path vector_file(const std::filesystem::path& folder, const std::string& name) {
    return folder / ("fields_" + name + ".csv");
}
} // namespace

WindowVelocity window_velocity(const Sheet& sheet, double x, double y, const SheetFlow& flow) {
    constexpr std::array<double, 3> nodes{-0.7745966692414834, 0, 0.7745966692414834},
        weights{5.0 / 18, 8.0 / 18, 5.0 / 18};
    WindowVelocity out;
    double covered = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            const auto point = sheet.point(x + 0.5 * sheet.window * nodes[i], y + 0.5 * sheet.window * nodes[j]);
            std::optional<LocalVelocity> local;
            if (const auto solid = flow.solid(point)) {
                local = LocalVelocity{*solid, {}};
                out.touches = true;
            } else {
                local = flow.liquid(point);
            }
            if (!local) continue;
            const double weight = weights[i] * weights[j];
            covered += weight;
            const std::array<Vec3, 2> axes{sheet.right, sheet.up};
            for (std::size_t a = 0; a < 2; ++a) {
                out.velocity[a] += weight * dot(axes[a], local->velocity);
                for (std::size_t b = 0; b < 2; ++b) {
                    for (std::size_t c = 0; c < 3; ++c)
                        out.gradient[a][b] += weight * axes[a][c] * dot(local->gradient[c], axes[b]);
                }
            }
        }
    }
    out.seen = covered > 0.5;
    if (!out.seen) return out;
    for (std::size_t a = 0; a < 2; ++a) {
        out.velocity[a] /= covered;
        for (auto& one : out.gradient[a]) one /= covered;
    }
    return out;
}

SheetComparison compare_field(
    const Sheet& sheet, const ObservedField& field, const SheetFlow& before, const SheetFlow& after) {
    SheetComparison out;
    out.squares = {field.number, field.time, 0, 0};
    const double step = after.time - before.time, fraction = step > 0 ? (field.time - before.time) / step : 0;
    const auto middle = middle_of(field);
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    for (const auto& vector : field.vectors) {
        const auto a = window_velocity(sheet, vector.x, vector.y, before),
                   b = window_velocity(sheet, vector.x, vector.y, after);
        const bool seen = a.seen && b.seen, compared = seen && !a.touches && !b.touches;
        const std::array<double, 2> measured{vector.u, vector.v}, arm{vector.x - middle.x, vector.y - middle.y};
        std::array<double, 2> simulated{none, none};
        double square = 0;
        for (std::size_t c = 0; c < 2; ++c) {
            SegmentResidual row;
            row.frame = field.number;
            row.time = field.time;
            row.x = vector.x;
            row.y = vector.y;
            (c == 0 ? row.normal_x : row.normal_y) = 1;
            row.points = compared ? 1 : 0;
            row.displacement = none;
            if (seen) {
                const auto blend = [&](double p, double q) { return (1 - fraction) * p + fraction * q; };
                simulated[c] = blend(a.velocity[c], b.velocity[c]);
                const std::array<double, 2> gradient{
                    blend(a.gradient[c][0], b.gradient[c][0]), blend(a.gradient[c][1], b.gradient[c][1])};
                row.displacement = (simulated[c] - measured[c]) / sheet.noise;
                square += std::pow(simulated[c] - measured[c], 2);
                // A later time zero shows the run earlier; a larger scale makes places and velocities larger; a turn moves the
                // place and the vector alike.
                row.by_view[sheet_time] = step > 0 ? -(b.velocity[c] - a.velocity[c]) / step / sheet.noise : 0;
                row.by_view[sheet_scale] = (gradient[0] * arm[0] + gradient[1] * arm[1] - measured[c]) / sheet.noise;
                row.by_view[sheet_right] = gradient[0] / sheet.noise;
                row.by_view[sheet_up] = gradient[1] / sheet.noise;
                const double turned = c == 0 ? -measured[1] : measured[0];
                row.by_view[sheet_turn] = (-gradient[0] * arm[1] + gradient[1] * arm[0] - turned) / sheet.noise;
            }
            out.segments.push_back(row);
        }
        out.vectors.push_back({field.number, vector, simulated[0], simulated[1]});
        if (!compared) continue;
        out.squares.square += square;
        out.squares.count += 1;
    }
    if (out.squares.count > 0) out.squares.square /= out.squares.count;
    return out;
}

void write_vectors(
    const std::filesystem::path& folder, const std::string& experiment, const std::vector<ComparedVector>& vectors) {
    auto table = CsvTable::create(vector_file(folder, experiment), vector_columns);
    for (const auto& one : vectors)
        table.append(std::vector<double>{
            double(one.field), one.measured.x, one.measured.y, one.measured.u, one.measured.v, one.u, one.v});
    table.sync();
}

std::vector<ComparedVector> read_vectors(const std::filesystem::path& folder, const std::string& experiment) {
    std::vector<ComparedVector> out;
    if (!std::filesystem::exists(vector_file(folder, experiment)))
        return out; // of another study that did not keep them
    const auto table = read_csv(vector_file(folder, experiment));
    std::vector<const std::vector<double>*> c;
    c.reserve(vector_columns.size());
    for (const auto& name : vector_columns) c.push_back(&table.column(name));
    for (std::size_t i = 0; i < table.rows(); ++i) {
        out.push_back({int((*c[0])[i]), {(*c[1])[i], (*c[2])[i], (*c[3])[i], (*c[4])[i]}, (*c[5])[i], (*c[6])[i]});
    }
    return out;
}

} // namespace treacle::identify
