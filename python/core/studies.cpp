// SPDX-License-Identifier: Apache-2.0
#include "bind.h"
#include "subvol/detail/printable.h"
#include "subvol/option.h"
#include "subvol/picture_maker.h"
#include "subvol/study.h"
#include "subvol/study_run.h"
#include "subvol/study_table.h"

namespace subvol::python {
namespace {

py::dict as_dict(const StudyValues& values) {
    py::dict result;
    for (const auto& [name, value] : values) {
        std::visit([&, key = name](const auto& of_a_type) { result[py::str(key)] = of_a_type; }, value);
    }
    return result;
}

py::dict as_dict(const CaseResult& result) {
    constexpr const char* kWhose = "the results of a study";
    py::dict figures;
    figures["metrics"] = read_only(py::cast(result.metrics), kWhose);
    figures["costs"] = read_only(py::cast(result.costs), kWhose);
    figures["notes"] = read_only(py::cast(result.notes), kWhose);
    figures["failure"] = result.failure;
    return figures;
}

/// The metrics that Python's function returns for a case. An error in it is the case's failure; Ctrl-C ends the run.
CaseResult work_on(const py::object& work, const StudyCase& item, std::optional<py::error_already_set>& interruption) {
    const py::gil_scoped_acquire with_gil;
    try {
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        const py::object metrics = work(item);
        CaseResult result;
        for (const auto& [name, value] : metrics.cast<py::dict>())
            result.metrics[py::str(name)] = py::float_(value.cast<py::object>());
        return result;
    } catch (py::error_already_set& error) {
        if (error.matches(PyExc_Exception)) {
            return {.failure = py::str(error.type().attr("__name__")).cast<std::string>() + ": " +
                               py::str(error.value()).cast<std::string>()};
        }
        interruption.emplace(std::move(error));
        throw Error(ErrorCode::Cancelled, "the study was interrupted");
    } catch (const py::cast_error&) {
        return {.failure = "the function did not return a dictionary of numbers"};
    }
}

std::unique_ptr<StudyResults> run_here(const Study& study, const py::object& work, const std::string& folder, bool fresh) {
    std::optional<py::error_already_set> interruption;
    auto results = std::make_unique<StudyResults>();
    try {
        const py::gil_scoped_release without_gil;
        *results = run_study(study, [&](const StudyCase& item) { return work_on(work, item, interruption); },
                             {.folder = folder, .jobs = 1, .fresh = fresh});
    } catch (const Error&) {
        if (interruption) throw py::error_already_set(std::move(*interruption));
        throw;
    }
    return results;
}

/// The methods of pictures, with the options that each reads.
std::vector<PictureMethod> picture_methods() {
    static PictureSettings any;  // reading a study changes it
    std::vector<PictureMethod> methods;
    for (const auto& row : NameTable<Method>::rows) methods.push_back({std::string(row.name), options_of(any, row.value)});
    return methods;
}

py::list tables_of(const StudyResults& results) {
    py::list tables;
    for (const StudyTable& table : make_tables(results)) {
        py::dict one;
        one["title"] = table.title;
        one["columns"] = table.columns;
        one["rows"] = table.rows;
        tables.append(one);
    }
    return tables;
}

}  // namespace

void bind_studies(py::module_& module) {
    py::class_<StudyCase>(module, "StudyCase", "One computation of a study.")
        .def_readonly("id", &StudyCase::id)
        .def_readonly("name", &StudyCase::name)
        .def_property_readonly("values",
                               [](const StudyCase& item) { return read_only(as_dict(item.values), "the values of a case"); })
        .def("__repr__", [](const StudyCase& item) { return "<subvol.StudyCase: " + detail::printable(item.name) + ">"; });
    py::class_<Study>(module, "Study", "Cases to run and measure, and how to show them.")
        .def_readonly("name", &Study::name)
        .def_readonly("title", &Study::title)
        .def_property_readonly("cases", [](const Study& study) { return py::tuple(py::cast(study.cases)); })
        .def("__len__", [](const Study& study) { return study.cases.size(); })
        .def("__repr__", [](const Study& study) {
            return "<subvol.Study: " + detail::printable(study.name) + ", " + std::to_string(study.cases.size()) + " cases>";
        });
    py::class_<StudyResults>(module, "StudyResults", "What the cases of a study gave, in their order.")
        .def_readonly("ran", &StudyResults::ran)
        .def_readonly("failed", &StudyResults::failed)
        .def_property_readonly("results",
                               [](const StudyResults& r) {
                                   py::list list;
                                   for (const CaseResult& one : r.results) {
                                       list.append(read_only(as_dict(one), "the results of a study"));
                                   }
                                   return py::tuple(list);
                               })
        .def("tables", &tables_of)
        .def("csv", &results_csv)
        .def("__repr__", [](const StudyResults& r) {
            return "<subvol.StudyResults: " + std::to_string(r.results.size()) + " cases, " + std::to_string(r.failed) +
                   " failed>";
        });
    module.def("list_studies", [] {
        py::dict studies;
        for (const StudyInfo& info : list_studies()) studies[py::str(info.name)] = info.title;
        return studies;
    });
    module.def(
        "built_in_study", [](const std::string& name) { return built_in_study(name, picture_methods()); }, py::arg("name"));
    module.def(
        "read_study", [](const std::string& path) { return read_study(path, picture_methods()); }, py::arg("path"));
    module.def(
        "parse_study", [](const std::string& json) { return parse_study(json, "study", picture_methods()); }, py::arg("json"));
    module.def("run_study", &run_here, py::arg("study"), py::arg("work"), py::arg("folder"), py::arg("fresh"));
}

}  // namespace subvol::python
