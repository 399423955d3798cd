#include "sph/viscosity/operator/near_pairs.hpp"

#include "kokkos/scan.hpp"

#include <algorithm>

namespace treacle::sph {

namespace {
// The near ones of the liquid around particle i, whose places are where pair sums read them: how many, which leaves a bit for
// each, and then which.
struct NearLiquid {
    Pairs from;
    Array4 packed_position;
    double square;             // of the support [m2]
    Array<std::uint8_t> masks; // of the pairs of the list that go through the formula together

    KOKKOS_INLINE_FUNCTION int count(int i) const {
        const Row row = from.row(i, packed_position);
        std::uint8_t* mask = masks_of(i);
        int out = 0;
        for (int k = 0; k < row.count; k += lanes, ++mask) {
            const unsigned bits = to_bitmask(row.near(k).r2 < SimdDouble(square)) & first_bits(row.count - k);
            *mask = static_cast<std::uint8_t>(bits);
            out += count_bits(bits);
        }
        return out;
    }
    KOKKOS_INLINE_FUNCTION void write(int i, int* to) const {
        const Row row = from.row(i, packed_position);
        const std::uint8_t* mask = masks_of(i);
        for (int k = 0; k < row.count; k += lanes, ++mask) to += compress_store(*mask, load_ints(row.index + k), to);
    }
    // Rows begin with masks of their own.
    static std::int64_t count_masks(std::int64_t pairs, int rows) { return pairs / lanes + rows; }

private:
    KOKKOS_INLINE_FUNCTION std::uint8_t* masks_of(int i) const { return masks.data() + from.offset(i) / lanes + i; }
};

// And of the solids, which are few.
struct NearSolids {
    Pairs from;
    double square;

    KOKKOS_INLINE_FUNCTION int count(int i) const {
        int out = 0;
        from.each(i, [&](int, double, double, double, double r2) { out += r2 < square ? 1 : 0; });
        return out;
    }
    KOKKOS_INLINE_FUNCTION void write(int i, int* to) const {
        from.each(i, [&](int j, double, double, double, double r2) {
            if (r2 < square) *to++ = j;
        });
    }
};

template <class Near>
void keep(const Near& from, int n, NeighbourList& near) {
    reserve(near.offset, static_cast<std::size_t>(n) + 1);
    const auto offset = near.offset;
    Kokkos::parallel_for(
        "treacle::count_near_pairs", n, KOKKOS_LAMBDA(int i) { offset(i) = from.count(i); });
    near.size = counts_to_offsets(offset, n);
    reserve(near.index, static_cast<std::size_t>(near.size) + NeighbourList::padding);
    const auto index = near.index;
    Kokkos::parallel_for(
        "treacle::write_near_pairs", n, KOKKOS_LAMBDA(int i) { from.write(i, index.data() + offset(i)); });
    const auto entries = near.size;
    Kokkos::parallel_for(
        "treacle::pad_near_pairs", NeighbourList::padding, KOKKOS_LAMBDA(int k) { index(entries + k) = 0; });
}
} // namespace

double viscous_support(const SphOptions& options, double spacing) {
    const double ratio = options.viscosity.form == ViscosityForm::corrected
                             ? std::min(options.viscosity.support_ratio, options.support_ratio)
                             : options.support_ratio;
    return ratio * spacing;
}

ViscousScene NearPairs::among(const ViscousScene& scene) {
    const double support = viscous_support(scene.options, scene.constants.spacing);
    if (support >= scene.constants.support) return scene;
    constants_ = scene.constants;
    constants_.support = support;
    const auto& liquid = scene.liquid.store;
    const int n = liquid.owned();
    pack_positions(scene.liquid, scene.liquid.volume());
    reserve(masks_, static_cast<std::size_t>(NearLiquid::count_masks(scene.neighbours.liquid.size, n)));
    keep(NearLiquid{pairs(scene.neighbours.liquid, liquid, liquid), scene.liquid.packed_position, support * support,
             masks_},
        n, near_.liquid);
    keep(NearSolids{pairs(scene.neighbours.solid, liquid, scene.solid.store), support * support}, n, near_.solid);
    return {{scene.options, constants_, scene.comm, scene.liquid, scene.solid, near_, scene.halo, scene.cells},
        scene.forces, scene.solid_halo};
}

std::size_t NearPairs::bytes() const { return near_.liquid.bytes() + near_.solid.bytes() + masks_.span(); }

} // namespace treacle::sph
