#pragma once
#include <cstdint>
#include <cstring>
#include <span>
#include <string>

// Inside of the folder only: what the writer and the reader of checkpoints agree on.
//   /            attributes "format", "format_version", "ranks"
//   /attributes  the attributes of this group are the single values
//   /replicated  /distributed  arrays by name, each with the attribute "checksum"
//   /rows        for each distributed array the rows of each rank that wrote it
namespace treacle::io::checkpoint {

inline const std::string format = "treacle checkpoint";
inline constexpr std::int64_t format_version = 4;

// Sum over all words of a mixture of value and place: parts of an array can be summed on different ranks and
// added, and still a change, an exchange or a loss of values shows. The mixture is the finaliser of
// splitmix64 (Steele, Lea, Flood 2014).
template <class T>
std::uint64_t checksum(std::span<const T> values, std::int64_t first) {
    static_assert(sizeof(T) == sizeof(std::uint64_t));
    std::uint64_t sum = 0;
    auto index = static_cast<std::uint64_t>(first);
    for (const T& value : values) {
        std::uint64_t word;
        std::memcpy(&word, &value, sizeof word);
        word ^= ++index * 0x9e3779b97f4a7c15ULL;
        word = (word ^ (word >> 30)) * 0xbf58476d1ce4e5b9ULL;
        word = (word ^ (word >> 27)) * 0x94d049bb133111ebULL;
        sum += word ^ (word >> 31);
    }
    return sum;
}

} // namespace treacle::io::checkpoint
