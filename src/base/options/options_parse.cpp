#include "base/options/document_tree.hpp"
#include "base/options/options.hpp"
#include "base/options/parse_some.hpp"
#include "base/text/text.hpp"

#include <algorithm>
#include <charconv>
#include <map>
#include <set>

namespace treacle {

namespace {

// State of the whole parsing, shared by the parsers of all its blocks.
struct Session {
    std::vector<Diagnostic> problems;
    std::size_t unreadable = 0; // problems after which a value is not what the user meant
    bool plane_vectors = false;
};

// Reads the keys of one block.
class BlockParser : public Declaration {
public:
    // `manual_path` is `path` without the numbers and names of list items.
    BlockParser(Session& session, const Node& node, std::string path, std::string manual_path)
        : session_(session), node_(node), path_(std::move(path)), manual_path_(std::move(manual_path)),
          unreadable_before_(session.unreadable) {}

    void number(
        const std::string& key, double& value, const Unit& unit, const Range& range, const std::string& doc) override {
        const Node* node = find(key, doc);
        if (!node || !expect(*node, key, Node::Kind::scalar, "must be a number")) return;
        read_number(*node, key, value, unit, range);
    }

    void integer(const std::string& key, int& value, const Range& range, const std::string& doc) override {
        const Node* node = find(key, doc);
        if (!node || !expect(*node, key, Node::Kind::scalar, "must be a whole number")) return;
        const auto& text = node->text;
        int read = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), read);
        if (end != text.data() + text.size() || error == std::errc::invalid_argument) {
            complain(*node, key, {"must be a whole number", "", ""});
        } else if (error != std::errc{}) {
            complain(*node, key, {"is too large", "it is a whole number of 32 bits", ""});
        } else if (!range.contains(read)) {
            complain(*node, key, {"must be " + range.text(), range.reason, range.cure});
        } else {
            value = read;
        }
    }

    void boolean(const std::string& key, bool& value, const std::string& doc) override {
        const Node* node = find(key, doc);
        if (!node || !expect(*node, key, Node::Kind::scalar, "must be true or false")) return;
        if (node->text == "true" || node->text == "false") {
            value = node->text == "true";
        } else {
            complain(*node, key, {"must be true or false", "", ""});
        }
    }

    void text(const std::string& key, std::string& value, const std::string& doc) override {
        const Node* node = find(key, doc);
        if (node && expect(*node, key, Node::Kind::scalar, "must be a text")) value = node->text;
    }

    void texts(const std::string& key, std::vector<std::string>& value, const std::string& doc,
        const std::vector<std::string>& allowed) override {
        const Node* node = find(key, doc);
        if (!node || !expect(*node, key, Node::Kind::list, "must be a list of words")) return;
        std::vector<std::string> read;
        for (std::size_t i = 0; i < node->items.size(); ++i) {
            const auto& item = node->items[i];
            const auto path = key + "." + std::to_string(i);
            if (!expect(item, path, Node::Kind::scalar, "must be a word")) continue;
            if (!allowed.empty() && std::ranges::find(allowed, item.text) == allowed.end()) {
                complain(item, path, unknown_word(item.text, allowed));
            }
            read.push_back(item.text);
        }
        value = std::move(read);
    }

    void numbers(const std::string& key, std::vector<double>& value, const Unit& unit, const Range& range,
        const std::string& doc) override {
        const Node* node = find(key, doc);
        if (!node || !expect(*node, key, Node::Kind::list, "must be a list of numbers")) return;
        std::vector<double> read(node->items.size());
        for (std::size_t i = 0; i < read.size(); ++i) {
            const auto path = key + "." + std::to_string(i);
            if (!expect(node->items[i], path, Node::Kind::scalar, "must be a number")) return;
            if (!read_number(node->items[i], path, read[i], unit, range)) return;
        }
        value = std::move(read);
    }

    void vec3(const std::string& key, Vec3& value, const Unit& unit, const std::string& doc, VectorKind kind) override {
        const Node* node = find(key, doc);
        const bool turns = session_.plane_vectors && kind == VectorKind::turning;
        if (turns && node && node->kind == Node::Kind::scalar) {
            double about_z = 0;
            if (read_number(*node, key, about_z, unit, range_any())) value = {0, 0, about_z};
            return;
        }
        const std::string must =
            turns ? "must be a number, or a list of 3 numbers of which the first two are 0"
                  : std::string("must be a list of ") + (session_.plane_vectors ? "2 numbers" : "3 numbers");
        if (!node || !expect(*node, key, Node::Kind::list, must)) return;
        const auto count = node->items.size();
        if (count != 3 && !(count == 2 && session_.plane_vectors && !turns)) {
            complain(*node, key, {must, "it has " + std::to_string(count), ""});
            return;
        }
        Vec3 read{0, 0, 0};
        for (std::size_t i = 0; i < count; ++i) {
            const auto path = key + "." + std::to_string(i);
            if (!expect(node->items[i], path, Node::Kind::scalar, "must be a number")) return;
            if (!read_number(node->items[i], path, read[i], unit, range_any())) return;
        }
        if (session_.plane_vectors && kind == VectorKind::in_plane && read[2] != 0) {
            complain(*node, key, {"must have no third number", "the scene is plane", "leave it out or write 0"});
            return;
        }
        if (turns && (read[0] != 0 || read[1] != 0)) {
            complain(*node, key,
                {"must be about z alone", "the scene is plane, and would be left by what turns about x or y",
                    "write a number, which is about z, or dimensions: 3"});
            return;
        }
        value = read;
    }

    void block_of(
        const std::string& key, const Members& members, const std::string& doc, const std::string& shorthand) override {
        const Node* node = find(key, doc);
        // Absent is as good as empty: the required keys inside are then found missing.
        Node empty;
        empty.kind = Node::Kind::block;
        empty.location = node_.location;
        if (node && !shorthand.empty() && node->kind == Node::Kind::scalar) {
            empty.location = node->location;
            empty.members.push_back({shorthand, node->location, *node});
            node = &empty;
        }
        if (node && !expect(*node, key, Node::Kind::block, "must be a block of keys")) return;
        const auto before = session_.problems.size();
        parse_block(node ? *node : empty, key, key, members);
        if (!node && session_.problems.size() > before) lacking_.insert(key);
    }

    bool optional_block(const std::string& key, bool, const Members& members, const std::string& doc) override {
        const Node* node = find(key, doc);
        if (!node || !expect(*node, key, Node::Kind::block, "must be a block of keys")) return false;
        parse_block(*node, key, key, members);
        return true;
    }

    void list_of(const std::string& key, const Items& items, const std::string& doc) override {
        const Node* node = find(key, doc);
        if (!node || !expect(*node, key, Node::Kind::list, "must be a list, each item starting with \"- \"")) return;
        items.clear();
        for (std::size_t i = 0; i < node->items.size(); ++i) {
            const auto& item = node->items[i];
            const auto path = key + "." + item_name(item, i);
            if (!expect(item, path, Node::Kind::block, "must be a block of keys")) continue;
            items.append();
            parse_block(item, path, key, [&](Declaration& d) { items.declare(items.size() - 1, d); });
        }
    }

    void required(const std::string& key) override {
        if (node_.find(key) || lacking_.contains(key)) return;
        const auto doc = docs_.find(key);
        report({node_.location, full(key) + " is missing", doc == docs_.end() ? "" : plain(doc->second),
            "see `treacle schema " + below(manual_path_, key) + "`"});
    }

    void check(bool ok, const std::string& key, const Complaint& complaint) override {
        if (ok || session_.unreadable > unreadable_before_) return;
        const Node* node = node_.find(key);
        Node absent;
        absent.location = node_.location;
        const bool shown = node && node->kind != Node::Kind::block &&
                           std::ranges::all_of(node->items, [](auto& item) { return item.kind == Node::Kind::scalar; });
        add(node ? *node : absent, key, complaint, shown ? node->brief() : "");
    }

    bool parsing() const override { return true; }
    bool given(const std::string& key) const override { return node_.find(key) != nullptr; }
    std::string location() const override { return node_.location; }
    std::string location_of(const std::string& key) const override {
        const Node* node = node_.find(key);
        return node ? node->location : node_.location;
    }
    void allow_2d_vectors() override { session_.plane_vectors = true; }
    bool plane_vectors() const override { return session_.plane_vectors; }

    // After the declaration: keys of the block that are not declared.
    void reject_unknown_keys() {
        std::vector<std::string> known;
        for (const auto& [key, doc] : docs_) known.push_back(key);
        for (const auto& member : node_.members) {
            if (docs_.contains(member.key)) continue;
            const auto close = nearest(member.key, known);
            session_.problems.push_back({member.location, full(shorten(member.key)) + " is not a known key", "",
                close ? "did you mean " + *close + "?" : "known here: " + join(known, ", ")});
        }
    }

protected:
    void choose(const std::string& key, std::size_t& index, const std::vector<std::string>& names,
        const std::string& doc) override {
        const Node* node = find(key, doc);
        if (!node || !expect(*node, key, Node::Kind::scalar, "must be one of " + join(names, ", "))) return;
        const auto found = std::ranges::find(names, node->text);
        if (found == names.end()) {
            complain(*node, key, unknown_word(node->text, names));
        } else {
            index = static_cast<std::size_t>(found - names.begin());
        }
    }

    void choose_key(std::size_t& index, const std::vector<Alternative>& alternatives) override {
        std::vector<std::string> keys, given_keys;
        for (const auto& alternative : alternatives) {
            keys.push_back(alternative.key);
            if (given(alternative.key)) given_keys.push_back(alternative.key);
            docs_[alternative.key] = alternative.doc;
        }
        if (given_keys.size() != 1) {
            const auto what = given_keys.empty() ? "has no " + join(keys, ", ") : "has " + join(given_keys, " and ");
            report({node_.location, path_ + " " + what, "exactly one of these keys is given", ""});
            return;
        }
        index = static_cast<std::size_t>(std::ranges::find(keys, given_keys[0]) - keys.begin());
        block_of(keys[index], alternatives[index].members, alternatives[index].doc, "");
    }

private:
    static std::string item_name(const Node& item, std::size_t index) {
        const Node* name = item.find("name");
        const bool usable = name && name->kind == Node::Kind::scalar && !name->text.empty();
        return usable ? name->brief() : std::to_string(index);
    }

    static std::string plain(std::string doc) {
        if (doc.ends_with('.')) doc.pop_back();
        return doc;
    }

    static std::string below(const std::string& path, const std::string& key) {
        return path.empty() ? key : path + "." + key;
    }
    std::string full(const std::string& key) const { return below(path_, key); }

    const Node* find(const std::string& key, const std::string& doc) {
        docs_[key] = doc;
        return node_.find(key);
    }

    void parse_block(const Node& node, const std::string& key, const std::string& manual_key, const Members& members) {
        BlockParser parser(session_, node, full(key), below(manual_path_, manual_key));
        members(parser);
        parser.reject_unknown_keys();
    }

    bool expect(const Node& node, const std::string& key, Node::Kind kind, const std::string& must) {
        if (node.kind == kind) return true;
        if (node.kind == Node::Kind::null) {
            report({node.location, full(key) + " has no value", "it " + must, "give it one or remove the key"});
        } else {
            complain(node, key, {must, "", ""});
        }
        return false;
    }

    bool read_number(const Node& node, const std::string& key, double& value, const Unit& unit, const Range& range) {
        const auto result = read_quantity(node.text, unit);
        const auto text = with_unit(node.brief(), unit);
        if (const auto* complaint = std::get_if<Complaint>(&result)) {
            ++session_.unreadable;
            add(node, key, *complaint, text);
            return false;
        }
        const double read = std::get<double>(result);
        if (!range.contains(read)) {
            ++session_.unreadable;
            add(node, key, {"must be " + range.text(), range.reason, range.cure}, text);
            return false;
        }
        value = read;
        return true;
    }

    static Complaint unknown_word(const std::string& word, const std::vector<std::string>& allowed) {
        const auto close = nearest(word, allowed);
        return {"must be one of " + join(allowed, ", "), "", close ? "did you mean " + *close + "?" : ""};
    }

    void complain(const Node& node, const std::string& key, const Complaint& complaint) {
        ++session_.unreadable;
        add(node, key, complaint, node.brief());
    }

    void add(const Node& node, const std::string& key, const Complaint& complaint, const std::string& value) {
        const std::string what = value.empty() ? full(key) + ": " : full(key) + " = " + value + ": ";
        session_.problems.push_back({node.location, what + complaint.must, complaint.reason, complaint.cure});
    }

    void report(Diagnostic diagnostic) {
        ++session_.unreadable;
        session_.problems.push_back(std::move(diagnostic));
    }

    Session& session_;
    const Node& node_;
    std::string path_;
    std::string manual_path_;
    std::size_t unreadable_before_;
    std::map<std::string, std::string> docs_; // of the keys declared so far
    std::set<std::string> lacking_;           // absent blocks whose missing keys have been reported
};

enum class OtherKeys { refused, left_alone };

void parse_root(const Document& document, const Declaration::Members& root, OtherKeys others) {
    const auto& tree = document.tree();
    Session session;
    session.problems = tree.problems;
    if (tree.root.kind == Node::Kind::block) {
        BlockParser parser(session, tree.root, "", "");
        root(parser);
        if (others == OtherKeys::refused) parser.reject_unknown_keys();
    } else {
        const bool empty = tree.root.kind == Node::Kind::null;
        session.problems.push_back({tree.root.location, empty ? "the file is empty" : "is not a block of keys",
            "a scene is lines of the form `key: value`", "start from a file in inputs/"});
    }
    if (!session.problems.empty()) throw InputError(std::move(session.problems));
}

} // namespace

void parse_document(const Document& document, const Declaration::Members& root) {
    parse_root(document, root, OtherKeys::refused);
}
void parse_some(const Document& document, const Declaration::Members& root) {
    parse_root(document, root, OtherKeys::left_alone);
}

} // namespace treacle
