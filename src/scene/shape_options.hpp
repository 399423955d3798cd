#pragma once
#include "scene/shapes/shape.hpp"

namespace treacle {
class Declaration;
}

namespace treacle::scene {

// The options of a shape: a block with one key, its kind, as in `{box: {min: [0, 0, 0], max: [1, 1, 1]}}`.
void declare(Declaration& d, Shape& shape);

} // namespace treacle::scene
