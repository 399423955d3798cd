#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace treacle {

// Insertions, deletions, substitutions and swaps of neighbours that turn one word into the other;
// upper and lower case, '-' and '_' count as equal.
int edit_distance(std::string_view a, std::string_view b);

// The candidate closest to `word`, or nothing when even that one is not a plausible misspelling.
std::optional<std::string> nearest(std::string_view word, const std::vector<std::string>& candidates);

// "a, b, c" for the separator ", "; empty for no parts.
std::string join(const std::vector<std::string>& parts, std::string_view separator);

// One line of at most about 60 characters, for messages.
std::string shorten(std::string text);

// The shortest decimal that reads back as the same double.
std::string format_number(double value);

// With `decimals` digits after the point.
std::string format_fixed(double value, int decimals);

// Both with as many digits as distinguish them, four at least; of equal numbers the texts are equal.
std::pair<std::string, std::string> tell_apart(double a, double b);

// The whole text as one number, in any locale; nothing when it is not one. Infinite when too large.
std::optional<double> read_number(std::string_view text);

// "850 ms", "12.3 s", "4 min 05 s", "3 h 02 min", "2 d 04 h".
std::string format_duration(double seconds);

// "512 B", "3.4 kB", "1.2 GB", in powers of 1000.
std::string format_bytes(std::uint64_t bytes);

// Lines of at most `width` columns, each after the first starting with `indent` blanks.
std::string wrap(std::string_view text, std::size_t width, std::size_t indent);

} // namespace treacle
