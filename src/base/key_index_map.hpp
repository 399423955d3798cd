#pragma once
#include <cstdint>
#include <vector>

namespace treacle {

// Numbers 0, 1, 2 … of the keys that come, in the order in which they come: a hash table with open addressing.
class KeyIndexMap {
public:
    // Removes all keys; room for so many is there from the start.
    void clear(std::size_t expected) {
        std::size_t size = 16;
        while (size < 2 * expected) size *= 2;
        slots_.assign(size, -1);
        keys_.clear();
    }
    // The number of a key, a new one where it has none yet.
    int number(std::int64_t key) {
        const std::size_t slot = slot_of(key);
        if (slots_[slot] >= 0) return slots_[slot];
        const int number = static_cast<int>(keys_.size());
        slots_[slot] = number;
        keys_.push_back(key);
        if (2 * keys_.size() > slots_.size()) grow();
        return number;
    }
    // Or -1.
    int find(std::int64_t key) const { return slots_[slot_of(key)]; }

    const std::vector<std::int64_t>& keys() const { return keys_; } // by their numbers
    int size() const { return static_cast<int>(keys_.size()); }     // keys so far
    // Memory of both arrays, with what is reserved [B].
    std::size_t bytes() const { return sizeof(int) * slots_.capacity() + sizeof(std::int64_t) * keys_.capacity(); }

private:
    // Index at which the key stands, or would.
    std::size_t slot_of(std::int64_t key) const {
        constexpr std::uint64_t golden = 0x9e3779b97f4a7c15; // 2^64 over the golden ratio (Knuth, volume 3, 6.4)
        const std::size_t mask = slots_.size() - 1;
        std::size_t slot = static_cast<std::size_t>((static_cast<std::uint64_t>(key) * golden) >> 20) & mask;
        while (slots_[slot] >= 0 && keys_[static_cast<std::size_t>(slots_[slot])] != key) slot = (slot + 1) & mask;
        return slot;
    }
    void grow() {
        slots_.assign(2 * slots_.size(), -1);
        for (std::size_t k = 0; k < keys_.size(); ++k) slots_[slot_of(keys_[k])] = static_cast<int>(k);
    }

    std::vector<int> slots_ = std::vector<int>(16, -1);
    std::vector<std::int64_t> keys_;
};

} // namespace treacle
