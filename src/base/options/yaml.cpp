#include "base/options/document_tree.hpp"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <cctype>
#include <map>
#include <sstream>

namespace treacle {

namespace {

constexpr std::size_t deepest = 64;
constexpr std::size_t most_nodes = 1'000'000; // aliases of aliases multiply
constexpr std::size_t most_keys = 1000;       // of one block

// Builds the tree from yaml-cpp's events, which still have the duplicate keys that its own tree drops.
class TreeBuilder : public YAML::EventHandler {
public:
    TreeBuilder(DocumentTree& tree, std::string location) : tree_(tree), location_(std::move(location)) {}

    void OnDocumentStart(const YAML::Mark&) override {}
    void OnDocumentEnd() override {}

    void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
        add(leaf(mark, Node::Kind::null, ""), anchor);
    }

    void OnScalar(
        const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, const std::string& value) override {
        reject_tag(mark, tag);
        // "!" marks a quoted text: then even an empty one is a value.
        const bool null = tag != "!" && (value.empty() || value == "~" || value == "null");
        add(leaf(mark, null ? Node::Kind::null : Node::Kind::scalar, null ? "" : value), anchor);
    }

    void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
        const auto found = anchors_.find(anchor);
        if (found == anchors_.end()) fail(location(mark), "an alias stands inside its own anchor", "write it out");
        const auto [node, size, depth] = found->second;
        Node copy = node;
        copy.location = location(mark);
        size_ += size;
        check_limits(mark, open_.size() + depth);
        attach(std::move(copy), depth);
    }

    void OnSequenceStart(
        const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, YAML::EmitterStyle::value) override {
        open(mark, tag, anchor, Node::Kind::list);
    }
    void OnSequenceEnd() override { close(); }

    void OnMapStart(
        const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, YAML::EmitterStyle::value) override {
        open(mark, tag, anchor, Node::Kind::block);
    }
    void OnMapEnd() override { close(); }

private:
    struct Open {
        Node node;
        YAML::anchor_t anchor = 0;
        std::size_t size_before = 0;
        std::size_t depth = 1; // of the tree under it
        bool key_read = false;
        std::string key;
        std::string key_location;
    };
    struct Anchored {
        Node node;
        std::size_t size;
        std::size_t depth;
    };

    std::string location(const YAML::Mark& mark) const {
        return location_.empty() ? tree_.name + ":" + std::to_string(mark.line + 1) : location_;
    }

    [[noreturn]] static void fail(const std::string& location, const std::string& problem, const std::string& cure) {
        throw InputError({location, problem, "", cure});
    }

    void reject_tag(const YAML::Mark& mark, const std::string& tag) const {
        if (tag.empty() || tag == "?" || tag == "!") return;
        fail(location(mark), "the tag " + tag + " has no meaning here", "remove it");
    }

    Node leaf(const YAML::Mark& mark, Node::Kind kind, const std::string& text) const {
        Node node;
        node.kind = kind;
        node.text = text;
        node.location = location(mark);
        return node;
    }

    void check_limits(const YAML::Mark& mark, std::size_t depth) const {
        if (depth > deepest) {
            fail(location(mark), "blocks are nested more than " + std::to_string(deepest) + " deep", "flatten them");
        }
        if (size_ > most_nodes) {
            fail(location(mark), "more than a million values", "give large data in a file of its own");
        }
    }

    void add(Node node, YAML::anchor_t anchor) {
        ++size_;
        if (anchor != 0) anchors_[anchor] = {node, 1, 1};
        attach(std::move(node), 1);
    }

    void open(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, Node::Kind kind) {
        reject_tag(mark, tag);
        check_limits(mark, open_.size() + 1);
        Open entry;
        entry.node = leaf(mark, kind, "");
        entry.anchor = anchor;
        entry.size_before = size_++;
        open_.push_back(std::move(entry));
    }

    void close() {
        Open entry = std::move(open_.back());
        open_.pop_back();
        if (entry.anchor != 0) anchors_[entry.anchor] = {entry.node, size_ - entry.size_before, entry.depth};
        attach(std::move(entry.node), entry.depth);
    }

    void attach(Node node, std::size_t depth) {
        if (open_.empty()) {
            tree_.root = std::move(node);
            return;
        }
        Open& parent = open_.back();
        parent.depth = std::max(parent.depth, depth + 1);
        if (parent.node.kind == Node::Kind::list) {
            parent.node.items.push_back(std::move(node));
        } else if (!parent.key_read) {
            if (node.kind != Node::Kind::scalar) fail(node.location, "a key is not a word", "write `key: value`");
            parent.key_read = true;
            parent.key = node.text;
            parent.key_location = node.location;
        } else {
            parent.key_read = false;
            add_member(parent, std::move(node));
        }
    }

    void add_member(Open& parent, Node value) {
        // An empty value has its mark where the next token starts.
        if (value.kind == Node::Kind::null) value.location = parent.key_location;
        for (const auto& member : parent.node.members) {
            if (member.key != parent.key) continue;
            tree_.problems.push_back({parent.key_location, "the key " + parent.key + " stands twice",
                "it is already given at " + member.location, "remove one of them"});
            return;
        }
        if (parent.node.members.size() == most_keys) {
            fail(parent.key_location, "more than " + std::to_string(most_keys) + " keys in a block", "remove some");
        }
        parent.node.members.push_back({parent.key, parent.key_location, std::move(value)});
    }

    DocumentTree& tree_;
    std::string location_;
    std::vector<Open> open_;
    std::map<YAML::anchor_t, Anchored> anchors_;
    std::size_t size_ = 0;
};

// yaml-cpp's own words, with a lower-case start so that they follow a place.
std::string lower_start(std::string text) {
    if (!text.empty()) text[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(text[0])));
    return text;
}

// True for a line (counted from 0) with a tab before its first word; dashes of list items are not words.
bool indented_by_tab(const std::string& text, int line) {
    std::size_t start = 0;
    for (int k = 0; k < line && start != std::string::npos; ++k) {
        start = text.find('\n', start);
        if (start != std::string::npos) ++start;
    }
    if (line < 0 || start == std::string::npos) return false;
    const auto word = std::min(text.find_first_not_of(" \t-", start), text.size());
    return text.substr(start, word - start).find('\t') != std::string::npos;
}

} // namespace

DocumentTree read_yaml(const std::string& text, const std::string& name, const std::string& location) {
    DocumentTree tree;
    tree.name = name;
    tree.root.location = location.empty() ? name + ":1" : location;
    const auto zero = text.find('\0');
    if (zero != std::string::npos) {
        throw InputError({tree.root.location, "is not a text file", "it has a zero byte", "give a YAML file"});
    }
    TreeBuilder builder(tree, location);
    try {
        // yaml-cpp 0.7 reports an open quote only when nothing, not even a line break, follows.
        std::istringstream stream(text.substr(0, text.find_last_not_of(" \n\r") + 1));
        YAML::Parser parser(stream);
        parser.HandleNextDocument(builder);
        Node first = std::move(tree.root);
        if (parser.HandleNextDocument(builder)) {
            throw InputError({tree.root.location, "a second document starts", "a scene is one document",
                "remove everything from the line `---` on"});
        }
        tree.root = std::move(first);
    } catch (const YAML::Exception& error) {
        const auto where = location.empty() ? name + ":" + std::to_string(error.mark.line + 1) : location;
        if (indented_by_tab(text, error.mark.line)) {
            throw InputError({where, "is not YAML: a tab stands in the indentation",
                "YAML indents by blanks, since a tab has no fixed width",
                "write blanks in the place of tabs, the same number for all keys of a block"});
        }
        throw InputError({where, "is not YAML: " + lower_start(error.msg), "",
            "check the indentation, colons and quotes around that line"});
    }
    return tree;
}

} // namespace treacle
