#include "base/options/options_tree.hpp"
#include "base/text/error.hpp"
#include "base/text/text.hpp"

#include <algorithm>

namespace treacle {

namespace {

using Kind = OptionEntry::Kind;
using Presence = OptionEntry::Presence;
constexpr std::size_t columns = 100;

bool has_members(const OptionEntry& entry) { return entry.kind == Kind::block || entry.kind == Kind::list; }

std::string type_of(const OptionEntry& entry) {
    const std::string unit = entry.unit.si.empty() ? "" : " [" + std::string(entry.unit.si) + "]";
    switch (entry.kind) {
    case Kind::number: return "number" + unit;
    case Kind::integer: return "whole number";
    case Kind::boolean: return "true or false";
    case Kind::text: return "text";
    case Kind::texts: return entry.words.empty() ? "list of words" : "list of " + join(entry.words, ", ");
    case Kind::numbers: return "list of numbers" + unit;
    case Kind::vec3:
        return (entry.vector == VectorKind::turning ? "3 numbers, or in a plane scene one about z," : "3 numbers") +
               unit;
    case Kind::choice: return "one of " + join(entry.words, ", ");
    case Kind::list: return "list of blocks";
    case Kind::block: return entry.shorthand.empty() ? "block" : "block, or a word for its " + entry.shorthand;
    }
    return "";
}

// "number [m], > 0, required"
std::string facts_of(const OptionEntry& entry) {
    std::string out = type_of(entry);
    const auto range = entry.range.text();
    if (!range.empty()) out += ", " + range;
    if (entry.presence == Presence::required) return out + ", required";
    if (entry.presence == Presence::one_of) return out + ", one of these is given";
    return has_members(entry) ? out : out + ", default " + entry.default_text;
}

void write_summary(const OptionEntry& entry, std::size_t depth, std::string& out) {
    const std::string indent(2 * depth, ' ');
    out += indent + entry.key + ": " + facts_of(entry) + "\n";
    if (!entry.doc.empty()) out += indent + "    " + wrap(entry.doc, columns, indent.size() + 4) + "\n";
    for (const auto& member : entry.members) write_summary(member, depth + 1, out);
}

// One key: the same, and how its values are written.
std::string write_detail(const OptionEntry& entry, const std::string& path) {
    OptionEntry named = entry;
    named.key = path;
    std::string out;
    write_summary(named, 0, out);
    const bool quantity = entry.kind == Kind::number || entry.kind == Kind::numbers || entry.kind == Kind::vec3;
    if (quantity && !entry.unit.si.empty()) {
        out += "    Plain numbers are in " + std::string(entry.unit.si) +
               "; with a unit: " + std::string(entry.unit.accepted) + ".\n";
    }
    if (!entry.range.reason.empty()) {
        out += "    " + entry.range.reason + (entry.range.cure.empty() ? "" : "; " + entry.range.cure) + ".\n";
    }
    return out;
}

void collect_paths(const OptionEntry& entry, const std::string& prefix, std::vector<std::string>& out) {
    for (const auto& member : entry.members) {
        out.push_back(prefix + member.key);
        collect_paths(member, prefix + member.key + ".", out);
    }
}

// Also a path of which only the end is misspelt or only the end is given: "viscosity".
std::string suggest(const OptionEntry& root, const std::string& path) {
    std::vector<std::string> paths;
    collect_paths(root, "", paths);
    std::vector<std::string> ending;
    for (const auto& known : paths) {
        if (known.ends_with("." + path)) ending.push_back(known);
    }
    if (!ending.empty()) return "did you mean " + join(ending, " or ") + "?";
    const auto close = nearest(path, paths);
    return close ? "did you mean " + *close + "?" : "`treacle schema` lists all keys";
}

const OptionEntry* find_entry(const OptionEntry& root, const std::string& path) {
    const OptionEntry* entry = &root;
    std::size_t start = 0;
    while (start <= path.size()) {
        const auto end = std::min(path.find('.', start), path.size());
        const auto part = path.substr(start, end - start);
        start = end + 1;
        const bool item = !part.empty() && std::ranges::all_of(part, [](char c) { return c >= '0' && c <= '9'; });
        if (item && entry->kind == Kind::list) continue;
        const auto found = std::ranges::find(entry->members, part, &OptionEntry::key);
        if (found == entry->members.end()) return nullptr;
        entry = &*found;
        if (entry->told_elsewhere) return entry;
    }
    return entry;
}

} // namespace

std::string describe(const Declaration::Members& root, const std::string& key) {
    const auto tree = describe_tree(root);
    if (key.empty()) {
        std::string out;
        for (const auto& member : tree.members) write_summary(member, 0, out);
        return out;
    }
    const auto* entry = find_entry(tree, key);
    if (!entry) throw InputError({"", key + " is not a known key", "", suggest(tree, key)});
    return write_detail(*entry, key);
}

} // namespace treacle
