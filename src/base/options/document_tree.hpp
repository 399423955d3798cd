#pragma once
#include "base/options/document.hpp"
#include "base/text/error.hpp"

#include <span>
#include <string>
#include <vector>

namespace treacle {

// Contents of a YAML document, with the place ("scene.yaml:14") of each part. Private to base.
struct Node {
    enum class Kind { null, scalar, list, block };

    struct Member; // of a block, in the order of the file

    Kind kind = Kind::null;      // decides which of the others are in use
    std::string text;            // scalar
    std::string location;        // "scene.yaml:14", or the override
    std::vector<Member> members; // of a block
    std::vector<Node> items;     // of a list

    // First member with this key; null without one, and for anything but a block.
    Node* find(const std::string& key);
    const Node* find(const std::string& key) const;

    // As written, shortened, for messages: "-3", "[1, 2]", "{...}".
    std::string brief() const;
};

// Key and value of a block. A duplicate key stays in the list and is a problem of the tree.
struct Node::Member {
    std::string key;      // as written, without quotes
    std::string location; // of the key
    Node value;           // with a location of its own
};

// Result of reading one file or override.
struct DocumentTree {
    std::string name;                 // path or "--set", for messages
    Node root;                        // null for an empty document
    std::vector<Diagnostic> problems; // found while reading, reported with those of the parsing
    std::span<const Renamed> renamed;
    std::vector<std::string> notes; // on earlier names
};

// Reads one YAML document; a key that stands twice becomes a problem of the tree. With a `place`, that is
// the location of everything. Throws InputError on a syntax error, tags, and more nesting or nodes than a scene
// could need.
DocumentTree read_yaml(const std::string& text, const std::string& name, const std::string& location = "");

} // namespace treacle
