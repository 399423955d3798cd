#pragma once
#include "base/text/error.hpp"

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace treacle::app {

// An option for an observation that a first guess needs; its name is that of the option without dashes.
struct SightOption {
    const char* name;
    const char* doc;
    const char* type;
};
std::span<const SightOption> sight_options();

// Arguments of `treacle new`.
struct NewStudyRequest {
    std::string name;                         // of the template; empty: list them
    std::filesystem::path folder;             // made when it is missing; must be empty
    std::vector<std::string> form;            // "length=7 cm +- 0.05 cm"
    std::map<std::string, std::string> sight; // values of sight_options() that were given
};

// `treacle new`: a folder with study.yaml, scene.yaml and FILMING.md for an experiment, the search's range centred on a first
// guess; or the list of experiments. Throws InputError, also where the folder is not empty.
ExitCode new_study(const NewStudyRequest& request);

} // namespace treacle::app
