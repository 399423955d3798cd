#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace treacle::study {

// The variables of a parameters file of Dakota's, in its standard or APREPRO format (Dakota's reference manual, "Dakota
// Parameters File Data Format"), and the number of the evaluation.
struct DakotaParameters {
    std::vector<std::pair<std::string, std::string>> variables; // label, value
    int evaluation = 0;                                         // 0: not stated
};
// Throws InputError with file:line.
DakotaParameters read_dakota_parameters(const std::filesystem::path& path);

} // namespace treacle::study
