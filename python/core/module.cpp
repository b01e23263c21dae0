// SPDX-License-Identifier: Apache-2.0
// The extension subvol._core: all but grids, which subvol._grids has, so that OpenVDB is loaded by its first use.
#include <tbb/global_control.h>

#include <memory>
#include <string_view>

#include "bind.h"
#include "given_grids.h"
#include "subvol/detail/error_text.h"
#include "subvol/detail/most_threads.h"
#include "subvol/detail/several_errors.h"
#include "subvol/option.h"
#include "subvol/scheme.h"
#include "subvol/version.h"
#include "uninitialised.h"

namespace subvol::python {
namespace {

py::str text_of(std::string_view bytes) {  // file names may be any bytes
    return py::reinterpret_steal<py::str>(
        PyUnicode_DecodeUTF8(bytes.data(), static_cast<py::ssize_t>(bytes.size()), "backslashreplace"));
}

/// The exceptions are classes of Python (subvol/_errors.py).
void raise(const Error& error) {
    const auto code = [&]() -> const char* {
        switch (error.code()) {
            case ErrorCode::InvalidInput:
                return "InvalidInput";
            case ErrorCode::Io:
                return "FileError";
            case ErrorCode::MissingCapability:
                return "MissingCapability";
            case ErrorCode::Cancelled:
                return "Cancelled";
        }
        return "Error";
    }();
    const py::object type = py::module_::import("subvol._errors").attr(code);
    // The places of several mistakes have lines of their own, which are cut already.
    const bool several = dynamic_cast<const detail::SeveralErrors*>(&error) != nullptr;
    const std::string sentence =
        several ? error.what() : detail::error_sentence(error.where(), error.message(), error.allowed());
    const py::object value = type(text_of(sentence), text_of(error.where()), text_of(error.allowed()));
    PyErr_SetObject(type.ptr(), value.ptr());
}

void translate(std::exception_ptr failure) {
    try {
        if (failure) std::rethrow_exception(failure);
    } catch (const Error& error) {
        raise(error);
    }
}

std::unique_ptr<tbb::global_control> thread_limit;

void set_threads(int threads) {
    if (threads < 0 || threads > detail::kMostThreads) {
        throw Error(ErrorCode::InvalidInput, std::to_string(threads) + " threads", "set_threads",
                    "0 to " + std::to_string(detail::kMostThreads));
    }
    thread_limit.reset();
    if (threads == 0) return;
    thread_limit =
        std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
}

}  // namespace

RefineOptions refine_options(const std::string& scheme, int levels, double tension, const std::optional<double>& crease_angle) {
    const SchemeOptions rules{.kind = scheme_named(scheme), .tension = tension, .crease_angle_deg = crease_angle};
    check_options(rules);
    return {.scheme = rules, .levels = levels};
}

}  // namespace subvol::python

PYBIND11_MODULE(_core, module) {
    using namespace subvol::python;
    module.doc() = "The calls of the C++ library, as they are. Use the package subvol.";
    module.attr("__version__") = SUBVOL_VERSION;
    py::register_exception_translator(&translate);
    module.def("set_threads", &set_threads, py::arg("threads"));
    bind_mesh(module);
    bind_look(module);
    bind_refine(module);
    bind_measure(module);
    bind_points(module);
    bind_render(module);
    bind_compare(module);
    bind_page(module);
    bind_studies(module);
    GivenGrids given;
    for (const char* call : {"rasterize", "write_vdb"}) describe(module, call, options_of(given));
    refuse_uninitialised(module);
}
