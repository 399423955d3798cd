#pragma once
#include <array>
#include <cstdio>
#include <string>

namespace treacle::test {

// The first 1000 characters of an open file.
inline std::string content(std::FILE* file) {
    std::rewind(file);
    std::array<char, 1000> buffer;
    return {buffer.data(), std::fread(buffer.data(), 1, buffer.size(), file)};
}

} // namespace treacle::test
