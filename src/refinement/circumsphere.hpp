// SPDX-License-Identifier: Apache-2.0
// Circumspheres of tetrahedra however flat they are.
#pragma once

#include "wellmesh/vec3.hpp"

namespace wellmesh {

struct Circumsphere {
    Vec3 centre{};
    double radius = 0;       ///< input units
    double six_volumes = 0;  ///< signed
};

/// Six volumes of no more than this part of the cubed longest edge are noise in rounded arithmetic, and so is what is derived from them.
inline constexpr double kThinVolume = 1e-10;
[[nodiscard]] bool is_thin(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// In rounded arithmetic where that keeps ten digits, else by exact_circumsphere.
[[nodiscard]] Circumsphere careful_circumsphere(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Numerator and denominator by expansion arithmetic [Shewchuk97], then rounded: radius and volume to a few ulp of themselves, the centre
/// to a few ulp of the radius or of the coordinates, whichever is more. Infinite radius if the four points are coplanar.
[[nodiscard]] Circumsphere exact_circumsphere(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

}  // namespace wellmesh
