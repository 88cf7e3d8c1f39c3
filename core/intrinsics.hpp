#pragma once
/// \file Vector instructions beyond AVX2, included before Eigen includes them.

#ifdef __AVX512F__
// GCC 12 warns of its own undefined values, `__m512d __Y = __Y`, wherever one of these functions is inlined
// (https://gcc.gnu.org/bugzilla/show_bug.cgi?id=105593).
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include <immintrin.h>
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic pop
#endif
#endif
