#pragma once
#include "kokkos/float4x4.hpp"

namespace treacle {

// Sum over rows of eight floats, each a vector x, a number s, a vector u and a 0: over the pairs of row i with `count`
// rows j of w [x_i - x_j, -(s_i + s_j)] [u_i - u_j, 1]^T. Quad l of it has the l-th number on the left times those on
// the right. Up to three entries of `index` beyond the count are read.
#if defined(TREACLE_AVX512)
// Four pairs at a time, a quad each.
inline Float4x4 sum_pair_products(const float* rows, int i, const int* index, const float* weights, int count) {
    const auto row = [&](int j) { return _mm256_loadu_ps(rows + 8 * std::int64_t(j)); };
    const __m256 turn =
        _mm256_castsi256_ps(_mm256_setr_epi32(0, 0, 0, static_cast<int>(0x80000000), 0, 0, 0, 0x3f800000)); // -s, 1
    const __m512 own = _mm512_maskz_broadcast_f32x8(0xffff, _mm256_xor_ps(row(i), turn));
    const __m512i stretched = _mm512_setr_epi32(0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3);
    __m512 sum[4] = {_mm512_setzero_ps(), _mm512_setzero_ps(), _mm512_setzero_ps(), _mm512_setzero_ps()};
    const auto less = [&](int k) {
        const __m512 two =
            _mm512_maskz_insertf32x8(0xffff, _mm512_castps256_ps512(row(index[k])), row(index[k + 1]), 1);
        return _mm512_sub_ps(own, two);
    };
    const auto add = [&](int k, __m128 w) {
        const __m512 first = less(k), second = less(k + 2);
        const __m512 x = _mm512_mul_ps(_mm512_maskz_permutexvar_ps(0xffff, stretched, _mm512_castps128_ps512(w)),
            _mm512_maskz_shuffle_f32x4(0xffff, first, second, 0x88));
        const __m512 u = _mm512_maskz_shuffle_f32x4(0xffff, first, second, 0xdd);
        sum[0] = _mm512_fmadd_ps(_mm512_maskz_permute_ps(0xffff, x, 0x00), u, sum[0]);
        sum[1] = _mm512_fmadd_ps(_mm512_maskz_permute_ps(0xffff, x, 0x55), u, sum[1]);
        sum[2] = _mm512_fmadd_ps(_mm512_maskz_permute_ps(0xffff, x, 0xaa), u, sum[2]);
        sum[3] = _mm512_fmadd_ps(_mm512_maskz_permute_ps(0xffff, x, 0xff), u, sum[3]);
    };
    int k = 0;
    for (; k + 4 <= count; k += 4) add(k, _mm_loadu_ps(weights + k));
    if (k < count) add(k, _mm_maskz_loadu_ps(static_cast<__mmask8>(0xf >> (4 - (count - k))), weights + k));
    // Quads of each sum.
    const auto halves = [](__m512 a, __m512 b) {
        return _mm512_add_ps(
            _mm512_maskz_shuffle_f32x4(0xffff, a, b, 0x88), _mm512_maskz_shuffle_f32x4(0xffff, a, b, 0xdd));
    };
    return halves(halves(sum[0], sum[1]), halves(sum[2], sum[3]));
}
#else
KOKKOS_INLINE_FUNCTION Float4x4 sum_pair_products(
    const float* rows, int i, const int* index, const float* weights, int count) {
    const float* own = rows + 8 * std::int64_t(i);
    Float4x4 sum(0.0f);
    for (int k = 0; k < count; ++k) {
        const float* other = rows + 8 * std::int64_t(index[k]);
        const float right[4] = {own[4] - other[4], own[5] - other[5], own[6] - other[6], 1};
        for (int l = 0; l < 4; ++l) {
            const float left = weights[k] * (l < 3 ? own[l] - other[l] : -(own[3] + other[3]));
            for (int m = 0; m < 4; ++m) sum.v[4 * l + m] += left * right[m];
        }
    }
    return sum;
}
#endif

} // namespace treacle
