# SPDX-License-Identifier: Apache-2.0
"""Voxels with labels as files, written without the library: .vdb, .vti and .nrrd."""

import gzip
import struct
import zlib

import numpy

# A turn about an oblique axis by 40°, exact in doubles to rounding.
_AXIS = numpy.array([1, 2, 2]) / 3
_CROSS = numpy.array([[0, -_AXIS[2], _AXIS[1]], [_AXIS[2], 0, -_AXIS[0]], [-_AXIS[1], _AXIS[0], 0]])
TURN = numpy.eye(3) + numpy.sin(numpy.radians(40)) * _CROSS + (1 - numpy.cos(numpy.radians(40))) * _CROSS @ _CROSS


def voxels(size, label):
    """Labels [i, j, k] of voxels whose centres are at whole numbers. label: of arrays x, y, z"""
    return label(*numpy.meshgrid(*(numpy.arange(n, dtype=float) for n in size), indexing="ij")).astype(numpy.int32)


def _text(words):
    return struct.pack("<I", len(words)) + words.encode()


def _bits(flags):
    return numpy.packbits(numpy.asarray(flags, bool), bitorder="little").tobytes()


def write_vdb(path, labels, voxel=1.0, origin=(0, 0, 0), first=(0, 0, 0), name="labels", kind="int32", tiles=True):
    """A grid of OpenVDB's file version 224, not compressed. Voxel [0, 0, 0] has the index `first`, a multiple of 8; what is 0 is not active.

    tiles: blocks of one label are tiles
    """
    number = {"int32": "<i4", "int64": "<i8", "float": "<f4"}[kind]
    first = numpy.asarray(first)
    padded = numpy.pad(labels, [(0, -n % 8) for n in labels.shape])
    leaves = {}
    for at in numpy.ndindex(*(n // 8 for n in padded.shape)):
        block = padded[tuple(slice(8 * a, 8 * a + 8) for a in at)]
        if block.any():
            leaves[tuple(int(a) for a in 8 * numpy.asarray(at) + first)] = block
    uppers = {}
    for at in leaves:
        lower = tuple(a // 128 * 128 for a in at)
        uppers.setdefault(tuple(a // 4096 * 4096 for a in at), {}).setdefault(lower, []).append(at)
    zero = numpy.zeros(1, number).tobytes()
    whole = b"\x06"  # all values follow
    topology, buffers = struct.pack("<i", 1) + zero + struct.pack("<II", 0, len(uppers)), b""
    for upper, lowers in sorted(uppers.items()):
        place = lambda at, origin, step, side: int(((numpy.asarray(at) - origin) // step) @ (side * side, side, 1))
        children = {place(lower, upper, 128, 32): lower for lower in lowers}
        topology += struct.pack("<iii", *upper) + _bits([n in children for n in range(32768)]) + bytes(4096) + whole + 32768 * zero
        for _, lower in sorted(children.items()):
            inside = {place(at, lower, 8, 16): leaves[at] for at in lowers[lower]}
            is_tile = {n: tiles and (block == block[0, 0, 0]).all() for n, block in inside.items()}
            values = numpy.zeros(4096, number)
            for n, block in inside.items():
                values[n] = block[0, 0, 0] if is_tile[n] else 0
            topology += _bits([n in inside and not is_tile[n] for n in range(4096)]) + _bits([is_tile.get(n, False) for n in range(4096)])
            topology += whole + values.tobytes()
            for n, block in sorted(inside.items()):
                if not is_tile[n]:
                    mask = _bits(block.ravel() != 0)
                    topology += mask
                    buffers += mask + whole + block.astype(number).tobytes()
    matrix = numpy.eye(4)
    matrix[:3, :3] = (numpy.eye(3) * voxel if numpy.ndim(voxel) < 2 else numpy.asarray(voxel)).T  # rows are the edges of a voxel
    matrix[3, :3] = origin
    head = struct.pack("<qIIIB", 0x56444220, 224, 10, 0, 1) + b"00000000-0000-0000-0000-000000000000" + struct.pack("<I", 0) + struct.pack("<i", 1)
    head += _text(name) + _text(f"Tree_{kind}_5_4_3") + _text("")
    grid = struct.pack("<I", 0) + struct.pack("<I", 0) + _text("AffineMap") + matrix.astype("<f8").tobytes()
    begin = len(head) + 24
    blocks = begin + len(grid) + len(topology)
    path.write_bytes(head + struct.pack("<qqq", begin, blocks, blocks + len(buffers)) + grid + topology + buffers)


def write_vti(path, labels, spacing=(1, 1, 1), origin=(0, 0, 0), turn=None, at="CellData", kind="Int32", name="labels", extra=""):
    """An image with appended data, compressed by zlib. origin: the centre of voxel [0, 0, 0]"""
    number = {"Int32": "<i4", "UInt8": "<u1", "Int64": "<i8", "UInt16": "<u2", "Float32": "<f4"}[kind]
    turn = numpy.eye(3) if turn is None else numpy.asarray(turn)
    corner = numpy.asarray(origin, float)
    if at == "CellData":
        corner = corner - turn @ (numpy.asarray(spacing) / 2)
    extent = " ".join(f"0 {n if at == 'CellData' else n - 1}" for n in labels.shape)
    raw = labels.astype(number).tobytes(order="F")
    packed = zlib.compress(raw)
    numbers = lambda values: " ".join(repr(float(x)) for x in numpy.ravel(values))
    head = f"""<?xml version="1.0"?>
<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian" header_type="UInt64" compressor="vtkZLibDataCompressor">
<ImageData WholeExtent="{extent}" Origin="{numbers(corner)}" Spacing="{numbers(spacing)}" Direction="{numbers(turn)}">
<Piece Extent="{extent}">
<{at}>
<DataArray type="{kind}" Name="{name}" format="appended" offset="0"/>{extra}
</{at}>
</Piece>
</ImageData>
<AppendedData encoding="raw">
_"""
    path.write_bytes(head.encode() + struct.pack("<QQQQ", 1, len(raw), 0, len(packed)) + packed + b"\n</AppendedData>\n</VTKFile>\n")


def write_nrrd(path, labels, edges=None, origin=(0, 0, 0), encoding="gzip", kind="int32", space="left-posterior-superior", head=""):
    """edges: of a voxel, in the columns; origin: the centre of voxel [0, 0, 0]"""
    number = {"int32": "<i4", "uchar": "<u1", "unsigned short": "<u2", "short": ">i2", "float": "<f4", "int64": "<i8"}[kind]
    edges = numpy.eye(3) if edges is None else numpy.asarray(edges)
    raw = labels.astype(number).tobytes(order="F")
    vector = lambda v: "(" + ",".join(repr(float(x)) for x in v) + ")"
    lines = ["NRRD0004", "# written by a test", f"type: {kind}", "dimension: 3", f"space: {space}", "sizes: " + " ".join(map(str, labels.shape)),
             "space directions: " + " ".join(vector(edges[:, k]) for k in range(3)), "kinds: domain domain domain",
             f"endian: {'big' if number[0] == '>' else 'little'}", f"encoding: {encoding}", "space origin: " + vector(origin)]
    data = {"gzip": lambda: gzip.compress(raw), "raw": lambda: raw, "ascii": lambda: " ".join(map(str, labels.ravel(order="F"))).encode()}[encoding]()
    path.write_bytes(("\n".join(lines) + "\n" + head + "\n").encode() + data)
