#pragma once
#include "base/options/options.hpp"

namespace treacle {

// As parse_document, of a file that holds keys for other readers as well: at its root, not in its blocks, what is not declared is left alone.
void parse_some(const Document& document, const Declaration::Members& root);

} // namespace treacle
