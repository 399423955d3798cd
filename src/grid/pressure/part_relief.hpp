#pragma once
#include "rigid/constrained_inverse_mass.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace treacle::grid {

// Relief of closed parts of the liquid by dynamic bodies (P3). A constant pressure 1 in part p pushes and turns the bodies
// by u_p; with their inverse mass K the constants meet by W = U^T K U, of which this keeps a factor, W = L L^T, with a column
// for each part that is relieved independently of those before it (pivoted Cholesky). All of it is the same on all ranks.
class PartRelief {
public:
    // `net`: [parts][6 a body] u_p, areas [1] and moments [m]; `gross`: sums of the sizes of what is in them.
    void find(const rigid::ConstrainedInverseMass& mobility, std::size_t parts, std::span<const double> net,
        std::span<const double> gross);

    // True where the constant of a part is no longer free because bodies give way to it.
    bool relieved(std::size_t part) const { return relieved_[part] != 0; }
    // By how much the flux out of each cell of a part has to change, per cell, so that there is a solution: the least
    // changes a with L^T a = 0 and sums - sizes a in the range of L; without bodies the means sums / sizes.
    std::vector<double> surplus(std::span<const double> sums, std::span<const double> sizes) const;

private:
    std::vector<char> relieved_; // [parts]
    std::vector<double> factor_; // [columns][parts] of L
};

} // namespace treacle::grid
