"""Writes rotated.csv: slivers and needles turned by arbitrary rotations, cut by planes, exact to the last bit.

    python3 rotated.py > ../rotated.csv
    python3 rotated.py --check          # closed forms against quadrature, nothing written

Needs mpmath. A cell is a unit cube squeezed along one axis (sliver) or two (needle), its nodes moved by up to 0.15 of
each extent (`ruled`) or by one linear map (`affine`, up to the rounding of the nodes), then rotated and, in every other
case, shifted away from the origin. Normals are arbitrary, or within the cell's aspect of its short directions, so that
the plane is nearly parallel to long faces.

The printed coordinates, normals and plane constants are the exact input; volume and section area of the cell that they
describe are evaluated with 120 digits by the divergence theorem with closed-form moments of the ruled faces,

    3 V = sum over faces [ (x1 - p).k - nu K11 ],   k = q0 K00 + q_alpha K10 + q_beta K01,   A = - n.(sum k) / n.n

and rounded once. Columns as in truncation.csv, without moments.
"""

import math
import random
import sys

import mpmath
from mpmath import mpf

mpmath.mp.dps = 120

FACES = [(0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (2, 3, 7, 6), (0, 3, 2, 1), (4, 5, 6, 7)]
CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
CASES = 12


def add(a, b):
    return [x + y for x, y in zip(a, b)]


def sub(a, b):
    return [x - y for x, y in zip(a, b)]


def scale(a, t):
    return [x * t for x in a]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def moments(w):
    """M00, M10, M11 of the region u + v + w u v <= 1 of the corner of a square, from S_k = sum (-w)^n / (n + k)."""
    if abs(w) < mpf("1e-4"):
        s = [sum((-w) ** n / (n + k) for n in range(40)) for k in (1, 2, 3, 4)]
    else:
        s = [mpmath.log(1 + w) / w]
        for k in (1, 2, 3):
            s.append((mpf(1) / k - s[-1]) / w)
    m10 = s[1] - s[2]
    return s[0] - s[1], m10, mpf(3) / 2 * (s[2] - s[3]) - m10 / 2


def moments_by_quadrature(w):
    v = lambda u: (1 - u) / (1 + w * u)
    quad = lambda f: mpmath.quad(f, [0, mpf(1) / 8, mpf(1) / 2, 1])
    return quad(v), quad(lambda u: u * v(u)), quad(lambda u: u * v(u) ** 2) / 2


def corner(s, i):
    s1, s2, s3, s4 = (s[(i + k) % 4] for k in range(4))
    a, b = s1 / (s1 - s2), s1 / (s1 - s4)
    m00, m10, m11 = moments((s2 * s4 - s1 * s3) / ((s2 - s1) * (s4 - s1)) - 1)
    return a * b * m00, a * a * b * m10, a * b * b * m10, a * a * b * b * m11


def strip(s, i):
    s1, s2, s3, s4 = (s[(i + k) % 4] for k in range(4))
    left, right = s1 / (s1 - s4), s2 / (s2 - s3)
    step = left - right
    m00, m10, m11 = moments((s3 - s2) / (s4 - s1) - 1)
    return (
        right + step * m00,
        right / 2 + step * m10,
        right**2 / 2 + step * right * m00 + step**2 * m10,
        right**2 / 4 + step * right * m10 + step**2 * m11,
    )


WHOLE = (mpf(1), mpf(1) / 2, mpf(1) / 2, mpf(1) / 4)


def pieces(s):
    """The part of a face with s <= 0 as (first corner, sign, moments)."""
    inside = [k for k in range(4) if s[k] <= 0]
    if not inside:
        return []
    if len(inside) == 4:
        return [(0, 1, WHOLE)]
    if len(inside) == 1:
        return [(inside[0], 1, corner(s, inside[0]))]
    outside = [k for k in range(4) if s[k] > 0]
    if len(inside) == 3:
        return [(0, 1, WHOLE), (outside[0], -1, corner(s, outside[0]))]
    if (inside[1] - inside[0]) % 4 != 2:
        first = inside[0] if (inside[0] + 1) % 4 == inside[1] else inside[1]
        return [(first, 1, strip(s, first))]
    if s[inside[0]] * s[inside[1]] > s[outside[0]] * s[outside[1]]:
        return [(0, 1, WHOLE)] + [(k, -1, corner(s, k)) for k in outside]
    return [(k, 1, corner(s, k)) for k in inside]


def truncate(nodes, normal, constant):
    """Truncated volume, and its derivative with respect to the plane constant."""
    x = [[mpf(c) for c in node] for node in nodes]
    n = [mpf(c) for c in normal]
    heights = [dot(n, node) - mpf(constant) for node in x]
    p = sub(x[0], scale(n, heights[0] / dot(n, n)))
    triple, total = mpf(0), [mpf(0)] * 3
    for face in FACES:
        for first, sign, (k00, k10, k01, k11) in pieces([heights[i] for i in face]):
            x1, x2, x3, x4 = (x[face[(first + k) % 4]] for k in range(4))
            e, g = sub(x2, x1), sub(x4, x1)
            t = sub(sub(x3, x4), e)
            q0, q_alpha, q_beta = cross(e, g), cross(e, t), cross(t, g)
            k = add(scale(q0, k00), add(scale(q_alpha, k10), scale(q_beta, k01)))
            triple += sign * (dot(sub(x1, p), k) - dot(t, q0) * k11)
            total = add(total, scale(k, sign))
    return triple / 3, -dot(n, total) / dot(n, n)


def rotation(rng):
    """Rows of a random rotation, from a random unit quaternion."""
    q = [rng.gauss(0, 1) for _ in range(4)]
    length = math.sqrt(dot(q, q))
    w, x, y, z = (c / length for c in q)
    return [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]


def case(rng, kind, aspect, ruled, number):
    squeezed = rng.sample(range(3), 1 if kind == "sliver" else 2)
    extent = [aspect if axis in squeezed else 1.0 for axis in range(3)]
    turn = rotation(rng)
    shear = [[(i == j) + rng.uniform(-0.15, 0.15) for j in range(3)] for i in range(3)]
    shift = [rng.uniform(-1, 1) * (number % 2) for _ in range(3)]
    nodes = []
    for at in CORNERS:
        local = [c + rng.uniform(-0.15, 0.15) for c in at] if ruled else [dot(row, at) for row in shear]
        nodes.append([dot(row, [c * e for c, e in zip(local, extent)]) for row in turn])
    nodes = [add(sub(node, nodes[0]), shift) for node in nodes]
    normal = [rng.gauss(0, 1) for _ in range(3)]
    if number % 3 != 0:
        # Nearly along the short directions: of the order of the aspect along the long ones.
        normal = [c * (1.0 if axis in squeezed else aspect) for axis, c in enumerate(normal)]
        normal = [dot(row, normal) for row in turn]
    length = math.sqrt(dot(normal, normal))
    normal = [c / length for c in normal]
    heights = [dot([mpf(c) for c in normal], [mpf(c) for c in node]) for node in nodes]
    part = mpf(rng.uniform(0.02, 0.98))
    constant = float(min(heights) + part * (max(heights) - min(heights)))
    return nodes, normal, constant


def check():
    for w in ("-0.999", "-0.5", "-1e-5", "0", "1e-9", "0.3", "7", "1e4"):
        exact, wanted = moments(mpf(w)), moments_by_quadrature(mpf(w))
        error = max(abs(a - b) for a, b in zip(exact, wanted))
        print(w, mpmath.nstr(error, 3))
        assert error <= mpf("1e-25"), w
    # The volume is the integral of its derivative.
    rng = random.Random(1)
    nodes, normal, constant = case(rng, "sliver", 1e-3, True, 1)
    heights = sorted(dot([mpf(c) for c in normal], [mpf(c) for c in node]) for node in nodes)
    stops = [h for h in heights if h < constant] + [mpf(constant)]
    mpmath.mp.dps = 30
    integral = mpmath.quad(lambda d: truncate(nodes, normal, d)[1], stops)
    error = abs(integral / truncate(nodes, normal, constant)[0] - 1)
    print("volume as the integral of the section", mpmath.nstr(error, 3))
    assert error <= mpf("1e-12")


def main():
    if "--check" in sys.argv:
        return check()
    columns = [f"{c}{i}" for i in range(8) for c in "xyz"]
    print(",".join(["category", *columns, "nx,ny,nz,d,cell_volume,truncated_volume,section_area"]))
    rng = random.Random(20)
    for kind in ("sliver", "needle"):
        for aspect in ("1e-1", "3e-2", "1e-3", "1e-6", "1e-8"):
            for shape in ("ruled", "affine"):
                for number in range(CASES):
                    nodes, normal, constant = case(rng, kind, float(aspect), shape == "ruled", number)
                    below, area = truncate(nodes, normal, constant)
                    whole, _ = truncate(nodes, normal, 1e6)
                    inputs = [c for node in nodes for c in node] + normal + [constant]
                    values = inputs + [float(v) for v in (whole, below, area)]
                    print(",".join([f"rotated_{kind}_{aspect}_{shape}", *map(repr, values)]))


main()
