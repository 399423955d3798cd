#include "base/text/split.hpp"

#include <algorithm>

namespace treacle {

std::vector<std::string> split(std::string_view text, char separator) {
    std::vector<std::string> parts;
    for (std::size_t from = 0; from <= text.size();) {
        const auto end = std::min(text.find(separator, from), text.size());
        parts.emplace_back(text.substr(from, end - from));
        from = end + 1;
    }
    return parts;
}

std::vector<std::string> split_words(std::string_view text, std::string_view separators) {
    std::vector<std::string> words;
    for (auto from = text.find_first_not_of(separators); from != std::string_view::npos;) {
        const auto end = std::min(text.find_first_of(separators, from), text.size());
        words.emplace_back(text.substr(from, end - from));
        from = text.find_first_not_of(separators, end);
    }
    return words;
}

} // namespace treacle
