"""Writes the bodies of the scenes in this folder: knot.stl (binary), nut.obj and gear.txt. Needs Python alone."""

import math
import struct
from pathlib import Path

FOLDER = Path(__file__).parent


def knot(along=120, around=10, thickness=0.35):
    """A trefoil knot as triangles, counter-clockwise seen from outside."""

    def centre(t):
        return (
            math.sin(t) + 2.0 * math.sin(2.0 * t),
            math.cos(t) - 2.0 * math.cos(2.0 * t),
            -math.sin(3.0 * t),
        )

    def unit(v):
        length = math.sqrt(sum(c * c for c in v))
        return tuple(c / length for c in v)

    def cross(a, b):
        return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])

    def point(i, j):
        t, s = 2.0 * math.pi * (i % along) / along, 2.0 * math.pi * (j % around) / around
        ahead, behind = centre(t + 1e-4), centre(t - 1e-4)
        tangent = unit(tuple(a - b for a, b in zip(ahead, behind)))
        side = unit(cross(tangent, (0.0, 0.0, 1.0)))
        up = cross(side, tangent)
        ring = (thickness * math.cos(s), thickness * math.sin(s))
        return tuple(c + ring[0] * a + ring[1] * b for c, a, b in zip(centre(t), side, up))

    for i in range(along):
        for j in range(around):
            a, b, c, d = point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)
            yield a, b, c
            yield a, c, d


def write_stl(path, triangles):
    triangles = list(triangles)
    with open(path, "wb") as file:
        file.write(b"trefoil knot".ljust(80, b" ") + struct.pack("<I", len(triangles)))
        for corners in triangles:
            file.write(struct.pack("<12fH", 0.0, 0.0, 0.0, *[c for x in corners for c in x], 0))


def nut(path):
    """A hexagonal nut with a bore, of polygons with four corners."""
    n = 24
    lines = []

    def hexagon(angle):
        sector = (angle + math.pi / 6.0) % (math.pi / 3.0) - math.pi / 6.0
        return 1.0 / math.cos(sector)

    for z in (-0.4, 0.4):
        for radius in (lambda angle: 0.55, hexagon):
            for i in range(n):
                angle = 2.0 * math.pi * i / n
                lines.append(f"v {radius(angle) * math.cos(angle):.9f} {radius(angle) * math.sin(angle):.9f} {z}")
    inner_low, outer_low, inner_high, outer_high = (1 + k * n for k in range(4))
    for i in range(n):
        j = (i + 1) % n
        lines.append(f"f {outer_low + i} {outer_low + j} {outer_high + j} {outer_high + i}")
        lines.append(f"f {inner_low + j} {inner_low + i} {inner_high + i} {inner_high + j}")
        lines.append(f"f {inner_high + i} {outer_high + i} {outer_high + j} {inner_high + j}")
        lines.append(f"f {inner_low + j} {outer_low + j} {outer_low + i} {inner_low + i}")
    path.write_text("# A hexagonal nut of width 2 with a bore of radius 0.55.\n" + "\n".join(lines) + "\n")


def gear(path, teeth=9):
    """A gear wheel with a square hole, a loop each."""
    lines = [f"# A gear wheel of {teeth} teeth with a square hole: x, y; a blank line between loops."]
    for tooth in range(teeth):
        for part, radius in ((0.0, 0.75), (0.35, 0.75), (0.45, 1.0), (0.9, 1.0)):
            angle = 2.0 * math.pi * (tooth + part) / teeth
            lines.append(f"{radius * math.cos(angle):.9f}, {radius * math.sin(angle):.9f}")
    lines.append("")
    lines += [f"{x}, {y}" for x, y in ((-0.25, -0.25), (0.25, -0.25), (0.25, 0.25), (-0.25, 0.25))]
    path.write_text("\n".join(lines) + "\n")


write_stl(FOLDER / "knot.stl", knot())
nut(FOLDER / "nut.obj")
gear(FOLDER / "gear.txt")
