#pragma once
#include "sph/model/neighbourhood.hpp"

namespace treacle::sph {

// Free-surface particles by geometry alone: of 26 directions (8 in 2D), one has neither liquid nor solid within
// 45 degrees of it inside the support. Writes Role::dirichlet to the owned ones and Role::poisson to the others.
void mark_surface(
    const Constants& constants, LiquidParticles& liquid, const SolidParticles& solid, const Neighbourhood& neighbours);

} // namespace treacle::sph
