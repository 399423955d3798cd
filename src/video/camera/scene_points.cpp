#include "video/camera/scene_points.hpp"

#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "video/picture/number_table.hpp"

namespace treacle::video {

namespace {

void read_deviations(const NumberTable& table, std::vector<ScenePoint>& points) {
    const auto deviations = table.column("s", unit::none);
    for (std::size_t i = 0; i < points.size(); ++i) {
        points[i].deviation = deviations[i];
        if (deviations[i] < 0)
            throw InputError({points[i].where, "s = " + format_number(deviations[i]) + ": must be > 0",
                "it is a standard deviation", "leave the column out if it is not known"});
    }
}

} // namespace

std::vector<ScenePoint> read_scene_points(const std::filesystem::path& path) {
    const NumberTable table(path);
    std::vector<ScenePoint> out(table.rows());
    for (std::size_t i = 0; i < out.size(); ++i) out[i].where = table.where(i);
    for (const char* name : {"x", "y", "z"}) {
        const auto values = table.column(name, unit::length);
        for (std::size_t i = 0; i < out.size(); ++i) out[i].position[std::size_t(name[0] - 'x')] = values[i];
    }
    for (const char* name : {"u", "v"}) {
        const auto values = table.column(name, unit::none);
        for (std::size_t i = 0; i < out.size(); ++i) out[i].pixel[std::size_t(name[0] - 'u')] = values[i];
    }
    if (table.has("s")) read_deviations(table, out);
    return out;
}

} // namespace treacle::video
