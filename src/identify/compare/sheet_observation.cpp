#include "identify/compare/sheet_observation.hpp"

#include "base/text/csv_reader.hpp"
#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "identify/experiment/observation.hpp"
#include "identify/experiment/piv_files.hpp"
#include "scene/sampling/signed_distance.hpp"
#include "video/piv/piv_outliers.hpp"

#include <algorithm>
#include <glob.h>

namespace treacle::identify {

namespace {
std::vector<std::filesystem::path> matching(const std::filesystem::path& pattern) {
    std::vector<std::filesystem::path> out;
    glob_t found{};
    if (glob(pattern.c_str(), 0, nullptr, &found) == 0)
        out.assign(found.gl_pathv, found.gl_pathv + found.gl_pathc); // sorted by name
    globfree(&found);
    return out;
}

std::vector<video::PivField> read_fields(const Sheet& sheet, const Beside& beside) {
    std::vector<video::PivField> out;
    for (const auto& name : sheet.files) {
        const auto paths = matching(beside(name));
        if (paths.empty())
            throw InputError({sheet.where, "files = " + name + " is not there",
                "names are taken from the study's folder", "check the name"});
        for (const auto& path : paths) {
            for (auto& field : read_piv(path)) {
                out.push_back(video::in_si(
                    std::move(field), {sheet.pixel, sheet.pair_interval}, sheet.where + ": " + path.string()));
            }
        }
    }
    return out;
}

std::vector<double> times_of(const Sheet& sheet, const Beside& beside, std::size_t count) {
    std::vector<double> out;
    if (sheet.times.empty()) {
        for (std::size_t i = 0; i < count; ++i) out.push_back(sheet.first + double(i) * sheet.interval);
        return out;
    }
    const auto table = read_csv(beside(sheet.times));
    out = table.column("time");
    if (out.size() == count) return out;
    throw InputError({sheet.where, "times = " + sheet.times + " has " + std::to_string(out.size()) + " rows",
        "there are " + std::to_string(count) + " fields", "give a row a field"});
}

void check_same_size(const Sheet& sheet, const std::vector<video::PivField>& fields) {
    for (const auto& field : fields) {
        if (field.x.size() == fields.front().x.size()) continue;
        throw InputError(
            {sheet.where, "outliers.alpha compares fields in time, and these differ in their number of vectors",
                "a vector needs its neighbours in time", "leave alpha out"});
    }
}

// Marks outliers as not valid; returns how many of each field.
std::vector<std::size_t> mark_outliers(
    const Sheet& sheet, std::vector<video::PivField>& fields, const std::vector<double>& times) {
    std::vector<std::size_t> before, out;
    for (const auto& field : fields) before.push_back(field.count_valid());
    if (sheet.outliers.median > 0) {
        // Twice the noise, so that a threshold of 2 spares all but a few good vectors in a hundred.
        for (auto& field : fields) video::reject_odd(field, sheet.outliers.median, 2 * sheet.noise);
    }
    if (sheet.outliers.alpha > 0 && fields.size() > 2) {
        const double step = times[1] - times[0];
        check_same_size(sheet, fields);
        video::reject_sudden(fields, sheet.outliers.alpha * step * step, sheet.outliers.floor * step * step);
    }
    for (std::size_t i = 0; i < fields.size(); ++i) out.push_back(before[i] - fields[i].count_valid());
    return out;
}

ObservedField convert(const Sheet& sheet, const video::PivField& field, double time,
    const std::vector<scene::SolidRegion>& mask, const Touches& touches, SheetCounts& counts) {
    ObservedField out;
    out.time = time;
    for (std::size_t i = 0; i < field.x.size(); ++i) {
        if (!field.valid[i]) continue;
        const SheetVector vector{field.x[i], sheet.y == Upward::up ? field.y[i] : -field.y[i], field.u[i],
            sheet.v == Upward::up ? field.v[i] : -field.v[i]};
        const auto point = sheet.point(vector.x, vector.y);
        if (std::ranges::any_of(mask, [&](const scene::SolidRegion& region) { return region.distance(point) <= 0; })) {
            ++counts.masked;
        } else if (touches && touches(point, time)) {
            ++counts.touching;
        } else {
            out.vectors.push_back(vector);
        }
    }
    return out;
}
} // namespace

ObservedSheet observe_sheet(const Experiment& experiment, const Beside& beside, const Touches& touches) {
    const auto& sheet = experiment.piv;
    auto fields = read_fields(sheet, beside);
    const auto times = times_of(sheet, beside, fields.size());
    std::vector<std::size_t> valid;
    valid.reserve(fields.size());
    for (const auto& field : fields) valid.push_back(field.count_valid());
    const auto outliers = mark_outliers(sheet, fields, times);
    std::vector<scene::SolidRegion> mask;
    for (const auto& shape : sheet.mask) mask.emplace_back(shape);
    ObservedSheet out;
    for (const auto i : compared_times(experiment, times, "field")) {
        out.counts.vectors += fields[i].x.size();
        out.counts.missing += fields[i].x.size() - valid[i];
        out.counts.outliers += outliers[i];
        out.fields.push_back(convert(sheet, fields[i], times[i] - experiment.time_zero, mask, touches, out.counts));
        out.fields.back().number = int(i);
    }
    if (out.counts.kept() == 0) {
        throw InputError({experiment.where, "no vector of the fields is left",
            std::to_string(out.counts.missing) + " were not measured, " + std::to_string(out.counts.outliers) +
                " are outliers, " + std::to_string(out.counts.masked) + " masked, " +
                std::to_string(out.counts.touching) + " touch the ball",
            "look at mask, ball and outliers"});
    }
    return out;
}

} // namespace treacle::identify
