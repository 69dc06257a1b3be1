// SPDX-License-Identifier: Apache-2.0
// Refuses to compile where the predicates would silently be wrong. Their error-free transformations (expansion.hpp) and
// error bounds need IEEE doubles, rounded to nearest, evaluated operation by operation as written:
//   -ffast-math reassociates (a + b) - a to b, so every rounding error that we compute would be "optimised" to zero;
//   extended precision (x87) rounds twice, so the computed error of a sum is not its error;
//   fused multiply-add turns x*y - hi into a value that Dekker's product does not expect (Dekker71, Shewchuk97).
// The first two are visible to the preprocessor. Contraction is not: cmake/floating_point.cmake turns it off for our own
// targets, and tests/unit/predicates/fp_environment_test.cpp proves at run time that the compiler obeyed.
#pragma once

#include <cfloat>
#include <limits>

#ifdef __FAST_MATH__
#error "wellmesh's exact predicates are wrong under -ffast-math"
#endif

namespace wellmesh {

static_assert(std::numeric_limits<double>::is_iec559 && std::numeric_limits<double>::digits == 53, "wellmesh needs IEEE doubles");
static_assert(FLT_EVAL_METHOD == 0, "wellmesh needs doubles without excess precision (on 32-bit x86: -msse2 -mfpmath=sse)");

}  // namespace wellmesh
