#include "base/options/options_tree.hpp"

#include <nlohmann/json.hpp>

namespace treacle {

namespace {

using Json = nlohmann::ordered_json;
using Kind = OptionEntry::Kind;
using Presence = OptionEntry::Presence;

void add_range(Json& schema, const Range& range) {
    if (range.lower == Range::Lower::included) schema["minimum"] = range.min;
    if (range.lower == Range::Lower::excluded) schema["exclusiveMinimum"] = range.min;
    if (range.max < std::numeric_limits<double>::infinity()) schema["maximum"] = range.max;
}

// A number in SI, or a text that starts with a number; which units fit is beyond a JSON Schema.
Json quantity(const Range& range) {
    Json plain = {{"type", "number"}};
    add_range(plain, range);
    const Json with_unit = {{"type", "string"}, {"pattern", "^\\s*[-+]?(\\d+\\.?\\d*|\\.\\d+)([eE][-+]?\\d+)?"}};
    return {{"anyOf", Json::array({plain, with_unit})}};
}

Json schema_of(const OptionEntry& entry);

Json object_of(const OptionEntry& block) {
    if (block.told_elsewhere) return {{"type", "object"}};
    Json properties = Json::object();
    Json required = Json::array();
    Json alternatives = Json::array();
    for (const auto& member : block.members) {
        properties[member.key] = schema_of(member);
        if (member.presence == Presence::required) required.push_back(member.key);
        if (member.presence == Presence::one_of) alternatives.push_back({{"required", {member.key}}});
    }
    Json out = {{"type", "object"}, {"additionalProperties", false}, {"properties", properties}};
    if (!required.empty()) out["required"] = required;
    if (!alternatives.empty()) out["oneOf"] = alternatives;
    return out;
}

Json block_of(const OptionEntry& entry) {
    auto object = object_of(entry);
    for (const auto& member : entry.members) {
        if (member.key != entry.shorthand) continue;
        return {{"anyOf", Json::array({schema_of(member), object})}};
    }
    return object;
}

Json texts_of(const OptionEntry& entry) {
    Json item = {{"type", "string"}};
    if (!entry.words.empty()) item["enum"] = entry.words;
    return {{"type", "array"}, {"items", item}};
}

Json type_of(const OptionEntry& entry) {
    switch (entry.kind) {
    case Kind::number: return quantity(entry.range);
    case Kind::integer: {
        Json out = {{"type", "integer"}};
        add_range(out, entry.range);
        return out;
    }
    case Kind::boolean: return {{"type", "boolean"}};
    // YAML reads an unquoted 5 as a number; it is a text here.
    case Kind::text: return {{"type", Json::array({"string", "number", "boolean"})}};
    case Kind::texts: return texts_of(entry);
    case Kind::numbers: return {{"type", "array"}, {"items", quantity(entry.range)}};
    case Kind::vec3: {
        Json list = {{"type", "array"}, {"items", quantity(range_any())}, {"minItems", 2}, {"maxItems", 3}};
        if (entry.vector != VectorKind::turning) return list;
        return {{"anyOf", Json::array({quantity(range_any()), list})}};
    }
    case Kind::choice: return {{"enum", entry.words}};
    case Kind::block: return block_of(entry);
    case Kind::list: return {{"type", "array"}, {"items", object_of(entry)}};
    }
    return {};
}

Json schema_of(const OptionEntry& entry) {
    Json out = type_of(entry);
    std::string text = entry.doc;
    if (!entry.unit.si.empty()) text += " [" + std::string(entry.unit.si) + "]";
    if (!text.empty()) out["description"] = text;
    const bool shown = !entry.default_text.empty() && entry.presence == Presence::optional;
    if (shown && entry.kind != Kind::texts) {
        // A default with its unit is a text, as one would write it.
        const auto value = Json::parse(entry.default_text, nullptr, false);
        out["default"] = value.is_discarded() ? Json(entry.default_text) : value;
    }
    return out;
}

} // namespace

std::string describe_json(const Declaration::Members& root) {
    Json out = {{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", "Treacle scene"}};
    out.update(object_of(describe_tree(root)));
    return out.dump(2) + "\n";
}

} // namespace treacle
