#pragma once
#include "base/text/error.hpp"

#include <string>
#include <vector>

namespace treacle {

// Contents of a YAML document, with the place ("scene.yaml:14") of each part. Private to base.
struct Node {
    enum class Kind { null, scalar, list, block };

    struct Member; // of a block, in the order of the file

    Kind kind = Kind::null;
    std::string text; // scalar
    std::string place;
    std::vector<Member> members;
    std::vector<Node> items;

    Node* find(const std::string& key);
    const Node* find(const std::string& key) const;

    // As written, shortened, for messages: "-3", "[1, 2]", "{...}".
    std::string brief() const;
};

struct Node::Member {
    std::string key;
    std::string place;
    Node value;
};

struct DocumentTree {
    std::string name;
    Node root;
    std::vector<Diagnostic> problems; // found while reading, reported with those of the parsing
};

// Reads one YAML document; a key that stands twice becomes a problem of the tree. With a `place`, that is
// the place of everything. Throws InputError on a syntax error, tags, and more nesting or nodes than a scene
// could need.
DocumentTree read_yaml(const std::string& text, const std::string& name, const std::string& place = "");

} // namespace treacle
