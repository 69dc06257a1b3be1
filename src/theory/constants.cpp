// SPDX-License-Identifier: Apache-2.0
#include "theory/constants.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/infinity.hpp"

namespace wellmesh {
namespace {

bool in_open_range(double x, double low, double high) { return x > low && x < high; }  // false for NaN

/// Ranges without which the inequalities mean nothing.
std::vector<std::string> check_ranges(const TheoryConstants& c) {
    std::vector<std::string> problems;
    if (!in_open_range(c.delta, 0, 1)) problems.push_back(fmt::format("delta must be above 0 and below 1, not {}", c.delta));
    if (!in_open_range(c.b, 0, kInfinity)) problems.push_back(fmt::format("b must be a finite number above 0, not {}", c.b));
    if (!in_open_range(c.rho0, 0, kInfinity)) problems.push_back(fmt::format("rho0 (max radius-edge ratio) must be a finite number above 0, not {}", c.rho0));
    if (!(c.sigma0 > 0 && c.sigma0 <= kLargestSigma))
        problems.push_back(fmt::format("sigma0 must be above 0 and at most {:.4f} (the regular tetrahedron's), not {}", kLargestSigma, c.sigma0));
    return problems;
}

/// Rounded up to what is printed, so that the number works.
std::string rounded_up(double x) { return fmt::format("{:.10g}", std::ceil(x * 1e4) / 1e4); }

/// Largest delta with f(delta) >= limit for a falling f, for messages.
template <class F>
std::string largest_delta(F&& f, double limit) {
    if (!(f(0.0) > limit)) return {};
    double low = 0, high = 1;
    for (unsigned i = 0; i < 60; ++i) {
        const double middle = (low + high) / 2;
        (f(middle) >= limit ? low : high) = middle;
    }
    // Rounded down to what is printed, so that the number works.
    return fmt::format(", or delta at most {:.4g}", std::floor(low * 1e4) / 1e4);
}

}  // namespace

std::vector<std::string> check(const TheoryConstants& c) {
    std::vector<std::string> problems = check_ranges(c);
    if (!problems.empty()) return problems;
    const double shrink = 1 - c.delta, alpha = c.alpha();
    const auto given = [&] { return fmt::format("delta = {}, b = {}, rho0 = {}", c.delta, c.b, c.rho0); };
    const auto alpha_of = [](double delta) { return (1 + delta) / (1 - delta); };
    if (!(shrink * c.rho0 >= 2))
        problems.push_back(fmt::format("(1 - delta) rho0 >= 2 (Lemma 4.3) is violated: {:.6g} with {}; rho0 must be at least {}{}", shrink * c.rho0, given(), rounded_up(2 / shrink),
                                       largest_delta([&](double d) { return (1 - d) * c.rho0; }, 2)));
    if (!(shrink * shrink * c.rho0 >= 8))
        problems.push_back(fmt::format("(1 - delta)^2 rho0 >= 8 (Theorem 4.2) is violated: {:.6g} with {}; rho0 must be at least {}{}", shrink * shrink * c.rho0, given(),
                                       rounded_up(8 / (shrink * shrink)), largest_delta([&](double d) { return (1 - d) * (1 - d) * c.rho0; }, 8)));
    if (!(shrink * c.b >= 4))
        problems.push_back(fmt::format("(1 - delta) b >= 4 (Theorem 4.2) is violated: {:.6g} with {}; b must be at least {}{}", shrink * c.b, given(), rounded_up(4 / shrink),
                                       largest_delta([&](double d) { return (1 - d) * c.b; }, 4)));
    if (!(c.rho0 > 8 * std::pow(alpha, 6)))
        problems.push_back(fmt::format("rho0 > 8 ((1 + delta) / (1 - delta))^6 (Theorem 5.1, grading) is violated: the right side is {:.6g} with {}; rho0 must be above it{}",
                                       8 * std::pow(alpha, 6), given(), largest_delta([&](double d) { return c.rho0 / (8 * std::pow(alpha_of(d), 6)); }, 1)));
    if (!(c.b > 2 * alpha * alpha * alpha))
        problems.push_back(fmt::format("b > 2 ((1 + delta) / (1 - delta))^3 (Theorem 5.1, grading) is violated: the right side is {:.6g} with {}; b must be above it{}",
                                       2 * alpha * alpha * alpha, given(), largest_delta([&](double d) { return c.b / (2 * std::pow(alpha_of(d), 3)); }, 1)));
    return problems;
}

double DensityBounds::largest() const { return std::max({d1, d2, d3}); }

DensityBounds density_bounds(const TheoryConstants& c) {
    const double a = c.alpha(), a2 = a * a, a3 = a2 * a, a4 = a3 * a, a5 = a4 * a, a6 = a5 * a, root2 = std::numbers::sqrt2;
    if (!(c.rho0 > 8 * a6) || !(c.b > 2 * a3) || !in_open_range(c.delta, 0, 1)) return {kInfinity, kInfinity, kInfinity};
    DensityBounds d;
    // An infinite b (no sliver of any size is made) leaves alpha of the second fraction.
    const double by_sliver = std::isinf(c.b) ? a : (a * c.b + a2 + root2 * a3) / (c.b - 2 * a3);
    d.d3 = std::max({(c.rho0 * (a + 2 * a2 + 2 * root2 * a3 + 4 * a4) + 4 * a5 + 4 * root2 * a6) / (c.rho0 - 8 * a6), by_sliver,
                     a + std::numbers::sqrt3 / (1 - c.delta)});  // the paper prints sqrt(3) alpha, which is more than (5.2) asks
    d.d2 = a + root2 * a * d.d3;
    d.d1 = a + root2 * a2 + 2 * a2 * d.d3;
    return d;
}

std::vector<std::string> unsatisfied(const DensityBounds& d, const TheoryConstants& c) {
    const double a = c.alpha(), a2 = a * a, a3 = a2 * a, a4 = a2 * a2, root2 = std::numbers::sqrt2, most = d.largest();
    std::vector<std::string> failed;
    const auto need = [&](const char* name, double left, double right) {
        if (!(left <= right * (1 + 1e-12))) failed.push_back(name);
    };
    need("(5.1)", a + most / ((1 - c.delta) * c.rho0), d.d3);
    need("(5.2)", a + std::numbers::sqrt3 / (1 - c.delta), d.d3);
    need("(5.3)", a + a * d.d3 / c.b, d.d3);
    need("(5.4)", a + 2 * a2 + 2 * a2 * most / c.rho0, d.d3);
    need("(5.5)", a + a * std::max(d.d1, d.d2) / c.b, d.d3);
    need("(5.6)", a + 2 * a2 + 2 * root2 * a3 + 4 * a4 + 4 * a4 * most / c.rho0, d.d3);
    need("(5.7)", a + root2 * a * d.d3, d.d2);
    need("(5.8)", a + root2 * a * std::max(d.d2, d.d3), d.d1);
    return failed;
}

double insertion_factor(unsigned number, const TheoryConstants& c) {
    switch (number) {
        case 1: return (1 - c.delta) * c.rho0;
        case 2: return (1 - c.delta) / std::numbers::sqrt3;
        case 3:
        case 5: return (1 - c.delta) / (1 + c.delta) * c.b;
        case 4:
        case 6: return (1 - c.delta) / 2;
        default: return (1 - c.delta) / (std::numbers::sqrt2 * (1 + c.delta));
    }
}

double log10_existence_sigma(const TheoryConstants& c) {
    // Length variation bound nu0 = 2^(2 m - 1) rho0^(m - 1), m = 2 / (1 - cos(eta / 4)), eta = arctan(2 rho0 - sqrt(4 rho0^2 - 1)) [Cheng00].
    // The difference is written 1 / sum, as it cancels; 1 - cos x is 2 sin^2(x / 2).
    const double eta = std::atan(1 / (2 * c.rho0 + std::sqrt(4 * c.rho0 * c.rho0 - 1)));
    const double half_sine = std::sin(eta / 8);
    const double m = 1 / (half_sine * half_sine);
    const double log_nu = (2 * m - 1) * std::log10(2.0) + (m - 1) * std::log10(c.rho0);
    // Vertices of triangles that can form small slivers keep (1 - delta) R / (2 rho0 nu0) apart within (delta + 2 b) R; the 1 of the packing bound
    // (1 + x)^3 is lost in x. A triangle takes three of them.
    const double log_vertices = 3 * (std::log10(4 * c.rho0 * (c.delta + 2 * c.b) / (1 - c.delta)) + log_nu);
    const double log_triangles = 3 * log_vertices - std::log10(6.0);
    const double log_delta = std::log10(c.delta), log_b = std::log10(c.b), log_rho = std::log10(c.rho0), pi = std::numbers::pi;
    // T c3 (b R)^3 < (delta R)^3 with c3 = 2 pi^2 (48 rho0 sigma0)^2, and so on [LiTeng01, 4.1].
    const double volume = 1.5 * (log_delta - log_b) - std::log10(48 * pi * std::numbers::sqrt2) - log_rho - 0.5 * log_triangles;
    const double area = 2 * (log_delta - log_b) - std::log10(192 * pi) - log_rho - log_triangles;
    const double length = 2 * (log_delta - log_b) - std::log10(768.0) - log_rho - 2 * log_triangles;
    return std::min({volume, area, length});
}

}  // namespace wellmesh
