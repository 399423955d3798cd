#pragma once
#include <string>
#include <vector>

namespace treacle {
class Declaration;
}

namespace treacle::identify {

// An experiment that could be filmed next: as one that was, but for what it sets.
struct SetUp {
    std::string name;
    std::string like;             // experiment whose scene, camera and times it takes; empty: the study's first
    std::vector<std::string> set; // keys of that scene: sizes of the block
    std::string camera;           // empty: that of the experiment
    double from = -1, to = -1;    // [s] of the scene's time; -1: those of the experiment
    std::string where;

    // Keys of an item of `candidates`.
    void declare(Declaration& d);
};

} // namespace treacle::identify
