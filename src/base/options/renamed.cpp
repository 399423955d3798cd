#include "base/options/document_tree.hpp"
#include "base/text/split.hpp"
#include "base/text/text.hpp"

#include <algorithm>
#include <functional>

namespace treacle {

namespace {
std::string below(const std::string& path, const std::string& key) { return path.empty() ? key : path + "." + key; }

std::string name_of(const Node& item, std::size_t index) {
    const Node* name = item.find("name");
    const bool usable = name && name->kind == Node::Kind::scalar && !name->text.empty();
    return usable ? name->brief() : std::to_string(index);
}

using Visit = std::function<void(Node& block, const std::string& where)>;

// The blocks that may have the last of the parts.
void each_block(Node& node, std::span<const std::string> parts, const std::string& where, const Visit& visit) {
    if (parts.size() == 1) {
        if (node.kind == Node::Kind::block) visit(node, where);
    } else if (parts.front() == "*") {
        for (std::size_t i = 0; i < node.items.size(); ++i)
            each_block(node.items[i], parts.subspan(1), below(where, name_of(node.items[i], i)), visit);
    } else if (Node* inner = node.find(parts.front())) {
        each_block(*inner, parts.subspan(1), below(where, parts.front()), visit);
    }
}

void rename_key(
    DocumentTree& tree, Node& block, const std::string& where, const std::string& key, const std::string& now) {
    const auto old = std::ranges::find(block.members, key, &Node::Member::key);
    if (old == block.members.end()) return;
    if (const Node* present = block.find(now)) {
        tree.problems.push_back({old->location, below(where, key) + " is now " + now + ", which is given as well",
            "it is at " + present->location, "leave " + key + " out"});
        block.members.erase(old);
        return;
    }
    tree.notes.push_back(old->location + ": " + below(where, key) + " is now " + now);
    old->key = now;
}

void rename_word(
    DocumentTree& tree, Node& block, const std::string& where, const std::string& key, const Renamed& one) {
    Node* value = block.find(key);
    if (!value || value->kind != Node::Kind::scalar || value->text != one.word) return;
    tree.notes.push_back(value->location + ": " + below(where, key) + ": " + one.word + " is now " + one.now);
    value->text = one.now;
}
} // namespace

std::string present_path(const std::string& path, std::span<const Renamed> table) {
    auto parts = split(path, '.');
    for (const auto& one : table) {
        const auto pattern = split(one.path, '.');
        if (!one.word.empty() || pattern.size() > parts.size()) continue;
        const bool fits = std::equal(pattern.begin(), pattern.end(), parts.begin(),
            [](const auto& a, const auto& b) { return a == "*" || a == b; });
        if (fits) parts[pattern.size() - 1] = one.now;
    }
    return join(parts, ".");
}

void Document::accept(std::span<const Renamed> table) {
    tree_->renamed = table;
    for (const auto& one : table) {
        const auto parts = split(one.path, '.');
        each_block(tree_->root, parts, "", [&](Node& block, const std::string& where) {
            if (one.word.empty()) {
                rename_key(*tree_, block, where, parts.back(), one.now);
            } else {
                rename_word(*tree_, block, where, parts.back(), one);
            }
        });
    }
}

const std::vector<std::string>& Document::notes() const { return tree_->notes; }

} // namespace treacle
