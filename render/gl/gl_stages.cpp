// SPDX-License-Identifier: Apache-2.0
#include "gl_stages.h"

#include <algorithm>

namespace subvol::detail {

std::vector<StageTime> GlStages::times() const {
    std::vector<StageTime> result;
    GLuint64 before = 0;
    for (std::size_t i = 0; i < marks_.size(); ++i) {
        GLuint64 now = 0;
        glGetQueryObjectui64v(marks_[i].query, GL_QUERY_RESULT, &now);
        if (i > 0 && *marks_[i - 1].stage != '\0') {
            const char* const name = marks_[i - 1].stage;
            auto at = std::find_if(result.begin(), result.end(), [&](const StageTime& s) { return s.stage == name; });
            if (at == result.end()) at = result.insert(at, {name, 0});
            at->seconds += static_cast<double>(now - before) * 1e-9;
        }
        before = now;
    }
    return result;
}

}  // namespace subvol::detail
