#include "study/lanes/forward_files.hpp"

#include "base/options/document.hpp"
#include "base/options/options.hpp"
#include "base/text/error.hpp"
#include "base/text/file.hpp"
#include "base/text/text.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace treacle::study {

namespace {
using Json = nlohmann::ordered_json;

// The layout of params.yaml.
struct RequestFile {
    int schema_version = 1, number = 0;
    std::string study, scene, key;
    std::vector<std::string> parameters, values, changes, overrides;
    double cut = 0;

    void declare(Declaration& d) {
        d.integer("schema_version", schema_version, range_between(1, 1), "Version of the layout of this file.");
        d.text("study", study, "The study's file.");
        d.required("study");
        d.integer("number", number, range_at_least(0), "Number of the run in the study; 0: none.");
        d.text("scene", scene, "Name of the study's scene.");
        d.required("scene");
        d.text("key", key, "Hash of all that the result depends on, when the run was asked for.");
        d.texts("parameters", parameters, "Names of the study's parameters.");
        d.texts("values", values, "Value of each, as it stands in the scene.");
        d.texts("changes", changes, "Keys of the scene that this run sets after the parameters.");
        d.number("cut", cut, unit::none, range_at_least(0),
            "Objective above which the run stops early: the sum of (6.9) over its films; 0: it does not.");
        d.texts("set", overrides, "Keys of the study that were overridden, as for --set.");
        d.check(parameters.size() == values.size(), "values",
            {"must be as many as the parameters", "", "give one for each"});
    }
};

// Dakota's "standard" format: a count and a word, then a value and a label a line.
std::string dakota_parameters(const ForwardRequest& request) {
    std::string out = std::to_string(request.parameters.size()) + " variables\n";
    for (std::size_t i = 0; i < request.parameters.size(); ++i) {
        const auto quantity = read_number_and_unit(request.run.values[i]);
        out += (quantity ? format_number(quantity->value) : request.run.values[i]) + " " + request.parameters[i] + "\n";
    }
    return out + "0 functions\n0 derivative_variables\n0 analysis_components\n" + std::to_string(request.run.number) +
           " eval_id\n";
}

std::string dakota_label(std::string name) {
    name = name.substr(0, name.find(" ["));
    for (auto& c : name) c = c == ' ' ? '_' : c;
    return name;
}
} // namespace

std::string request_folder(std::int64_t number) {
    char text[32];
    std::snprintf(text, sizeof text, "%04lld", static_cast<long long>(number));
    return text;
}

ForwardRequest request_of(const Study& study, const RunRequest& run) {
    ForwardRequest out{study.path, run, {}, study.overrides};
    for (const auto& parameter : study.parameters) out.parameters.push_back(parameter.name);
    return out;
}

void write_request(const std::filesystem::path& folder, const ForwardRequest& request, Durability durability) {
    std::filesystem::create_directories(folder);
    RequestFile file;
    file.study = request.study.string();
    file.number = int(request.run.number);
    file.scene = request.run.scene;
    file.key = request.run.key;
    file.parameters = request.parameters;
    file.values = request.run.values;
    file.changes = request.run.changes;
    file.overrides = request.overrides;
    if (request.cut < no_cut) file.cut = request.cut;
    write_file_atomically(folder / "params.in", dakota_parameters(request), durability);
    write_file_atomically(folder / "params.yaml", effective(file), durability);
}

ForwardRequest read_request(const std::filesystem::path& folder) {
    const auto path = folder / "params.yaml";
    if (!std::filesystem::exists(path)) {
        throw InputError({folder.string(), "has no params.yaml", "it says which run of which study is asked for",
            "`treacle sweep STUDY --ask N --to DIR` writes such folders"});
    }
    RequestFile file;
    parse(Document::load(path), file);
    return {file.study, {file.number, file.scene, file.values, file.key, file.changes}, file.parameters, file.overrides,
        file.cut > 0 ? file.cut : no_cut};
}

void write_result(const std::filesystem::path& folder, const ForwardResult& result) {
    std::string dakota;
    Json figures = Json::object();
    for (const auto& figure : result.figures) {
        figures[figure.name] = std::isfinite(figure.value) ? Json(figure.value) : Json(nullptr);
        dakota += format_number(figure.value) + " " + dakota_label(figure.name) + "\n";
    }
    Json json{{"number", result.number}, {"key", result.key}, {"figures", figures}, {"seconds", result.seconds},
        {"peak_bytes", result.peak_bytes}};
    if (result.bound) json["bound"] = *result.bound;
    write_file_atomically(folder / "results.out", dakota);
    write_file_atomically(folder / "result.json", json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

void write_failure(const std::filesystem::path& folder, const std::string& reason) {
    write_file_atomically(folder / "results.out", "FAIL\n"); // the text of Dakota's failure capturing
    write_file_atomically(folder / "FAIL", reason + "\n");
}

std::optional<ForwardResult> read_result(const std::filesystem::path& folder, const std::string& key) {
    const auto path = folder / "result.json";
    if (!std::filesystem::exists(path)) return {};
    try {
        const auto json = Json::parse(read_file(path));
        ForwardResult out{json.at("number").get<std::int64_t>(), json.at("key").get<std::string>(), {},
            json.at("seconds").get<double>(), json.at("peak_bytes").get<double>()};
        if (out.key != key) return {};
        if (json.contains("bound")) out.bound = json.at("bound").get<double>();
        for (const auto& [name, value] : json.at("figures").items()) {
            out.figures.push_back({name, value.is_null() ? std::nan("") : value.get<double>()});
        }
        return out;
    } catch (const nlohmann::json::exception& error) {
        throw InputError({path.string(), "cannot be read", error.what(), "remove it and run again"});
    }
}

void take_result(const ForwardResult& result, RunOutcome& outcome) {
    outcome.status = result.bound ? RunStatus::stopped_early : RunStatus::done;
    outcome.reason = result.bound ? "objective >= " + format_number(*result.bound) : "";
    outcome.bound = result.bound.value_or(0);
    outcome.figures = result.figures;
    outcome.peak_bytes = std::max(outcome.peak_bytes, result.peak_bytes);
}

std::string read_failure(const std::filesystem::path& folder) {
    auto text = read_file(folder / "FAIL");
    for (auto& c : text) c = c == '\n' ? ' ' : c;
    text.erase(text.find_last_not_of(' ') + 1);
    return text;
}

} // namespace treacle::study
