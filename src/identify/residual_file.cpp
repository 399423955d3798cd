#include "identify/residual_file.hpp"

#include "base/csv.hpp"
#include "base/csv_reader.hpp"

namespace treacle::identify {

namespace {
std::vector<std::string> segment_columns() {
    std::vector<std::string> out{"frame", "time [s]", "x [px]", "y [px]", "normal x", "normal y", "points", "displacement [px]"};
    for (const char* name : view_names) out.push_back(std::string("by ") + name);
    return out;
}
const std::vector<std::string> frame_columns{"frame", "time [s]", "mismatches [px]", "observed [px]", "simulated [px]", "compared [px]"};

std::filesystem::path segment_file(const std::filesystem::path& folder, const std::string& name) { return folder / ("residuals_" + name + ".csv"); }
std::filesystem::path frame_file(const std::filesystem::path& folder, const std::string& name) { return folder / ("mismatches_" + name + ".csv"); }
} // namespace

void write_residuals(const std::filesystem::path& folder, const std::string& experiment, const RunResiduals& residuals) {
    auto segments = CsvTable::create(segment_file(folder, experiment), segment_columns());
    for (const auto& s : residuals.segments) {
        std::vector<double> row{double(s.frame), s.time, s.x, s.y, s.normal_x, s.normal_y, s.points, s.displacement};
        row.insert(row.end(), s.by_view.begin(), s.by_view.end());
        segments.append(row);
    }
    segments.sync();
    auto frames = CsvTable::create(frame_file(folder, experiment), frame_columns);
    for (std::size_t i = 0; i < residuals.frames.size(); ++i) {
        const auto& f = residuals.frames[i];
        frames.append(std::vector<double>{double(residuals.observed[i].number), residuals.observed[i].time, double(f.mismatches), double(f.observed),
                                          double(f.simulated), double(f.compared)});
    }
    frames.sync();
}

RunResiduals read_residuals(const std::filesystem::path& folder, const std::string& experiment) {
    RunResiduals out;
    const auto segments = read_csv(segment_file(folder, experiment));
    std::vector<const std::vector<double>*> columns;
    for (const auto& name : segment_columns()) columns.push_back(&segments.column(name));
    for (std::size_t i = 0; i < segments.rows(); ++i) {
        const auto at = [&](std::size_t c) { return (*columns[c])[i]; };
        SegmentResidual s{int(at(0)), at(1), at(2), at(3), at(4), at(5), at(6), at(7), {}};
        for (std::size_t k = 0; k < s.by_view.size(); ++k) s.by_view[k] = at(8 + k);
        out.segments.push_back(s);
    }
    const auto frames = read_csv(frame_file(folder, experiment));
    for (std::size_t i = 0; i < frames.rows(); ++i) {
        const auto at = [&](const char* name) { return frames.column(name)[i]; };
        FrameComparison f;
        f.mismatches = std::int64_t(at("mismatches"));
        f.observed = std::int64_t(at("observed"));
        f.simulated = std::int64_t(at("simulated"));
        f.compared = std::int64_t(at("compared"));
        out.observed.push_back({int(at("frame")), at("time"), {}});
        out.mismatch += mismatch_objective(f) / double(frames.rows());
        out.frames.push_back(std::move(f));
    }
    return out;
}

} // namespace treacle::identify
