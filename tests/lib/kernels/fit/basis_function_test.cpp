// SPDX-License-Identifier: Apache-2.0
#include "subvol/basis_function.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/expect_error.h"
#include "lib/test_meshes.h"
#include "subvol/limit.h"

namespace subvol {

using namespace detail;
namespace basis_function_test {

constexpr Scheme kSchemes[] = {Scheme::Mcq, Scheme::CatmullClark, Scheme::Bsxw, Scheme::Linear};

/// Sums f(value) over all places (i, j, k) of the support.
template <class F>
double sum_over_support(const BasisFunction& basis, const F& f) {
    double sum = 0;
    std::size_t entry = 0;
    each_in_wedge(static_cast<std::size_t>(basis.last()), [&](std::size_t i, std::size_t j, std::size_t k) {
        sum += wedge_multiplicity(i, j, k) * f(basis.values[entry++]);
    });
    return sum;
}

TEST(BasisFunction, WedgeHasEveryPlaceOnce) {
    std::vector<int> seen(wedge_size(3));
    for (int i = -3; i <= 3; ++i) {
        for (int j = -3; j <= 3; ++j) {
            for (int k = -3; k <= 3; ++k) ++seen.at(wedge_index_of(i, j, k));
        }
    }
    std::size_t entry = 0;
    each_in_wedge(3, [&](std::size_t i, std::size_t j, std::size_t k) {
        EXPECT_EQ(wedge_index(i, j, k), entry);
        EXPECT_EQ(seen[entry++], wedge_multiplicity(i, j, k)) << i << j << k;
    });
    EXPECT_EQ(entry, seen.size());
}

TEST(BasisFunction, McqTakesItsExactValues) {
    const BasisFunction basis = sample_basis_function(Scheme::Mcq, 5);
    const auto at = [&](double x, double y, double z) {
        return basis.at(static_cast<int>(32 * x), static_cast<int>(32 * y), static_cast<int>(32 * z));
    };
    EXPECT_EQ(at(0, 0, 0), 1);
    EXPECT_EQ(at(.5, 0, 0), 1. / 2);
    EXPECT_EQ(at(0, .5, -.5), 9. / 32);
    EXPECT_EQ(at(.5, -.5, .5), 11. / 64);
    EXPECT_EQ(at(.25, 0, 0), .7802734375);
    EXPECT_EQ(at(1.5, 0, 0), 0);
    EXPECT_EQ(at(1, .5, 0), 1. / 64);
    EXPECT_EQ(at(1, 0, 1.5), -1. / 64);
    EXPECT_EQ(at(0, .5, 1.5), -1. / 64);
    EXPECT_EQ(at(-.5, .5, -1.5), -1. / 64);
    EXPECT_EQ(at(1.5, .5, 1), -1. / 128);
    EXPECT_EQ(at(.5, 1, 1), 0);
    EXPECT_EQ(at(0, 0, .75), 61. / 256);
    EXPECT_EQ(at(1.25, 0, 0), -9. / 512);
    EXPECT_EQ(at(.25, .25, 0), 1311. / 2048);
    EXPECT_EQ(at(.25, .25, .25), 2229. / 4096);
    EXPECT_EQ(basis.at(97, 0, 0), 0);
    EXPECT_EQ(basis.at(0, -1000, 0), 0);
}

TEST(BasisFunction, McqHasItsMomentsAndMinimum) {
    const BasisFunction basis = sample_basis_function(Scheme::Mcq, 5);
    const double samples = 193.0 * 193 * 193;
    // Sums of 157,000 terms, each rounded at 1e-16 of the sum: an error of 1e-13 at most.
    EXPECT_EQ(sum_over_support(basis, [](double f) { return f; }), 32768);  // Σ over the lattice = 1 / its cell: ∫φ = 1
    EXPECT_NEAR(sum_over_support(basis, [](double f) { return f * f; }) / samples, .0018996672643604641, 1e-15);
    EXPECT_NEAR(sum_over_support(basis, [](double f) { return std::abs(f); }) / samples, .006733210714958662, 1e-15);
    const auto least = std::min_element(basis.values.begin(), basis.values.end());
    EXPECT_EQ(least - basis.values.begin(), static_cast<std::ptrdiff_t>(wedge_index(37, 0, 0)));
    EXPECT_EQ(*least, -.02150755375623703);
}

TEST(BasisFunction, McqTouches208CellsOf216) {
    const BasisFunction basis = sample_basis_function(Scheme::Mcq, 5);
    int touched = 0;
    for (int cell = 0; cell < 27; ++cell) {  // an octant's
        bool any = false;
        for (int n = 0; n < 33 * 33 * 33; ++n) {
            any |= basis.at(cell % 3 * 32 + n % 33, cell / 3 % 3 * 32 + n / 33 % 33, cell / 9 * 32 + n / 1089) != 0;
        }
        touched += any;
    }
    EXPECT_EQ(8 * touched, 208);
}

TEST(BasisFunction, IsOneAtTheVertexOfAnInterpolatingScheme) {
    for (const Scheme scheme : kSchemes) {
        const BasisFunction basis = sample_basis_function(scheme, 2);
        EXPECT_EQ(basis.at(0, 0, 0) == 1, interpolates(scheme));
        EXPECT_EQ(basis.at(4, 0, 0) == 0, interpolates(scheme));
    }
    EXPECT_DOUBLE_EQ(sample_basis_function(Scheme::CatmullClark, 3).at(0, 8, -8), 4. / 6 / 36);
    EXPECT_EQ(sample_basis_function(Scheme::Linear, 3).at(4, -4, 2), 3. / 16);
}

TEST(BasisFunction, ShiftedCopiesSumToOne) {
    for (const Scheme scheme : kSchemes) {
        const BasisFunction basis = sample_basis_function(scheme, 3);
        for (int i = 0; i < 8; ++i) {
            for (int j = 0; j <= i; ++j) {
                for (int k = 0; k <= j; ++k) {
                    double sum = 0;
                    for (int n = 0; n < 343; ++n) {
                        sum += basis.at(i + 8 * (n % 7 - 3), j + 8 * (n / 7 % 7 - 3), k + 8 * (n / 49 - 3));
                    }
                    EXPECT_NEAR(sum, 1, 1e-15);
                }
            }
        }
    }
}

TEST(BasisFunction, IntegratesToOne) {
    for (const Scheme scheme : kSchemes) {
        const double sum = sum_over_support(sample_basis_function(scheme, 4), [](double f) { return f; });
        EXPECT_NEAR(sum / 4096, 1, 1e-14);  // the trapezoid rule is exact: shifted copies sum to one
    }
}

/// φ(x) = Σ m(k) φ(2x − k), with the mask m(k) given.
template <class Mask>
void expect_refinement_equation(const BasisFunction& basis, double tolerance, const Mask& mask) {
    const int one = 1 << basis.level;
    for (int i = 0; i <= basis.last(); i += 3) {
        for (int j = 0; j <= i; j += 2) {
            for (int k = 0; k <= j; ++k) {
                double sum = 0;
                for (int n = 0; n < 343; ++n) {
                    const int a = n % 7 - 3, b = n / 7 % 7 - 3, c = n / 49 - 3;
                    sum += mask(a, b, c) * basis.at(2 * i - a * one, 2 * j - b * one, 2 * k - c * one);
                }
                ASSERT_NEAR(sum, basis.at(i, j, k), tolerance) << i << " " << j << " " << k;
            }
        }
    }
}

TEST(BasisFunction, SatisfiesItsRefinementEquation) {
    const double exact = 0, rounded = 4e-15;  // 16 roundings of 1, where weights are no sums of powers of two
    for (const auto& [tension, tolerance] : {std::pair{1.0 / 16, exact}, {0.03, rounded}}) {
        const BasisFunction mask = sample_basis_function(Scheme::Mcq, 1, tension);
        expect_refinement_equation(sample_basis_function(Scheme::Mcq, 4, tension), tolerance,
                                   [&](int a, int b, int c) { return mask.at(a, b, c); });
    }
    const double binomial[] = {6. / 8, 4. / 8, 1. / 8, 0};
    expect_refinement_equation(sample_basis_function(Scheme::CatmullClark, 4), rounded, [&](int a, int b, int c) {
        return binomial[std::abs(a)] * binomial[std::abs(b)] * binomial[std::abs(c)];
    });
}

TEST(BasisFunction, WithoutTensionMcqIsLinear) {
    const BasisFunction mcq = sample_basis_function(Scheme::Mcq, 3, 0), linear = sample_basis_function(Scheme::Linear, 3);
    for (int i = 0; i <= 24; ++i) EXPECT_EQ(mcq.at(i, i / 2, i / 3), linear.at(i, i / 2, i / 3));
}

TEST(BasisFunction, IsTheLimitOnAMesh) {
    const Index n = 8;
    HexMesh mesh = test::make_box(n, n, n);
    test::add_field(mesh, "phi", [](const Vec3& p) { return p == Vec3(4, 4, 4) ? 1.0 : 0.0; });
    for (const Scheme scheme : kSchemes) {
        const BasisFunction basis = sample_basis_function(scheme, 2);
        std::vector<LimitQuery> queries;
        std::vector<double> expected;
        for (int k = -12; k <= 12; k += 2) {
            for (int j = -12; j <= 12; ++j) {
                for (int i = -12; i < 12; ++i) {
                    const auto cell = [&](int x) { return static_cast<Index>(std::min(x / 4, 7)); };
                    const int x = i + 16, y = j + 16, z = k + 16;
                    queries.push_back(
                        {cell(x) + n * (cell(y) + n * cell(z)), Vec3(x, y, z) / 4.0 - Vec3(cell(x), cell(y), cell(z))});
                    expected.push_back(basis.at(i, j, k));
                }
            }
        }
        const LimitSamples samples = evaluate_limit(mesh, queries, {.scheme = {scheme}});
        for (std::size_t q = 0; q < queries.size(); ++q) {
            ASSERT_NEAR(samples.attributes[0].values[q], expected[q], 1e-15) << q;
        }
    }
}

TEST(BasisFunction, LevelsAreBounded) {
    test::expect_error(ErrorCode::InvalidInput, "level of the basis function is 8",
                       [] { (void)sample_basis_function(Scheme::Mcq, 8); });
    test::expect_error(ErrorCode::InvalidInput, "level of the basis function is -1",
                       [] { (void)sample_basis_function(Scheme::Linear, -1); });
    test::expect_error(ErrorCode::InvalidInput, "tension", [] { (void)sample_basis_function(Scheme::Mcq, 1, std::nan("")); });
}

}  // namespace basis_function_test
}  // namespace subvol
