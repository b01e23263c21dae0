// SPDX-License-Identifier: Apache-2.0
#ifndef vtkSubvolVolumeMapper_h
#define vtkSubvolVolumeMapper_h

#include <memory>

#include "SubvolVtkModule.h"
#include "vtkUnstructuredGridVolumeMapper.h"

/// Draws the limit of a grid as a volume: the picture of `subvol render` by VTK's camera, colours, opacities, unit distance and
/// clipping planes. Rays end at what VTK has drawn before, so that opaque geometry shows in the right place inside the volume,
/// too. Colours are those of the screen, without conversion, as VTK's own.
///
/// The picture is kept, and shown again as long as nothing that it depends on has changed.
class SUBVOLVTK_EXPORT vtkSubvolVolumeMapper : public vtkUnstructuredGridVolumeMapper {
public:
    static vtkSubvolVolumeMapper* New();
    vtkTypeMacro(vtkSubvolVolumeMapper, vtkUnstructuredGridVolumeMapper);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    void Render(vtkRenderer* renderer, vtkVolume* volume) override;
    void ReleaseGraphicsResources(vtkWindow* window) override;

    /// The method of the picture, as of `subvol render --method`: splat, tets, dense.
    void SetMethod(const char* name);
    /// What draws splats: auto (a GPU if there is one, else the CPU), cpu, gl. Our OpenGL has a thread of its own, as its
    /// context cannot be current beside VTK's.
    void SetRenderer(const char* name);
    /// What drew the last picture: "cpu" or "gl"; empty before the first one.
    const char* GetBackend();
    /// Any other option of pictures by its name in Python, such as "scheme" to "cc" or "samples" to "2"; nothing or an empty
    /// text: its default.
    void SetOption(const char* name, const char* text);
    /// Several of them in one text: "per_edge=2 shade=1".
    void SetOptions(const char* text);
    void SetScheme(const char* name) { SetOption("scheme", name); }
    /// Light on surfaces of equal value.
    void SetShade(bool shade) { SetOption("shade", shade ? "1" : ""); }

    /// One pixel stands for so many along each side; 0: for 3 while the window is asked for many frames a second, else 1.
    vtkSetClampMacro(Reduction, int, 0, 16);
    vtkGetMacro(Reduction, int);

    /// Whether the last call of Render() kept the picture, and the seconds that it took.
    vtkGetMacro(Kept, bool);
    vtkGetMacro(Seconds, double);

protected:
    vtkSubvolVolumeMapper();
    ~vtkSubvolVolumeMapper() override;

private:
    vtkSubvolVolumeMapper(const vtkSubvolVolumeMapper&) = delete;
    void operator=(const vtkSubvolVolumeMapper&) = delete;

    struct State;
    std::unique_ptr<State> Internals;
    int Reduction = 0;
    bool Kept = false;
    double Seconds = 0;
};

#endif
