#include "app/export/info_run.hpp"

#include "app/input/table_text.hpp"
#include "app/render/frame_field.hpp"
#include "app/render/frame_set.hpp"
#include "base/text/text.hpp"
#include "io/checkpoint/checkpoint.hpp"

#include <fstream>
#include <nlohmann/json.hpp>

namespace treacle::app {

namespace {

using Json = nlohmann::ordered_json;

// Null when there is no such file or it is not JSON: a run may have been killed before it wrote one.
Json read_json(const std::filesystem::path& path) {
    std::ifstream file(path);
    return file ? Json::parse(file, nullptr, false) : Json();
}

std::string text_of(const Json& value) {
    if (value.is_string()) return value.get<std::string>();
    if (value.is_number_float()) return short_number(value.get<double>());
    if (value.is_array()) {
        std::vector<std::string> parts;
        for (const auto& item : value) parts.push_back(text_of(item));
        return join(parts, " ");
    }
    return value.dump();
}

// Entries of an object, those of objects in it on lines of their own.
void show_entries(const Json& object, const std::string& indent, Log& log) {
    for (const auto& [key, value] : object.items()) {
        const bool small = value.is_object() && value.contains("min") && value.contains("max");
        if (small) {
            log.line(label(indent + key) + text_of(value["min"]) + " to " + text_of(value["max"]) + " over the ranks");
        } else if (value.is_object()) {
            log.line(label(indent + key));
            show_entries(value, indent + "  ", log);
        } else {
            log.line(label(indent + key) + text_of(value));
        }
    }
}

void show_object(const std::filesystem::path& path, const std::string& title, const std::string& missing, Log& log) {
    const auto object = read_json(path);
    if (!object.is_object()) {
        log.line(title + ": " + missing);
        return;
    }
    log.line(title);
    show_entries(object, "", log);
}

// The names and last values of a table's columns; empty when there is no row.
using Row = std::vector<std::pair<std::string, std::string>>;
struct Table {
    Row last;
    std::size_t rows = 0;
};

std::vector<std::string> cells(const std::string& line) {
    std::vector<std::string> out(1);
    for (const char c : line) {
        if (c == ',') {
            out.emplace_back();
        } else {
            out.back() += c;
        }
    }
    return out;
}

Table read_table(const std::filesystem::path& path) {
    std::ifstream file(path);
    std::string line, last, header;
    Table table;
    std::getline(file, header);
    while (std::getline(file, line)) {
        if (file.eof()) break; // cut off: the run is writing it
        last = line;
        ++table.rows;
    }
    if (table.rows == 0) return table;
    const auto names = cells(header), values = cells(last);
    for (std::size_t i = 0; i < std::min(names.size(), values.size()); ++i) {
        table.last.emplace_back(names[i], values[i]);
    }
    return table;
}

void show_steps(const RunView& run, Log& log) {
    const auto table = read_table(run.folder.steps());
    log.line("steps: " + std::to_string(table.rows));
    constexpr std::size_t shown = 10; // the first columns show its progress; steps.csv has the rest
    for (std::size_t i = 0; i < std::min(shown, table.last.size()); ++i) {
        const auto number = read_number(table.last[i].second);
        log.line(
            label("last " + table.last[i].first) + (number && i > 0 ? short_number(*number) : table.last[i].second));
    }
}

void show_frames(const RunView& run, Log& log) {
    if (run.frames.empty()) {
        log.line("frames: none");
        return;
    }
    log.line("frames: " + std::to_string(run.frames.size()) + ", from " + short_number(run.frames.front().time) +
             " to " + short_number(run.frames.back().time) + " s");
    const auto frame = io::read_frame(run.frame(run.frames.size() - 1));
    log.line(label("last one") + run.frame(run.frames.size() - 1).string());
    log.line(label("particles") + grouped(static_cast<std::uint64_t>(frame.total)));
    std::vector<std::string> names;
    for (const auto& column : frame.fields) names.push_back(with_unit_of(column.name, column));
    log.line(label("fields") + join(names, ", "));
}

void show_checkpoints(const Comm& comm, const RunView& run, Log& log) {
    const auto paths = io::list_checkpoints(run.folder.checkpoints());
    log.line("checkpoints: " + (paths.empty() ? std::string("none") : std::to_string(paths.size())));
    for (const auto& path : paths) {
        const auto broken = io::validate_checkpoint(comm, path);
        log.line(label(path.filename().string()) + (broken.empty() ? "whole" : "broken: " + broken));
    }
}

void show_scene(const RunView& run, Log& log) {
    const auto& scene = run.input.scene;
    log.line("run: " + run.folder.root.string() + (scene.title.empty() ? "" : ", " + scene.title));
    std::vector<std::string> liquids;
    for (const auto& liquid : scene.liquids) {
        liquids.push_back(
            liquid.name + " (" + short_number(liquid.density) + " kg/m3, " + short_number(liquid.viscosity) + " Pa s)");
    }
    log.line(label("liquids") + join(liquids, ", "));
    log.line(label("spacing") + short_number(scene.domain.spacing) + " m");
    log.line(label("end of time") + short_number(scene.time.end) + " s");
}

} // namespace

void show_run(const Comm& comm, const std::filesystem::path& path, Log& log) {
    const auto run = open_run(comm, path);
    show_scene(run, log);
    comm.guard_root([&] {
        show_object(run.folder.manifest(), "made by", "there is no manifest.json", log);
        show_steps(run, log);
        show_frames(run, log);
    });
    show_checkpoints(comm, run, log);
    comm.guard_root([&] {
        show_object(run.folder.summary(), "how it ended",
            "no summary.json: the run is still going, or was ended by an error", log);
    });
}

} // namespace treacle::app
