#pragma once
#include "base/options/options.hpp"

#include <string>
#include <vector>

namespace treacle::scene {

// A key `name` whose words can be part of a path (`liquids.water.density`), a column and a file name.
void declare_name(Declaration& d, std::string& name, const std::string& doc);

// After a list was read: gives the nameless items their standard name, numbered when it is taken, and rejects
// names that stand twice.
void settle_name_list(Declaration& d, const std::string& key, const std::vector<std::string*>& names,
    const std::vector<std::string>& standards);

// As settle_name_list(); the function gives the name that an item takes when it has none.
template <class T, class F>
void settle_names(Declaration& d, const std::string& key, std::vector<T>& items, F standard) {
    std::vector<std::string*> names;
    std::vector<std::string> standards;
    for (auto& item : items) {
        names.push_back(&item.name);
        standards.push_back(standard(item));
    }
    settle_name_list(d, key, names, standards);
}

} // namespace treacle::scene
