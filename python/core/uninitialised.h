// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

#include <exception>
#include <string>

namespace subvol::python {

/// Memory of an object for the buffer protocol. Python calls this from C, where an exception of C++ ends the process.
inline int buffer_of(PyObject* object, Py_buffer* view, int flags) noexcept {
    try {
        return pybind11::detail::pybind11_getbuffer(object, view, flags);
    } catch (pybind11::error_already_set& error) {
        error.restore();
    } catch (const pybind11::builtin_exception& error) {
        error.set_error();
    } catch (const std::exception& error) {
        PyErr_SetString(PyExc_BufferError, error.what());
    }
    if (view != nullptr) view->obj = nullptr;
    return -1;
}

/// How an object is pickled and copied, by all protocols: the oldest would make an object of the base of all classes of
/// pybind11, which ends the process.
inline pybind11::tuple reduced(const pybind11::object& object) {
    if (!pybind11::hasattr(object, "__setstate__")) {
        throw pybind11::type_error("cannot pickle '" +
                                   pybind11::str(pybind11::type::of(object).attr("__name__")).cast<std::string>() + "' object");
    }
    const auto make = pybind11::module_::import("copyreg").attr("__newobj__");
    return pybind11::make_tuple(make, pybind11::make_tuple(pybind11::type::of(object)), object.attr("__getstate__")());
}

/// Makes uses of objects that `__new__` made and no `__init__` a TypeError, for all classes of a module, and pickling safe.
/// pybind11 would allocate memory for them, and read whatever is in it.
inline void refuse_uninitialised(const pybind11::module_& module) {
    for (const auto& item : pybind11::reinterpret_borrow<pybind11::dict>(module.attr("__dict__"))) {
        if (PyType_Check(item.second.ptr()) == 0) continue;
        auto* type = pybind11::detail::get_type_info(reinterpret_cast<PyTypeObject*>(item.second.ptr()));
        if (type == nullptr) continue;
        type->operator_new = [](std::size_t) -> void* { throw pybind11::type_error("the object was not initialised"); };
        item.second.attr("__reduce__") = pybind11::cpp_function(&reduced, pybind11::is_method(item.second));
        if (PyBufferProcs* buffer = type->type->tp_as_buffer; buffer != nullptr && buffer->bf_getbuffer != nullptr) {
            buffer->bf_getbuffer = &buffer_of;
        }
    }
}

}  // namespace subvol::python
