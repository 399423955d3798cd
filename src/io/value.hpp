#pragma once
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace treacle::io {

// A value of a JSON file: number, text, flag, list, or an object whose entries keep their order.
//     Value summary = Value::object({{"steps", 1200}, {"maximum speed [m/s]", 3.1}});
class Value {
public:
    using List = std::vector<Value>;
    using Object = std::vector<std::pair<std::string, Value>>;

    Value() = default; // null
    // A flag, a number or a text; integers become 64 bits wide.
    Value(bool flag) : data_(flag) {}
    Value(int number) : data_(static_cast<std::int64_t>(number)) {}
    Value(std::int64_t number) : data_(number) {}
    Value(double number) : data_(number) {}
    Value(const char* text) : data_(std::string(text)) {}
    Value(std::string text) : data_(std::move(text)) {}

    // A list or an object as given: a key that stands twice stays twice.
    static Value list(List items);
    static Value object(Object entries);

    // Adds an entry to an object; a null value becomes an object first. Throws std::logic_error otherwise.
    Value& set(const std::string& key, Value value);
    // Adds an item to a list, likewise.
    Value& add(Value value);

    // JSON text, indented by two. Numbers that are not finite become the texts "nan", "inf", "-inf", since
    // JSON has none.
    std::string json() const;

    const auto& data() const { return data_; } // std::variant; std::monostate: null

private:
    std::variant<std::monostate, bool, std::int64_t, double, std::string, List, Object> data_;
};

// Replaces the file as a whole. Throws SimulationError.
void write_json(const std::filesystem::path& path, const Value& value);

} // namespace treacle::io
