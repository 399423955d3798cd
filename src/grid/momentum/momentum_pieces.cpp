#include "base/disjoint_sets.hpp"
#include "grid/mac/pressure_faces.hpp"
#include "grid/momentum/momentum_balance.hpp"

#include <algorithm>
#include <limits>

// Pieces of liquid and bodies that hang together (M).
namespace treacle::grid {

namespace {
constexpr double least_solid = 1e-9; // share of a face's cube

// True for a body whose motion is prescribed, not a result of its loads.
bool is_constrained(const rigid::RigidBodies& bodies, std::size_t b) {
    const auto& setup = bodies.setup();
    if (!bodies.dynamic(b) || std::ranges::any_of(setup.bodies[b].locked, [](bool is) { return is; })) return true;
    return std::ranges::any_of(
        setup.joints, [b](const auto& joint) { return joint.body == b || joint.other == static_cast<int>(b); });
}

// Place of a label among those found, their number for none of them.
std::size_t index_of(const std::vector<double>& found, double label) {
    return static_cast<std::size_t>(std::ranges::find(found, label) - found.begin());
}
} // namespace

// Connected cells, bodies and what rests on this rank, and the least number in each set over all ranks.
struct MomentumBalance::Labels {
    std::size_t cells;
    DisjointSets sets;
    std::vector<double> label; // [members], of the least member of a set

    Labels(std::size_t of_window, std::size_t bodies) : cells(of_window) { sets.reset(cells + bodies + 1); }
    double of(std::size_t i) { return label[sets.find(i)]; }
    double of_body(std::size_t b) { return of(cells + b); }
    std::size_t rest() const { return sets.size() - 1; } // member that all that rests is
    // Lowers the label of the set of i to `to`; true when it falls.
    bool lower(std::size_t i, double to) {
        auto& mine = label[sets.find(i)];
        const bool falls = to < mine;
        mine = std::min(mine, to);
        return falls;
    }
};

namespace {
void mark_liquid(const MomentumBalance::Scene& scene, const Array<int>& liquid) {
    const CellBox window = scene.halo.window(), owned = scene.halo.owned();
    const CellList cells = scene.cells;
    const auto distance = scene.distance;
    Kokkos::deep_copy(liquid, 0);
    Kokkos::parallel_for(
        "treacle::momentum_liquid", static_cast<int>(owned.size()), KOKKOS_LAMBDA(int n) {
            int c[3];
            owned.cell(n, c);
            const int here = cells.window.index(c[0], c[1], c[2]), at = window.index(c[0], c[1], c[2]);
            liquid(at) = cells.end(here) > cells.begin(here) || distance(at) < 0 ? 1 : 0;
        });
}

// Ways in the window from a cell to those around it, edges and corners too, and to itself.
std::vector<std::ptrdiff_t> ways_around(const PressureFaces& faces, int dimensions) {
    std::vector<std::ptrdiff_t> out;
    const int deep = dimensions == 3 ? 1 : 0;
    for (int z = -deep; z <= deep; ++z) {
        for (int y = -1; y <= 1; ++y) {
            for (int x = -1; x <= 1; ++x)
                out.push_back(x * faces.stride[0] + y * faces.stride[1] + z * faces.stride[2]);
        }
    }
    return out;
}

// Joins cells with liquid whose particles read the same faces.
void join_liquid(const MomentumBalance::Scene& scene, const Array<int>::HostMirror& liquid, DisjointSets& sets) {
    const CellBox window = scene.halo.window(), around = grown(scene.halo.owned(), 1, scene.grid.dimensions);
    const auto ways = ways_around(pressure_faces(window, scene.grid.dimensions), scene.grid.dimensions);
    for (int n = 0; n < around.size(); ++n) {
        int c[3];
        around.cell(n, c);
        const auto i = static_cast<std::size_t>(window.index(c[0], c[1], c[2]));
        if (liquid(i) == 0) continue;
        for (const auto way : ways) {
            const auto next = i + static_cast<std::size_t>(way);
            if (way < 0 && liquid(next) != 0) sets.join(i, next);
        }
    }
}

// Joins cells with liquid to the solids at the faces that their particles read, those of the cells around.
void join_solids(
    const MomentumBalance::Scene& scene, const Array<int>::HostMirror& liquid, std::size_t rest, DisjointSets& sets) {
    const CellBox window = scene.halo.window(), around = grown(scene.halo.owned(), 1, scene.grid.dimensions);
    const auto cells = static_cast<std::size_t>(window.size());
    const auto faces = pressure_faces(window, scene.grid.dimensions);
    const auto& stride = faces.stride;
    const auto ways = ways_around(faces, scene.grid.dimensions);
    const auto join_around = [&](std::size_t face, std::ptrdiff_t along, std::size_t member) {
        for (const auto way : ways) {
            const auto above = face + static_cast<std::size_t>(way);
            for (const auto cell : {above, above - static_cast<std::size_t>(along)}) {
                if (liquid(cell) != 0) sets.join(cell, member);
            }
        }
    };
    for (int a = 0; a < scene.grid.dimensions; ++a) {
        const auto& of = scene.body_fractions[static_cast<std::size_t>(a)];
        const auto fluid = on_host(scene.fluid.axis[a]), fraction = on_host(of.fraction);
        const auto first = on_host(of.first), body = on_host(of.body);
        for (int n = 0; n < around.size(); ++n) {
            int c[3];
            around.cell(n, c);
            const auto i = static_cast<std::size_t>(window.index(c[0], c[1], c[2]));
            double solid = 1 - fluid(i);
            if (!(solid > least_solid)) continue;
            for (int e = first(i); e < first(i + 1); ++e) {
                const auto at = static_cast<std::size_t>(e);
                solid -= fraction(at);
                if (fraction(at) > 0) join_around(i, stride[a], cells + static_cast<std::size_t>(body(at)));
            }
            if (solid > least_solid) join_around(i, stride[a], rest);
        }
    }
}
} // namespace

// Collective: gives each set the least number of its members on all ranks. `liquid`: [window] 1: cells with liquid.
void MomentumBalance::lower_labels(
    const Comm& comm, const Scene& scene, const Array<int>::HostMirror& liquid, Labels& labels) {
    const std::size_t cells = labels.cells, n = labels.sets.size() - cells;
    // Numbers that no two members share but those of a body, and of what rests, on all ranks.
    labels.label.assign(cells + n, std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < cells + n; ++i)
        labels.lower(
            i, i < cells ? LooseLiquid::label_of(comm.rank(), i) : LooseLiquid::label_of(comm.size(), i - cells));
    auto label = Kokkos::create_mirror_view(label_);
    std::vector<double> of_body(n);
    for (bool changed = true; changed;) {
        for (std::size_t i = 0; i < cells; ++i) label(i) = liquid(i) != 0 ? labels.of(i) : -1;
        for (std::size_t b = 0; b < n; ++b) of_body[b] = -labels.of(cells + b);
        Kokkos::deep_copy(label_, label);
        scene.halo.gather({label_});
        const auto others = on_host(label_);
        comm.max(std::span<double>(of_body));
        changed = false;
        for (std::size_t i = 0; i < cells; ++i) {
            if (others(i) >= 0) changed = labels.lower(i, others(i)) || changed;
        }
        for (std::size_t b = 0; b < n; ++b) changed = labels.lower(cells + b, -of_body[b]) || changed;
        changed = comm.any(changed);
    }
}

// Makes a group for each label of a body, in the order of the bodies. Returns these labels.
std::vector<double> MomentumBalance::group_bodies(Labels& labels, const rigid::RigidBodies& bodies) {
    std::vector<double> found;
    groups_.clear();
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        const double of = labels.of_body(b);
        const auto g = index_of(found, of);
        if (g == found.size()) {
            found.push_back(of);
            groups_.emplace_back();
        }
        if (bodies.moves(b)) groups_[g].bodies.push_back(b);
    }
    return found;
}

// Members are the cells of the window, then the bodies, then what rests; on the host, where the sets are.
void MomentumBalance::connect(const Comm& comm, const Scene& scene, const rigid::RigidBodies& bodies) {
    const auto cells = static_cast<std::size_t>(scene.halo.window().size());
    reserve(label_, cells);
    reserve(group_, cells);
    mark_liquid(scene, group_);
    scene.halo.gather({group_});
    const auto liquid = on_host(group_);
    Labels labels(cells, bodies.size());
    if (!scene.halo.owned().empty()) {
        join_liquid(scene, liquid, labels.sets);
        join_solids(scene, liquid, labels.rest(), labels.sets);
    }
    lower_labels(comm, scene, liquid, labels);
    const auto found = group_bodies(labels, bodies);
    const double rest = labels.of(labels.rest());
    std::vector<std::int64_t> wet(groups_.size(), 0); // cells
    std::vector<double> loose(cells, LooseLiquid::none);
    auto group = Kokkos::create_mirror_view(group_);
    for (std::size_t i = 0; i < cells; ++i) {
        const bool is_liquid = liquid(i) != 0; // read first: on a host build both are the same numbers
        group(i) = -1;
        if (!is_liquid) continue;
        const double label = labels.of(i);
        const auto g = index_of(found, label);
        if (g < groups_.size()) {
            group(i) = static_cast<int>(g);
            ++wet[g];
        } else if (label != rest) {
            loose[i] = label;
        }
    }
    Kokkos::deep_copy(group_, group);
    comm.sum(std::span<std::int64_t>(wet));
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        auto& of = groups_[g];
        const auto surface_velocity_only = [&](std::size_t b) {
            return bodies.setup().bodies[b].surface_velocity_only;
        };
        of.balanced = found[g] != rest && wet[g] > 0 && !of.bodies.empty() &&
                      std::ranges::none_of(of.bodies, surface_velocity_only);
        of.free = std::ranges::none_of(of.bodies, [&](std::size_t b) { return is_constrained(bodies, b); });
    }
    loose_.begin(scene, loose);
}

} // namespace treacle::grid
