#pragma once
#include "kokkos/float4.hpp"

namespace treacle {

// Prefetches the line of the cache that an address is in, whether there is anything at that address or not; on devices
// other threads run during a stall.
KOKKOS_INLINE_FUNCTION void prefetch([[maybe_unused]] const void* address) {
#if !defined(__CUDA_ARCH__) && !defined(__HIP_DEVICE_COMPILE__)
    __builtin_prefetch(address);
#endif
}

// Four quads of four floats that go through one formula together, in one register where there are such: a row of a View of
// sixteen floats. Three vectors and a fourth one fit, each with a number of its own in its last place.
using Array16 = Kokkos::View<float* [16], Kokkos::LayoutRight, Memory>;

// Index of the element (k, l) of a symmetric matrix among six: xx, yy, zz, xy, xz, yz.
KOKKOS_INLINE_FUNCTION constexpr int symmetric_element(int k, int l) { return k == l ? k : k + l + 2; }

// Rows of eight floats: those of such a matrix, and up to two more.
using Array8 = Kokkos::View<float* [8], Kokkos::LayoutRight, Memory>;

#if defined(TREACLE_AVX512)
// Element k of quad q is the float 4 q + k of a row. A float becomes all sixteen; rows need no alignment.
struct Float4x4 {
    __m512 v;
    Float4x4() = default;
    Float4x4(__m512 value) : v(value) {}
    Float4x4(float value) : v(_mm512_set1_ps(value)) {}
    static Float4x4 load(const float* row) { return _mm512_loadu_ps(row); }
    void store(float* row) const { _mm512_storeu_ps(row, v); }
    // But for the last places and the last quad.
    void store_vectors(float* row) const { _mm512_mask_storeu_ps(row, 0x0777, v); }
    friend Float4x4 operator+(Float4x4 a, Float4x4 b) { return _mm512_add_ps(a.v, b.v); }
    friend Float4x4 operator-(Float4x4 a, Float4x4 b) { return _mm512_sub_ps(a.v, b.v); }
    friend Float4x4 operator*(Float4x4 a, Float4x4 b) { return _mm512_mul_ps(a.v, b.v); }
    // this += a b
    void add(Float4x4 a, Float4x4 b) { v = _mm512_fmadd_ps(a.v, b.v, v); }
    // All of each quad are its k-th one.
    template <int k>
    Float4x4 all() const {
        return _mm512_maskz_permute_ps(0xffff, v, k * 0x55);
    }
    // All quads are the q-th one.
    template <int q>
    Float4x4 quad() const {
        return _mm512_maskz_shuffle_f32x4(0xffff, v, v, q * 0x55);
    }
    // But for the last quad 0.
    Float4x4 keep_last_row() const { return _mm512_maskz_mov_ps(0xf000, v); }
    Float4 sum_quads() const {
        const __m256 two = _mm256_add_ps(_mm512_castps512_ps256(v), _mm512_maskz_extractf32x8_ps(0xff, v, 1));
        return _mm_add_ps(_mm256_castps256_ps128(two), _mm256_extractf128_ps(two, 1));
    }
    // Transposes the 3 x 3 elements; the others stay as they are.
    Float4x4 transposed() const {
        const __m512i from = _mm512_setr_epi32(0, 4, 8, 3, 1, 5, 9, 7, 2, 6, 10, 11, 12, 13, 14, 15);
        return _mm512_maskz_permutexvar_ps(0xffff, from, v);
    }
    // All of quad l are the matrix' element (m, l); the last quad is 0. Eight floats are read.
    template <int m>
    static Float4x4 broadcast_elements(const float* matrix) {
        constexpr int x = symmetric_element(m, 0), y = symmetric_element(m, 1), z = symmetric_element(m, 2);
        const __m512i from = _mm512_setr_epi32(x, x, x, x, y, y, y, y, z, z, z, z, 0, 0, 0, 0);
        return _mm512_maskz_permutexvar_ps(0x0fff, from, _mm512_maskz_broadcast_f32x8(0xffff, _mm256_loadu_ps(matrix)));
    }
    // Each quad is the matrix' row m, and 0.
    template <int m>
    static Float4x4 broadcast_row(const double* matrix) {
        constexpr int x = symmetric_element(m, 0), y = symmetric_element(m, 1), z = symmetric_element(m, 2);
        const __m512i from = _mm512_setr_epi32(x, y, z, 6, x, y, z, 6, x, y, z, 6, x, y, z, 6);
        const __m256 six = _mm512_maskz_cvtpd_ps(0xff, _mm512_maskz_loadu_pd(0x3f, matrix));
        return _mm512_maskz_permutexvar_ps(0xffff, from, _mm512_maskz_broadcast_f32x8(0xffff, six));
    }
};
#else
// Element k of quad q is v[4 q + k]. The operations give what those of AVX-512 above do, with no fused product.
struct Float4x4 {
    float v[16]; // [quads][4]
    Float4x4() = default;
    KOKKOS_INLINE_FUNCTION Float4x4(float value) {
        for (float& one : v) one = value;
    }
    KOKKOS_INLINE_FUNCTION static Float4x4 load(const float* row) {
        Float4x4 out;
        for (int k = 0; k < 16; ++k) out.v[k] = row[k];
        return out;
    }
    KOKKOS_INLINE_FUNCTION void store(float* row) const {
        for (int k = 0; k < 16; ++k) row[k] = v[k];
    }
    KOKKOS_INLINE_FUNCTION void store_vectors(float* row) const {
        for (int k = 0; k < 12; ++k) {
            if (k % 4 < 3) row[k] = v[k];
        }
    }
    KOKKOS_INLINE_FUNCTION friend Float4x4 operator+(const Float4x4& a, const Float4x4& b) {
        Float4x4 out;
        for (int k = 0; k < 16; ++k) out.v[k] = a.v[k] + b.v[k];
        return out;
    }
    KOKKOS_INLINE_FUNCTION friend Float4x4 operator-(const Float4x4& a, const Float4x4& b) {
        Float4x4 out;
        for (int k = 0; k < 16; ++k) out.v[k] = a.v[k] - b.v[k];
        return out;
    }
    KOKKOS_INLINE_FUNCTION friend Float4x4 operator*(const Float4x4& a, const Float4x4& b) {
        Float4x4 out;
        for (int k = 0; k < 16; ++k) out.v[k] = a.v[k] * b.v[k];
        return out;
    }
    KOKKOS_INLINE_FUNCTION void add(const Float4x4& a, const Float4x4& b) {
        for (int k = 0; k < 16; ++k) v[k] += a.v[k] * b.v[k];
    }
    template <int k>
    KOKKOS_INLINE_FUNCTION Float4x4 all() const {
        Float4x4 out;
        for (int l = 0; l < 16; ++l) out.v[l] = v[l / 4 * 4 + k];
        return out;
    }
    template <int q>
    KOKKOS_INLINE_FUNCTION Float4x4 quad() const {
        Float4x4 out;
        for (int l = 0; l < 16; ++l) out.v[l] = v[4 * q + l % 4];
        return out;
    }
    KOKKOS_INLINE_FUNCTION Float4x4 keep_last_row() const {
        Float4x4 out(0.0f);
        for (int l = 12; l < 16; ++l) out.v[l] = v[l];
        return out;
    }
    KOKKOS_INLINE_FUNCTION Float4 sum_quads() const {
        return (Float4::load(v) + Float4::load(v + 4)) + (Float4::load(v + 8) + Float4::load(v + 12));
    }
    KOKKOS_INLINE_FUNCTION Float4x4 transposed() const {
        Float4x4 out = *this;
        for (int k = 0; k < 3; ++k) {
            for (int l = 0; l < 3; ++l) out.v[4 * l + k] = v[4 * k + l];
        }
        return out;
    }
    template <int m>
    KOKKOS_INLINE_FUNCTION static Float4x4 broadcast_elements(const float* matrix) {
        Float4x4 out(0.0f);
        for (int l = 0; l < 12; ++l) out.v[l] = matrix[symmetric_element(m, l / 4)];
        return out;
    }
    template <int m>
    KOKKOS_INLINE_FUNCTION static Float4x4 broadcast_row(const double* matrix) {
        Float4x4 out(0.0f);
        for (int l = 0; l < 16; ++l) {
            if (l % 4 < 3) out.v[l] = static_cast<float>(matrix[symmetric_element(m, l % 4)]);
        }
        return out;
    }
};
#endif

} // namespace treacle
