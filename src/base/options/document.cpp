#include "base/options/document.hpp"

#include "base/options/document_tree.hpp"
#include "base/text/split.hpp"
#include "base/text/text.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <iterator>
#include <optional>

namespace treacle {

namespace {
template <class N>
auto find_member(N& node, const std::string& key) -> decltype(&node.members.front().value) {
    for (auto& member : node.members) {
        if (member.key == key) return &member.value;
    }
    return nullptr;
}
} // namespace

Node* Node::find(const std::string& key) { return find_member(*this, key); }
const Node* Node::find(const std::string& key) const { return find_member(*this, key); }

std::string Node::brief() const {
    if (kind == Kind::block) return "{...}";
    if (kind != Kind::list) return shorten(text);
    constexpr std::size_t most = 6;
    std::string out;
    for (std::size_t i = 0; i < items.size(); ++i) {
        out += (i > 0 ? ", " : "") + (i < most ? items[i].brief() : std::string("..."));
        if (i == most) break;
    }
    return shorten("[" + out + "]");
}

Document::Document(std::unique_ptr<DocumentTree> tree) : tree_(std::move(tree)) {}
Document::Document(const Document& other) : tree_(std::make_unique<DocumentTree>(*other.tree_)) {}
Document::Document(Document&& other) noexcept = default;
Document& Document::operator=(Document other) noexcept {
    tree_ = std::move(other.tree_);
    return *this;
}
Document::~Document() = default;

Document Document::load(const std::filesystem::path& path) {
    std::error_code ignored;
    const auto name = path.string();
    if (!std::filesystem::exists(path, ignored)) {
        throw InputError({name, "there is no such file", "", "check the path"});
    }
    if (std::filesystem::is_directory(path, ignored)) {
        throw InputError({name, "is a folder, not a scene file", "", "give the YAML file in it"});
    }
    std::ifstream file(path, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    if (!file) throw InputError({name, "cannot be read", "", "check its permissions"});
    return from_text(text, name);
}

Document Document::from_text(const std::string& text, const std::string& name) {
    return Document(std::make_unique<DocumentTree>(read_yaml(text, name)));
}

namespace {

std::vector<std::string> names_of(const Node& list) {
    std::vector<std::string> names;
    for (const auto& item : list.items) {
        const auto* name = item.find("name");
        if (name && name->kind == Node::Kind::scalar) names.push_back(name->text);
    }
    return names;
}

std::optional<std::size_t> read_index(const std::string& word) {
    std::size_t index = 0;
    const auto* end = word.data() + word.size();
    const auto result = std::from_chars(word.data(), end, index);
    if (word.empty() || result.ptr != end || result.ec != std::errc{}) return {};
    return index;
}

// The item of a list that a part of an override's path means.
Node& find_item(Node& list, const std::string& word, const std::string& location) {
    if (const auto index = read_index(word)) {
        if (*index < list.items.size()) return list.items[*index];
        throw InputError({location, "there is no item " + word,
            "the list has " + std::to_string(list.items.size()) + " items, counted from 0", ""});
    }
    for (auto& item : list.items) {
        const auto* name = item.find("name");
        if (name && name->text == word) return item;
    }
    const auto names = names_of(list);
    const auto close = nearest(word, names);
    throw InputError({location, "there is no item named " + word,
        names.empty() ? "the items have no names" : "the names are " + join(names, ", "),
        close ? "did you mean " + *close + "?" : "use its number, counted from 0"});
}

Node& find_or_make(Node& node, const std::string& word, const std::string& location) {
    if (node.kind == Node::Kind::list) return find_item(node, word, location);
    if (node.kind == Node::Kind::scalar) {
        throw InputError({location, word + " would be a key of \"" + node.brief() + "\", which is not a block",
            "it is given at " + node.location, "override it as a whole, for instance ={...}"});
    }
    if (node.kind == Node::Kind::null) {
        node.kind = Node::Kind::block;
        node.location = location;
    }
    if (Node* known = node.find(word)) return *known;
    node.members.push_back({word, location, {}});
    node.members.back().value.location = location;
    return node.members.back().value;
}

void note_override(DocumentTree& tree, const std::string& given, const std::string& path, const std::string& location) {
    if (given != path) tree.notes.push_back(location + ": " + given + " is now " + path);
}

} // namespace

void Document::set(const std::string& assignment, const std::string& origin) {
    const std::string location = origin.empty() ? "--set " + assignment : origin;
    try {
        const auto equals = assignment.find('=');
        const auto path = present_path(assignment.substr(0, equals), tree_->renamed);
        const auto parts = split(path, '.');
        const bool gap = std::ranges::find(parts, "") != parts.end();
        if (equals == std::string::npos || gap) {
            throw InputError({location, "is not of the form a.b.c=value", "", "write for instance --set time.end=2"});
        }
        auto value = read_yaml(assignment.substr(equals + 1), "--set", location);
        Node* node = &tree_->root;
        for (const auto& part : parts) node = &find_or_make(*node, part, location);
        *node = std::move(value.root);
        std::ranges::move(value.problems, std::back_inserter(tree_->problems));
        note_override(*tree_, assignment.substr(0, equals), path, location);
        accept(tree_->renamed);
    } catch (const InputError& error) {
        std::ranges::copy(error.diagnostics(), std::back_inserter(tree_->problems));
    }
}

} // namespace treacle
