#include "sph/pressure/components.hpp"

#include "sph/pressure/laplacian.hpp"

#include <map>
#include <vector>

namespace treacle::sph {

namespace {
// A wall term below this share of the diagonal leaves the system nearly singular: it is no anchor.
constexpr double least_anchor = 1e-3;
// Nor are Dirichlet neighbours whose a_ij add up to less than this share: a component that hangs on one neighbour at
// the rim of its support would get pressures a thousand times too large. The nearest neighbour of a particle inside
// the liquid has a share of 0.07.
constexpr double least_link = 0.05;

// Lock-free union-find (Jaiganesh & Burtscher 2018): roots only ever hook to smaller roots, so that the root
// of a component is its least member whatever the order of the threads.
struct Forest {
    Array<int> parent;

    KOKKOS_INLINE_FUNCTION int find(int i) const {
        int up = parent(i);
        while (up != i) {
            const int next = parent(up);
            parent(i) = next; // path halving
            i = up;
            up = next;
        }
        return i;
    }
    KOKKOS_INLINE_FUNCTION void join(int i, int j) const {
        int a = find(i), b = find(j);
        while (a != b) {
            const int high = math::max(a, b), low = math::min(a, b);
            const int seen = Kokkos::atomic_compare_exchange(&parent(high), high, low);
            if (seen == high) return;
            a = find(seen);
            b = low;
        }
    }
};

template <class Kernel, class Liquids>
struct JoinLoop {
    LaplacianWeight<Kernel> laplacian;
    Liquids liquids;
    Pairs pairs;
    Forest forest; // parents of Poisson particles, -1 for all others, ghosts included
    Array<double> wall, diagonal;
    Array<int> has_datum;

    KOKKOS_INLINE_FUNCTION double weight(int i, int j) const {
        const auto& x = pairs.of;
        const double dx = x(i, 0) - x(j, 0), dy = x(i, 1) - x(j, 1), dz = x(i, 2) - x(j, 2);
        const double r2 = dx * dx + dy * dy + dz * dz;
        return laplacian.weight(laplacian.volume(i) + laplacian.volume(j), r2, math::sqrt(r2)) *
               liquids.inverse_density(i, j);
    }
    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        const auto& parent = forest.parent;
        if (parent(i) < 0) return;
        const double needed = least_link * diagonal(i);
        double dirichlet_sum = wall(i) > least_anchor * diagonal(i) ? needed : 0;
        const int count = pairs.count(i);
        const int* around = pairs.index.data() + pairs.offset(i);
        int previous = -1; // neighbours follow one another in their cells: most have just been joined
        for (int k = 0; k < count; k += lanes) {
            const SimdInt index = load_ints(around + k), up = gather_ints(parent.data(), index);
            const unsigned all = first_bits(count - k);
            const unsigned fixed = all & bits_below(up, 0);
            for (unsigned left = fixed; left != 0 && dirichlet_sum < needed; left &= left - 1) {
                dirichlet_sum += weight(i, around[k + lowest_bit(left)]);
            }
            unsigned apart = all & ~fixed & bits_below(index, i) & ~bits_equal(up, previous);
            for (; apart != 0; apart &= apart - 1) {
                const int j = around[k + lowest_bit(apart)], above = parent(j);
                if (above == previous) continue;
                forest.join(i, j);
                previous = above;
            }
        }
        has_datum(i) = static_cast<int>(dirichlet_sum >= needed);
    }
};
} // namespace

std::int64_t PressurePinning::label(const SphOptions& options, const Constants& constants,
    const LiquidParticles& liquid, const Neighbourhood& neighbours) {
    const int n = liquid.store.owned();
    reserve(root_, static_cast<std::size_t>(liquid.store.total()));
    reserve(has_datum_, static_cast<std::size_t>(n));
    const auto root = root_, has_datum = has_datum_;
    const auto role = liquid.role();
    const Forest forest{root_};
    Kokkos::parallel_for(
        "treacle::start_components", liquid.store.total(), KOKKOS_LAMBDA(int i) {
            root(i) = role(i) == Role::poisson ? i : -1;
            if (i < n) has_datum(i) = 0;
        });
    with_kernel(options.kernel, constants.dimensions, constants.support, [&](const auto& kernel) {
        using Kernel = std::decay_t<decltype(kernel)>;
        with_liquids(constants.immiscible, liquid.liquid(), 0, [&](const auto& liquids) {
            using Liquids = std::decay_t<decltype(liquids)>;
            Kokkos::parallel_for("treacle::join_components", n,
                JoinLoop<Kernel, Liquids>{laplacian_weight(kernel, constants, liquid), liquids,
                    pairs(neighbours.liquid, liquid.store, liquid.store), forest, liquid.wall_term(), liquid.diagonal(),
                    has_datum_});
        });
    });
    Kokkos::parallel_for(
        "treacle::flatten_components", n, KOKKOS_LAMBDA(int i) {
            if (role(i) != Role::poisson) return;
            root(i) = forest.find(i);
            if (has_datum(i) == 1) Kokkos::atomic_exchange(&has_datum(root(i)), 1);
        });
    int loose = 0;
    Kokkos::parallel_reduce(
        "treacle::count_loose", n,
        KOKKOS_LAMBDA(int i, int& sum) {
            sum += static_cast<int>(role(i) == Role::poisson && root(i) == i && has_datum(i) == 0);
        },
        loose);
    return loose;
}

// Lowers the label of each component to the least of the components that it touches on other ranks.
void PressurePinning::merge_across_ranks(
    const Comm& comm, LiquidParticles& liquid, const Neighbourhood& neighbours, Halo& halo) {
    const int n = liquid.store.owned();
    const int first = static_cast<int>(comm.exclusive_sum(static_cast<std::int64_t>(n)));
    reserve(label_, static_cast<std::size_t>(n));
    const auto root = root_, has_datum = has_datum_, label = label_;
    const auto role = liquid.role(), component = liquid.component();
    const auto offset = neighbours.liquid.offset;
    const auto index = neighbours.liquid.index;
    Kokkos::parallel_for(
        "treacle::start_labels", n, KOKKOS_LAMBDA(int i) { label(i) = has_datum(i) == 1 ? -1 : first + i; });
    for (bool changing = true; changing;) {
        Kokkos::parallel_for(
            "treacle::spread_labels", n, KOKKOS_LAMBDA(int i) {
                if (role(i) == Role::poisson) component(i) = label(root(i));
            });
        halo.gather(liquid.store, {liquid.component_field()});
        int changes = 0;
        Kokkos::parallel_reduce(
            "treacle::merge_labels", n,
            KOKKOS_LAMBDA(int i, int& sum) {
                if (role(i) != Role::poisson || label(root(i)) < 0) return;
                for (std::int64_t k = offset(i); k < offset(i + 1); ++k) {
                    const int j = index(k);
                    if (j < n || role(j) != Role::poisson || component(j) >= label(root(i))) continue;
                    Kokkos::atomic_fetch_min(&label(root(i)), component(j));
                    ++sum;
                }
            },
            changes);
        changing = comm.any(changes > 0);
    }
}

// The particle of least source of each component that is still loose, least id on ties. Candidates of all
// ranks are compared on every rank: one per component and rank, and such components are rare.
std::int64_t PressurePinning::choose_anchors(const Comm& comm, LiquidParticles& liquid) {
    const int n = liquid.store.owned();
    const auto root = on_host(root_);
    const auto label = on_host(label_);
    const auto role = on_host(liquid.role());
    const auto source = on_host(liquid.source());
    const auto id = on_host(liquid.id());
    struct Candidate {
        double source;
        std::int64_t id;
        int index; // -1: of another rank
        bool before(const Candidate& other) const {
            return source != other.source ? source < other.source : id < other.id;
        }
    };
    std::map<std::int64_t, Candidate> best;
    const auto offer = [&](std::int64_t component, const Candidate& candidate) {
        const auto [at, added] = best.emplace(component, candidate);
        if (!added && candidate.before(at->second)) at->second = candidate;
    };
    for (int i = 0; i < n; ++i) {
        if (role(i) != Role::poisson || label(root(i)) < 0) continue;
        offer(label(root(i)), {source(i), id(i), i});
    }
    std::vector<std::int64_t> keys;
    std::vector<double> sources;
    for (const auto& [component, candidate] : best) {
        keys.push_back(component);
        keys.push_back(candidate.id);
        sources.push_back(candidate.source);
    }
    const auto all_keys = comm.all_gather(std::span<const std::int64_t>(keys));
    const auto all_sources = comm.all_gather(std::span<const double>(sources));
    for (std::size_t k = 0; k < all_sources.size(); ++k) {
        if (best.count(all_keys[2 * k]) == 0) continue;
        const auto& own = best.at(all_keys[2 * k]);
        if (own.index < 0 || own.id != all_keys[2 * k + 1])
            offer(all_keys[2 * k], {all_sources[k], all_keys[2 * k + 1], -1});
    }
    std::int64_t chosen = 0;
    for (const auto& [component, candidate] : best) {
        if (candidate.index < 0) continue;
        role(candidate.index) = Role::dirichlet;
        ++chosen;
    }
    Kokkos::deep_copy(liquid.role(), role);
    return chosen;
}

std::int64_t PressurePinning::anchor(const SphOptions& options, const Constants& constants, const Comm& comm,
    LiquidParticles& liquid, const Neighbourhood& neighbours, Halo& halo) {
    std::int64_t all = 0;
    while (comm.any(label(options, constants, liquid, neighbours) > 0)) {
        merge_across_ranks(comm, liquid, neighbours, halo);
        const std::int64_t chosen = choose_anchors(comm, liquid);
        // A component that is loose on this rank may have its datum on another rank; and a new anchor may itself hold too
        // little.
        if (!comm.any(chosen > 0)) break;
        halo.gather(liquid.store, {liquid.role_field()});
        all += chosen;
    }
    return all;
}

} // namespace treacle::sph
