#pragma once
#include "kokkos/lanes.hpp"

namespace treacle {

// Four numbers of one particle that go through one formula together, as a row of an Array4 has them: pair
// sums of vectors and matrices then take a neighbour at a time, without the shuffles that eight neighbours at
// a time cost (lanes.hpp).
#if defined(TREACLE_AVX512) || defined(TREACLE_AVX2)
struct Quad {
    __m256d v;
    Quad() = default;
    Quad(__m256d value) : v(value) {}
    Quad(double value) : v(_mm256_set1_pd(value)) {}
    static Quad load(const double* row) { return _mm256_load_pd(row); }
    // Three numbers and a 0.
    static Quad load(const Array3& rows, int row) {
        const double* from = rows.data() + 3 * std::int64_t(row);
#if defined(TREACLE_AVX512)
        return _mm256_maskz_loadu_pd(0x7, from);
#else
        return _mm256_maskload_pd(from, _mm256_setr_epi64x(-1, -1, -1, 0));
#endif
    }
    void store(double* to) const { _mm256_storeu_pd(to, v); }
    friend Quad operator-(Quad a, Quad b) { return _mm256_sub_pd(a.v, b.v); }
    friend Quad operator*(Quad a, Quad b) { return _mm256_mul_pd(a.v, b.v); }
    // this += a b
    void add(Quad a, Quad b) {
#if defined(__FMA__)
        v = _mm256_fmadd_pd(a.v, b.v, v);
#else
        v = _mm256_add_pd(v, _mm256_mul_pd(a.v, b.v));
#endif
    }
    // All four are the k-th one.
    template <int k>
    Quad all() const {
#if defined(TREACLE_AVX512)
        return _mm256_maskz_permutex_pd(0xf, v, k * 0x55);
#else
        return _mm256_permute4x64_pd(v, k * 0x55);
#endif
    }
};
#else
struct Quad {
    double v[4];
    Quad() = default;
    KOKKOS_INLINE_FUNCTION Quad(double value) : v{value, value, value, value} {}
    KOKKOS_INLINE_FUNCTION static Quad load(const double* row) {
        Quad out(0.0);
        for (int k = 0; k < 4; ++k) out.v[k] = row[k];
        return out;
    }
    KOKKOS_INLINE_FUNCTION static Quad load(const Array3& rows, int row) {
        Quad out(0.0);
        for (int k = 0; k < 3; ++k) out.v[k] = rows(row, k);
        return out;
    }
    KOKKOS_INLINE_FUNCTION void store(double* to) const {
        for (int k = 0; k < 4; ++k) to[k] = v[k];
    }
    KOKKOS_INLINE_FUNCTION friend Quad operator-(const Quad& a, const Quad& b) {
        Quad out(0.0);
        for (int k = 0; k < 4; ++k) out.v[k] = a.v[k] - b.v[k];
        return out;
    }
    KOKKOS_INLINE_FUNCTION friend Quad operator*(const Quad& a, const Quad& b) {
        Quad out(0.0);
        for (int k = 0; k < 4; ++k) out.v[k] = a.v[k] * b.v[k];
        return out;
    }
    KOKKOS_INLINE_FUNCTION void add(const Quad& a, const Quad& b) {
        for (int k = 0; k < 4; ++k) v[k] += a.v[k] * b.v[k];
    }
    template <int k>
    KOKKOS_INLINE_FUNCTION Quad all() const {
        return Quad(v[k]);
    }
};
#endif

// As many floats as there are lanes.
KOKKOS_INLINE_FUNCTION Lanes load_lanes(const float* from) {
#if defined(TREACLE_AVX512)
    return _mm512_maskz_cvtps_pd(0xff, _mm256_loadu_ps(from));
#elif defined(TREACLE_AVX2)
    return _mm256_cvtps_pd(_mm_loadu_ps(from));
#else
    return *from;
#endif
}

} // namespace treacle
