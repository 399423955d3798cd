#include "base/vec3.hpp"
