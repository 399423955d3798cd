#include "grid/geometry/open_flux.hpp"

namespace treacle::grid {

namespace {
// Weight of the face beside along one axis; none where it is no row, or has no stress in common.
struct WeightLoop {
    PressureFaces faces;
    CellBox box; // places with neighbours in the window
    Array<double> closed_centre, no_slip_open;
    EdgeField shear;
    Array<int> row;
    int axis, beside; // the axis across the face, and that along which the other face is
    Array<double> out;

    // Distance of the middle of the open part from that of the face [cells], where the solid beside slides.
    KOKKOS_INLINE_FUNCTION double offset(std::ptrdiff_t i) const {
        const double open = faces.open(axis, static_cast<std::size_t>(i));
        if (!(open > 0) || !(open < 1) || row(i) < 0 || no_slip_open(i) < 1) return 0;
        return -(1 - open) / open * closed_centre(i);
    }
    KOKKOS_INLINE_FUNCTION void operator()(int n, int& found) const {
        int c[3];
        box.cell(n, c);
        const auto i = static_cast<std::ptrdiff_t>(faces.window.index(c[0], c[1], c[2]));
        const double distance = math::max(-0.5, math::min(offset(i), 0.5));
        const std::ptrdiff_t to = distance > 0 ? faces.stride[beside] : -faces.stride[beside];
        const bool tied = row(i + to) >= 0 && shear.axis[3 - axis - beside](to > 0 ? i + to : i) > 0;
        out(i) = tied ? distance : 0.0;
        if (out(i) != 0) ++found;
    }
};

// Bilinear weights where the face beside along both axes is a row, too, else linear: a face's own weight is a quarter at least, or nothing would be left
// to it in a corner.
struct DiagonalLoop {
    CellBox window, box;
    Array<double> first, second;
    std::ptrdiff_t forward[2];
    Array<int> row;
    Array<double> out;

    KOKKOS_INLINE_FUNCTION void operator()(int n) const {
        int c[3];
        box.cell(n, c);
        const auto i = static_cast<std::ptrdiff_t>(window.index(c[0], c[1], c[2]));
        const std::ptrdiff_t to =
            i + (first(i) > 0 ? forward[0] : -forward[0]) + (second(i) > 0 ? forward[1] : -forward[1]);
        out(i) = row(to) >= 0 ? math::fabs(first(i) * second(i)) : 0.0;
    }
};
} // namespace

void OpenFlux::find(const Comm& comm, const Scene& scene) {
    const auto& faces = scene.faces;
    dimensions_ = faces.dimensions;
    CellBox box = faces.window;
    for (int k = 0; k < 3; ++k) {
        stride_[k] = faces.stride[k];
        if (k >= dimensions_ || box.empty()) continue;
        ++box.lo[k];
        --box.hi[k];
    }
    std::int64_t found = 0;
    for (int a = 0; a < dimensions_; ++a) {
        for (int k = 0; k < 2; ++k) {
            const int beside = (a + 1 + k) % 3;
            reserve(weight_[a][k], static_cast<std::size_t>(faces.window.size()));
            Kokkos::deep_copy(weight_[a][k], 0.0);
            if (beside >= dimensions_ || box.empty()) continue;
            int here = 0;
            Kokkos::parallel_reduce("treacle::open_flux", static_cast<int>(box.size()),
                WeightLoop{faces, box, scene.closed_centre[a][k], scene.no_slip_open.axis[a], scene.shear,
                    scene.row_of[a], a, beside, weight_[a][k]},
                here);
            found += here;
        }
        reserve(diagonal_[a], static_cast<std::size_t>(faces.window.size()));
        Kokkos::deep_copy(diagonal_[a], 0.0);
        if (box.empty()) continue;
        Kokkos::parallel_for("treacle::open_flux_diagonals", static_cast<int>(box.size()),
            DiagonalLoop{faces.window, box, weight_[a][0], weight_[a][1], {stride_[(a + 1) % 3], stride_[(a + 2) % 3]},
                scene.row_of[a], diagonal_[a]});
    }
    interpolates_ = comm.sum(found) > 0;
}

std::size_t OpenFlux::bytes() const {
    std::size_t numbers = 0;
    for (int a = 0; a < 3; ++a) numbers += weight_[a][0].span() + weight_[a][1].span() + diagonal_[a].span();
    return 8 * numbers;
}

} // namespace treacle::grid
