#pragma once

namespace treacle {

// Throws std::logic_error with the place in the sources: a fault of the program, not of its input.
[[noreturn]] void contract_broken(
    const char* kind, const char* condition, const char* file, int line, const char* function);

} // namespace treacle

// Conditions on sizes and states between parts of the program, for host code: what a function expects of its arguments,
// and what it ensures of its results. Tested in debug builds alone, where CMake defines TREACLE_CONTRACTS; conditions
// have no effects of their own.
#ifdef TREACLE_CONTRACTS
#define TREACLE_EXPECT(condition)                                                                                      \
    ((condition) ? void() : ::treacle::contract_broken("expects", #condition, __FILE__, __LINE__, __func__))
#define TREACLE_ENSURE(condition)                                                                                      \
    ((condition) ? void() : ::treacle::contract_broken("ensures", #condition, __FILE__, __LINE__, __func__))
#else
#define TREACLE_EXPECT(condition) static_cast<void>(0)
#define TREACLE_ENSURE(condition) static_cast<void>(0)
#endif
