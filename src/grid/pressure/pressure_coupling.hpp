#pragma once
#include "grid/geometry/closed_centres.hpp"
#include "grid/mac/body_motion.hpp"
#include "grid/pressure/pressure_system.hpp"

#include <array>
#include <span>
#include <vector>

namespace treacle::grid {

// Shares of moving bodies in the faces' cubes, by the axis of the face.
using FaceBodyFractions = std::array<BodyFractions, 3>;

// Points at which the motion of a body counts at a face: the middle of the face, and for a body that liquid slides along the
// centre of the face's closed part (closed_centres.hpp). In kernels.
struct MotionPoints {
    MacGrid grid;
    bool slips = false;
    // [6 sides, then bodies] slip lengths [m]; [window] ClosedCentres::offset(axis, k) [cells].
    Array<double> length, offset[3][2];

    // Position `x` [m] at the face across `axis` below cell `c`; `body` may be Solids::nothing.
    KOKKOS_INLINE_FUNCTION void at(int body, int axis, const int c[3], std::size_t face, double x[3]) const {
        grid.face(axis, c, x);
        if (!slips || body < 0 || !(length(6 + body) > 0)) return;
        for (int k = 0; k < 2; ++k) x[(axis + 1 + k) % 3] += grid.dx * offset[axis][k](face);
    }
};

// Bodies that liquid slides along; none without `closed`.
struct SlipAreas {
    const ClosedCentres* closed = nullptr;
    Array<double> length; // [6 sides, then bodies] slip lengths, 0: no slip [m]

    MotionPoints points(const MacGrid& grid) const; // of this grid, without a copy of the arrays
};

// Bodies in the pressure system (P2). The closed part of a face belongs to its bodies by their shares of the cube
// around it, what is left to solids at rest. J has a row of six numbers for each cell and body: the areas of the body at
// the cell's faces, out of the cell, with their arms about the body's centre [1, m]. The arms are those of the faces' middles,
// where the liquid's velocities are, so that liquid that turns with a body does so exactly; of a body that the liquid slides
// along those of the solid parts' centres, so that a turn along its surface moves no liquid at all. Bodies take the flux J V out of the
// cells; the pressure loads them with dx^2 J^T p.
class PressureCoupling {
public:
    // The rows J of this rank's cells, for the poses of the bodies. `fluid`: fractions of the cubes around faces.
    void build(const PressureSystem& system, const MacGrid& grid, const FaceField& fluid,
        const FaceBodyFractions& body_fractions, const BodyMotion& motion, const SlipAreas& slip = {});

    // out -= scale J V, on this rank's rows; of all bodies that move.
    void subtract_flux(const BodyMotion& motion, double scale, const Array<double>& out) const;
    // Collective: dx^2 J^T x summed over the ranks, 6 numbers a body; of a 2D scene dx J^T x, per metre.
    std::vector<double> loads(const Comm& comm, std::span<const double> x) const;
    // y += mass J M^-1 J^T x with the mass of a full cell [kg], of a 2D scene [kg/m], collective. What the strong
    // coupling adds to products: symmetric and positive semidefinite, of rank six a body, never assembled.
    void add_response(const Comm& comm, const rigid::ConstrainedInverseMass& mobility, double mass,
        std::span<const double> x, std::span<double> y) const;

    // y += factor J V on this rank's rows, V 6 numbers a body.
    void add_flux(std::span<const double> velocities, double factor, std::span<double> y) const;

    // True where no moving body is at a row of this rank; memory of this rank [bytes].
    bool empty() const { return entries_.empty(); }
    std::size_t bytes() const;

    // One body at one cell, on the host.
    struct Entry {
        int row, body;
        double u[6]; // row of J: areas [1] and moments [m], over dx^2
    };
    const std::vector<Entry>& entries() const { return entries_; }

    // Part of build(); not private, since nvcc takes no kernel in a private function.
    int count(const PressureSystem& system, const FaceField& fluid, const FaceBodyFractions& body_fractions);

private:
    std::vector<double> sums(const Comm& comm, std::span<const double> x) const;

    double face_ = 0; // [m2], of a 2D scene [m]: area of a whole face
    std::size_t bodies_ = 0;
    int rows_ = 0;
    Array<int> offset_{"treacle::coupling_offset", 0}; // [rows + 1]
    Array<int> body_{"treacle::coupling_body", 0};     // [entries]
    Array<double> u_{"treacle::coupling_row", 0};      // [entries * 6]
    std::vector<Entry> entries_;                       // the same on the host
};

} // namespace treacle::grid
