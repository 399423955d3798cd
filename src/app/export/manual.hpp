#pragma once
#include <string>

namespace treacle::app {

// Texts of commands that only print, the same on every rank.

// `treacle --version`: program, sources, compiler and libraries.
std::string version_text();

// `treacle schema`: of everything ("") or of one key. Throws InputError with the nearest key when there is
// none.
std::string schema_text(const std::string& key);
std::string schema_json();

} // namespace treacle::app
