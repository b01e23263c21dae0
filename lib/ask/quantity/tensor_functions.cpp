// SPDX-License-Identifier: Apache-2.0
#include "tensor_functions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <utility>

namespace subvol::detail {
namespace {

constexpr std::size_t kSymmetric = 6;

/// The symmetric part of a tensor of six or nine channels.
struct Symmetric {
    double xx, yy, zz, xy, yz, xz;
};

Symmetric symmetric(std::span<const double> t) {
    if (t.size() == kSymmetric) return {t[0], t[1], t[2], t[3], t[4], t[5]};
    return {t[0], t[4], t[8], (t[1] + t[3]) / 2, (t[5] + t[7]) / 2, (t[2] + t[6]) / 2};
}

double trace(std::span<const double> t) {
    const Symmetric s = symmetric(t);
    return s.xx + s.yy + s.zz;
}

double hydrostatic(std::span<const double> t) {
    return trace(t) / 3;
}

double norm(std::span<const double> t) {
    double squares = 0;
    for (const double value : t) squares += value * value;
    if (t.size() == kSymmetric) squares += t[3] * t[3] + t[4] * t[4] + t[5] * t[5];  // each stands twice in the matrix
    return std::sqrt(squares);
}

double mises(std::span<const double> t) {
    const Symmetric s = symmetric(t);
    const double a = s.xx - s.yy, b = s.yy - s.zz, c = s.zz - s.xx;
    return std::sqrt((a * a + b * b + c * c) / 2 + 3 * (s.xy * s.xy + s.yz * s.yz + s.xz * s.xz));
}

double determinant(std::span<const double> t) {
    std::array<double, 9> m{};
    if (t.size() == kSymmetric) {
        m = {t[0], t[3], t[5], t[3], t[1], t[4], t[5], t[4], t[2]};
    } else {
        std::ranges::copy(t, m.begin());
    }
    return m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) + m[2] * (m[3] * m[7] - m[4] * m[6]);
}

/// The eigenvalues of the symmetric part, the largest first, by Jacobi's rotations: exact for tensors that are nearly multiples
/// of the identity, too.
std::array<double, 3> principals(std::span<const double> t) {
    const Symmetric s = symmetric(t);
    double m[3][3] = {{s.xx, s.xy, s.xz}, {s.xy, s.yy, s.yz}, {s.xz, s.yz, s.zz}};
    constexpr int kMostSweeps = 20;
    for (int sweep = 0; sweep < kMostSweeps && (m[0][1] != 0 || m[0][2] != 0 || m[1][2] != 0); ++sweep) {
        for (const auto& [p, q] : {std::pair{0, 1}, {0, 2}, {1, 2}}) {
            if (m[p][q] == 0) continue;
            const int r = 3 - p - q;
            const double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
            const double tangent = std::copysign(1, theta) / (std::abs(theta) + std::hypot(theta, 1.0));
            const double cosine = 1 / std::hypot(tangent, 1.0), sine = tangent * cosine;
            m[p][p] -= tangent * m[p][q];
            m[q][q] += tangent * m[p][q];
            const double a = m[r][p], b = m[r][q];
            m[r][p] = m[p][r] = cosine * a - sine * b;
            m[r][q] = m[q][r] = sine * a + cosine * b;
            m[p][q] = m[q][p] = 0;
        }
    }
    std::array<double, 3> values{m[0][0], m[1][1], m[2][2]};
    std::ranges::sort(values, std::greater());
    return values;
}

template <std::size_t K>
double principal(std::span<const double> t) {
    return principals(t)[K];
}

/// The largest difference of principal values, twice the largest shear.
double tresca(std::span<const double> t) {
    const std::array<double, 3> values = principals(t);
    return values[0] - values[2];
}

constexpr std::array kTensors{6, 9};
constexpr std::string_view kTensorWords = "a tensor with 6 or 9 components";

constexpr std::array<TensorFunction, 10> kFunctions{{{"length", "a vector or tensor", {}, norm, false, true},
                                                     {"norm", "a vector or tensor", {}, norm, false, true},
                                                     {"mises", kTensorWords, kTensors, mises, false, true},
                                                     {"principal1", kTensorWords, kTensors, principal<0>},
                                                     {"principal2", kTensorWords, kTensors, principal<1>},
                                                     {"principal3", kTensorWords, kTensors, principal<2>},
                                                     {"tresca", kTensorWords, kTensors, tresca, false, true},
                                                     {"hydrostatic", kTensorWords, kTensors, hydrostatic, true},
                                                     {"trace", kTensorWords, kTensors, trace, true},
                                                     {"det", kTensorWords, kTensors, determinant}}};

}  // namespace

const TensorFunction* find_tensor_function(std::string_view name) {
    const auto* const found = std::ranges::find(kFunctions, name, &TensorFunction::name);
    return found == kFunctions.end() ? nullptr : found;
}

std::vector<std::string_view> tensor_functions() {
    std::vector<std::string_view> names;
    for (const TensorFunction& function : kFunctions) names.push_back(function.name);
    return names;
}

}  // namespace subvol::detail
