#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Steps of work by VTK, each alone: its CPU seconds and the process's peak memory in MB, without the start of Python.

    vtk_steps.py read MESH.vtu
    vtk_steps.py contour MESH.vtu VALUE        prints the number of triangles, too
    vtk_steps.py resample MESH.vtu SIDE FILE   writes the values of boxes, SIDE along each axis, as an array of numpy
"""
import json
import resource
import sys
import time

import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy


def reader_of(mesh):
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(mesh)
    return reader


def read(mesh):
    reader = reader_of(mesh)
    reader.Update()
    return {"cells": reader.GetOutput().GetNumberOfCells()}


def contour(mesh, value):
    reader = reader_of(mesh)
    reader.Update()
    reader.GetOutput().GetPointData().SetActiveScalars("density")
    cut = vtk.vtkContourFilter()
    cut.SetInputConnection(reader.GetOutputPort())
    cut.SetValue(0, float(value))
    cut.Update()
    return {"triangles": cut.GetOutput().GetNumberOfCells()}


def resample(mesh, side, file):
    reader = reader_of(mesh)  # kept: the port does not keep it
    boxes = vtk.vtkResampleToImage()
    boxes.SetInputConnection(reader.GetOutputPort())
    boxes.SetSamplingDimensions(int(side), int(side), int(side))
    boxes.Update()
    data, shape = boxes.GetOutput().GetPointData(), (int(side),) * 3
    values = vtk_to_numpy(data.GetArray("density")).reshape(shape).transpose(2, 1, 0).astype(numpy.float32)
    mask = vtk_to_numpy(data.GetArray("vtkValidPointMask")).reshape(shape).transpose(2, 1, 0)
    values[mask == 0] = 0
    numpy.save(file, values)
    return {"active": int((values != 0).sum())}


def main(step, *words):
    begin = time.process_time()
    found = {"read": read, "contour": contour, "resample": resample}[step](*words)
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(json.dumps({"cpu": time.process_time() - begin, "mb": memory, "version": vtk.vtkVersion().GetVTKVersion(), **found}))


main(*sys.argv[1:])
