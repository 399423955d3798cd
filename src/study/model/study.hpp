#pragma once
#include "study/model/parameter.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace treacle::study {

// A scene of a study, with what it overrides.
struct StudyScene {
    std::string name;
    std::string file;             // beside the study's file, or absolute
    std::vector<std::string> set; // "a.b.c=value"
    std::string where;

    void declare(Declaration& d); // item of `scenes`; the name defaults to that of the file or its folder
};

// Value of a column; `mean` is over time, `at_time` interpolated.
enum class Statistic { last, first, max, min, mean, at_time };

// A figure that is read from the tables of a finished run.
struct Reading {
    std::string name;
    std::string measurement; // a column of measurements.csv by the measurement's name
    std::string table;       // or one of "steps", "bodies", "measurements" with
    std::string column;      // its column, "maximum speed [m/s]"
    Statistic at = Statistic::last;
    double time = 0; // [s] of Statistic::at_time, interpolated
    std::string where;

    void declare(Declaration& d); // item of `read`; one of `measurement` and `table`
};

// Files that are kept of a finished run besides its figures.
enum class Keep { nothing, tables, everything };

// Block `runs`.
struct RunOptions {
    int ranks = 1;                  // a run
    int lanes = 0;                  // runs at once; 0: cores / ranks
    std::string launcher;           // "srun --exact -n {ranks}"; empty: mpiexec for more than one rank, none for one
    double time_limit = 0;          // [s] a run; 0: none
    double memory = 0;              // [GB] a run, all ranks together; 0: no limit
    double hang_factor = 20;        // mean steps without a new row in steps.csv, after which a run counts as hung
    double hang_least = 60;         // [s], and at least this long
    Keep keep = Keep::tables;       // of a run that is done
    bool speculate = true;          // lanes that would idle do runs that a search may request next
    double disk = 0;                // [GB] that the folder of runs may take; 0: no limit
    std::vector<std::string> reuse; // folders of other studies whose finished runs count
    std::string launcher_where;     // place of the launcher, or of the block

    void declare(Declaration& d); // check_launcher() looks for the launcher
    // The words in front of a run's own command.
    std::vector<std::string> launch_words() const;
};

// Points of a sweep: combinations of all values, rows as given, or points spread over the ranges.
enum class Design { none, grid, list, file, latin_hypercube, sobol };

// Block `sweep`.
struct Sweep {
    Design design = Design::none;  // none: the study has no sweep
    std::vector<std::string> rows; // of a list, each with a word per parameter: "0.5 Pa.s, 2 cm"
    std::string file;              // CSV whose columns are the parameters' names
    int runs = 0;                  // points of latin_hypercube and sobol
    int seed = 1;                  // of latin_hypercube; of sobol a shift along the sequence
    std::string where;             // "study.yaml:14"

    void declare(Declaration& d); // refuses a design without its rows, file or number of runs
};

// Many runs of scenes: what varies, what is read from each, how they run. Everything but the scenes' content.
struct Study {
    int schema_version = 1;
    std::string title;
    std::vector<StudyScene> scenes;
    std::vector<Parameter> parameters;
    std::vector<Measured> measured;
    std::vector<Reading> read;
    RunOptions runs;
    Sweep sweep;

    std::filesystem::path path;         // of the file, absolute
    std::vector<std::string> overrides; // of --set

    void declare(Declaration& d);                                    // refuses keys and names that stand twice
    std::filesystem::path scene_file(const StudyScene& scene) const; // absolute
};

} // namespace treacle::study
