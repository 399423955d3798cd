#pragma once
#include "base/options/options.hpp"

#include <string>
#include <vector>

namespace treacle {

// The declaration as data, from which the manual and the JSON Schema are written. Private to base.
struct OptionEntry {
    enum class Kind { number, integer, boolean, text, texts, numbers, vec3, choice, block, list };
    enum class Presence { optional, required, one_of };

    std::string key;
    Kind kind = Kind::block;
    Presence presence = Presence::optional;
    std::string doc;
    std::string standard; // the default, as one would write it; empty for blocks and lists of them
    Unit unit = unit::none;
    Range range;
    std::vector<std::string> words; // that a choice or each of the texts may be
    std::string shorthand;          // of a block
    bool told_elsewhere = false;    // a block whose members stand further up
    VectorKind vector = VectorKind::in_plane;
    std::vector<OptionEntry> members;
};

// The root's members are those of the document.
OptionEntry describe_tree(const Declaration::Members& root);

} // namespace treacle
