// SPDX-License-Identifier: MIT
//
// pack.h: a few lanes of float or double that compute together, and the small vocabulary with which a kernel is
// written once for scalars and packs alike.
//
// A kernel takes a scalar type T that is float, double or Pack<...>. Literals are written T(Value<T>(0.5)).
// Conditions go through select, any and all: a lane's result never depends on its neighbours, so that results do not
// change with the way triangles are grouped into packs.
//
// Pack carries an instruction-set tag, and nothing here calls a function that is not a template over it or a compiler
// builtin. Code for different instruction sets therefore has different names, and the linker cannot put the AVX copy
// of an inline function where the baseline copy belongs. For the same reason kernels use no standard algorithms.
//
//   template <class T> T cube(const T& x) { return x * x * x; }
//   cube(2.0);                                 // 8
//   struct Here;                               // the tag of this file's instruction set
//   cube(Pack<float, 4, Here>(2.0f));          // 8 8 8 8
#pragma once

#include <concepts>
#include <type_traits>

#define ALCAP_INLINE [[gnu::always_inline]] inline

namespace alcap::kernels {

/// The result of comparing two packs: per lane, all bits set or none.
template <class T, int N, class Isa>
struct Mask {
  using Lane = std::conditional_t<sizeof(T) == 8, long long, int>;
  typedef Lane Native __attribute__((vector_size(N * sizeof(T))));
  Native v;

  ALCAP_INLINE friend Mask operator&(const Mask& a, const Mask& b) { return {a.v & b.v}; }
  ALCAP_INLINE friend Mask operator|(const Mask& a, const Mask& b) { return {a.v | b.v}; }
  ALCAP_INLINE friend Mask operator!(const Mask& a) { return {~a.v}; }
};

/// N lanes of T, computed with the instruction set Isa. Arithmetic is lane by lane; a value converts to all lanes.
template <class T, int N, class Isa>
struct Pack {
  typedef T Native __attribute__((vector_size(N * sizeof(T))));
  using MaskType = Mask<T, N, Isa>;
  static constexpr int size = N;
  Native v;

  Pack() = default;
  ALCAP_INLINE Pack(T value) : v(value - Native{}) {}  // NOLINT(google-explicit-constructor): literals mix with packs
  ALCAP_INLINE static Pack from(const Native& native) {
    Pack p;
    p.v = native;
    return p;
  }
  /// N contiguous values; no alignment needed.
  ALCAP_INLINE static Pack load(const T* from) {
    Pack p;
    __builtin_memcpy(&p.v, from, sizeof(Native));
    return p;
  }
  ALCAP_INLINE void store(T* to) const { __builtin_memcpy(to, &v, sizeof(Native)); }
  ALCAP_INLINE T operator[](int lane) const { return v[lane]; }

  ALCAP_INLINE friend Pack operator+(const Pack& a, const Pack& b) { return from(a.v + b.v); }
  ALCAP_INLINE friend Pack operator-(const Pack& a, const Pack& b) { return from(a.v - b.v); }
  ALCAP_INLINE friend Pack operator*(const Pack& a, const Pack& b) { return from(a.v * b.v); }
  ALCAP_INLINE friend Pack operator/(const Pack& a, const Pack& b) { return from(a.v / b.v); }
  ALCAP_INLINE friend Pack operator-(const Pack& a) { return from(-a.v); }
  ALCAP_INLINE friend MaskType operator<(const Pack& a, const Pack& b) { return {a.v < b.v}; }
  ALCAP_INLINE friend MaskType operator<=(const Pack& a, const Pack& b) { return {a.v <= b.v}; }
  ALCAP_INLINE friend MaskType operator>(const Pack& a, const Pack& b) { return {a.v > b.v}; }
  ALCAP_INLINE friend MaskType operator>=(const Pack& a, const Pack& b) { return {a.v >= b.v}; }
};

namespace detail {
template <class T>
struct ValueOf {
  using type = T;
};
template <class T, int N, class Isa>
struct ValueOf<Pack<T, N, Isa>> {
  using type = T;
};
}  // namespace detail

/// float or double: the type of one lane.
template <class T>
using Value = typename detail::ValueOf<T>::type;

// Scalars -------------------------------------------------------------------------------------------------------------

template <std::floating_point T>
ALCAP_INLINE T select(bool condition, T yes, T no) {
  return condition ? yes : no;
}
template <std::same_as<bool> B>
ALCAP_INLINE bool any(B condition) {
  return condition;
}
template <std::same_as<bool> B>
ALCAP_INLINE bool all(B condition) {
  return condition;
}
template <std::floating_point T>
ALCAP_INLINE T abs(T x) {
  if constexpr (sizeof(T) == sizeof(float)) {
    return __builtin_fabsf(x);
  } else {
    return __builtin_fabs(x);
  }
}
template <std::floating_point T>
ALCAP_INLINE T sqrt(T x) {
  if constexpr (sizeof(T) == sizeof(float)) {
    return __builtin_sqrtf(x);
  } else {
    return __builtin_sqrt(x);
  }
}
/// Both at once, by the C library.
template <std::floating_point T>
ALCAP_INLINE void sincos(T x, T& sine, T& cosine) {
  if constexpr (sizeof(T) == sizeof(float)) {
    sine = __builtin_sinf(x), cosine = __builtin_cosf(x);
  } else {
    sine = __builtin_sin(x), cosine = __builtin_cos(x);
  }
}

// Packs ---------------------------------------------------------------------------------------------------------------

template <class T, int N, class Isa>
ALCAP_INLINE Pack<T, N, Isa> select(const Mask<T, N, Isa>& mask, const Pack<T, N, Isa>& yes,
                                    const Pack<T, N, Isa>& no) {
  return Pack<T, N, Isa>::from(mask.v ? yes.v : no.v);
}
template <class T, int N, class Isa>
ALCAP_INLINE bool any(const Mask<T, N, Isa>& mask) {
  constexpr int words = static_cast<int>(N * sizeof(T) / sizeof(long long));
  long long w[words], bits = 0;
  __builtin_memcpy(w, &mask.v, sizeof(w));
  for (int i = 0; i < words; ++i) bits |= w[i];
  return bits != 0;
}
template <class T, int N, class Isa>
ALCAP_INLINE bool all(const Mask<T, N, Isa>& mask) {
  return !any(!mask);
}
template <class T, int N, class Isa>
ALCAP_INLINE Pack<T, N, Isa> abs(const Pack<T, N, Isa>& x) {
  return select(x < Pack<T, N, Isa>(T(0)), -x, x);
}
template <class T, int N, class Isa>
ALCAP_INLINE Pack<T, N, Isa> sqrt(const Pack<T, N, Isa>& x) {
  Pack<T, N, Isa> r;
  for (int i = 0; i < N; ++i) {
    if constexpr (sizeof(T) == sizeof(float)) {
      r.v[i] = __builtin_sqrtf(x.v[i]);
    } else {
      r.v[i] = __builtin_sqrt(x.v[i]);
    }
  }
  return r;
}
/// Lane by lane through the C library: exact to its standard for every argument. Only closed forms at large
/// arguments call it, off the hot path.
template <class T, int N, class Isa>
ALCAP_INLINE void sincos(const Pack<T, N, Isa>& x, Pack<T, N, Isa>& sine, Pack<T, N, Isa>& cosine) {
  for (int i = 0; i < N; ++i) {
    if constexpr (sizeof(T) == sizeof(float)) {
      sine.v[i] = __builtin_sinf(x.v[i]), cosine.v[i] = __builtin_cosf(x.v[i]);
    } else {
      sine.v[i] = __builtin_sin(x.v[i]), cosine.v[i] = __builtin_cos(x.v[i]);
    }
  }
}

// Both ----------------------------------------------------------------------------------------------------------------

/// a b + c in one statement: compilers may fuse it, where the flags of the file and the instruction set allow.
template <class T>
ALCAP_INLINE T mul_add(const T& a, const T& b, const T& c) {
  if constexpr (std::floating_point<T>) {
    return a * b + c;
  } else {
    return T::from(a.v * b.v + c.v);
  }
}
template <class T>
ALCAP_INLINE T max(const T& a, const T& b) {
  return select(a < b, b, a);
}
template <class T>
ALCAP_INLINE T min(const T& a, const T& b) {
  return select(b < a, b, a);
}

}  // namespace alcap::kernels
