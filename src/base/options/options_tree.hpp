#pragma once
#include "base/options/options.hpp"

#include <string>
#include <vector>

namespace treacle {

// The declaration as data, from which the manual and the JSON Schema are written. Private to base.
struct OptionEntry {
    enum class Kind { number, integer, boolean, text, texts, numbers, vec3, choice, block, list };
    enum class Presence { optional, required, one_of };

    std::string key;                          // empty for the root
    Kind kind = Kind::block;                  // block: `members`; choice and texts: `words`
    Presence presence = Presence::optional;   // one_of: one of the keys of its block that exclude each other
    std::string doc;                          // sentence of the manual
    std::string default_text;                 // the default, as one would write it; empty for blocks and lists of them
    Unit unit = unit::none;                   // of numbers and vectors
    Range range;                              // of numbers
    std::vector<std::string> words;           // that a choice or each of the texts may be
    std::string shorthand;                    // of a block
    bool told_elsewhere = false;              // a block whose members stand further up
    VectorKind vector = VectorKind::in_plane; // of vectors
    std::vector<OptionEntry> members;         // of a block, or of an item of a list
};

// The root's members are those of the document.
OptionEntry describe_tree(const Declaration::Members& root);

} // namespace treacle
