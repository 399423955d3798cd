#include "base/options/options.hpp"
#include "base/text/text.hpp"

#include <array>
#include <cstdio>

namespace treacle {

namespace {

std::string in_quotes(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') {
            out += std::string("\\") + c;
        } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
            std::array<char, 8> escape;
            std::snprintf(escape.data(), escape.size(), "\\x%02X", static_cast<unsigned>(c));
            out += escape.data();
        } else {
            out += c;
        }
    }
    return out + "\"";
}

// Shared by the emitters of all blocks.
struct Sheet {
    std::string text;
    bool plane_vectors = false;
};

class Emitter : public Declaration {
public:
    Emitter(Sheet& sheet, std::size_t indent) : sheet_(sheet), out_(sheet.text), indent_(indent) {}

    // The first key of a list item stands behind the dash.
    void start_item() { dash_ = true; }
    bool wrote_nothing() const { return first_; }

    void number(const std::string& key, double& value, const Unit& unit, const Range&, const std::string&) override {
        line(key, with_unit(format_number(value), unit));
    }
    void integer(const std::string& key, int& value, const Range&, const std::string&) override {
        line(key, std::to_string(value));
    }
    void boolean(const std::string& key, bool& value, const std::string&) override {
        line(key, value ? "true" : "false");
    }
    void text(const std::string& key, std::string& value, const std::string&) override { line(key, in_quotes(value)); }
    void texts(const std::string& key, std::vector<std::string>& value, const std::string&,
        const std::vector<std::string>&) override {
        std::vector<std::string> words;
        words.reserve(value.size());
        for (const auto& word : value) words.push_back(in_quotes(word));
        line(key, "[" + join(words, ", ") + "]");
    }
    void numbers(const std::string& key, std::vector<double>& value, const Unit& unit, const Range&,
        const std::string&) override {
        std::vector<std::string> parts;
        parts.reserve(value.size());
        for (const double x : value) parts.push_back(with_unit(format_number(x), unit));
        line(key, "[" + join(parts, ", ") + "]");
    }
    void vec3(const std::string& key, Vec3& value, const Unit& unit, const std::string&, VectorKind kind) override {
        std::vector<std::string> parts;
        parts.reserve(value.size());
        for (const double x : value) parts.push_back(with_unit(format_number(x), unit));
        if (plane_vectors() && kind == VectorKind::in_plane) parts.pop_back();
        line(key, "[" + join(parts, ", ") + "]");
    }

    void block_of(const std::string& key, const Members& members, const std::string&, const std::string&) override {
        const auto before = out_.size();
        const bool first_before = first_;
        line(key, "");
        Emitter inside(sheet_, indent_ + 2);
        members(inside);
        if (!inside.wrote_nothing()) return;
        out_.resize(before);
        first_ = first_before;
        line(key, "{}");
    }
    bool optional_block(const std::string& key, bool present, const Members& members, const std::string& doc) override {
        if (present) block_of(key, members, doc, "");
        return present;
    }
    void list_of(const std::string& key, const Items& items, const std::string&) override {
        if (items.size() == 0) {
            line(key, "[]");
            return;
        }
        line(key, "");
        for (std::size_t i = 0; i < items.size(); ++i) {
            Emitter item(sheet_, indent_ + 4);
            item.start_item();
            items.declare(i, item);
        }
    }
    void required(const std::string&) override {}
    void allow_2d_vectors() override { sheet_.plane_vectors = true; }
    bool plane_vectors() const override { return sheet_.plane_vectors; }

protected:
    void choose(const std::string& key, std::size_t& index, const std::vector<std::string>& names,
        const std::string&) override {
        line(key, names[index]);
    }
    void choose_key(std::size_t& index, const std::vector<Alternative>& alternatives) override {
        block_of(alternatives[index].key, alternatives[index].members, "", "");
    }

private:
    void line(const std::string& key, const std::string& value) {
        if (dash_ && first_) {
            out_ += std::string(indent_ - 2, ' ') + "- ";
        } else {
            out_ += std::string(indent_, ' ');
        }
        first_ = false;
        out_ += key + ":" + (value.empty() ? "" : " " + value) + "\n";
    }

    Sheet& sheet_;
    std::string& out_;
    std::size_t indent_;
    bool dash_ = false;
    bool first_ = true;
};

} // namespace

std::string emit(const Declaration::Members& root) {
    Sheet sheet;
    Emitter emitter(sheet, 0);
    root(emitter);
    return sheet.text;
}

} // namespace treacle
