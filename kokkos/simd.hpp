#pragma once
#include "kokkos/types.hpp"

#include <type_traits>

#if !defined(KOKKOS_ENABLE_CUDA) && !defined(KOKKOS_ENABLE_HIP) && !defined(KOKKOS_ENABLE_SYCL)
#if defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__AVX512VL__)
#define TREACLE_AVX512
#include <immintrin.h>
#elif defined(__AVX2__)
#define TREACLE_AVX2
#include <immintrin.h>
#endif
#endif

// Several numbers that go through one formula together: eight or four in a vector register, one on devices and
// on other processors. A formula is written once, as a template over `double` and `SimdDouble`. Every lane gets the same
// number that it would get in any other place, so that a_ij and a_ji stay equal bit for bit.
namespace treacle {

// Scalar forms of the operations on several numbers below, for formulas with T = double.
KOKKOS_INLINE_FUNCTION double select(bool condition, double yes, double no) { return condition ? yes : no; }
KOKKOS_INLINE_FUNCTION double inverse(double x) { return 1 / x; }
KOKKOS_INLINE_FUNCTION double inverse_sqrt(double x) { return 1 / math::sqrt(x); }
KOKKOS_INLINE_FUNCTION double sum_lanes(double x) { return x; }
// To numbers that a float has.
KOKKOS_INLINE_FUNCTION double rounded(double x) { return static_cast<double>(static_cast<float>(x)); }
KOKKOS_INLINE_FUNCTION unsigned to_bitmask(bool condition) { return condition ? 1u : 0u; }

// Index of the lowest bit that is set; `bits` is not 0.
KOKKOS_INLINE_FUNCTION int lowest_bit(unsigned bits) {
#if defined(__CUDA_ARCH__) || defined(__HIP_DEVICE_COMPILE__)
    return __ffs(static_cast<int>(bits)) - 1;
#else
    return __builtin_ctz(bits);
#endif
}
// Number of bits that are set.
KOKKOS_INLINE_FUNCTION int count_bits(unsigned bits) {
#if defined(__CUDA_ARCH__) || defined(__HIP_DEVICE_COMPILE__)
    return __popc(bits);
#else
    return __builtin_popcount(bits);
#endif
}

#if defined(TREACLE_AVX512)
// All lanes named in zero-masked intrinsics: GCC 12 warns falsely of undefined values in its unmasked ones.
inline constexpr int lanes = 8;

// A register of 8 doubles. A double becomes all of them; load and store take any alignment.
struct SimdDouble {
    __m512d v;
    SimdDouble() = default;
    SimdDouble(__m512d value) : v(value) {}
    SimdDouble(double value) : v(_mm512_set1_pd(value)) {}
    static SimdDouble load(const double* from) { return _mm512_loadu_pd(from); }
    void store(double* to) const { _mm512_storeu_pd(to, v); }
    friend SimdDouble operator+(SimdDouble a, SimdDouble b) { return _mm512_add_pd(a.v, b.v); }
    friend SimdDouble operator-(SimdDouble a, SimdDouble b) { return _mm512_sub_pd(a.v, b.v); }
    friend SimdDouble operator*(SimdDouble a, SimdDouble b) { return _mm512_mul_pd(a.v, b.v); }
    friend SimdDouble operator-(SimdDouble a) { return SimdDouble(-0.0) - a; }
    friend __mmask8 operator<(SimdDouble a, SimdDouble b) { return _mm512_cmp_pd_mask(a.v, b.v, _CMP_LT_OQ); }
};
// Bit k is the outcome of the comparison of the k-th numbers; false where one is NaN.
using LaneMask = __mmask8;

// Operations number by number. The mask of the first n has all bits for n >= 8; the sum adds in pairs.
inline SimdDouble select(LaneMask condition, SimdDouble yes, SimdDouble no) {
    return _mm512_mask_blend_pd(condition, no.v, yes.v);
}
inline unsigned to_bitmask(LaneMask mask) { return mask; }
inline LaneMask tail_mask(int n) { return static_cast<LaneMask>(0xffu >> (lanes - math::min(n, lanes))); }
inline double sum_lanes(SimdDouble x) {
    const __m256d low = _mm512_maskz_extractf64x4_pd(0xf, x.v, 0);
    const __m256d high = _mm512_maskz_extractf64x4_pd(0xf, x.v, 1);
    const __m256d four = _mm256_add_pd(low, high);
    const __m128d two = _mm_add_pd(_mm256_castpd256_pd128(four), _mm256_extractf128_pd(four, 1));
    return _mm_cvtsd_f64(_mm_add_sd(two, _mm_unpackhi_pd(two, two)));
}
// An estimate of 14 bits and two steps of Newton: within two units in the last place, at a third of the cost of a
// division or a square root.
inline SimdDouble inverse(SimdDouble x) {
    __m512d y = _mm512_maskz_rcp14_pd(0xff, x.v);
    const __m512d one = _mm512_set1_pd(1.0);
    y = _mm512_fmadd_pd(y, _mm512_fnmadd_pd(x.v, y, one), y);
    return _mm512_fmadd_pd(y, _mm512_fnmadd_pd(x.v, y, one), y);
}
inline SimdDouble inverse_sqrt(SimdDouble x) {
    __m512d y = _mm512_maskz_rsqrt14_pd(0xff, x.v);
    const __m512d one = _mm512_set1_pd(1.0), half = _mm512_set1_pd(0.5);
    for (int k = 0; k < 2; ++k) {
        const __m512d error = _mm512_fnmadd_pd(_mm512_mul_pd(x.v, y), y, one);
        y = _mm512_fmadd_pd(_mm512_mul_pd(half, y), error, y);
    }
    return y;
}
inline SimdDouble rounded(SimdDouble x) { return _mm512_maskz_cvtps_pd(0xff, _mm512_maskz_cvtpd_ps(0xff, x.v)); }
namespace math {
inline SimdDouble min(SimdDouble a, SimdDouble b) { return _mm512_maskz_min_pd(0xff, a.v, b.v); }
inline SimdDouble max(SimdDouble a, SimdDouble b) { return _mm512_maskz_max_pd(0xff, a.v, b.v); }
} // namespace math
#elif defined(TREACLE_AVX2)
inline constexpr int lanes = 4;

// Outcomes of a comparison; false where a number is NaN.
struct LaneMask {
    __m256d v; // all bits of a number set, or none
};
// A register of 4 doubles. A double becomes all of them; load and store take any alignment.
struct SimdDouble {
    __m256d v;
    SimdDouble() = default;
    SimdDouble(__m256d value) : v(value) {}
    SimdDouble(double value) : v(_mm256_set1_pd(value)) {}
    static SimdDouble load(const double* from) { return _mm256_loadu_pd(from); }
    void store(double* to) const { _mm256_storeu_pd(to, v); }
    friend SimdDouble operator+(SimdDouble a, SimdDouble b) { return _mm256_add_pd(a.v, b.v); }
    friend SimdDouble operator-(SimdDouble a, SimdDouble b) { return _mm256_sub_pd(a.v, b.v); }
    friend SimdDouble operator*(SimdDouble a, SimdDouble b) { return _mm256_mul_pd(a.v, b.v); }
    friend SimdDouble operator-(SimdDouble a) { return SimdDouble(-0.0) - a; }
    friend LaneMask operator<(SimdDouble a, SimdDouble b) { return {_mm256_cmp_pd(a.v, b.v, _CMP_LT_OQ)}; }
};

// Operations number by number. The mask of the first n has all bits for n >= 4; the sum adds in pairs.
inline SimdDouble select(LaneMask condition, SimdDouble yes, SimdDouble no) {
    return _mm256_blendv_pd(no.v, yes.v, condition.v);
}
inline unsigned to_bitmask(LaneMask mask) { return static_cast<unsigned>(_mm256_movemask_pd(mask.v)); }
inline LaneMask tail_mask(int n) { return {_mm256_cmp_pd(_mm256_setr_pd(0, 1, 2, 3), _mm256_set1_pd(n), _CMP_LT_OQ)}; }
inline double sum_lanes(SimdDouble x) {
    const __m128d half = _mm_add_pd(_mm256_castpd256_pd128(x.v), _mm256_extractf128_pd(x.v, 1));
    return _mm_cvtsd_f64(_mm_add_sd(half, _mm_unpackhi_pd(half, half)));
}
// Division and square root of IEEE 754, unlike the estimates of AVX-512.
inline SimdDouble inverse(SimdDouble x) { return _mm256_div_pd(_mm256_set1_pd(1.0), x.v); }
inline SimdDouble inverse_sqrt(SimdDouble x) { return _mm256_div_pd(_mm256_set1_pd(1.0), _mm256_sqrt_pd(x.v)); }
inline SimdDouble rounded(SimdDouble x) { return _mm256_cvtps_pd(_mm256_cvtpd_ps(x.v)); }
namespace math {
// The second number where one of the two is NaN.
inline SimdDouble min(SimdDouble a, SimdDouble b) { return _mm256_min_pd(a.v, b.v); }
inline SimdDouble max(SimdDouble a, SimdDouble b) { return _mm256_max_pd(a.v, b.v); }
} // namespace math
#else
inline constexpr int lanes = 1;
// One number: the formulas in their scalar form.
using SimdDouble = double;
using LaneMask = bool;
KOKKOS_INLINE_FUNCTION LaneMask tail_mask(int) { return true; }
#endif

// Number type that a formula is a template over; an integer would be a mistake.
template <class T>
concept Number = std::is_same_v<T, double> || std::is_same_v<T, SimdDouble>;

// The next 8, 4 or 1 numbers at `from`, of any alignment.
KOKKOS_INLINE_FUNCTION SimdDouble load_lanes(const double* from) {
#if defined(TREACLE_AVX512) || defined(TREACLE_AVX2)
    return SimdDouble::load(from);
#else
    return *from;
#endif
}
// Writes the next 8, 4 or 1 numbers at `to`, of any alignment.
KOKKOS_INLINE_FUNCTION void store_lanes(SimdDouble x, double* to) {
#if defined(TREACLE_AVX512) || defined(TREACLE_AVX2)
    x.store(to);
#else
    *to = x;
#endif
}

// As many integers; the outcomes of comparisons are the bits of one number.
#if defined(TREACLE_AVX512)
using SimdInt = __m256i;
inline SimdInt load_ints(const int* from) { return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from)); }
inline void store_ints(SimdInt x, int* to) { _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), x); }
inline SimdInt gather_ints(const int* from, SimdInt index) { return _mm256_i32gather_epi32(from, index, 4); }
inline SimdDouble gather_lanes(const double* from, SimdInt index) {
    return _mm512_mask_i32gather_pd(_mm512_setzero_pd(), 0xff, index, from, 8);
}
inline SimdInt shift_ints(SimdInt x, int by) { return _mm256_add_epi32(x, _mm256_set1_epi32(by)); }
inline unsigned bits_below(SimdInt x, int bound) { return _mm256_cmplt_epi32_mask(x, _mm256_set1_epi32(bound)); }
inline unsigned bits_equal(SimdInt x, int to) { return _mm256_cmpeq_epi32_mask(x, _mm256_set1_epi32(to)); }
#elif defined(TREACLE_AVX2)
using SimdInt = __m128i;
inline SimdInt load_ints(const int* from) { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(from)); }
inline void store_ints(SimdInt x, int* to) { _mm_storeu_si128(reinterpret_cast<__m128i*>(to), x); }
inline SimdInt gather_ints(const int* from, SimdInt index) { return _mm_i32gather_epi32(from, index, 4); }
inline SimdDouble gather_lanes(const double* from, SimdInt index) { return _mm256_i32gather_pd(from, index, 8); }
inline SimdInt shift_ints(SimdInt x, int by) { return _mm_add_epi32(x, _mm_set1_epi32(by)); }
inline unsigned to_bitmask(SimdInt mask) { return static_cast<unsigned>(_mm_movemask_ps(_mm_castsi128_ps(mask))); }
inline unsigned bits_below(SimdInt x, int bound) { return to_bitmask(_mm_cmplt_epi32(x, _mm_set1_epi32(bound))); }
inline unsigned bits_equal(SimdInt x, int to) { return to_bitmask(_mm_cmpeq_epi32(x, _mm_set1_epi32(to))); }
#else
using SimdInt = int;
KOKKOS_INLINE_FUNCTION SimdInt load_ints(const int* from) { return *from; }
KOKKOS_INLINE_FUNCTION void store_ints(SimdInt x, int* to) { *to = x; }
KOKKOS_INLINE_FUNCTION SimdInt gather_ints(const int* from, SimdInt index) { return from[index]; }
KOKKOS_INLINE_FUNCTION SimdDouble gather_lanes(const double* from, SimdInt index) { return from[index]; }
KOKKOS_INLINE_FUNCTION SimdInt shift_ints(SimdInt x, int by) { return x + by; }
KOKKOS_INLINE_FUNCTION unsigned bits_below(SimdInt x, int bound) { return to_bitmask(x < bound); }
KOKKOS_INLINE_FUNCTION unsigned bits_equal(SimdInt x, int to) { return to_bitmask(x == to); }
#endif

// Bits of the lanes that a row of n more entries still has.
KOKKOS_INLINE_FUNCTION unsigned first_bits(int n) { return (1u << math::min(n, lanes)) - 1; }

// Writes the integers whose bits are set, one behind the other, and returns how many; nothing else is written.
KOKKOS_INLINE_FUNCTION int compress_store(unsigned bits, SimdInt x, int* to) {
#if defined(TREACLE_AVX512)
    const int n = __builtin_popcount(bits);
    const auto chosen = static_cast<__mmask8>(bits), first = static_cast<__mmask8>((1u << n) - 1);
    _mm256_mask_storeu_epi32(to, first, _mm256_maskz_compress_epi32(chosen, x));
    return n;
#else
    int all[lanes];
    store_ints(x, all);
    int n = 0;
    for (; bits != 0; bits &= bits - 1, ++n) to[n] = all[lowest_bit(bits)];
    return n;
#endif
}

// Numbers of a mask's lanes and their columns, one behind the other; returns how many.
KOKKOS_INLINE_FUNCTION int compress_store(
    unsigned bits, SimdInt column, SimdDouble value, int* to_column, double* to_value) {
#if defined(TREACLE_AVX512)
    const int n = compress_store(bits, column, to_column);
    const auto chosen = static_cast<__mmask8>(bits), first = static_cast<__mmask8>((1u << n) - 1);
    _mm512_mask_storeu_pd(to_value, first, _mm512_maskz_compress_pd(chosen, value.v));
    return n;
#else
    int columns[lanes];
    double values[lanes];
    store_ints(column, columns);
    store_lanes(value, values);
    int n = 0;
    for (; bits != 0; bits &= bits - 1, ++n) {
        to_column[n] = columns[lowest_bit(bits)];
        to_value[n] = values[lowest_bit(bits)];
    }
    return n;
#endif
}

// A distance and its inverse from its square; at 0 the inverse is merely large.
template <Number T>
struct Distance {
    T r, inverse;
};
template <Number T>
KOKKOS_INLINE_FUNCTION Distance<T> distance(T r2) {
    const T inverse = inverse_sqrt(math::max(r2, T(1e-200)));
    return {r2 * inverse, inverse};
}

// Rows index[0] ... index[lanes - 1] of an Array4, a column to each of x, y, z, w.
struct Quads {
    SimdDouble x, y, z, w;
};
KOKKOS_INLINE_FUNCTION Quads gather_quads(const double* rows, const int* index) {
#if defined(TREACLE_AVX512)
    const auto two = [&](int low, int high) {
        const double* a = rows + 4 * std::int64_t(index[low]);
        const double* b = rows + 4 * std::int64_t(index[high]);
        return _mm512_maskz_insertf64x4(0xff, _mm512_castpd256_pd512(_mm256_load_pd(a)), _mm256_load_pd(b), 1);
    };
    const __m512d a = two(0, 2), b = two(1, 3), c = two(4, 6), d = two(5, 7);
    const __m512d xz = _mm512_maskz_unpacklo_pd(0xff, a, b), yw = _mm512_maskz_unpackhi_pd(0xff, a, b);
    const __m512d xz2 = _mm512_maskz_unpacklo_pd(0xff, c, d), yw2 = _mm512_maskz_unpackhi_pd(0xff, c, d);
    return {_mm512_maskz_shuffle_f64x2(0xff, xz, xz2, 0x88), _mm512_maskz_shuffle_f64x2(0xff, yw, yw2, 0x88),
        _mm512_maskz_shuffle_f64x2(0xff, xz, xz2, 0xdd), _mm512_maskz_shuffle_f64x2(0xff, yw, yw2, 0xdd)};
#elif defined(TREACLE_AVX2)
    const auto one = [&](int k) { return _mm256_load_pd(rows + 4 * std::int64_t(index[k])); };
    const __m256d a = one(0), b = one(1), c = one(2), d = one(3);
    const __m256d xz = _mm256_unpacklo_pd(a, b), yw = _mm256_unpackhi_pd(a, b);
    const __m256d xz2 = _mm256_unpacklo_pd(c, d), yw2 = _mm256_unpackhi_pd(c, d);
    return {_mm256_permute2f128_pd(xz, xz2, 0x20), _mm256_permute2f128_pd(yw, yw2, 0x20),
        _mm256_permute2f128_pd(xz, xz2, 0x31), _mm256_permute2f128_pd(yw, yw2, 0x31)};
#else
    const double* row = rows + 4 * std::int64_t(index[0]);
    return {row[0], row[1], row[2], row[3]};
#endif
}

// Writes start + k for every set bit k of 16 and returns how many there are; nothing else is written.
KOKKOS_INLINE_FUNCTION int write_set_bits(unsigned bits, int start, int* to) {
#if defined(TREACLE_AVX512)
    const __m512i steps = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    const int n = __builtin_popcount(bits);
    const __m512i packed =
        _mm512_maskz_compress_epi32(static_cast<__mmask16>(bits), _mm512_add_epi32(_mm512_set1_epi32(start), steps));
    _mm512_mask_storeu_epi32(to, static_cast<__mmask16>((1u << n) - 1), packed);
    return n;
#else
    int n = 0;
    for (; bits != 0; bits &= bits - 1) to[n++] = start + lowest_bit(bits);
    return n;
#endif
}

} // namespace treacle
