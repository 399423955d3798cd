#pragma once
#include "kokkos/particle_store.hpp"
#include "surface/field/lattice.hpp"
#include "surface/field/solids.hpp"

namespace treacle::surface {

// Adds images of this rank's particles x that are nearer to a solid than the support: x - 2 s n, with the signed distance s
// and its normal n, and images of images where several solids are near. An image stays where the surface that it was
// mirrored at is the nearest one, which in thin solids is the half on the particle's side. Images have the fields of their
// particles; `image_field` has the solids that they were mirrored in. They may lie in other ranks' cells: migrate next.
void add_solid_images(
    ParticleStore& store, int image_field, const Solids& solids, double support, const Lattice& lattice);

} // namespace treacle::surface
