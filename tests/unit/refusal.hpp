#pragma once
#include "base/text/error.hpp"

#include <functional>
#include <string>

namespace treacle::test {

// Message of the InputError that act() ends with; empty when it ends without one.
inline std::string refusal(const std::function<void()>& act) {
    try {
        act();
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

} // namespace treacle::test
