// SPDX-License-Identifier: Apache-2.0
#include "rbf_terms.h"

namespace subvol::detail {

std::vector<KernelTerms> terms_of(const RbfVolume& volume, const RbfChannel& channel) {
    std::vector<KernelTerms> terms(volume.size());
    for (std::size_t i = 0; i < terms.size(); ++i) {
        const auto& g = channel.gradients[i];
        const Vec3 h = to_frame(volume.frames[i], Vec3(g[0], g[1], g[2]));
        terms[i] = {double(channel.values[i]), h.x, h.y, h.z, double(channel.moments[i])};
    }
    return terms;
}

void set_terms(RbfChannel& channel, std::span<const Symmetric3> frames, std::span<const KernelTerms> terms) {
    channel.values.resize(terms.size());
    channel.gradients.resize(terms.size());
    channel.moments.resize(terms.size());
    for (std::size_t i = 0; i < terms.size(); ++i) {
        const KernelTerms& t = terms[i];
        const Vec3 g = inverse_root(frames[i]).transposed_times({t[1], t[2], t[3]});
        channel.values[i] = static_cast<float>(t[0]);
        channel.gradients[i] = {static_cast<float>(g.x), static_cast<float>(g.y), static_cast<float>(g.z)};
        channel.moments[i] = static_cast<float>(t[4]);
    }
}

}  // namespace subvol::detail
