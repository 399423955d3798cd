#include "base/text/text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>

namespace treacle {

namespace {
char fold(char c) { return c == '-' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }

std::string print(const char* format, double value) {
    std::array<char, 64> buffer;
    std::snprintf(buffer.data(), buffer.size(), format, value);
    return buffer.data();
}

std::string two_digits(long value) { return (value < 10 ? "0" : "") + std::to_string(value); }
} // namespace

int edit_distance(std::string_view a, std::string_view b) {
    std::vector<int> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) last[j] = static_cast<int>(j);
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = static_cast<int>(i);
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const char x = fold(a[i - 1]);
            const char y = fold(b[j - 1]);
            row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (x == y ? 0 : 1)});
            const bool swapped = i > 1 && j > 1 && x == fold(b[j - 2]) && y == fold(a[i - 2]);
            if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
        }
        std::swap(before, last);
        std::swap(last, row);
    }
    return last[b.size()];
}

std::optional<std::string> nearest(std::string_view word, const std::vector<std::string>& candidates) {
    constexpr std::size_t longest_word = 64; // beyond it nothing is a misspelling of a key
    if (word.size() > longest_word) return {};
    std::optional<std::string> best;
    int least = std::numeric_limits<int>::max();
    for (const auto& candidate : candidates) {
        const int distance = edit_distance(word, candidate);
        const auto longer = static_cast<int>(std::max(word.size(), candidate.size()));
        if (distance <= std::max(1, longer / 3) && distance < longer && distance < least) {
            least = distance;
            best = candidate;
        }
    }
    return best;
}

std::string join(const std::vector<std::string>& parts, std::string_view separator) {
    std::string out;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (i > 0) out += separator;
        out += parts[i];
    }
    return out;
}

std::string shorten(std::string text) {
    constexpr std::size_t longest = 60;
    if (text.size() > longest) {
        auto end = longest;
        const auto inside_letter = [&] { return (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80; };
        while (end > 0 && inside_letter()) --end;
        text = text.substr(0, end) + "...";
    }
    std::ranges::replace_if(
        text, [](unsigned char c) { return std::iscntrl(c) != 0; }, ' ');
    return text;
}

std::string format_number(double value) {
    std::array<char, 32> buffer;
    const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
    return {buffer.data(), end};
}

std::string format_fixed(double value, int decimals) {
    std::string text(std::size_t(std::snprintf(nullptr, 0, "%.*f", decimals, value)), '\0');
    std::snprintf(text.data(), text.size() + 1, "%.*f", decimals, value);
    return text;
}

std::pair<std::string, std::string> tell_apart(double a, double b) {
    constexpr int fewest = 4, most = 17; // digits, the most that a double has
    std::pair<std::string, std::string> out;
    for (int digits = fewest; digits <= most; ++digits) {
        const auto format = "%." + std::to_string(digits) + "g";
        out = {print(format.c_str(), a), print(format.c_str(), b)};
        if (out.first != out.second) break;
    }
    return a == b ? std::pair(format_number(a), format_number(b)) : out;
}

std::optional<double> read_number(std::string_view text) {
    if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || end != text.data() + text.size()) return {};
    // from_chars does not return the side; strtod gives infinity or the nearest small number.
    if (error == std::errc::result_out_of_range) return std::strtod(std::string(text).c_str(), nullptr);
    if (error != std::errc{}) return {};
    return value;
}

std::string format_duration(double seconds) {
    if (!std::isfinite(seconds) || seconds < 0) return "?";
    if (seconds < 0.9995) return print("%.0f ms", seconds * 1e3);
    if (seconds < 59.95) return print("%.1f s", seconds);
    const long whole = std::lround(std::min(seconds, 1e15));
    if (whole < 3600) return std::to_string(whole / 60) + " min " + two_digits(whole % 60) + " s";
    if (whole < 86400) return std::to_string(whole / 3600) + " h " + two_digits(whole / 60 % 60) + " min";
    return std::to_string(whole / 86400) + " d " + two_digits(whole / 3600 % 24) + " h";
}

std::string format_bytes(std::uint64_t bytes) {
    static constexpr std::array units{" kB", " MB", " GB", " TB", " PB", " EB"};
    if (bytes < 1000) return std::to_string(bytes) + " B";
    double value = static_cast<double>(bytes) / 1000;
    std::size_t i = 0;
    while (value >= 999.95 && i + 1 < units.size()) {
        value /= 1000;
        ++i;
    }
    return print("%.1f", value) + units[i];
}

std::string wrap(std::string_view text, std::size_t width, std::size_t indent) {
    std::string out;
    std::size_t column = 0;
    while (!text.empty()) {
        const auto end = std::min(text.find(' '), text.size());
        const auto word = text.substr(0, end);
        if (column > 0 && column + 1 + word.size() > width) {
            out += '\n' + std::string(indent, ' ');
            column = indent;
        } else if (column > 0) {
            out += ' ';
            ++column;
        }
        out += word;
        column += word.size();
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return out;
}

} // namespace treacle
