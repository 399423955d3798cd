#include "base/options/options_tree.hpp"

#include "base/text/text.hpp"

#include <algorithm>

namespace treacle {

namespace {

std::string format_vector(const Vec3& value) {
    return "[" + format_number(value[0]) + ", " + format_number(value[1]) + ", " + format_number(value[2]) + "]";
}

class Describer : public Declaration {
public:
    using Kind = OptionEntry::Kind;

    explicit Describer(OptionEntry& block) : block_(block) {}

    void number(
        const std::string& key, double& value, const Unit& unit, const Range& range, const std::string& doc) override {
        auto& entry = add(key, Kind::number, doc);
        entry.default_text = with_unit(format_number(value), unit);
        entry.unit = unit;
        entry.range = range;
    }

    void integer(const std::string& key, int& value, const Range& range, const std::string& doc) override {
        auto& entry = add(key, Kind::integer, doc);
        entry.default_text = std::to_string(value);
        entry.range = range;
    }

    void boolean(const std::string& key, bool& value, const std::string& doc) override {
        add(key, Kind::boolean, doc).default_text = value ? "true" : "false";
    }

    void text(const std::string& key, std::string& value, const std::string& doc) override {
        add(key, Kind::text, doc).default_text = "\"" + value + "\"";
    }

    void texts(const std::string& key, std::vector<std::string>& value, const std::string& doc,
        const std::vector<std::string>& allowed) override {
        auto& entry = add(key, Kind::texts, doc);
        entry.default_text = "[" + join(value, ", ") + "]";
        entry.words = allowed;
    }

    void numbers(const std::string& key, std::vector<double>& value, const Unit& unit, const Range& range,
        const std::string& doc) override {
        auto& entry = add(key, Kind::numbers, doc);
        std::vector<std::string> parts;
        parts.reserve(value.size());
        for (const double x : value) parts.push_back(with_unit(format_number(x), unit));
        entry.default_text = "[" + join(parts, ", ") + "]";
        entry.unit = unit;
        entry.range = range;
    }

    void vec3(const std::string& key, Vec3& value, const Unit& unit, const std::string& doc, VectorKind kind) override {
        auto& entry = add(key, Kind::vec3, doc);
        entry.vector = kind;
        entry.default_text = format_vector(value);
        entry.unit = unit;
    }

    void block_of(
        const std::string& key, const Members& members, const std::string& doc, const std::string& shorthand) override {
        auto& entry = add(key, Kind::block, doc);
        entry.shorthand = shorthand;
        describe_members(entry, members);
    }

    bool optional_block(const std::string& key, bool present, const Members& members, const std::string& doc) override {
        describe_members(add(key, Kind::block, doc), members);
        return present;
    }

    void list_of(const std::string& key, const Items& items, const std::string& doc) override {
        describe_members(add(key, Kind::list, doc), items.declare_default);
    }

    void required(const std::string& key) override {
        std::ranges::find(block_.members, key, &OptionEntry::key)->presence = OptionEntry::Presence::required;
    }

    bool told_elsewhere() override { return block_.told_elsewhere = true; }

protected:
    void choose(const std::string& key, std::size_t& index, const std::vector<std::string>& names,
        const std::string& doc) override {
        auto& entry = add(key, Kind::choice, doc);
        entry.default_text = names[index];
        entry.words = names;
    }

    void choose_key(std::size_t&, const std::vector<Alternative>& alternatives) override {
        for (const auto& alternative : alternatives) {
            auto& entry = add(alternative.key, Kind::block, alternative.doc);
            entry.presence = OptionEntry::Presence::one_of;
            describe_members(entry, alternative.members);
        }
    }

private:
    OptionEntry& add(const std::string& key, Kind kind, const std::string& doc) {
        OptionEntry entry;
        entry.key = key;
        entry.kind = kind;
        entry.doc = doc;
        block_.members.push_back(std::move(entry));
        return block_.members.back();
    }

    static void describe_members(OptionEntry& entry, const Members& members) {
        Describer describer(entry);
        members(describer);
    }

    OptionEntry& block_;
};

} // namespace

OptionEntry describe_tree(const Declaration::Members& root) {
    OptionEntry entry;
    Describer describer(entry);
    root(describer);
    return entry;
}

} // namespace treacle
