// SPDX-License-Identifier: Apache-2.0
// How far the coordinates of a text file may be off because of their text: Plc::relative_rounding.
#pragma once

#include <string_view>

namespace wellmesh::io {

/// Collects the coordinates of one file, then bounds their rounding as a fraction of the largest magnitude.
///
/// A coordinate is *exact* if its decimal text is an integer or a dyadic fraction (0.5, 12.375): a number with f > 0 decimals
/// is dyadic only if its digits divide by 5^f, so rounding produces one in 5^f times by chance. Let D be the largest number
/// of significant digits (written zeros at the end included) of the coordinates that are not exact. The rule, in this order:
///   1. every coordinate is a float32 number, and one is written out with >= 10 digits and fills >= 23 bits: 2^-24;
///   2. every coordinate is exact: 0;
///   3. D >= 16: 0, the text fixes the doubles to about an ulp;
///   4. D <= 4: 0, such numbers were typed or designed (0.1, 2.54) and mean what they say; a program that loses digits
///      keeps five or more;
///   5. else half a unit of the D-th digit of the largest coordinate that is not exact: what "%.De" and "%.Dg" lose. For
///      "%.nf" the largest number has the most digits, so that this is half a unit of the n-th decimal there.
/// Numbers that %g printed shorter (0.5 for 0.500000) cannot be told from exact ones one by one; D, taken over the whole
/// file, covers them.
class TextPrecision {
public:
    /// @param token  decimal text that parse_real() accepted as `value`.
    void note(std::string_view token, double value);
    /// A coordinate of a binary file: its shortest text is what a program that lost digits would have written.
    void note(double value);
    /// Adds what another one was told.
    void join(const TextPrecision& other);
    [[nodiscard]] double relative_rounding() const;

private:
    double largest_ = 0;            // magnitude, over all coordinates
    double largest_inexact_ = 0;
    int digits_ = 0;                // D
    bool all_float32_ = true;
    bool full_float32_ = false;     // one is written out with many digits and fills the mantissa
};

/// Rounding of coordinates that were stored as float32: half a unit of a 24 bit mantissa.
inline constexpr double kFloat32Rounding = 0x1p-24;

}  // namespace wellmesh::io
