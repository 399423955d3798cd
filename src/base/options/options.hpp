#pragma once
#include "base/options/document.hpp"
#include "base/text/units.hpp"
#include "base/text/vec3.hpp"

#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace treacle {

// Options are declared once: a struct has `void declare(Declaration& d)` (or there is a free
// `void declare(Declaration&, T&)` beside it) that names each key, its variable, unit, range and a sentence.
// The variable's initial value is the default. Parsing, the manual, the JSON Schema and the effective values
// are four visitors of that one declaration. Call it in the order of the manual.

// The values that a number may have; `reason` and `cure` complete the message about one that it may not.
struct Range {
    enum class Lower { none, included, excluded };

    Lower lower = Lower::none;                            // none: any number up to max
    double min = 0;                                       // bound of `lower`, in the option's SI unit
    double max = std::numeric_limits<double>::infinity(); // included
    std::string reason, cure;                             // sentences without a full stop; may be empty

    // The same bounds with a reason and a cure.
    Range because(std::string why, std::string what_to_do) const;
    bool contains(double value) const; // false for NaN
    std::string text() const;          // ">= 0", "in [0, 1]"; empty when everything is allowed
};
// Bounds in the option's SI unit; each without an upper one.
Range range_any();
Range range_above(double min);
Range range_at_least(double min);
Range range_between(double min, double max);  // both included
Range range_above_to(double min, double max); // the lower bound excluded

// In 2D scenes two numbers are enough for a vector. A third one must be 0 (`in_plane`) or is kept, as for
// the place of a camera (`in_space`). What turns (`turning`) turns about z there: one number is enough, and the first two
// of three must be 0.
enum class VectorKind { in_plane, in_space, turning };

// Visitor of the options of a block. Values are in SI; `doc` is one sentence of the manual.
class Declaration {
public:
    using Members = std::function<void(Declaration&)>; // declares the keys of one block

    // Items of a list of blocks, without their type.
    struct Items {
        std::function<std::size_t()> size;
        std::function<void()> clear;
        std::function<void()> append;
        std::function<void(std::size_t, Declaration&)> declare;
        Members declare_default; // an item that is in no list, for the manual
    };

    // One of the keys that exclude each other.
    struct Alternative {
        std::string key;
        Members members;
        std::string doc;
    };

    virtual ~Declaration() = default;

    // Keys of the current block. A visitor that parses sets the value where the document has the key, and collects
    // problems (type, unit, range, unknown key) instead of throwing; other visitors leave the value as it is.
    virtual void number(
        const std::string& key, double& value, const Unit& unit, const Range& range, const std::string& doc) = 0;
    virtual void integer(const std::string& key, int& value, const Range& range, const std::string& doc) = 0;
    virtual void boolean(const std::string& key, bool& value, const std::string& doc) = 0;
    virtual void text(const std::string& key, std::string& value, const std::string& doc) = 0;
    // With `allowed`, each must be one of these.
    virtual void texts(const std::string& key, std::vector<std::string>& value, const std::string& doc,
        const std::vector<std::string>& allowed = {}) = 0;
    // A list of any length, each within `range`.
    virtual void numbers(const std::string& key, std::vector<double>& value, const Unit& unit, const Range& range,
        const std::string& doc) = 0;
    virtual void vec3(const std::string& key, Vec3& value, const Unit& unit, const std::string& doc,
        VectorKind kind = VectorKind::in_plane) = 0;
    // An axis or normal: not zero, no unit, of any length. `in_plane`: in 2D scenes without a third number.
    void direction(const std::string& key, Vec3& value, const std::string& doc, VectorKind kind = VectorKind::in_space);

    // One of the names of `choices`. A value that is none of them becomes the first.
    template <class E>
    void choice(const std::string& key, E& value, const std::vector<std::pair<std::string, E>>& choices,
        const std::string& doc);

    // A block of keys. With a `shorthand`, a word in its place is taken for that key of it: `x_min: wall`.
    template <class T>
    void block(const std::string& key, T& value, const std::string& doc, const std::string& shorthand = "") {
        block_of(
            key, [&value](Declaration& d) { declare_members(d, value); }, doc, shorthand);
    }
    virtual void block_of(
        const std::string& key, const Members& members, const std::string& doc, const std::string& shorthand = "") = 0;
    // A block that may be absent; `present`: true when it is there before; result: true when it is there after.
    virtual bool optional_block(
        const std::string& key, bool present, const Members& members, const std::string& doc) = 0;

    // A list of blocks. In messages an item goes by its key `name`, else by its number.
    template <class T>
    void list(const std::string& key, std::vector<T>& value, const std::string& doc);
    virtual void list_of(const std::string& key, const Items& items, const std::string& doc) = 0;

    // Exactly one of these keys of the current block is given, and sets `value`.
    template <class E>
    void one_of(E& value, const std::vector<std::pair<E, Alternative>>& alternatives);

    // The key, declared before, must be given.
    virtual void required(const std::string& key) = 0;

    // A condition on several keys of the current block, reported at `key`. Skipped when a value of the block
    // could not be read.
    virtual void check(bool, const std::string&, const Complaint&) {}

    // True while values are read from a document: the only time to derive one value from another.
    virtual bool parsing() const { return false; }
    // True when the document has this key in the current block; false when not parsing.
    virtual bool given(const std::string&) const { return false; }
    // "scene.yaml:14", where the current block starts; empty when not parsing.
    virtual std::string location() const { return ""; }
    // Place of this key's value, or of the block that lacks it; empty when not parsing.
    virtual std::string location_of(const std::string&) const { return ""; }
    // 2D scenes: vectors declared from here on may be read, and are emitted, with two numbers.
    virtual void allow_2d_vectors() {}
    // True in a block that has the keys of one further up, and may hold itself, when the visitor writes a manual, which
    // does not repeat them.
    virtual bool told_elsewhere() { return false; }
    virtual bool plane_vectors() const { return false; }

    // Calls the member `declare` of a struct, or else the free function.
    template <class T>
    static void declare_members(Declaration& d, T& value) {
        if constexpr (requires { value.declare(d); }) {
            value.declare(d);
        } else {
            declare(d, value);
        }
    }

protected:
    virtual void choose(
        const std::string& key, std::size_t& index, const std::vector<std::string>& names, const std::string& doc) = 0;
    virtual void choose_key(std::size_t& index, const std::vector<Alternative>& alternatives) = 0;
};

// Definition of the choice by choose(), which goes by the names' indices.
template <class E>
void Declaration::choice(
    const std::string& key, E& value, const std::vector<std::pair<std::string, E>>& choices, const std::string& doc) {
    std::vector<std::string> names;
    std::size_t index = 0;
    for (const auto& [name, meaning] : choices) {
        if (meaning == value) index = names.size();
        names.push_back(name);
    }
    choose(key, index, names, doc);
    value = choices[index].second;
}

// Definition of the list by list_of(), without the items' type.
template <class T>
void Declaration::list(const std::string& key, std::vector<T>& value, const std::string& doc) {
    Items items;
    items.size = [&value] { return value.size(); };
    items.clear = [&value] { value.clear(); };
    items.append = [&value] { value.emplace_back(); };
    items.declare = [&value](std::size_t i, Declaration& d) { declare_members(d, value[i]); };
    items.declare_default = [](Declaration& d) {
        T item;
        declare_members(d, item);
    };
    list_of(key, items, doc);
}

// Definition of the alternatives by choose_key(), which goes by their indices.
template <class E>
void Declaration::one_of(E& value, const std::vector<std::pair<E, Alternative>>& alternatives) {
    std::vector<Alternative> keys;
    std::size_t index = 0;
    for (const auto& [meaning, alternative] : alternatives) {
        if (meaning == value) index = keys.size();
        keys.push_back(alternative);
    }
    // Known before its keys are read, so that they may depend on it.
    for (std::size_t i = 0; i < keys.size(); ++i) {
        keys[i].members = [&value, &alternatives, i](Declaration& d) {
            if (d.parsing()) value = alternatives[i].first;
            alternatives[i].second.members(d);
        };
    }
    choose_key(index, keys);
    value = alternatives[index].first;
}

// All problems of the document against the declaration, those of its reading and overrides included, in one
// InputError.
void parse_document(const Document& document, const Declaration::Members& root);

// The manual: of everything (key ""), or of one key such as "liquids.viscosity". Throws InputError with the
// nearest key when there is no such one.
std::string describe(const Declaration::Members& root, const std::string& key);
std::string describe_json(const Declaration::Members& root);
std::string emit(const Declaration::Members& root);

// Reads into `root`, which keeps its value when this throws.
template <class T>
void parse(const Document& document, T& root) {
    T fresh = root;
    parse_document(document, [&](Declaration& d) { Declaration::declare_members(d, fresh); });
    root = std::move(fresh);
}

// Manual of a struct, whose values are shown as the defaults. Throws as describe().
template <class T>
std::string manual(T root, const std::string& key = "") {
    return describe([&](Declaration& d) { Declaration::declare_members(d, root); }, key);
}

// A JSON Schema (draft 2020-12) for editors.
template <class T>
std::string json_schema(T root) {
    return describe_json([&](Declaration& d) { Declaration::declare_members(d, root); });
}

// YAML with every value in SI, which parses to the identical struct.
template <class T>
std::string effective(T root) {
    return emit([&](Declaration& d) { Declaration::declare_members(d, root); });
}

} // namespace treacle
