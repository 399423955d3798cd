#include "grid/unified/pressed_faces.hpp"

#include "base/text/contract.hpp"

#include <algorithm>

namespace treacle::grid {

namespace {
// Rows of the cells below and above each face of the viscous system, its open share, and the share over theta.
struct SidesLoop {
    PressureFaces faces;
    Array<int> face_of, row_of, rows;
    Array<double> values;

    KOKKOS_INLINE_FUNCTION void operator()(int r) const {
        const int a = face_of(r) % 3, i = face_of(r) / 3;
        const auto above = static_cast<std::size_t>(i), below = above - static_cast<std::size_t>(faces.stride[a]);
        const double open = faces.open(a, above), fraction = faces.effective_area_fraction(a, above);
        const bool pushes = fraction > 0;
        rows(2 * r) = pushes ? row_of(below) : -1;
        rows(2 * r + 1) = pushes ? row_of(above) : -1;
        values(2 * r) = pushes ? open : 0.0;
        values(2 * r + 1) = pushes ? open / fraction : 0.0;
    }
};

// Rows and open shares of the six faces of each cell with a pressure; into the cell.
struct FluxLoop {
    PressureFaces faces;
    Array<int> cell_of, row_of[3], rows;
    Array<double> values;

    KOKKOS_INLINE_FUNCTION void operator()(int r) const {
        for (int a = 0; a < 3; ++a) {
            for (int side = 0; side < 2; ++side) {
                const int k = 6 * r + 2 * a + side;
                rows(k) = -1;
                if (a >= faces.dimensions) continue;
                const auto i = static_cast<std::size_t>(cell_of(r) + side * faces.stride[a]);
                const double open = faces.open(a, i);
                if (!(open > 0)) continue;
                rows(k) = row_of[a](i);
                values(k) = side == 0 ? open : -open;
            }
        }
    }
};

// Rows of the faces in one flux with each row's, and their weights: those whose velocity its flux takes, then those whose flux takes
// its own.
constexpr int most_taken = 3, most_taking = 8, most_others = most_taken + most_taking;
struct NeighbourLoop {
    OpenFlux flux;
    Array<int> face_of, row_of[3], rows;
    Array<double> values;

    KOKKOS_INLINE_FUNCTION void operator()(int r) const {
        const int a = face_of(r) % 3;
        const std::ptrdiff_t i = face_of(r) / 3;
        int taken = most_others * r, taking = taken + most_taken;
        for (int k = taken; k < taken + most_others; ++k) rows(k) = -1;
        flux.each_taken(a, i, [&](std::ptrdiff_t j, double weight) { add(taken, row_of[a](j), j != i, weight); });
        flux.each_taking(a, i, [&](std::ptrdiff_t j, double weight) { add(taking, row_of[a](j), j != i, weight); });
    }
    KOKKOS_INLINE_FUNCTION void add(int& at, int row, bool other, double weight) const {
        if (!other) return;
        rows(at) = row;
        values(at) = weight;
        ++at;
    }
};

// Local columns of rows by their global numbers: this rank's, then those of a halo.
struct LocalColumns {
    int first, rows;
    std::span<const int> halo;

    int operator()(int global) const {
        if (global >= first && global < first + rows) return global - first;
        return rows + static_cast<int>(std::lower_bound(halo.begin(), halo.end(), global) - halo.begin());
    }
};

double value_at(std::span<const double> own, std::span<const double> around, int column) {
    const auto k = static_cast<std::size_t>(column);
    return k < own.size() ? own[k] : around[k - own.size()];
}
} // namespace

void PressedFaces::find_sides(const ViscousSystem& viscous, const PressureSystem& pressure, const Scales& scales) {
    const auto n = static_cast<std::size_t>(faces_);
    reserve(rows_, 2 * n);
    reserve(values_, 2 * n);
    Kokkos::parallel_for("treacle::pressed_sides", faces_,
        SidesLoop{pressure.faces(), viscous.face_of(), pressure.row_of(), rows_, values_});
    const auto rows = on_host(rows_);
    const auto values = on_host(values_);
    const LocalColumns local_column{static_cast<int>(pressure.first_row()), pressures_, of_pressures_->columns()};
    sides_.resize(n);
    for (std::size_t r = 0; r < n; ++r) {
        const int below = rows(2 * r), above = rows(2 * r + 1);
        sides_[r] = {below < 0 ? none : local_column(below), above < 0 ? none : local_column(above),
            scales.area * values(2 * r), scales.change * values(2 * r + 1)};
    }
}

void PressedFaces::find_flux(const ViscousSystem& viscous, const PressureSystem& pressure, double area) {
    const auto m = static_cast<std::size_t>(pressures_);
    reserve(rows_, 6 * m);
    reserve(values_, 6 * m);
    Kokkos::parallel_for("treacle::pressed_flux", pressures_,
        FluxLoop{pressure.faces(), pressure.cell_of(), {viscous.row_of(0), viscous.row_of(1), viscous.row_of(2)}, rows_,
            values_});
    const auto rows = on_host(rows_);
    const auto values = on_host(values_);
    const LocalColumns local_column{static_cast<int>(viscous.first_row()), faces_, of_faces_->columns()};
    entries_.clear();
    first_.assign(1, 0);
    for (std::size_t r = 0; r < m; ++r) {
        for (std::size_t k = 6 * r; k < 6 * r + 6; ++k) {
            if (rows(k) >= 0) entries_.push_back({local_column(rows(k)), area * values(k)});
        }
        first_.push_back(static_cast<int>(entries_.size()));
    }
}

void PressedFaces::find_neighbours(const ViscousSystem& viscous) {
    const auto n = static_cast<std::size_t>(faces_);
    const std::size_t all = most_others * n;
    reserve(rows_, all);
    reserve(values_, all);
    Kokkos::parallel_for("treacle::pressed_neighbours", faces_,
        NeighbourLoop{viscous.flux(), viscous.face_of(), {viscous.row_of(0), viscous.row_of(1), viscous.row_of(2)},
            rows_, values_});
    const auto rows = on_host(rows_);
    const auto values = on_host(values_);
    const LocalColumns local_column{static_cast<int>(viscous.first_row()), faces_, of_faces_->columns()};
    for (std::size_t k = 0; k < all; ++k) {
        if (rows(k) < 0) continue;
        const Neighbour found{static_cast<int>(k / most_others), local_column(rows(k)), values(k)};
        (k % most_others < most_taken ? taken_ : given_).push_back(found);
    }
}

void PressedFaces::build(ViscousSystem& viscous, PressureSystem& pressure, const Scales& scales) {
    faces_ = viscous.faces();
    pressures_ = pressure.rows();
    of_faces_ = &viscous.halo();
    of_pressures_ = &pressure.halo();
    find_sides(viscous, pressure, scales);
    find_flux(viscous, pressure, scales.area);
    difference_.resize(sides_.size());
    taken_.clear();
    given_.clear();
    interpolates_ = viscous.flux().interpolates();
    if (interpolates_) find_neighbours(viscous);
}

void PressedFaces::flux(std::span<const double> u, std::span<double> y) {
    if (!interpolates_) return middle_flux(u, y);
    const auto around = of_faces_->gather(u);
    const auto own = u.first(static_cast<std::size_t>(faces_));
    at_open_.assign(own.begin(), own.end());
    for (const auto& [face, other, weight] : taken_) {
        const auto r = static_cast<std::size_t>(face);
        at_open_[r] += weight * (value_at(own, around, other) - own[r]);
    }
    middle_flux(at_open_, y);
}

void PressedFaces::middle_flux(std::span<const double> u, std::span<double> y) {
    TREACLE_EXPECT(u.size() >= std::size_t(faces_) && y.size() < first_.size());
    const auto around = of_faces_->gather(u);
    const auto own = u.first(static_cast<std::size_t>(faces_));
    for (std::size_t r = 0; r < y.size(); ++r) {
        double sum = 0;
        for (int k = first_[r]; k < first_[r + 1]; ++k) {
            const auto& entry = entries_[static_cast<std::size_t>(k)];
            sum += entry.area * value_at(own, around, entry.face);
        }
        y[r] = sum;
    }
}

void PressedFaces::differences(std::span<const double> p, std::vector<double>& out) {
    const auto around = of_pressures_->gather(p);
    for (std::size_t r = 0; r < out.size(); ++r) {
        const auto& face = sides_[r];
        out[r] = (face.above == none ? 0.0 : value_at(p, around, face.above)) -
                 (face.below == none ? 0.0 : value_at(p, around, face.below));
    }
}

void PressedFaces::add_middle_forces(std::span<const double> p, std::span<double> y) {
    differences(p, difference_);
    for (std::size_t r = 0; r < sides_.size(); ++r) y[r] += sides_[r].area * difference_[r];
}

void PressedFaces::add_forces(std::span<const double> p, std::span<double> y) {
    if (!interpolates_) return add_middle_forces(p, y);
    at_open_.assign(sides_.size(), 0.0);
    add_middle_forces(p, at_open_);
    const auto around = of_faces_->gather(at_open_);
    for (std::size_t r = 0; r < sides_.size(); ++r) y[r] += at_open_[r];
    for (const auto& [face, other, weight] : taken_) {
        const auto r = static_cast<std::size_t>(face);
        y[r] -= weight * at_open_[r];
    }
    for (const auto& [face, other, weight] : given_) {
        y[static_cast<std::size_t>(face)] += weight * value_at(at_open_, around, other);
    }
}

void PressedFaces::push(std::span<const double> p, std::span<double> u) {
    differences(p, difference_);
    for (std::size_t r = 0; r < sides_.size(); ++r) u[r] -= sides_[r].change * difference_[r];
}

std::size_t PressedFaces::bytes() const {
    return sides_.capacity() * sizeof(Sides) + entries_.capacity() * sizeof(Entry) +
           4 * (first_.capacity() + rows_.span()) +
           8 * (difference_.capacity() + values_.span() + at_open_.capacity()) +
           sizeof(Neighbour) * (taken_.capacity() + given_.capacity());
}

} // namespace treacle::grid
