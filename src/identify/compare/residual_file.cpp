#include "identify/compare/residual_file.hpp"

#include "base/text/csv.hpp"
#include "base/text/csv_reader.hpp"

namespace treacle::identify {

namespace {
std::vector<std::string> segment_columns(ExperimentKind kind) {
    std::vector<std::string> out{
        "frame", "time [s]", "x [px]", "y [px]", "normal x", "normal y", "points", "displacement [px]"};
    if (kind == ExperimentKind::occupancy) out.back() = "displacement [noise]";
    if (kind == ExperimentKind::piv)
        out = {"field", "time [s]", "x [m]", "y [m]", "right", "up", "compared", "difference [noise]"};
    if (kind == ExperimentKind::series)
        out = {"row", "time [s]", "x", "y", "right", "up", "compared", "difference [noise]"};
    for (const auto& view : view_parameters(kind)) out.push_back(std::string("by ") + view.name);
    return out;
}
const std::vector<std::string> contour_frame_columns{
    "frame", "time [s]", "mismatches [px]", "observed [px]", "simulated [px]", "compared [px]", "beyond [px]"};
std::vector<std::string> square_columns(ExperimentKind kind) {
    return {"frame", "time [s]",
        kind == ExperimentKind::piv ? "square difference [m2/s2]" : "square difference [noise2]", "compared"};
}

std::filesystem::path segment_file(const std::filesystem::path& folder, const std::string& name) {
    return folder / ("residuals_" + name + ".csv");
}
std::filesystem::path frame_file(const std::filesystem::path& folder, const std::string& name) {
    return folder / ("mismatches_" + name + ".csv");
}

void read_contour_frames(const CsvColumns& frames, RunResiduals& out) {
    for (std::size_t i = 0; i < frames.rows(); ++i) {
        const auto at = [&](const char* name) { return frames.column(name)[i]; };
        FrameComparison f;
        f.mismatches = std::int64_t(at("mismatches"));
        f.observed = std::int64_t(at("observed"));
        f.simulated = std::int64_t(at("simulated"));
        f.compared = std::int64_t(at("compared"));
        f.beyond = at("beyond");
        out.observed.push_back({int(at("frame")), at("time"), {}});
        out.mismatch += mismatch_objective(f) / double(frames.rows());
        out.frames.push_back(std::move(f));
    }
}

void read_squares(const CsvColumns& frames, RunResiduals& out) {
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < frames.rows(); ++i) {
        const auto at = [&](const char* name) { return frames.column(name)[i]; };
        out.squares.push_back({int(at("frame")), at("time"), at("square difference"), at("compared")});
        sum += out.squares.back().square * out.squares.back().count;
        count += out.squares.back().count;
    }
    out.mismatch = count > 0 ? sum / count : 0;
}
} // namespace

namespace {

void write_segments(const std::filesystem::path& folder, const std::string& experiment, const RunResiduals& residuals) {
    const auto views = view_parameters(residuals.kind).size();
    auto segments = CsvTable::create(segment_file(folder, experiment), segment_columns(residuals.kind));
    for (const auto& s : residuals.segments) {
        std::vector<double> row{double(s.frame), s.time, s.x, s.y, s.normal_x, s.normal_y, s.points, s.displacement};
        row.insert(row.end(), s.by_view.begin(), s.by_view.begin() + std::ptrdiff_t(views));
        segments.append(row);
    }
    segments.sync();
}

} // namespace

void write_residuals(
    const std::filesystem::path& folder, const std::string& experiment, const RunResiduals& residuals) {
    write_segments(folder, experiment, residuals);
    const bool masks = has_masks(residuals.kind);
    auto frames = CsvTable::create(
        frame_file(folder, experiment), masks ? contour_frame_columns : square_columns(residuals.kind));
    for (std::size_t i = 0; i < residuals.frames.size(); ++i) {
        const auto& f = residuals.frames[i];
        frames.append(std::vector<double>{double(residuals.observed[i].number), residuals.observed[i].time,
            double(f.mismatches), double(f.observed), double(f.simulated), double(f.compared), f.beyond});
    }
    for (const auto& f : residuals.squares)
        frames.append(std::vector<double>{double(f.number), f.time, f.square, f.count});
    frames.sync();
}

RunResiduals read_residuals(const std::filesystem::path& folder, const std::string& experiment, ExperimentKind kind) {
    RunResiduals out;
    out.kind = kind;
    const auto segments = read_csv(segment_file(folder, experiment));
    std::vector<const std::vector<double>*> columns;
    for (const auto& name : segment_columns(kind)) columns.push_back(&segments.column(name));
    for (std::size_t i = 0; i < segments.rows(); ++i) {
        const auto at = [&](std::size_t c) { return (*columns[c])[i]; };
        SegmentResidual s{int(at(0)), at(1), at(2), at(3), at(4), at(5), at(6), at(7), {}};
        for (std::size_t k = 0; k + 8 < columns.size(); ++k) s.by_view[k] = at(8 + k);
        out.segments.push_back(s);
    }
    const auto frames = read_csv(frame_file(folder, experiment));
    if (has_masks(kind)) {
        read_contour_frames(frames, out);
    } else {
        read_squares(frames, out);
    }
    return out;
}

} // namespace treacle::identify
