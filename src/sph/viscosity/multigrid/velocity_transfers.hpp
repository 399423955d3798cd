#pragma once
#include "sph/viscosity/multigrid/velocity_cells.hpp"
#include "sph/viscosity/operator/viscous_operator.hpp"

// Between the levels of velocity cells, and between particles and the finest.
namespace treacle::sph {

// Fraction of the cycle, beside the particles' own blocks, which do a part of its work as well.
inline constexpr float cycle_weight = 0.8f;

constexpr int power_of_3(int d) { return d == 0 ? 1 : 3 * power_of_3(d - 1); } // nodes of the finer level around a node

// r of a level from that of the finer one: each of its nodes counts on the first rank that has it.
template <int D>
struct Restrict {
    Array<int> children;              // [nodes][3^D] of the finer level, -1: none
    Array<float> first, fine, coarse; // [fine] 1 on the first rank that has the node, else 0; [fine][4], [nodes][4]

    KOKKOS_INLINE_FUNCTION void operator()(int v) const {
        constexpr int family = power_of_3(D);
        Float4 sum = 0.0f;
        for (int c = 0; c < family; ++c) {
            const int child = children(family * v + c);
            if (child < 0) continue;
            float weight = first(child);
            for (int rest = c, k = 0; k < D; ++k, rest /= 3) weight *= rest % 3 == 1 ? 1.0f : 0.5f;
            sum.add(Float4(weight), Float4::load(fine.data() + 4 * std::int64_t(child)));
        }
        sum.store(coarse.data() + 4 * std::int64_t(v));
    }
};

// d = what the parents' z are at this level's nodes; z += d.
template <int D>
struct Prolong {
    Array<int> parents;                // [nodes][corners] of the coarser level, -1: none
    Array<float> weight, coarse, d, z; // [nodes], [coarser nodes][4], [nodes][4], [nodes][4]

    KOKKOS_INLINE_FUNCTION void operator()(int v) const {
        const std::int64_t at = 4 * std::int64_t(v);
        Float4 sum = 0.0f;
        for (int c = 0; c < corners<D>; ++c) {
            const int parent = parents(corners<D> * v + c);
            if (parent >= 0) sum = sum + Float4::load(coarse.data() + 4 * std::int64_t(parent));
        }
        sum = Float4(weight(v)) * sum;
        sum.store(d.data() + at);
        (sum + Float4::load(z.data() + at)).store(z.data() + at);
    }
};

// The particles of each cell, one cell after the other, with the shares that its corners have in their velocities.
struct CellParticles {
    // Indices [cells + 1]; [particles].
    Array<int> begin{"treacle::velocity_begin", 0}, particle{"treacle::velocity_particles", 0};
    Array<float> weight{"treacle::velocity_weights", 0}; // [particles][corners]
};

// Weights of a cell's corners at a position in the cell, from 0 to 1 along each axis.
template <int D>
void trilinear_weights(const double at[3], float weight[corners<D>]) {
    weight[0] = 1;
    for (int k = 0; k < D; ++k) {
        for (int a = 0; a < 1 << k; ++a) {
            weight[a + (1 << k)] = weight[a] * static_cast<float>(at[k]);
            weight[a] *= static_cast<float>(1 - at[k]);
        }
    }
}

// Forces on the corners of each cell that stand for those on its particles.
template <int D>
struct ParticleForces {
    CellParticles members;
    Array3 r;           // [owned][3] residual of the particles
    Array<float> force; // [cells][corners][4]

    KOKKOS_INLINE_FUNCTION void operator()(int e) const {
        Float4 sum[corners<D>];
        for (int a = 0; a < corners<D>; ++a) sum[a] = 0.0f;
        for (int m = members.begin(e); m < members.begin(e + 1); ++m) {
            const float* weight = members.weight.data() + corners<D> * std::int64_t(m);
            const int i = members.particle(m);
            const Float4 on =
                Float4::of(static_cast<float>(r(i, 0)), static_cast<float>(r(i, 1)), static_cast<float>(r(i, 2)));
            for (int a = 0; a < corners<D>; ++a) sum[a].add(Float4(weight[a]), on);
        }
        float* to = force.data() + 4 * corners<D> * std::int64_t(e);
        for (int a = 0; a < corners<D>; ++a) sum[a].store(to + 4 * a);
    }
};

// z = B r + what the corners' velocities are at each particle; r.z.
template <int D>
struct ParticleVelocities {
    CellParticles members;
    Array<int> corner; // [cells][corners] nodes
    Array<float> u;    // [nodes][4]
    ViscousOperator::Blocks block;
    Array3 r, z; // [owned][3]

    KOKKOS_INLINE_FUNCTION void operator()(int e, double& sum) const {
        Float4 around[corners<D>];
        double product = 0;
        for (int a = 0; a < corners<D>; ++a)
            around[a] = Float4::load(u.data() + 4 * std::int64_t(corner(corners<D> * e + a)));
        for (int m = members.begin(e); m < members.begin(e + 1); ++m) {
            const float* weight = members.weight.data() + corners<D> * std::int64_t(m);
            const int i = members.particle(m);
            Float4 even = 0.0f, odd = 0.0f; // two, since each addition depends on the one before
            for (int a = 0; a < corners<D>; a += 2) {
                even.add(Float4(weight[a]), around[a]);
                odd.add(Float4(weight[a + 1]), around[a + 1]);
            }
            float mean[4];
            (Float4(cycle_weight) * (even + odd)).store(mean);
            const double from[3] = {r(i, 0), r(i, 1), r(i, 2)};
            double to[3];
            read_symmetric(block, i).times(from, to);
            for (int k = 0; k < 3; ++k) {
                to[k] += static_cast<double>(mean[k]);
                z(i, k) = to[k];
                product += from[k] * to[k];
            }
        }
        sum += product;
    }
};

} // namespace treacle::sph
