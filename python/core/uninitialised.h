// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

namespace subvol::python {

/// Makes uses of objects that `__new__` made and no `__init__` a TypeError, for all classes of a module. pybind11 would
/// allocate memory for them, and read whatever is in it.
inline void refuse_uninitialised(const pybind11::module_& module) {
    for (const auto& item : pybind11::reinterpret_borrow<pybind11::dict>(module.attr("__dict__"))) {
        if (PyType_Check(item.second.ptr()) == 0) continue;
        auto* type = pybind11::detail::get_type_info(reinterpret_cast<PyTypeObject*>(item.second.ptr()));
        if (type == nullptr) continue;
        type->operator_new = [](std::size_t) -> void* { throw pybind11::type_error("the object was not initialised"); };
    }
}

}  // namespace subvol::python
