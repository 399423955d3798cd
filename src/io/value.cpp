#include "io/value.hpp"

#include "base/text/file.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <stdexcept>

namespace treacle::io {

namespace {
using Json = nlohmann::ordered_json;

Json convert(const Value& value);

struct Converter {
    Json operator()(std::monostate) const { return nullptr; }
    Json operator()(bool flag) const { return flag; }
    Json operator()(std::int64_t number) const { return number; }
    Json operator()(double number) const {
        if (std::isnan(number)) return "nan";
        if (std::isinf(number)) return number > 0 ? "inf" : "-inf";
        return number;
    }
    Json operator()(const std::string& text) const { return text; }
    Json operator()(const Value::List& items) const {
        Json out = Json::array();
        for (const auto& item : items) out.push_back(convert(item));
        return out;
    }
    Json operator()(const Value::Object& entries) const {
        Json out = Json::object();
        for (const auto& [key, value] : entries) out[key] = convert(value);
        return out;
    }
};

Json convert(const Value& value) { return std::visit(Converter{}, value.data()); }
} // namespace

Value Value::list(List items) {
    Value value;
    value.data_ = std::move(items);
    return value;
}

Value Value::object(Object entries) {
    Value value;
    value.data_ = std::move(entries);
    return value;
}

Value& Value::set(const std::string& key, Value value) {
    if (std::holds_alternative<std::monostate>(data_)) data_ = Object{};
    if (!std::holds_alternative<Object>(data_)) throw std::logic_error("a key in a value that is no object");
    auto& entries = std::get<Object>(data_);
    for (auto& [name, old] : entries)
        if (name == key) {
            old = std::move(value);
            return *this;
        }
    entries.emplace_back(key, std::move(value));
    return *this;
}

Value& Value::add(Value value) {
    if (std::holds_alternative<std::monostate>(data_)) data_ = List{};
    if (!std::holds_alternative<List>(data_)) throw std::logic_error("an item in a value that is no list");
    std::get<List>(data_).push_back(std::move(value));
    return *this;
}

std::string Value::json() const { return convert(*this).dump(2, ' ', false, Json::error_handler_t::replace); }

void write_json(const std::filesystem::path& path, const Value& value) {
    write_file_atomically(path, value.json() + "\n");
}

} // namespace treacle::io
