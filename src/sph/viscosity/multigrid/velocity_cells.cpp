#include "sph/viscosity/multigrid/velocity_cells.hpp"

#include "sph/model/symmetric.hpp"

namespace treacle::sph {

namespace {
// Forces of each cell on its corners.
template <int D>
struct CellForces {
    Element<D> element;
    Array<int> corner;
    Array<float> stiffness, u, force;

    KOKKOS_INLINE_FUNCTION void operator()(int e) const {
        Float4 at[corners<D>];
        const int* corner_of = corner.data() + corners<D> * std::int64_t(e);
        for (int a = 0; a < corners<D>; ++a) at[a] = Float4::load(u.data() + 4 * std::int64_t(corner_of[a]));
        element.apply(at);
        const Float4 c = stiffness(e);
        float* to = force.data() + 4 * corners<D> * std::int64_t(e);
        for (int a = 0; a < corners<D>; ++a) (c * at[a]).store(to + 4 * a);
    }
};

// out = mass u + what the cells around put on each node.
template <int D>
struct NodeSums {
    Array<int> around;
    Array<float> force;
    bool massive;
    Array<float> mass, u, out;

    KOKKOS_INLINE_FUNCTION void operator()(int v) const {
        Float4 sum = massive ? Float4(mass(v)) * Float4::load(u.data() + 4 * std::int64_t(v)) : Float4(0.0f);
        for (int c = 0; c < corners<D>; ++c) {
            const int slot = around(corners<D> * v + c);
            if (slot >= 0) sum = sum + Float4::load(force.data() + 4 * std::int64_t(slot));
        }
        sum.store(out.data() + 4 * std::int64_t(v));
    }
};

// r -= q; d = old d + fresh B r; z += d. The first time there is no q, d or z yet.
struct Smooth {
    bool first;
    float old, fresh;
    Array<float> block, q, r, d, z;

    KOKKOS_INLINE_FUNCTION void operator()(int v) const {
        const std::int64_t at = 4 * std::int64_t(v);
        Float4 left = Float4::load(r.data() + at);
        if (!first) {
            left = left - Float4::load(q.data() + at);
            left.store(r.data() + at);
        }
        const float* b = block.data() + 3 * at;
        Float4 turned = left.all<0>() * Float4::load(b);
        turned.add(left.all<1>(), Float4::load(b + 4));
        turned.add(left.all<2>(), Float4::load(b + 8));
        Float4 step = Float4(fresh) * turned;
        if (!first) step.add(Float4(old), Float4::load(d.data() + at));
        step.store(d.data() + at);
        if (!first) step = step + Float4::load(z.data() + at);
        step.store(z.data() + at);
    }
};

// Key of a corner of a cell on a level of keys.
template <int D>
std::int64_t corner_key(const LatticeShape& shape, const int cell[3], int corner) {
    int node[3] = {cell[0], cell[1], cell[2]};
    for (int k = 0; k < D; ++k) node[k] += corner >> k & 1;
    shape.wrap(node);
    return LatticeKey::pack(node);
}
} // namespace

template <int D>
void VelocityCells<D>::connect(const Comm& comm) {
    constexpr int n = corners<D>;
    cells = static_cast<int>(cell_keys.size());
    node_numbers.clear(2 * cell_keys.size());
    host_corner.resize(cell_keys.size() * n);
    for (std::size_t e = 0; e < cell_keys.size(); ++e) {
        int cell[3];
        LatticeKey::unpack(cell_keys[e], cell);
        for (int a = 0; a < n; ++a)
            host_corner[n * e + static_cast<std::size_t>(a)] = node_numbers.number(corner_key<D>(shape, cell, a));
    }
    nodes = node_numbers.size();
    const auto count = static_cast<std::size_t>(nodes);
    std::vector<int> host_around(count * n, -1);
    for (std::size_t e = 0; e < cell_keys.size(); ++e) {
        for (std::size_t a = 0; a < n; ++a) {
            int* slots = &host_around[n * static_cast<std::size_t>(host_corner[n * e + a])];
            std::size_t free = 0;
            while (slots[free] >= 0) ++free; // a periodic axis of one cell has it on both sides: never more than n
            slots[free] = static_cast<int>(n * e + a);
        }
    }
    assign(corner, host_corner);
    assign(around, host_around);
    shared.connect(comm, node_numbers.keys());
    reserve(force, cell_keys.size() * n * 4);
    for (auto* vector : {&r, &z, &d, &q}) reserve(*vector, count * 4);
}

template <int D>
void VelocityCells<D>::finish(
    const Element<D>& unit, const typename Element<D>::Matrix& matrix, double largest_eigenvalue) {
    element = unit;
    largest = largest_eigenvalue;
    assign(stiffness, host_stiffness);
    assign(mass, host_mass);
    std::vector<float> blocks(host_mass.size() * 12, 0.0f); // columns
    for (std::size_t v = 0; v < host_mass.size(); ++v) {
        for (std::size_t k = 0; k < D; ++k) blocks[12 * v + 5 * k] = host_mass[v];
    }
    float own[corners<D>][D][D];
    for (int a = 0; a < corners<D>; ++a) {
        for (int k = 0; k < D; ++k) {
            for (int l = 0; l < D; ++l) own[a][k][l] = static_cast<float>(matrix(D * a + l, D * a + k));
        }
    }
    for (std::size_t e = 0; e < cell_keys.size(); ++e) {
        for (std::size_t a = 0; a < corners<D>; ++a) {
            float* to = &blocks[12 * static_cast<std::size_t>(host_corner[corners<D> * e + a])];
            for (int k = 0; k < D; ++k) {
                for (int l = 0; l < D; ++l) to[4 * k + l] += host_stiffness[e] * own[a][k][l];
            }
        }
    }
    assign(block, blocks);
    shared.add(block, 12);
    const auto matrices = block;
    Kokkos::parallel_for(
        "treacle::velocity_blocks", nodes, KOKKOS_LAMBDA(int v) {
            float* b = matrices.data() + 12 * std::int64_t(v);
            const double most = math::max(math::max(b[0], b[5]), b[10]);
            if (!(most > 1e-30)) { // nothing holds the node, and nothing pulls at it
                for (int k = 0; k < 12; ++k) b[k] = 0;
                return;
            }
            const double scale = 1 / most;
            const Symmetric inverted = inverse(Symmetric{
                scale * b[0], scale * b[5], D > 2 ? scale * b[10] : 1, scale * b[1], scale * b[2], scale * b[6]});
            const double entries[12] = {inverted.xx, inverted.xy, inverted.xz, 0, inverted.xy, inverted.yy, inverted.yz,
                0, inverted.xz, inverted.yz, D > 2 ? inverted.zz : 0, 0};
            for (int k = 0; k < 12; ++k) b[k] = static_cast<float>(scale * entries[k]);
        });
}

template <int D>
void VelocityCells<D>::multiply() {
    Kokkos::parallel_for("treacle::velocity_forces", cells, CellForces<D>{element, corner, stiffness, d, force});
    Kokkos::parallel_for("treacle::velocity_products", nodes, NodeSums<D>{around, force, true, mass, d, q});
    shared.add(q, 4);
}

template <int D>
void VelocityCells<D>::sum_forces() {
    Kokkos::parallel_for("treacle::velocity_right_hand_sides", nodes, NodeSums<D>{around, force, false, mass, d, r});
    shared.add(r, 4);
}

template <int D>
void VelocityCells<D>::subtract_product() {
    multiply();
    const auto from = r, product = q;
    Kokkos::parallel_for(
        "treacle::velocity_residual", 4 * nodes, KOKKOS_LAMBDA(int k) { from(k) -= product(k); });
}

template <int D>
void VelocityCells<D>::smooth(int steps, double fraction, bool first) {
    const double middle = largest * (1 + fraction) / 2, half = largest * (1 - fraction) / 2, sigma = middle / half;
    double rho = 1 / sigma, old = 0, fresh = 1 / middle;
    for (int k = 0; k < steps; ++k) {
        if (k > 0 || !first) multiply();
        if (k > 0) {
            const double next = 1 / (2 * sigma - rho);
            old = next * rho;
            fresh = 2 * next / half;
            rho = next;
        }
        Kokkos::parallel_for("treacle::velocity_smooth", nodes,
            Smooth{first && k == 0, static_cast<float>(old), static_cast<float>(fresh), block, q, r, d, z});
    }
}

template <int D>
std::size_t VelocityCells<D>::bytes() const {
    std::size_t out = 8 * cell_keys.capacity() + node_numbers.bytes() +
                      4 * (host_stiffness.capacity() + host_mass.capacity() + host_corner.capacity()) + shared.bytes();
    for (const auto* array : {&corner, &around, &parents, &children}) out += 4 * array->span();
    for (const auto* array : {&stiffness, &mass, &block, &force, &r, &z, &d, &q, &parent_weight})
        out += 4 * array->span();
    return out;
}

template struct VelocityCells<2>;
template struct VelocityCells<3>;

} // namespace treacle::sph
