"""Writes structured grids in every way that VTK has, as XML and as legacy files, into the folder named as argument, and prints their names.

The grids are those of tests/import/file.rs. Ends with status 3 where pyvista is not installed.
"""

import sys

try:
    import numpy
    import pyvista
    from vtkmodules.vtkIOLegacy import vtkStructuredGridWriter
    from vtkmodules.vtkIOXML import vtkXMLStructuredGridWriter
except ImportError as missing:
    print(missing, file=sys.stderr)
    sys.exit(3)

folder = sys.argv[1]


def grid(counts, dtype):
    points = []
    for k in range(counts[2]):
        for j in range(counts[1]):
            for i in range(counts[0]):
                z = 2.5 if counts[2] == 1 else k + 0.25 * i
                points.append((i + 0.125 * j, j - 0.0625 * i, z))
    made = pyvista.StructuredGrid()
    made.points = numpy.array(points, dtype=dtype)
    made.dimensions = counts
    cells = made.n_cells
    for name, step in (("one", 1), ("two", 3)):
        made.cell_data["alpha." + name] = numpy.array([cell * step % 5 / 8 for cell in range(cells)], dtype=dtype)
    made.cell_data["normal"] = numpy.full((cells, 3), numpy.nan)
    made.point_data["velocity"] = numpy.zeros((made.n_points, 3))
    return made


def write(name, made, mode, encode, compressor, order, header):
    writer = vtkXMLStructuredGridWriter()
    writer.SetFileName(folder + "/" + name)
    writer.SetInputData(made)
    getattr(writer, "SetDataModeTo" + mode)()
    writer.SetEncodeAppendedData(encode)
    writer.SetCompressorType(["NONE", "ZLIB", "LZ4", "LZMA"].index(compressor))
    writer.SetBlockSize(128)
    getattr(writer, "SetByteOrderTo" + order)()
    getattr(writer, "SetHeaderTypeToUInt" + header)()
    assert writer.Write() == 1
    print(name)


for shape, counts in (("flat", (5, 4, 1)), ("solid", (4, 3, 5))):
    for mode, encode in (("Ascii", False), ("Binary", False), ("Appended", False), ("Appended", True)):
        for compressor in ("NONE", "ZLIB", "LZ4", "LZMA"):
            if mode == "Ascii" and compressor != "NONE":
                continue
            name = f"{shape}_{mode}_{encode}_{compressor}.vts".lower()
            order = "BigEndian" if compressor == "LZ4" else "LittleEndian"
            header = "32" if encode else "64"
            write(name, grid(counts, numpy.float64), mode, encode, compressor, order, header)
    made = grid(counts, numpy.float32)
    made.save(f"{folder}/{shape}_default.vts")
    print(f"{shape}_default.vts")
    # Programs leave all sorts of things beside the grid.
    made.cell_data["normal"] = numpy.full((made.n_cells, 3), 0.5)
    made.field_data["TIME"] = numpy.array([1.5])
    made.field_data["words"] = numpy.array(["POINTS 3", "", "and more " * 20])
    made.point_data["inside"] = numpy.full(made.n_points, True)
    made.cell_data["number"] = numpy.arange(made.n_cells)
    for text in (True, False):
        name = f"{shape}_pyvista_{text}.vtk".lower()
        made.save(f"{folder}/{name}", binary=not text)
        print(name)
        for version in (42, 51):
            name = f"{shape}_{version}_{text}.vtk".lower()
            made.cell_data.active_vectors_name = "normal"
            writer = vtkStructuredGridWriter()
            writer.SetFileName(folder + "/" + name)
            writer.SetInputData(made)
            writer.SetFileVersion(version)
            writer.SetFileType(1 if text else 2)
            writer.SetWriteExtent(version == 42)
            assert writer.Write() == 1
            print(name)
