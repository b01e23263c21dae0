// SPDX-License-Identifier: Apache-2.0
#include "manual_chapters.h"

namespace subvol::cli {

const std::array<Chapter, 3> kFirstChapters{
    {{"THE VOLUME",
      R"(A mesh of hexahedra with values at its points is the control mesh. A scheme refines it again and again; what the
levels converge to is the limit, in geometry and in values. The volume is the limit. Outside of it there is nothing, which is not the
same as a value of 0. --levels L takes the mesh of level L with trilinear cells instead; --levels 0 is the mesh as it came.

mcq = the default: passes through the control points; smooth except at irregular edges. It can fold badly shaped cells; subvol
subdivide counts them.

cc = Catmull-Clark solids: smooth, does not pass through the control points.

bsxw = the scheme of Bajaj, Schaefer, Warren and Xu: likewise.

linear = trilinear cells: what most programs show.)"},
     {"FIELDS",
      R"(Values may be at points or at cells. Values at cells become values at points: the mean over the cells at a point,
weighted by volume. A vector counts by its length; NAME.k is its component k. Without --field a physical scalar is taken rather than
node numbers, flags or constants, and the choice is said. --density takes an expression in x, y and z instead, such as
sin(3*x)+z. A mesh without fields has the density 1.)"},
     {"FILES",
      R"(Which format a file has follows from its extension. Meshes: MEDIT .mesh and .meshb; VTK .vtk, .vtu, .vts, .vtr and
.vti; Gmsh .msh; Plot3D .xyz and .p3d; Exodus II .e, .exo, .ex2 and .g; VTKHDF .vtkhdf and .hdf; XDMF .xdmf and .xmf; CGNS
.cgns; CalculiX .frd; Abaqus .inp; EnSight .case; OpenFOAM .foam, or the folder of a case; lists of files .pvd, .series, .vtm and
.pvtu; wavelets .svw. Points: .ply, .vtp, .svk and .vdb. Grids: .vdb. Pictures: .png and .exr, and what OpenImageIO reads.
model:NAME and model:NAME:RESOLUTION generate a mesh.

An output file is complete or absent: it is written under a temporary name beside its place, and takes its name when it is done. What
was there before stays if the command fails, and leaves its permissions to what replaces it. A row of # in a name stands for the number of a frame.)"}}};

const std::array<Chapter, 6> kLastChapters{
    {{"OUTPUT FOR PROGRAMS",
      R"(With --json a verb prints one JSON object on standard output, and nothing else there. Numbers are in SI or
world units, seconds and bytes. warnings is a list of sentences; seconds has the time of each stage; peak_bytes is the most memory that
was held. If there is an error, the object has the one key error, with

code = the exit code,

what = the sentence without its place,

where = the option, file, line or cell that is wrong; may be empty,

allowed = what would be right; may be empty.

Messages for people are on standard error.)"},
     {"A FIRST SESSION", R"(Look at a mesh before anything else: info ends with a verdict.

  subvol info part.vtk

Draw it; --views 4 shows it from four sides. Then look into it: opacities at percentages of the field's range.

  subvol render part.vtk -o part.png --views 4
  subvol render part.vtk -o inside.png --tf coolwarm --opacity 0%:0,50%:.1,100%:.8

How good is a picture? Draw the reference by rays, and compare. Above 40 dB people see no difference.

  subvol render part.vtk -o splat.exr
  subvol render part.vtk -o rays.exr --method tets --levels 2
  subvol compare splat.exr rays.exr --heatmap difference.png

Take it to a renderer of films.

  subvol vdb part.vtk -o part.vdb --resolution 400)"},
     {"HOW LONG THINGS TAKE",
      R"(Splats of a few thousand cells take under a second. Rays through tetrahedra take seconds, through dense
grids minutes: draw a smaller --size first, or fewer --levels. The time of a grid grows with the number of its voxels, eightfold for
twice the --resolution. Every level makes eight cells of one. The progress bar on a terminal estimates the time left; Ctrl-C ends the
command within half a second and leaves no unfinished file.)"},
     {"SHARES OF THE WORK",
      R"(Of points, vdb, render and info, --part K/N does one of N shares, K from 1 to N, and writes it as a file of its own: for
the array jobs of batch systems. join puts the files together; the result has the bits of one process. mpirun -n N subvol VERB does all
shares at once, in builds with MPI; rank 0 writes the one output, and speaks for all.

  subvol vdb part.vtu -o slab1.vdb --part 1/2
  subvol vdb part.vtu -o slab2.vdb --part 2/2
  subvol join slab1.vdb slab2.vdb -o part.vdb)"},
     {"ENVIRONMENT", R"(SOURCE_DATE_EPOCH = the date of this page, in seconds, where it is made.

COLUMNS, LINES = not used: help is 80 columns wide.

TMPDIR = where a file that goes to a pipe or a device is made first.)"},
     {"SEE ALSO", R"(ffmpeg(1), for videos; paraview(1); blender(1).

The documents of the sources: docs/pictures.md (looks and colours), docs/studies.md (error studies), docs/formats.md (files),
docs/science.md (what is computed), docs/cookbook.md (other programs), docs/shares.md (shares of the work).)"}}};

}  // namespace subvol::cli
