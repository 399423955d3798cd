#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace treacle {

// The parts of a text between separators, empty ones among them: "a::b" has three.
std::vector<std::string> split(std::string_view text, char separator);

// The words of a text between any of the separators, several in a row counting as one.
std::vector<std::string> split_words(std::string_view text, std::string_view separators = " \t\r\n\v\f");

} // namespace treacle
