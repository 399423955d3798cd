#pragma once
#include <string>

namespace treacle {
class Declaration;
}

namespace treacle::identify {

// Numbers that were measured over time, and what they are in the run: a measurement of the scene, or a column of a table.
struct Series {
    std::string file;             // CSV with columns time, the values and plus_minus, beside the study's file
    std::string values = "value"; // name of the values' column
    std::string measurement;      // of the scene
    std::string table, column;    // or a table of the run and its column, "ball position z [m]"
    double offset = 0;            // standard deviation of the instrument's zero, in SI
    std::string where;

    // Keys of the block `series` of an experiment.
    void declare(Declaration& d);
};

} // namespace treacle::identify
