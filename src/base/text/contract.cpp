#include "base/text/contract.hpp"

#include <stdexcept>
#include <string>

namespace treacle {

void contract_broken(const char* kind, const char* condition, const char* file, int line, const char* function) {
    throw std::logic_error(
        std::string(file) + ":" + std::to_string(line) + ": " + function + " " + kind + " " + condition);
}

} // namespace treacle
