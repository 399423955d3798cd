#include "grid/viscosity/mechanisms.hpp"

#include <algorithm>

namespace treacle::grid {

namespace {
// Fractions of what the faces' own stiffness would resist: above, sweeps suffice; below, round-off is as large.
constexpr double most_resistance = 0.3, least_resistance = 1e-10;

// A stress by its kind, 0 … 2 for xx, yy, zz and 3 … 5 for the shear around an axis, and the place it is at.
struct Stress {
    int kind;
    std::ptrdiff_t at;
    double weight, sign; // sign: of the velocity of its face in the strain
};
struct FaceAt {
    int axis;
    std::ptrdiff_t at;
    double pull; // what the strain has of the face's velocity
};

struct MechanismLoop {
    ViscousFaces faces;
    CellBox cells;
    Array<int> row_of[3];
    int first, rows;
    Array<Mechanisms::Motion> out; // as many as it has room for

    template <class Use>
    KOKKOS_INLINE_FUNCTION void each_stress(int a, std::ptrdiff_t i, const Use& use) const {
        use(Stress{a, i, faces.normal(i), -1});
        use(Stress{a, i - faces.stride[a], faces.normal(i - faces.stride[a]), 1});
        for (int b = 0; b < faces.dimensions; ++b) {
            if (b == a) continue;
            const int c = 3 - a - b;
            use(Stress{3 + c, i, faces.shear.axis[c](i), 1});
            use(Stress{3 + c, i + faces.stride[b], faces.shear.axis[c](i + faces.stride[b]), -1});
        }
    }
    template <class Use>
    KOKKOS_INLINE_FUNCTION void each_face(const Stress& stress, const Use& use) const {
        if (stress.kind < 3) {
            const int a = stress.kind;
            use(FaceAt{a, stress.at, -faces.fraction.axis[a](stress.at)});
            use(FaceAt{a, stress.at + faces.stride[a], faces.fraction.axis[a](stress.at + faces.stride[a])});
            return;
        }
        for (int a = 0; a < faces.dimensions; ++a) {
            if (a == stress.kind - 3) continue;
            const auto before = stress.at - faces.stride[3 - a - (stress.kind - 3)];
            use(FaceAt{a, stress.at, faces.fraction.axis[a](stress.at)});
            use(FaceAt{a, before, -faces.fraction.axis[a](before)});
        }
    }
    KOKKOS_INLINE_FUNCTION bool free(int a, std::ptrdiff_t i) const {
        if (faces.role[a](i) != unknown_face) return false;
        bool slips = false;
        faces.each_slip(a, i, [&](std::ptrdiff_t, int, double) { slips = true; });
        return !slips;
    }
    // True when a face has one stress and no other.
    KOKKOS_INLINE_FUNCTION bool loose(int a, std::ptrdiff_t i) const {
        if (faces.normal(i) > 0 && faces.normal(i - faces.stride[a]) > 0) return false; // most faces
        int stresses = 0;
        faces.each_stress(a, i, faces.normal, faces.shear, [&](double w) { stresses += static_cast<int>(w > 0); });
        return stresses == 1 && free(a, i);
    }
    // The loose face in a stress with the least mass; false: there is none.
    KOKKOS_INLINE_FUNCTION bool gives_way(const Stress& stress, FaceAt& found) const {
        double least = -1;
        each_face(stress, [&](const FaceAt& face) {
            if (!loose(face.axis, face.at)) return;
            const double mass = faces.mass.axis[face.axis](face.at) / (face.pull * face.pull);
            if (least >= 0 && !(mass < least)) return;
            least = mass;
            found = face;
        });
        return least >= 0;
    }
    // The mechanism of face (a, i).
    KOKKOS_INLINE_FUNCTION bool find(int a, std::ptrdiff_t i, Mechanisms::Motion& motion) const {
        if (!free(a, i)) return false;
        const double fraction = faces.fraction.axis[a](i);
        double mass = faces.mass.axis[a](i), stiff = mass;
        int members = 1;
        bool moves = true;
        each_stress(a, i, [&](const Stress& stress) {
            if (!moves || !(stress.weight > 0)) return;
            FaceAt other{};
            moves = gives_way(stress, other) && !(other.axis == a && other.at == i);
            if (!moves) return;
            const double part = -stress.sign * fraction / other.pull, own = faces.mass.axis[other.axis](other.at);
            motion.row[members] = row_of[other.axis](other.at);
            motion.part[members] = part;
            ++members;
            mass += part * part * own;
            stiff +=
                fraction * fraction * stress.weight + part * part * (own + other.pull * other.pull * stress.weight);
        });
        if (!moves || members == 1 || mass > most_resistance * stiff || mass < least_resistance * stiff) return false;
        motion.row[0] = row_of[a](i);
        motion.part[0] = 1;
        motion.inverse = 1 / mass;
        for (int k = members; k < Mechanisms::most_members; ++k) motion.row[k] = -1;
        return true;
    }
    KOKKOS_INLINE_FUNCTION void operator()(int n, int& sum, bool last) const {
        int c[3];
        cells.cell(n, c);
        const std::ptrdiff_t i = faces.window.index(c[0], c[1], c[2]);
        for (int a = 0; a < faces.dimensions; ++a) {
            Mechanisms::Motion motion;
            if (!find(a, i, motion)) continue;
            bool here = false;
            for (int k = 0; k < Mechanisms::most_members; ++k) {
                here = here || (motion.row[k] >= first && motion.row[k] < first + rows);
            }
            if (!here) continue;
            if (last && sum < static_cast<int>(out.extent(0))) out(sum) = motion;
            ++sum;
        }
    }
};
} // namespace

// Members by their rows: what is not of this rank comes from the halo.
void Mechanisms::connect(const Comm& comm, std::int64_t first_row) {
    const auto is_own = [&](int row) { return row >= 0 && row < rows_; };
    std::vector<int> others;
    for (const auto& member : members_) {
        if (!is_own(member.column)) others.push_back(member.column + static_cast<int>(first_row));
    }
    std::sort(others.begin(), others.end());
    others.erase(std::unique(others.begin(), others.end()), others.end());
    for (auto& member : members_) {
        if (is_own(member.column)) continue;
        const auto at = std::lower_bound(others.begin(), others.end(), member.column + static_cast<int>(first_row));
        member.column = rows_ + static_cast<int>(at - others.begin());
    }
    shared_ = comm.sum(static_cast<std::int64_t>(others.size())) > 0;
    if (shared_) halo_.connect(comm, first_row, others);
}

void Mechanisms::build(const Comm& comm, const ViscousFaces& faces, const ViscousSystem& system, const CellBox& owned) {
    rows_ = system.faces();
    const int first_row = static_cast<int>(system.first_row());
    MechanismLoop loop{faces, grown(owned, owned.empty() ? 0 : 1, faces.dimensions), {}, first_row, rows_, found_};
    for (int a = 0; a < faces.dimensions; ++a) loop.row_of[a] = system.row_of(a);
    const int n = static_cast<int>(loop.cells.size());
    int found = 0;
    Kokkos::parallel_scan("treacle::find_mechanisms", n, loop, found);
    if (static_cast<std::size_t>(found) > found_.extent(0)) { // the room of the step before does not do
        reserve(found_, static_cast<std::size_t>(found));
        loop.out = found_;
        Kokkos::parallel_scan("treacle::find_mechanisms", n, loop, found);
    }
    const auto motions = on_host(found_);
    members_.clear();
    first_.assign(1, 0);
    inverse_.clear();
    for (std::size_t m = 0; m < static_cast<std::size_t>(found); ++m) {
        for (int k = 0; k < most_members && motions(m).row[k] >= 0; ++k) {
            members_.push_back({motions(m).row[k] - first_row, motions(m).part[k]});
        }
        first_.push_back(members_.size());
        inverse_.push_back(motions(m).inverse);
    }
    std::int64_t own = 0;
    for (std::size_t m = 0; m < inverse_.size(); ++m) {
        const int face = members_[first_[m]].column;
        own += std::int64_t{face >= 0 && face < rows_};
    }
    count_ = comm.sum(own);
    connect(comm, first_row);
    strength_.assign(shared_ ? static_cast<std::size_t>(system.rows()) : 0, 0.0);
}

// The rank of a mechanism's face finds its strength v^T r/(v^T M/dt v), those of the other faces request it.
void Mechanisms::add(std::span<const double> r, std::span<double> z) {
    const auto rows = static_cast<std::size_t>(rows_);
    std::span<const double> around;
    const auto value = [&](std::span<const double> own, std::size_t column) {
        return column < rows ? own[column] : around[column - rows];
    };
    const auto push = [&](std::size_t m, double strength) {
        for (std::size_t k = first_[m]; k < first_[m + 1]; ++k) {
            if (members_[k].column < rows_)
                z[static_cast<std::size_t>(members_[k].column)] += members_[k].part * strength;
        }
    };
    if (shared_) around = halo_.gather(r);
    for (std::size_t m = 0; m < inverse_.size(); ++m) {
        const auto face = static_cast<std::size_t>(members_[first_[m]].column);
        if (face >= rows) continue;
        double sum = 0;
        for (std::size_t k = first_[m]; k < first_[m + 1]; ++k) {
            sum += members_[k].part * value(r, static_cast<std::size_t>(members_[k].column));
        }
        push(m, inverse_[m] * sum);
        if (shared_) strength_[face] = inverse_[m] * sum;
    }
    if (!shared_) return;
    around = halo_.gather(strength_);
    for (std::size_t m = 0; m < inverse_.size(); ++m) {
        const auto face = static_cast<std::size_t>(members_[first_[m]].column);
        if (face >= rows) push(m, around[face - rows]);
    }
}

void Mechanisms::mark(std::span<unsigned char> rows) const {
    for (const auto& member : members_) {
        if (member.column < rows_) rows[static_cast<std::size_t>(member.column)] = 1;
    }
}

std::size_t Mechanisms::bytes() const {
    return members_.capacity() * sizeof(Member) + 8 * (first_.capacity() + inverse_.capacity() + strength_.capacity()) +
           found_.span() * sizeof(Motion) + halo_.bytes();
}

} // namespace treacle::grid
