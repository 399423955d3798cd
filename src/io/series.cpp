#include "io/series.hpp"

#include "base/text/error.hpp"
#include "base/text/file.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>

namespace treacle::io {

void write_series(const std::filesystem::path& path, const std::vector<SeriesEntry>& entries) {
    nlohmann::ordered_json files = nlohmann::ordered_json::array();
    for (const auto& entry : entries) files.push_back({{"name", entry.file}, {"time", entry.time}});
    const nlohmann::ordered_json series = {{"file-series-version", "1.0"}, {"files", files}};
    write_file_atomically(path, series.dump(1) + "\n");
}

std::vector<SeriesEntry> read_series(const std::filesystem::path& path) {
    std::ifstream stream(path);
    if (!stream) throw InputError(Diagnostic{path.string(), "cannot open this index of frames", "", ""});
    std::vector<SeriesEntry> entries;
    try {
        const auto series = nlohmann::json::parse(stream);
        for (const auto& file : series.at("files"))
            entries.push_back({file.at("name").get<std::string>(), file.at("time").get<double>()});
    } catch (const nlohmann::json::exception& error) {
        throw InputError(Diagnostic{path.string(), "not an index of frames", error.what(), ""});
    }
    std::stable_sort(entries.begin(), entries.end(), [](const auto& a, const auto& b) { return a.time < b.time; });
    return entries;
}

std::vector<std::string> series_names(const std::filesystem::path& folder) {
    std::vector<std::string> names;
    std::error_code missing;
    const std::string suffix = series_suffix;
    for (const auto& item : std::filesystem::directory_iterator(folder, missing)) {
        const auto file = item.path().filename().string();
        if (file.ends_with(suffix)) names.push_back(file.substr(0, file.size() - suffix.size()));
    }
    std::sort(names.begin(), names.end());
    return names;
}

} // namespace treacle::io
