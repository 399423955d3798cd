#include "study/model/study.hpp"

#include "base/options/options.hpp"
#include "base/text/text.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <sstream>

namespace treacle::study {

namespace {
// Names of items must be unique: they are columns and keys.
template <class T, class Name>
void check_names(Declaration& d, const std::string& key, const std::vector<T>& items, const Name& name) {
    if (!d.parsing()) return;
    std::map<std::string, std::string> seen;
    for (const auto& item : items) {
        const auto [earlier, fresh] = seen.emplace(name(item), item.where);
        d.check(fresh, key,
            {"must have names that differ", item.where + ": " + name(item) + " stands at " + earlier->second + " too",
                "give one of them another name"});
    }
}
} // namespace

void StudyScene::declare(Declaration& d) {
    if (d.parsing()) where = d.location();
    d.text("name", name, "Name in tables; by default that of the file's folder or of the file.");
    d.text("file", file, "The scene's file, beside the study's or with its whole path.");
    d.required("file");
    d.texts("set", set, "Keys of the scene that the study overrides in all runs: [time.end=2 s].");
    if (!d.parsing() || !name.empty()) return;
    const std::filesystem::path path = file;
    name = path.stem() == "scene" && path.has_parent_path() ? path.parent_path().filename().string()
                                                            : path.stem().string();
}

void Reading::declare(Declaration& d) {
    if (d.parsing()) where = d.location();
    d.text("name", name, "Name of the figure; by default that of the measurement or column.");
    d.text("measurement", measurement, "Name of one of the scene's measurements.");
    d.text("table", table, "Or a table of the run: steps, bodies or measurements.");
    d.text("column", column, "Column of that table, with its unit as in the header: maximum speed [m/s].");
    d.choice<Statistic>("at", at,
        {{"last", Statistic::last}, {"first", Statistic::first}, {"max", Statistic::max}, {"min", Statistic::min},
            {"mean", Statistic::mean}, {"time", Statistic::at_time}},
        "Which of the column's values: the last or first, the largest or least, the mean over time, or that at "
        "`time`.");
    d.number("time", time, unit::time, range_at_least(0),
        "Simulated time of at: time; between rows the value is interpolated.");
    if (!d.parsing()) return;
    d.check(measurement.empty() != table.empty(), "measurement",
        {"must be given, or a table with its column, and not both", "a figure has one source",
            "write for instance measurement: front"});
    d.check(table.empty() || table == "steps" || table == "bodies" || table == "measurements", "table",
        {"must be steps, bodies or measurements", "a run writes no other table", ""});
    d.check(table.empty() || !column.empty(), "column",
        {"must be given", "the table has several", "its header names them"});
    d.check(
        at == Statistic::at_time || time == 0, "time", {"has no effect", "it belongs to at: time", "write at: time"});
    if (name.empty()) name = measurement.empty() ? column.substr(0, column.find(" [")) : measurement;
    d.check(name.find_first_of(",\"\n\r") == std::string::npos, "name",
        {"must not have a comma, a quote or a line break", "it becomes the header of a column",
            "choose a plainer name"});
}

void RunOptions::declare(Declaration& d) {
    d.integer("ranks", ranks, range_at_least(1),
        "MPI ranks of each run. Results may differ in their last digits between numbers of ranks.");
    d.integer("lanes", lanes, range_at_least(0), "Runs at once; 0: as many as there are cores for.");
    d.text("launcher", launcher,
        "Command in front of each run, {ranks} stands for their number: srun --exact -n {ranks}. By default "
        "none for one rank, and mpiexec for more.");
    if (d.parsing()) launcher_where = d.location_of("launcher");
    d.number("time_limit", time_limit, unit::time, range_at_least(0),
        "Time of the clock after which a run is ended and counts as failed; 0: none.");
    d.number("memory", memory, unit::none, range_at_least(0),
        "Gigabytes of memory that a run may hold before it is ended; 0: no limit.");
    d.number("hang_factor", hang_factor, unit::none, range_at_least(0),
        "A run that takes no step for so many mean steps is ended and counts as hung; 0: never.");
    d.number("hang_least", hang_least, unit::time, range_at_least(0),
        "But not before this time of the clock without a step; ten times as long before the first step, and while a "
        "finished run is compared with films.");
    d.choice<Keep>("keep", keep,
        {{"nothing", Keep::nothing}, {"tables", Keep::tables}, {"everything", Keep::everything}},
        "What stays of a finished run besides its figures: nothing, its tables, or its frames as well.");
    d.boolean("speculate", speculate,
        "Whether lanes that would idle do runs that a search may ask for next; its answer is the same without.");
    d.number("disk", disk, unit::none, range_at_least(0),
        "Gigabytes that the runs' folders may take; before more is written the study stops. 0: no limit.");
    d.texts("reuse", reuse, "Folders of other studies, whose finished runs of equal scenes count as this study's.");
}

std::vector<std::string> RunOptions::launch_words() const {
    std::istringstream text(launcher.empty() && ranks > 1 ? "mpiexec -n {ranks}" : launcher);
    std::vector<std::string> words;
    for (std::string word; text >> word; words.push_back(word)) {
        if (const auto at = word.find("{ranks}"); at != std::string::npos) word.replace(at, 7, std::to_string(ranks));
    }
    return words;
}

void Sweep::declare(Declaration& d) {
    if (d.parsing()) where = d.location();
    d.choice<Design>("design", design,
        {{"none", Design::none}, {"grid", Design::grid}, {"list", Design::list}, {"file", Design::file},
            {"latin_hypercube", Design::latin_hypercube}, {"sobol", Design::sobol}},
        "Which points: every combination of the parameters' values, a list of rows, a CSV file of rows, or points "
        "spread over "
        "the parameters' ranges.");
    d.texts("rows", rows,
        "Of a list: a text each run with a value for each parameter, in their order: [\"1 Pa.s, sph\", \"1 Pa.s, "
        "grid\"].");
    d.text("file", file, "Of design: file, a CSV whose header names the parameters.");
    d.integer("runs", runs, range_at_least(0), "Number of points of latin_hypercube and sobol.");
    d.integer("seed", seed, range_at_least(0),
        "Another number gives other points of latin_hypercube; of sobol, points further along the sequence.");
    if (!d.parsing()) return;
    d.check(design != Design::list || !rows.empty(), "rows",
        {"must not be empty", "the design is a list", "give a row a run"});
    d.check(design != Design::file || !file.empty(), "file",
        {"must be given", "the design is a file", "write file: rows.csv"});
    const bool spread = design == Design::latin_hypercube || design == Design::sobol;
    d.check(!spread || runs > 0, "runs",
        {"must be given", "nothing else says how many points there are", "write for instance runs: 40"});
}

void Study::declare(Declaration& d) {
    d.integer("schema_version", schema_version, range_any(), "Version of the layout of this file.");
    d.required("schema_version");
    d.check(schema_version == 1, "schema_version",
        {"must be 1", "it is the only version that this program knows", "`treacle schema --study` shows its keys"});
    d.text("title", title, "One line for people.");
    d.list("scenes", scenes, "The scenes; every point of the parameters is run in each.");
    d.required("scenes");
    d.check(!scenes.empty(), "scenes", {"must not be empty", "there would be nothing to run", "name a scene's file"});
    check_names(d, "scenes", scenes, [](const StudyScene& s) { return s.name; });
    d.list("parameters", parameters, "The values of the scenes that vary.");
    check_names(d, "parameters", parameters, [](const Parameter& p) { return p.name; });
    d.list("measured", measured, "Values of the scenes that were measured, with their uncertainty.");
    check_names(d, "measured", measured, [](const Measured& m) { return m.name; });
    if (d.parsing()) {
        std::map<std::string, std::string> keys;
        const auto check_key = [&](const std::string& block, const std::string& key, const std::string& location) {
            const auto [earlier, fresh] = keys.emplace(key, location);
            d.check(fresh, block,
                {"must have keys that differ", location + ": " + key + " is set at " + earlier->second + " too",
                    "a value of the scene can be set once"});
        };
        for (const auto& one : parameters) check_key("parameters", one.key, one.where);
        for (const auto& one : measured) check_key("measured", one.key, one.where);
    }
    d.list("read", read, "The figures that are read from each run; without any, the last values of all measurements.");
    check_names(d, "read", read, [](const Reading& r) { return r.name; });
    d.block("runs", runs, "How the runs are done.");
    d.block("sweep", sweep, "The points of `treacle sweep`.", "design");
}

std::filesystem::path Study::scene_file(const StudyScene& scene) const {
    const std::filesystem::path file = scene.file;
    auto whole = file.is_absolute() ? file : path.parent_path() / file;
    if (std::filesystem::is_directory(whole)) whole /= "scene.yaml";
    return whole.lexically_normal();
}

} // namespace treacle::study
