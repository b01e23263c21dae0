// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <epoxy/gl.h>

#include <string>
#include <vector>

#include "subvol/gl_device.h"

namespace subvol::detail {

/// Measures how long the device takes for each stage of the work, on the current context.
class GlStages {
public:
    ~GlStages() { clear(); }
    GlStages() = default;
    GlStages(const GlStages&) = delete;
    GlStages& operator=(const GlStages&) = delete;

    void clear() {
        for (const Mark& mark : marks_) glDeleteQueries(1, &mark.query);
        marks_.clear();
    }
    /// Begins a stage; an empty name only ends the one before.
    void begin(const char* stage) {
        GLuint query = 0;
        glGenQueries(1, &query);
        glQueryCounter(query, GL_TIMESTAMP);
        marks_.push_back({stage, query});
    }
    /// Stages with the same name are added up. Waits for the device.
    [[nodiscard]] std::vector<StageTime> times() const;

private:
    struct Mark {
        const char* stage;
        GLuint query;
    };
    std::vector<Mark> marks_;
};

}  // namespace subvol::detail
