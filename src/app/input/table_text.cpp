#include "app/input/table_text.hpp"

#include "identify/experiment/digits.hpp"

namespace treacle::app {

std::string label(const std::string& text) {
    std::string out = "  " + text + " ";
    if (out.size() < 24) out.resize(24, ' ');
    return out;
}

std::string short_number(double value) { return identify::digits(value); }

std::string grouped(std::uint64_t count) {
    std::string out = std::to_string(count);
    for (auto index = static_cast<int>(out.size()) - 3; index > 0; index -= 3) {
        out.insert(static_cast<std::size_t>(index), " ");
    }
    return out;
}

} // namespace treacle::app
