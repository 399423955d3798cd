#pragma once
#include "kokkos/simd.hpp"

namespace treacle {

// Four numbers of one particle that go through one formula together, as a row of an Array4 has them: pair
// sums of vectors and matrices then take a neighbour at a time, without the shuffles that eight neighbours at
// a time cost (simd.hpp).
#if defined(TREACLE_AVX512) || defined(TREACLE_AVX2)
struct Double4 {
    __m256d v;
    Double4() = default;
    Double4(__m256d value) : v(value) {}
    Double4(double value) : v(_mm256_set1_pd(value)) {}
    static Double4 load(const double* row) { return _mm256_load_pd(row); }
    // Three numbers and a 0.
    static Double4 load(const Array3& rows, int row) {
        const double* from = rows.data() + 3 * std::int64_t(row);
#if defined(TREACLE_AVX512)
        return _mm256_maskz_loadu_pd(0x7, from);
#else
        return _mm256_maskload_pd(from, _mm256_setr_epi64x(-1, -1, -1, 0));
#endif
    }
    // Any alignment, unlike load() of a pointer, which takes 32 bytes.
    void store(double* to) const { _mm256_storeu_pd(to, v); }
    friend Double4 operator+(Double4 a, Double4 b) { return _mm256_add_pd(a.v, b.v); }
    friend Double4 operator-(Double4 a, Double4 b) { return _mm256_sub_pd(a.v, b.v); }
    friend Double4 operator*(Double4 a, Double4 b) { return _mm256_mul_pd(a.v, b.v); }
    // this += a b
    void add(Double4 a, Double4 b) {
#if defined(__FMA__)
        v = _mm256_fmadd_pd(a.v, b.v, v);
#else
        v = _mm256_add_pd(v, _mm256_mul_pd(a.v, b.v));
#endif
    }
    // All four are the k-th one.
    template <int k>
    Double4 all() const {
#if defined(TREACLE_AVX512)
        return _mm256_maskz_permutex_pd(0xf, v, k * 0x55);
#else
        return _mm256_permute4x64_pd(v, k * 0x55);
#endif
    }
};

// The same of floats: a vector and a number beside it, or a 0.
struct Float4 {
    __m128 v;
    Float4() = default;
    Float4(__m128 value) : v(value) {}
    Float4(float value) : v(_mm_set1_ps(value)) {}
    static Float4 of(float x, float y, float z) { return _mm_setr_ps(x, y, z, 0.0f); }
    static Float4 load(const float* row) { return _mm_loadu_ps(row); }
    void store(float* row) const { _mm_storeu_ps(row, v); }
    friend Float4 operator+(Float4 a, Float4 b) { return _mm_add_ps(a.v, b.v); }
    friend Float4 operator-(Float4 a, Float4 b) { return _mm_sub_ps(a.v, b.v); }
    friend Float4 operator*(Float4 a, Float4 b) { return _mm_mul_ps(a.v, b.v); }
    // this += a b
    void add(Float4 a, Float4 b) {
#if defined(__FMA__)
        v = _mm_fmadd_ps(a.v, b.v, v);
#else
        v = _mm_add_ps(v, _mm_mul_ps(a.v, b.v));
#endif
    }
    // All four are the k-th one.
    template <int k>
    Float4 all() const {
        return _mm_shuffle_ps(v, v, k * 0x55);
    }
};
#else
// Four numbers of either precision.
template <class T>
struct FourNumbers {
    T v[4];
    FourNumbers() = default;
    KOKKOS_INLINE_FUNCTION FourNumbers(T value) : v{value, value, value, value} {}
    KOKKOS_INLINE_FUNCTION static FourNumbers of(T x, T y, T z) {
        FourNumbers out(0);
        out.v[0] = x, out.v[1] = y, out.v[2] = z;
        return out;
    }
    KOKKOS_INLINE_FUNCTION static FourNumbers load(const T* row) {
        FourNumbers out(0);
        for (int k = 0; k < 4; ++k) out.v[k] = row[k];
        return out;
    }
    KOKKOS_INLINE_FUNCTION static FourNumbers load(const Array3& rows, int row) {
        FourNumbers out(0);
        for (int k = 0; k < 3; ++k) out.v[k] = static_cast<T>(rows(row, k));
        return out;
    }
    KOKKOS_INLINE_FUNCTION void store(T* to) const {
        for (int k = 0; k < 4; ++k) to[k] = v[k];
    }
    KOKKOS_INLINE_FUNCTION friend FourNumbers operator+(const FourNumbers& a, const FourNumbers& b) {
        FourNumbers out(0);
        for (int k = 0; k < 4; ++k) out.v[k] = a.v[k] + b.v[k];
        return out;
    }
    KOKKOS_INLINE_FUNCTION friend FourNumbers operator-(const FourNumbers& a, const FourNumbers& b) {
        FourNumbers out(0);
        for (int k = 0; k < 4; ++k) out.v[k] = a.v[k] - b.v[k];
        return out;
    }
    KOKKOS_INLINE_FUNCTION friend FourNumbers operator*(const FourNumbers& a, const FourNumbers& b) {
        FourNumbers out(0);
        for (int k = 0; k < 4; ++k) out.v[k] = a.v[k] * b.v[k];
        return out;
    }
    KOKKOS_INLINE_FUNCTION void add(const FourNumbers& a, const FourNumbers& b) {
        for (int k = 0; k < 4; ++k) v[k] += a.v[k] * b.v[k];
    }
    template <int k>
    KOKKOS_INLINE_FUNCTION FourNumbers all() const {
        return FourNumbers(v[k]);
    }
};
using Double4 = FourNumbers<double>;
using Float4 = FourNumbers<float>;
#endif

// As many floats as there are lanes.
KOKKOS_INLINE_FUNCTION SimdDouble load_lanes(const float* from) {
#if defined(TREACLE_AVX512)
    return _mm512_maskz_cvtps_pd(0xff, _mm256_loadu_ps(from));
#elif defined(TREACLE_AVX2)
    return _mm256_cvtps_pd(_mm_loadu_ps(from));
#else
    return *from;
#endif
}

// The first n of them as floats; nothing else is written.
KOKKOS_INLINE_FUNCTION void store_floats(SimdDouble x, int n, float* to) {
#if defined(TREACLE_AVX512)
    _mm256_mask_storeu_ps(to, tail_mask(n), _mm512_maskz_cvtpd_ps(0xff, x.v));
#else
    double all[lanes];
    store_lanes(x, all);
    for (int k = 0; k < math::min(n, lanes); ++k) to[k] = static_cast<float>(all[k]);
#endif
}

} // namespace treacle
