#include "base/text/contract.hpp"

#include <stdexcept>
#include <string>

namespace treacle {

void contract_broken(const char* kind, const char* condition, const std::source_location& where) {
    throw std::logic_error(std::string(where.file_name()) + ":" + std::to_string(where.line()) + ": " +
                           where.function_name() + " " + kind + " " + condition);
}

} // namespace treacle
