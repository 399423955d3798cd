#pragma once
#include "grid/mac/body_motion.hpp"
#include "grid/mac/fine_nodes.hpp"
#include "mpi/cell_halo.hpp"
#include "rigid/bodies.hpp"

#include <cstdint>
#include <utility>
#include <vector>

namespace treacle::grid {

// The sides of the domain that are walls.
struct WallPlanes {
    double at[6]{}; // [m]
    bool is_wall[6]{};
    int dimensions = 3;

    // [m] positive in the domain.
    KOKKOS_INLINE_FUNCTION double distance(int side, const double x[3]) const {
        return side % 2 == 0 ? x[side / 2] - at[side] : at[side] - x[side / 2];
    }
};

// Walls of the domain and bodies: their signed distance at the fine nodes of a window, negative inside, and which of
// them is nearest. Nodes farther than `band` from any surface have a bound of the right sign, at least `band` large
// outside. Evaluated on the host, since shapes are host objects: resting bodies only where the window is new, moving
// ones only within their own extent.
class Solids {
public:
    // Sides of the domain that are walls are solid beyond them; open and periodic ones are not.
    // `counted` [bodies]: 1 for those that count; empty: all.
    Solids(const MacGrid& grid, const scene::Domain& domain, std::vector<char> counted = {});

    static constexpr int nothing = -1000; // number of no solid
    // Numbers of solids: bodies by their place in RigidBodies, side k of the domain as -1 - k.
    static constexpr int side(int k) { return -1 - k; }
    // Place of a solid in lists of the six sides, then the bodies.
    KOKKOS_INLINE_FUNCTION static constexpr int slot(int number) { return number >= 0 ? 6 + number : -1 - number; }
    double band() const { return band_; } // [m]

    // Follows the window of the halo and the poses of the bodies. Returns whether any distance changed. Local.
    bool update(const CellHalo& halo, const rigid::RigidBodies& bodies);
    // Number of calls of update() that changed any distance: results that follow from distances alone are right while it stays.
    std::int64_t changes() const { return changes_; }

    // Fields as of the last update().
    const FineNodes& nodes() const { return nodes_; }
    const Array<double>& distance() const { return distance_; }     // [fine nodes] [m]
    const Array<int>& number() const { return number_; }            // [fine nodes]
    DistanceSampler sampler() const { return {nodes_, distance_}; } // trilinear, of distance()
    const Array<int>& moves() const { return moves_; }              // [bodies] 1 where a body moves
    const BodyMotion& motion() const { return motion_; }
    const WallPlanes& walls() const { return walls_; }

    // Signed distance of all solids at any place of the domain [m], on the host, exact.
    double distance_at(const Vec3& x, const rigid::RigidBodies& bodies) const;

private:
    bool follow(const CellHalo& halo, const rigid::RigidBodies& bodies);
    void follow_window(const CellBox& window, const rigid::RigidBodies& bodies);
    void add_bodies(const rigid::RigidBodies& bodies, bool moving, const CellBox& cells);
    void upload_motion(const rigid::RigidBodies& bodies);

    MacGrid grid_;
    WallPlanes walls_;
    std::vector<char> counted_;
    double band_ = 0;
    std::int64_t changes_ = 0;
    FineNodes nodes_;
    Array<double> distance_{"treacle::solid_distance", 0}, resting_{"treacle::resting_distance", 0};
    Array<int> number_{"treacle::solid_number", 0}, resting_number_{"treacle::resting_number", 0};
    BodyMotion motion_;
    Array<int> moves_{"treacle::body_moves", 0};
    std::vector<CellBox> touched_;                           // where moving bodies stand in distance_
    std::vector<std::pair<std::size_t, rigid::Pose>> poses_; // by body, that they have there
};

} // namespace treacle::grid
