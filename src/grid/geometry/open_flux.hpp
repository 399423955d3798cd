#pragma once
#include "grid/mac/pressure_faces.hpp"
#include "mpi/comm.hpp"

namespace treacle::grid {

// Whose velocities the flux through a face takes (U): its open area times the velocity at the middle of its open part. Where liquid slides
// along the solid that closes the rest, that is interpolated to from the faces beside on the open side; elsewhere it is that of the face's
// middle, by which liquid that turns along a round wall would cross it, and be held as by a rough one. Lookups in kernels.
class OpenFlux {
public:
    // All over the window.
    struct Scene {
        PressureFaces faces;
        Array<double> closed_centre[3][2]; // ClosedCentres::offset(axis, k), of all solids
        FaceField no_slip_open;            // open area fractions of the faces, of the no-slip solids alone
        EdgeField shear;                   // of the viscous stresses, 0 where there is none
        Array<int> row_of[3];              // numbers of the faces with a velocity, negative: none
    };
    // Collective. Two faces in one flux have a stress between them, and so are in each other's halo.
    void find(const Comm& comm, const Scene& scene);
    // True where any flux takes more than its own face's velocity. The same on every rank.
    bool interpolates() const { return interpolates_; }
    std::size_t bytes() const; // of this rank [bytes]

    // use(j, weight) for each face j across a whose velocity the flux through face i takes; weights sum to one.
    template <class Use>
    KOKKOS_INLINE_FUNCTION void each_taken(int a, std::ptrdiff_t i, const Use& use) const {
        each_step(a, [&](int first, int second, std::ptrdiff_t step) {
            if (const double part = weight(a, i, first, second); part > 0) use(i + step, part);
        });
    }
    // use(j, weight) for each face j across a whose flux takes the velocity of face i.
    template <class Use>
    KOKKOS_INLINE_FUNCTION void each_taking(int a, std::ptrdiff_t i, const Use& use) const {
        each_step(a, [&](int first, int second, std::ptrdiff_t step) {
            if (const double part = weight(a, i - step, first, second); part > 0) use(i - step, part);
        });
    }

private:
    // Steps to the faces beside, -1 to 1 along axis a + 1 and a + 2 each.
    template <class Use>
    KOKKOS_INLINE_FUNCTION void each_step(int a, const Use& use) const {
        const int along[2] = {(a + 1) % 3, (a + 2) % 3};
        const int most[2] = {
            interpolates_ && along[0] < dimensions_ ? 1 : 0, interpolates_ && along[1] < dimensions_ ? 1 : 0};
        for (int second = -most[1]; second <= most[1]; ++second) {
            for (int first = -most[0]; first <= most[0]; ++first)
                use(first, second, first * stride_[along[0]] + second * stride_[along[1]]);
        }
    }
    // Weight of the face a step beside in the flux through face j.
    KOKKOS_INLINE_FUNCTION double weight(int a, std::ptrdiff_t j, int first, int second) const {
        if (!interpolates_) return 1;
        const double to_first = weight_[a][0](j), to_second = weight_[a][1](j), both = diagonal_[a](j);
        const double of_first = math::fabs(to_first), of_second = math::fabs(to_second);
        if (first == 0 && second == 0) return 1 - of_first - of_second + both;
        if (first * to_first < 0 || second * to_second < 0) return 0;
        return first == 0 ? of_second - both : second == 0 ? of_first - both : both;
    }

    std::ptrdiff_t stride_[3]{1, 1, 1};
    int dimensions_ = 3;
    bool interpolates_ = false;
    Array<double> weight_[3][2]; // [window] of the faces after along axis a + 1 + k, < 0: of those before
    Array<double> diagonal_[3];  // [window] of the face that is beside along both
};

} // namespace treacle::grid
