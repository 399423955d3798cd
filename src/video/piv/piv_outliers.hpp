#pragma once
#include "video/piv/piv_field.hpp"

namespace treacle::video {

// The normalised median test (Westerweel & Scarano 2005): a vector is marked as not valid where
//   |u - median(u_i)| / (median |u_i - median(u_i)| + noise)
// of its up to eight valid neighbours, both components together, is above the threshold; the field's slope, a median of its
// own, is taken off first, since the neighbours of a vector at a rim lie to one side. Vectors lie on a rectangular grid;
// those with fewer than three neighbours are kept. `noise` [the field's unit of velocity]. Returns how many were marked.
std::size_t reject_odd(PivField& field, double threshold, double noise);

} // namespace treacle::video
