#pragma once
#include "kokkos/lanes.hpp"

namespace treacle {

// Four floats that go through one formula together: a vector and a number beside it, or a 0. Rows of four start at multiples
// of 16 bytes.
#if defined(TREACLE_AVX512) || defined(TREACLE_AVX2)
struct Four {
    __m128 v;
    Four() = default;
    Four(__m128 value) : v(value) {}
    Four(float value) : v(_mm_set1_ps(value)) {}
    static Four of(float x, float y, float z) { return _mm_setr_ps(x, y, z, 0.0f); }
    static Four load(const float* row) { return _mm_loadu_ps(row); }
    void store(float* row) const { _mm_storeu_ps(row, v); }
    friend Four operator+(Four a, Four b) { return _mm_add_ps(a.v, b.v); }
    friend Four operator-(Four a, Four b) { return _mm_sub_ps(a.v, b.v); }
    friend Four operator*(Four a, Four b) { return _mm_mul_ps(a.v, b.v); }
    // this += a b
    void add(Four a, Four b) {
#if defined(__FMA__)
        v = _mm_fmadd_ps(a.v, b.v, v);
#else
        v = _mm_add_ps(v, _mm_mul_ps(a.v, b.v));
#endif
    }
    // All four are the k-th one.
    template <int k>
    Four all() const {
        return _mm_shuffle_ps(v, v, k * 0x55);
    }
};
#else
struct Four {
    float v[4];
    Four() = default;
    KOKKOS_INLINE_FUNCTION Four(float value) : v{value, value, value, value} {}
    KOKKOS_INLINE_FUNCTION static Four of(float x, float y, float z) {
        Four out(0.0f);
        out.v[0] = x, out.v[1] = y, out.v[2] = z;
        return out;
    }
    KOKKOS_INLINE_FUNCTION static Four load(const float* row) {
        Four out(0.0f);
        for (int k = 0; k < 4; ++k) out.v[k] = row[k];
        return out;
    }
    KOKKOS_INLINE_FUNCTION void store(float* row) const {
        for (int k = 0; k < 4; ++k) row[k] = v[k];
    }
    KOKKOS_INLINE_FUNCTION friend Four operator+(const Four& a, const Four& b) {
        Four out(0.0f);
        for (int k = 0; k < 4; ++k) out.v[k] = a.v[k] + b.v[k];
        return out;
    }
    KOKKOS_INLINE_FUNCTION friend Four operator-(const Four& a, const Four& b) {
        Four out(0.0f);
        for (int k = 0; k < 4; ++k) out.v[k] = a.v[k] - b.v[k];
        return out;
    }
    KOKKOS_INLINE_FUNCTION friend Four operator*(const Four& a, const Four& b) {
        Four out(0.0f);
        for (int k = 0; k < 4; ++k) out.v[k] = a.v[k] * b.v[k];
        return out;
    }
    KOKKOS_INLINE_FUNCTION void add(const Four& a, const Four& b) {
        for (int k = 0; k < 4; ++k) v[k] += a.v[k] * b.v[k];
    }
    template <int k>
    KOKKOS_INLINE_FUNCTION Four all() const {
        return Four(v[k]);
    }
};
#endif

} // namespace treacle
