"""Prints what VTK reads from the files named as arguments, for comparison with what was written.

One line per item: a key, a tab, values parted by blanks. Floats are printed so that they read back to the same
bits. Ends with status 3 where pyvista is not installed.
"""

import sys

try:
    import numpy
    import pyvista
except ImportError as missing:
    print(missing, file=sys.stderr)
    sys.exit(3)


def show(key, values):
    values = numpy.asarray(values).ravel().tolist()
    print(key, " ".join(repr(value) for value in values), sep="\t")


def show_data(data):
    print("class", type(data).__name__, sep="\t")
    show("counts", [data.n_points, data.n_cells])
    show("points", data.points)
    for name, values in data.cell_data.items():
        show("type of " + name, [1 if values.ndim == 1 else values.shape[1], values.dtype.itemsize])
        show("values of " + name, values)
    if data.n_cells > 0:
        show("last cell", data.get_cell(data.n_cells - 1).points)
        sized = data.compute_cell_sizes()
        show("sizes", [sized[name].sum() for name in ("Length", "Area", "Volume")])
        show("least sizes", [sized[name].min() for name in ("Length", "Area", "Volume")])


for path in sys.argv[1:]:
    print("file", path, sep="\t")
    if path.endswith(".pvd"):
        reader = pyvista.get_reader(path)
        show("times", reader.time_values)
        for time in reader.time_values:
            reader.set_active_time_value(time)
            print("groups", " ".join(part.group for part in reader.active_datasets), sep="\t")
            show("cells", [data.n_cells for data in reader.read()])
    else:
        show_data(pyvista.read(path))
