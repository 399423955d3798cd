#include "scene/names.hpp"

#include <algorithm>
#include <cctype>

namespace treacle::scene {

namespace {
bool is_word(const std::string& name) {
    const auto fits = [](unsigned char c) { return c < 0x80 && (std::isalnum(c) || c == '_' || c == '-'); };
    return std::ranges::all_of(name, fits) && std::isalpha(static_cast<unsigned char>(name[0]));
}

bool is_taken(const std::vector<std::string*>& names, const std::string& name) {
    return std::ranges::any_of(names, [&](const std::string* other) { return *other == name; });
}
} // namespace

void declare_name(Declaration& d, std::string& name, const std::string& doc) {
    d.text("name", name, doc);
    d.check(name.empty() || is_word(name), "name",
        {"must start with a letter and have only letters, digits, _ and -",
            "it becomes part of keys, columns and file names", ""});
}

void settle_name_list(Declaration& d, const std::string& key, const std::vector<std::string*>& names,
    const std::vector<std::string>& standards) {
    if (!d.parsing()) return;
    for (std::size_t i = 0; i < names.size(); ++i) {
        const auto same = [&](const std::string* other) { return *other == *names[i]; };
        const bool again = std::any_of(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(i), same);
        if (names[i]->empty()) {
            std::string name = standards[i];
            for (int number = 2; is_taken(names, name); ++number) name = standards[i] + "_" + std::to_string(number);
            *names[i] = name;
        } else {
            d.check(!again, key,
                {"the name " + *names[i] + " stands twice", "messages and overrides go by it", "rename one of them"});
        }
    }
}

} // namespace treacle::scene
