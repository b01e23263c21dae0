// SPDX-License-Identifier: Apache-2.0
#ifndef vtkSubvolRepresentation_h
#define vtkSubvolRepresentation_h

#include "SubvolParaViewModule.h"
#include "vtkNew.h"
#include "vtkSubvolVolumeMapper.h"
#include "vtkVolumeRepresentation.h"

/// "Subdivision splats" of ParaView: the limit of an unstructured grid, or of several blocks together, as a volume, drawn by
/// vtkSubvolVolumeMapper, with a coarse picture while one turns the view. Cells are distributed among ranks as by ParaView's
/// own volumes.
class SUBVOLPARAVIEW_EXPORT vtkSubvolRepresentation : public vtkVolumeRepresentation {
public:
    static vtkSubvolRepresentation* New();
    vtkTypeMacro(vtkSubvolRepresentation, vtkVolumeRepresentation);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    using vtkVolumeRepresentation::SetInputArrayToProcess;
    /// Blocks are put together again, those that have the array.
    void SetInputArrayToProcess(int index, int port, int connection, int association, const char* name) override;

    int ProcessViewRequest(vtkInformationRequestKey* request, vtkInformation* in, vtkInformation* out) override;

    // The mapper has them.
    void SetMethod(const char* name) { Mapper->SetMethod(name); }
    void SetRenderer(const char* name) { Mapper->SetRenderer(name); }
    void SetScheme(const char* name) { Mapper->SetScheme(name); }
    void SetShade(bool shade) { Mapper->SetShade(shade); }
    void SetOptions(const char* text) { Mapper->SetOptions(text); }

    /// How many pixels along each side one of a picture stands for while one turns the view.
    vtkSetClampMacro(InteractiveReduction, int, 1, 16);
    vtkGetMacro(InteractiveReduction, int);

protected:
    vtkSubvolRepresentation();
    ~vtkSubvolRepresentation() override = default;

    int FillInputPortInformation(int port, vtkInformation* info) override;
    int RequestData(vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;
    bool AddToView(vtkView* view) override;
    bool RemoveFromView(vtkView* view) override;

private:
    vtkSubvolRepresentation(const vtkSubvolRepresentation&) = delete;
    void operator=(const vtkSubvolRepresentation&) = delete;

    void ChooseArray();

    vtkNew<vtkSubvolVolumeMapper> Mapper;
    vtkSmartPointer<vtkDataObject> Cells;  // of this rank
    bool Joined = false;                   // of blocks, with values at points
    int InteractiveReduction = 3;
};

#endif
