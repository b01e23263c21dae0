// SPDX-License-Identifier: Apache-2.0
#include "vtkSubvolReader.h"

#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkObjectFactory.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkUnstructuredGrid.h>

#include "grids.h"
#include "option_words.h"
#include "subvol/error.h"
#include "subvol/mesh_io.h"
#include "subvol/mesh_series.h"

using namespace subvol;

using Pipeline = vtkStreamingDemandDrivenPipeline;

vtkStandardNewMacro(vtkSubvolReader);

vtkSubvolReader::vtkSubvolReader() {
    SetNumberOfInputPorts(0);
}

void vtkSubvolReader::PrintSelf(ostream& os, vtkIndent indent) {
    Superclass::PrintSelf(os, indent);
    os << indent << "FileName: " << FileName << '\n' << indent << "Options: " << Options << '\n';
}

int vtkSubvolReader::CanReadFile(const char* name) {
    try {
        return name != nullptr && is_mesh_file(name) ? 1 : 0;
    } catch (const std::exception&) {
        return 0;
    }
}

int vtkSubvolReader::RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs) {
    try {
        if (FileName.empty()) throw Error(ErrorCode::InvalidInput, "no file is named", "FileName");
        const MeshSeries series = open_series(FileName);
        vtkInformation& output = *outputs->GetInformationObject(0);
        output.Remove(Pipeline::TIME_STEPS());
        output.Remove(Pipeline::TIME_RANGE());
        if (series.size() < 2) return 1;
        const double range[]{series.times.front(), series.times.back()};
        output.Set(Pipeline::TIME_STEPS(), series.times.data(), static_cast<int>(series.size()));
        output.Set(Pipeline::TIME_RANGE(), range, 2);
    } catch (const std::exception& error) {
        vtkErrorMacro(<< error.what());
        return 0;
    }
    return 1;
}

int vtkSubvolReader::RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs) {
    vtkInformation& output = *outputs->GetInformationObject(0);
    try {
        ReadOptions options;
        set_options(options_of(options), words_of(Options.c_str()));
        const MeshSeries series = open_series(FileName);
        const bool chosen = options.step || options.time;  // by its number or time, for good
        if (!chosen && series.size() > 1 && output.Has(Pipeline::UPDATE_TIME_STEP()))
            options.step = nearest_step(series, output.Get(Pipeline::UPDATE_TIME_STEP()));
        const ReadResult read = read_mesh(FileName, options);
        vtkUnstructuredGrid& grid = *vtkUnstructuredGrid::GetData(outputs);
        set_grid(grid, read.mesh, read.sets);
        if (series.size() > 1) grid.GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), series.times[read.step]);
        for (const std::string& warning : read.warnings) vtkWarningMacro(<< FileName << ": " << warning);
    } catch (const std::exception& error) {
        vtkErrorMacro(<< error.what());
        return 0;
    }
    return 1;
}
