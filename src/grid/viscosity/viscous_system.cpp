#include "grid/viscosity/viscous_system.hpp"

#include "grid/viscosity/viscosity.hpp"
#include "kokkos/scan.hpp"
#include "solve/rows/host_blocks.hpp"

#include <algorithm>

namespace treacle::grid {

namespace {
constexpr int most_entries = 15; // of a row: 1 + 6 of its axis + 8 of the others
// The same where fluxes take velocities of faces beside: 27 + 24 + 24 faces of the 18 cells whose flux may take the row's, and 3 more of each.
constexpr int most_interpolated_entries = 300;

struct NumberLoop {
    ViscousFaces faces;
    CellBox owned;
    Array<int> row_of[3], face_of;
    int first;
    bool write;

    KOKKOS_INLINE_FUNCTION void operator()(int n, int& sum, bool last) const {
        int c[3];
        owned.cell(n, c);
        const int i = faces.window.index(c[0], c[1], c[2]);
        for (int a = 0; a < faces.dimensions; ++a) {
            const bool unknown = faces.role[a](i) == unknown_face;
            if (last && write) {
                row_of[a](i) = unknown ? first + sum : -1;
                if (unknown) face_of(sum) = 3 * i + a;
            }
            sum += static_cast<int>(unknown);
        }
    }
};

// A row while it is filled, its columns kept rising; entries of the same column add up.
struct RisingRow {
    int* column;
    double* value;
    int count = 0;

    KOKKOS_INLINE_FUNCTION void add(int c, double v) {
        int k = count;
        while (k > 0 && column[k - 1] > c) --k;
        if (k > 0 && column[k - 1] == c) {
            value[k - 1] += v;
            return;
        }
        for (int l = count; l > k; --l) {
            column[l] = column[l - 1];
            value[l] = value[l - 1];
        }
        column[k] = c;
        value[k] = v;
        ++count;
    }
};

template <int most>
struct RowLoop {
    ViscousFaces faces;
    OpenFlux flux;
    Array<int> row_of[3], halo_column[3], face_of;
    ViscousSystem::Block own, other;
    int first, rows;
    bool write;

    // Globals of this rank's rows become local, of others places in the halo.
    KOKKOS_INLINE_FUNCTION void operator()(int r) const {
        int columns[2][most];
        double values[2][most];
        RisingRow here{columns[0], values[0]}, there{columns[1], values[1]};
        const int a = face_of(r) % 3;
        const std::ptrdiff_t i = face_of(r) / 3;
        const double fraction = faces.fraction.axis[a](i);
        here.add(r, faces.mass.axis[a](i));
        const auto add = [&](int b, std::ptrdiff_t j, double value) {
            const int row = row_of[b](j);
            if (row < 0) return;
            if (row >= first && row < first + rows) {
                here.add(row - first, value);
            } else {
                there.add(halo_column[b](j), value);
            }
        };
        faces.each_entry(a, i,
            [&](int b, std::ptrdiff_t j, double entry) { add(b, j, entry * (fraction * faces.fraction.axis[b](j))); });
        faces.volumes.each_entry(flux, a, i, add);
        if (!write) {
            own.offset(r) = here.count;
            other.offset(r) = there.count;
            return;
        }
        for (int k = 0; k < here.count; ++k) {
            own.column(own.offset(r) + k) = columns[0][k];
            own.value(own.offset(r) + k) = values[0][k];
        }
        for (int k = 0; k < there.count; ++k) {
            other.column(other.offset(r) + k) = columns[1][k];
            other.value(other.offset(r) + k) = values[1][k];
        }
    }
};

struct RightLoop {
    ViscousFaces faces;
    Array<int> face_of;
    FaceField velocity;
    Array<double> b;

    KOKKOS_INLINE_FUNCTION void operator()(int r) const {
        const int a = face_of(r) % 3;
        const std::ptrdiff_t i = face_of(r) / 3;
        double pull = 0;
        faces.each_entry(
            a, i, [&](int axis, std::ptrdiff_t j, double entry) { pull += entry * faces.solid.axis[axis](j); });
        faces.each_slip(a, i, [&](std::ptrdiff_t cell, int axis, double k) { pull -= k * faces.wall[axis](cell); });
        b(r) =
            faces.mass.axis[a](i) * velocity.axis[a](i) - faces.fraction.axis[a](i) * (pull - faces.strain_pull(a, i));
    }
};
} // namespace

void ViscousSystem::number_rows(const Comm& comm, CellHalo& halo, const ViscousFaces& faces) {
    const auto window_size = static_cast<std::size_t>(faces.window.size());
    for (auto& rows : row_of_) {
        reserve(rows, window_size);
        Kokkos::deep_copy(rows, -1);
    }
    NumberLoop loop{faces, owned_, {row_of_[0], row_of_[1], row_of_[2]}, face_of_, 0, false};
    const int cells = static_cast<int>(owned_.size());
    free_ = 0;
    Kokkos::parallel_scan("treacle::count_viscous_rows", cells, loop, free_);
    first_row_ = comm.exclusive_sum(static_cast<std::int64_t>(rows()));
    global_rows_ = comm.sum(static_cast<std::int64_t>(rows()));
    reserve(face_of_, static_cast<std::size_t>(free_));
    loop.face_of = face_of_;
    loop.first = static_cast<int>(first_row_);
    loop.write = true;
    Kokkos::parallel_scan("treacle::number_viscous_rows", cells, loop, free_);
    halo.gather({row_of_[0], row_of_[1], row_of_[2]});
}

// On the host, where the halo is: faces of the layer of cells around the owned ones, of two where fluxes take velocities of faces beside.
void ViscousSystem::connect_halo(const Comm& comm, const CellHalo& halo, int dimensions) {
    const auto& window = halo.window();
    CellBox around = owned_;
    const int layers = flux_.interpolates() ? 2 : 1;
    for (int k = 0; k < dimensions && !owned_.empty(); ++k) {
        around.lo[k] -= layers;
        around.hi[k] += layers;
    }
    columns_.clear();
    const auto each = [&](const auto& use) {
        for (int a = 0; a < dimensions; ++a) {
            const auto row = on_host(row_of_[a]);
            for (int n = 0; n < around.size(); ++n) {
                int c[3];
                around.cell(n, c);
                if (owned_.contains(c)) continue;
                const int i = window.index(c[0], c[1], c[2]);
                if (row(i) >= 0 && (row(i) < first_row_ || row(i) >= first_row_ + rows())) use(a, i, row(i));
            }
        }
    };
    each([&](int, int, int row) { columns_.push_back(row); });
    std::sort(columns_.begin(), columns_.end());
    columns_.erase(std::unique(columns_.begin(), columns_.end()), columns_.end());
    halo_.connect(comm, first_row_, columns_);
    Array<int>::HostMirror halo_column[3];
    for (int a = 0; a < dimensions; ++a) {
        reserve(halo_column_[a], static_cast<std::size_t>(window.size()));
        halo_column[a] = Kokkos::create_mirror_view(halo_column_[a]);
    }
    each([&](int a, int i, int row) {
        halo_column[a](i) =
            static_cast<int>(std::lower_bound(columns_.begin(), columns_.end(), row) - columns_.begin());
    });
    for (int a = 0; a < dimensions; ++a) Kokkos::deep_copy(halo_column_[a], halo_column[a]);
}

template <int most>
void ViscousSystem::run_rows(const char* name, const ViscousFaces& faces, bool write) {
    Kokkos::parallel_for(name, free_,
        RowLoop<most>{faces, flux_, {row_of_[0], row_of_[1], row_of_[2]},
            {halo_column_[0], halo_column_[1], halo_column_[2]}, face_of_, own_, other_, static_cast<int>(first_row_),
            free_, write});
}

void ViscousSystem::run_rows(const char* name, const ViscousFaces& faces, bool write) {
    if (flux_.interpolates())
        run_rows<most_interpolated_entries>(name, faces, write);
    else
        run_rows<most_entries>(name, faces, write);
}

void ViscousSystem::count_entries(const ViscousFaces& faces) {
    const auto n = static_cast<std::size_t>(rows());
    reserve(own_.offset, n + 1);
    reserve(other_.offset, n + 1);
    run_rows("treacle::count_viscous_entries", faces, false);
    const int faces_here = free_, extra = extra_;
    const auto own = own_.offset, other = other_.offset;
    Kokkos::parallel_for(
        "treacle::count_body_entries", extra, KOKKOS_LAMBDA(int k) {
            own(faces_here + k) = extra;
            other(faces_here + k) = 0;
        });
    for (auto* block : {&own_, &other_}) {
        const auto entries = static_cast<std::size_t>(counts_to_offsets(block->offset, rows()));
        reserve(block->column, entries);
        reserve(block->value, entries);
    }
}

void ViscousSystem::fill(const ViscousFaces& faces) {
    run_rows("treacle::fill_viscous_matrix", faces, true);
    const int faces_here = free_, extra = extra_;
    const auto own = own_;
    Kokkos::parallel_for(
        "treacle::fill_body_rows", extra, KOKKOS_LAMBDA(int k) {
            for (int l = 0; l < extra; ++l) {
                own.column(own.offset(faces_here + k) + l) = faces_here + l;
                own.value(own.offset(faces_here + k) + l) = 0;
            }
        });
}

void ViscousSystem::find_flux(const Comm& comm, CellHalo& halo, const ViscousFaces& faces,
    const PressureFaces& pressure_faces, const SlipSolids* slip) {
    flux_ = OpenFlux();
    if (!slip) return;
    owned_ = halo.owned();
    number_rows(comm, halo, faces);
    OpenFlux::Scene scene{pressure_faces, {}, slip->no_slip_fractions.open, faces.shear, {}};
    for (int a = 0; a < 3; ++a) {
        for (int k = 0; k < 2; ++k) scene.closed_centre[a][k] = slip->closed_centre[a][k];
        scene.row_of[a] = row_of_[a];
    }
    flux_.find(comm, scene);
}

void ViscousSystem::assemble(const Comm& comm, CellHalo& halo, const ViscousFaces& faces, int extra) {
    owned_ = halo.owned();
    extra_ = comm.is_root() ? extra : 0;
    if (faces.volumes.stiffness.extent(0) == 0) flux_ = OpenFlux();
    number_rows(comm, halo, faces);
    connect_halo(comm, halo, faces.dimensions);
    count_entries(faces);
    fill(faces);
    host_own_ = {on_host(own_.offset), on_host(own_.column), on_host(own_.value)};
    host_other_ = {on_host(other_.offset), on_host(other_.column), on_host(other_.value)};
}

double& ViscousSystem::extra_entry(int row, int column) {
    return host_own_.value(host_own_.offset(free_ + row) + column);
}

solve::CsrBlocks ViscousSystem::blocks() {
    return solve::csr_blocks(host_own_, host_other_, halo_, {first_row_, rows(), global_rows_});
}

void ViscousSystem::right_hand_side(
    const ViscousFaces& faces, const FaceField& velocity, const Array<double>& b) const {
    Kokkos::parallel_for("treacle::viscous_right_hand_side", free_, RightLoop{faces, face_of_, velocity, b});
}

std::size_t ViscousSystem::bytes() const {
    std::size_t total = 4 * (face_of_.span() + columns_.capacity()) + halo_.bytes() + flux_.bytes();
    for (int a = 0; a < 3; ++a) total += 4 * (row_of_[a].span() + halo_column_[a].span());
    for (const auto* block : {&own_, &other_}) {
        total += 4 * (block->offset.span() + block->column.span()) + 8 * block->value.span();
    }
    return total;
}

} // namespace treacle::grid
