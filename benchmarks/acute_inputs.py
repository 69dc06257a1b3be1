# SPDX-License-Identifier: Apache-2.0
"""Valid inputs whose angles are as acute as can be, made by code: wedges, fans, cones tip to tip, bundles, random simplicial complexes.

All are piecewise linear complexes: cells meet in shared cells only, so a conforming mesh exists for each. `families()` names them all.
Angles are in degrees. Random ones are fixed by their seed on every machine.
"""
import math
import random
from dataclasses import dataclass
from itertools import combinations, product

from synthetic_domains import Domain


@dataclass
class Acute:
    """One input and what is asked of the mesh that conforms to it, its quality apart."""
    family: str
    domain: Domain
    volume: float                  # of all that is meshed
    most_vertices: int = None      # for conformity alone

    @property
    def name(self):
        return self.domain.name


class Builder:
    """Collects vertices, polygons and segments of one complex."""

    def __init__(self):
        self.vertices, self.facets = [], []

    def vertex(self, *p):
        self.vertices.append(tuple(float(c) for c in p))
        return len(self.vertices) - 1

    def facet(self, *polygons):
        self.facets.append(([list(p) for p in polygons], []))

    def segment(self, a, b):
        """A facet of one two-vertex polygon: a segment, in a .poly file."""
        self.facet([a, b])

    def box(self, low=(0, 0, 0), high=(1, 1, 1)):
        """The six facets of an axis-parallel box; its volume."""
        v = [self.vertex(*(high[k] if corner[k] else low[k] for k in range(3))) for corner in product((0, 1), repeat=3)]
        for polygon in ((0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)):
            self.facet([v[i] for i in polygon])
        return math.prod(b - a for a, b in zip(low, high))

    def acute(self, family, name, volume, most_vertices=None):
        return Acute(family, Domain(name, self.vertices, self.facets, {}), volume, most_vertices)


def radians(*degrees):
    return [d * math.pi / 180 for d in degrees]


def wedge(angle):
    """A triangular prism of unit length, two of its rectangles unit squares at `angle`."""
    t = math.radians(angle)
    b = Builder()
    low, high = ([b.vertex(x, y, z) for x, y in ((0, 0), (1, 0), (math.cos(t), math.sin(t)))] for z in (0, 1))
    b.facet(low)
    b.facet(high)
    for i in range(3):
        b.facet([low[i], low[(i + 1) % 3], high[(i + 1) % 3], high[i]])
    return b.acute("wedge", f"wedge_{angle:g}", math.sin(t) / 2)


def spike(angle, sides=5):
    """A pyramid of unit height over a regular polygon; opposite slopes meet at about `angle`."""
    b = Builder()
    radius = math.tan(math.radians(angle) / 2)
    tip = b.vertex(0, 0, 1)
    base = [b.vertex(radius * math.cos(t), radius * math.sin(t), 0) for t in (2 * math.pi * i / sides for i in range(sides))]
    b.facet(base)
    for i in range(sides):
        b.facet([base[i], base[(i + 1) % sides], tip])
    return b.acute("spike", f"spike_{angle:g}", sides * radius ** 2 * math.sin(2 * math.pi / sides) / 6)


def big_apex(sides):
    """A right cone over a polygon of many sides: the degree of its apex."""
    solid = spike(90, sides)
    solid.family, solid.domain.name = "apex", f"apex_of_{sides}"
    return solid


def blades(name, family, angles, most_vertices=None):
    """Rectangles around one upright segment inside the unit cube, at the given azimuths."""
    b = Builder()
    volume = b.box()
    axis = [b.vertex(0.5, 0.5, z) for z in (0.2, 0.8)]
    for t in radians(*angles):
        outer = [b.vertex(0.5 + 0.3 * math.cos(t), 0.5 + 0.3 * math.sin(t), z) for z in (0.2, 0.8)]
        b.facet([axis[0], axis[1], outer[1], outer[0]])
    return b.acute(family, name, volume, most_vertices)


def fan(n, most_vertices=None):
    """Blades at equal angles, the first 10 degrees off the x axis."""
    return blades(f"fan_{n}", "fan", [10 + 360 * i / n for i in range(n)], most_vertices)


def slit(angle):
    """The unit cube with a notch of `angle` cut into its top, 0.8 deep."""
    b = Builder()
    half = 0.8 * math.tan(math.radians(angle) / 2)
    outline = [(0, 0), (1, 0), (1, 1), (0.5 + half, 1), (0.5, 0.2), (0.5 - half, 1), (0, 1)]
    ends = [[b.vertex(x, y, z) for x, z in outline] for y in (0, 1)]
    n = len(outline)
    for end in ends:
        b.facet(end)
    for i in range(n):
        b.facet([ends[0][i], ends[0][(i + 1) % n], ends[1][(i + 1) % n], ends[1][i]])
    return b.acute("slit", f"slit_{angle:g}", 1 - 0.8 * half)


def cones(name, gap, sides=12, twist=0.0):
    """Two open cones tip to tip in the unit cube, `gap` degrees between their slopes; the upper one turned by `twist` sides."""
    b = Builder()
    volume = b.box()
    tip = b.vertex(0.5, 0.5, 0.5)
    slope = math.radians(gap) / 2
    for sign in (-1, 1):
        turn = twist if sign > 0 else 0
        rim = [b.vertex(0.5 + 0.4 * math.cos(slope) * math.cos(t), 0.5 + 0.4 * math.cos(slope) * math.sin(t), 0.5 + sign * 0.4 * math.sin(slope))
               for t in (2 * math.pi * (i + turn + 0.1) / sides for i in range(sides))]
        for i in range(sides):
            b.facet([tip, rim[i], rim[(i + 1) % sides]])
    return b.acute("cones", name, volume)


def bundle(seed, n=7):
    """Triangles around one segment in the unit cube, at random azimuths and of random widths: any angle may occur, near 0 too."""
    rng = random.Random(f"bundle {seed}")
    b = Builder()
    volume = b.box()
    ends = [b.vertex(0.5, 0.5, 0.25), b.vertex(0.52, 0.55, 0.8)]
    for _ in range(n):
        t, r, z = rng.uniform(0, 2 * math.pi), rng.uniform(0.05, 0.35), rng.uniform(0.15, 0.85)
        b.facet([*ends, b.vertex(0.5 + r * math.cos(t), 0.5 + r * math.sin(t), z)])
    return b.acute("bundle", f"bundle_{seed}", volume)


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def unit(a):
    length = math.sqrt(dot(a, a))
    return tuple(x / length for x in a)


def arcs_cross(arc, other):
    """Whether two arcs of great circles, each shorter than a half, have a common point."""
    (a, b), (c, d) = arc, other
    n, m = cross(a, b), cross(c, d)
    if dot(n, c) * dot(n, d) > 0 or dot(m, a) * dot(m, b) > 0:
        return False
    line = cross(n, m)
    return any(all(dot(cross(start, p), normal) >= 0 and dot(cross(p, end), normal) >= 0 for start, end, normal in ((a, b, n), (c, d, m)))
               for p in (line, tuple(-x for x in line)))


def apex(seed, n, widest, cone=180.0):
    """Triangles that share one vertex, in random directions no farther than `cone` from the x axis, each up to `widest` at that vertex."""
    rng = random.Random(f"apex {seed} {n}")
    b = Builder()
    volume = b.box()
    tip, arcs = b.vertex(0.5, 0.5, 0.5), []
    while len(arcs) < n:
        axis = unit([rng.gauss(0, 1) for _ in range(3)])
        if axis[0] < math.cos(math.radians(cone)):
            side = unit((0, rng.gauss(0, 1), rng.gauss(0, 1)))
            t = math.radians(rng.uniform(0, cone))
            axis = unit((math.cos(t), side[1] * math.sin(t), side[2] * math.sin(t)))
        across = unit(cross(axis, [rng.gauss(0, 1) for _ in range(3)]))
        t = math.radians(rng.uniform(0.1, 1) * widest) / 2
        arc = tuple(unit([math.cos(t) * a + s * math.sin(t) * c for a, c in zip(axis, across)]) for s in (-1, 1))
        if not any(arcs_cross(arc, other) for other in arcs):
            arcs.append(arc)
            lengths = [rng.uniform(0.15, 0.45) for _ in range(2)]
            b.facet([tip, *(b.vertex(*(0.5 + r * x for x in p)) for r, p in zip(lengths, arc))])
    return b.acute("apex" if cone == 180.0 else "needles", f"{'apex' if cone == 180.0 else 'needles'}_{n}_{seed}", volume)


def angles_in_a_facet():
    """Two coplanar triangles with one common corner: angles of 3, 4 and 13 degrees in one plane."""
    b = Builder()
    volume = b.box()
    tip = b.vertex(0.1, 0.2, 0.5)
    rim = [b.vertex(0.1 + 0.75 * math.cos(t), 0.2 + 0.75 * math.sin(t), 0.5) for t in radians(10, 13, 17, 30)]
    b.facet([tip, rim[0], rim[1]])
    b.facet([tip, rim[2], rim[3]])
    return b.acute("in_facet", "in_facet_3_4_13", volume)


def touch(angle):
    """Two triangles whose corners touch the inside of a rectangle's edge, one of them leaving the rectangle's plane by `angle` only."""
    b = Builder()
    volume = b.box()
    edge = [b.vertex(x, 0.5, 0.5) for x in (0.2, 0.4, 0.6, 0.8)]
    far = [b.vertex(x, 0.85, 0.5) for x in (0.8, 0.2)]
    b.facet([*edge, *far])
    b.facet([edge[1], b.vertex(0.35, 0.3, 0.7), b.vertex(0.5, 0.3, 0.75)])
    t = math.radians(angle)
    b.facet([edge[2], *(b.vertex(x, 0.5 + 0.25 * math.cos(t), 0.5 + 0.25 * math.sin(t)) for x in (0.55, 0.7))])
    return b.acute("touch", f"touch_{angle:g}", volume)


def segment_on_facet(angle):
    """A square facet with segments that leave its inside, a corner and an edge at `angle`."""
    b = Builder()
    volume = b.box()
    rise, run = 0.3 * math.sin(math.radians(angle)), 0.3 * math.cos(math.radians(angle))
    corners = [b.vertex(x, y, 0.5) for x, y in ((0.2, 0.2), (0.8, 0.2), (0.8, 0.5), (0.8, 0.8), (0.2, 0.8))]
    inside = b.vertex(0.4, 0.45, 0.5)
    b.facet(corners, [inside])
    b.segment(inside, b.vertex(0.4 + run, 0.45, 0.5 + rise))
    b.segment(corners[0], b.vertex(0.2 + run * 0.6, 0.2 + run * 0.8, 0.5 - rise))
    b.segment(corners[2], b.vertex(0.8 - run, 0.5, 0.5 - rise))
    return b.acute("segment_facet", f"segment_facet_{angle:g}", volume)


def broom(n, angle):
    """`n` segments from one vertex within a cone of `angle`."""
    rng = random.Random(f"broom {n} {angle}")
    b = Builder()
    volume = b.box()
    tip = b.vertex(0.2, 0.5, 0.5)
    for _ in range(n):
        t, u = math.radians(angle) / 2 * math.sqrt(rng.random()), rng.uniform(0, 2 * math.pi)
        r = rng.uniform(0.3, 0.6)
        b.segment(tip, b.vertex(0.2 + r * math.cos(t), 0.5 + r * math.sin(t) * math.cos(u), 0.5 + r * math.sin(t) * math.sin(u)))
    return b.acute("broom", f"broom_{n}_{angle:g}", volume)


def delaunay_tetrahedra(points):
    """Of points with whole coordinates, in exact arithmetic [Bowyer81]; an enclosing tetrahedron's corners are left out of the result."""
    reach = 64 * (1 + max(abs(c) for p in points for c in p))
    points = [*points, (-reach, -reach, -reach), (3 * reach, -reach, -reach), (-reach, 3 * reach, -reach), (-reach, -reach, 3 * reach)]

    def volume(a, b, c, d):
        u, v, w = (tuple(q[k] - points[a][k] for k in range(3)) for q in (points[b], points[c], points[d]))
        return dot(u, cross(v, w))

    def conflicts(t, p):
        (a, b, c), d = t[:3], t[3]
        rows = [tuple(points[i][k] - points[p][k] for k in range(3)) for i in (a, b, c, d)]
        s = [dot(r, r) for r in rows]
        determinant = sum((-1) ** i * s[i] * dot(r[0], cross(r[1], r[2])) for i, r in ((i, [rows[j] for j in range(4) if j != i]) for i in range(4)))
        return determinant > 0

    n = len(points) - 4
    tets = {(n, n + 1, n + 2, n + 3)}
    for p in range(n):
        cavity = [t for t in tets if conflicts(t, p)]
        faces = {}
        for t in cavity:
            tets.remove(t)
            for face in combinations(t, 3):
                faces[tuple(sorted(face))] = tuple(sorted(face)) not in faces
        for face, outer in sorted(faces.items()):
            if outer:
                a, b, c = face
                v = volume(a, b, c, p)
                assert v != 0, "points in degenerate position: take another seed"
                tets.add((a, b, c, p) if v > 0 else (b, a, c, p))
    return sorted(t for t in tets if max(t) < n)


RANDOM_SHAPES = {"cube": (1, 1, 1), "slab": (1, 1, 0.05), "needle": (1, 0.05, 0.05)}
GRID = 2 ** 20


def random_complex(seed):
    """A box around 10, 25 or 60 random points in a cube, a thin slab or a needle, 35 % of the faces of their Delaunay triangulation as facets
    and 10 % of its other edges as segments: hundreds of angles near 0, several acute axes at one vertex."""
    rng = random.Random(f"complex {seed}")
    shape = list(RANDOM_SHAPES)[seed % 3]
    n = (10, 25, 60)[seed // 3 % 3]
    points = [tuple(int(rng.random() * s * GRID) for s in RANDOM_SHAPES[shape]) for _ in range(n)]
    tets = delaunay_tetrahedra(points)
    faces = [f for f in sorted({tuple(sorted(f)) for t in tets for f in combinations(t, 3)}) if rng.random() < 0.35]
    used = {e for f in faces for e in combinations(f, 2)}
    edges = [e for e in sorted({tuple(sorted(e)) for t in tets for e in combinations(t, 2)} - used) if rng.random() < 0.1]
    b = Builder()
    volume = b.box((-0.25, -0.25, -0.25), [s + 0.25 for s in RANDOM_SHAPES[shape]])
    kept = {i: b.vertex(*(c / GRID for c in points[i])) for i in sorted({i for cell in [*faces, *edges] for i in cell})}
    for cell in [*faces, *edges]:
        b.facet([kept[i] for i in cell])
    return b.acute("random", f"random_{shape}_{n}_{seed}", volume)


def hull_triangles(points):
    """Faces of the convex hull of points in general position, counter-clockwise from outside; every vertex in turn, all faces tried."""
    def sees(face, p):
        a, b, c = (points[i] for i in face)
        return dot(cross([y - x for x, y in zip(a, b)], [y - x for x, y in zip(a, c)]), [y - x for x, y in zip(a, points[p])]) > 0

    start = (0, 1, 2) if not sees((0, 1, 2), 3) else (0, 2, 1)
    faces = {start} | {(start[(i + 1) % 3], start[i], 3) for i in range(3)}
    for p in range(4, len(points)):
        seen = [f for f in faces if sees(f, p)]
        edges = {(f[i], f[(i + 1) % 3]) for f in seen for i in range(3)}
        faces.difference_update(seen)
        faces |= {(a, b, p) for a, b in edges if (b, a) not in edges}
    return sorted(faces)


def lumpy_surface(n, seed, stretch=(1.0, 1.0, 1.0)):
    """A closed triangulated surface around the origin, like a scan: random vertices, all triangles facets, thin ones among them."""
    rng = random.Random(f"surface {n} {seed}")
    directions = [unit([rng.gauss(0, 1) for _ in range(3)]) for _ in range(n)]
    faces = hull_triangles(directions)
    b = Builder()
    for d in directions:
        r = 1 + 0.25 * math.sin(3 * d[0] + 1) * math.cos(4 * d[1]) * math.sin(3 * d[2] + 2)
        b.vertex(*(r * s * x for s, x in zip(stretch, d)))
    for f in faces:
        b.facet(f)
    v = b.vertices
    volume = sum(dot(v[i], cross(v[j], v[k])) for i, j, k in faces) / 6
    name = f"surface_{n}" + ("" if stretch == (1.0, 1.0, 1.0) else "_flat")
    return b.acute("surface", name, volume, 4 * n)


ANGLES = (60, 30, 10, 5, 1, 0.1, 0.01)


def families(random_cases=12):
    """All inputs in a fixed order, `random_cases` of the random complexes among them."""
    yield from (wedge(a) for a in ANGLES)
    yield from (spike(a) for a in ANGLES)
    yield from (slit(a) for a in (30, 5, 0.5, 0.01))
    yield from (blades(f"blades_{a:g}", "blades", (20, 20 + a)) for a in (30, 5, 0.1, 0.01))
    yield fan(16, 200)
    yield fan(64, 3500)
    yield from (bundle(seed) for seed in range(4))
    yield cones("cones_steep", 120)
    yield cones("cones_flat", 7)
    yield cones("cones_very_flat_twisted", 1, 10, 0.5)
    yield from (apex(seed, 12, 40) for seed in range(3))
    yield from (apex(seed, 8, 4, 7.0) for seed in range(2))
    yield big_apex(100)
    yield big_apex(1000)
    yield angles_in_a_facet()
    yield from (touch(a) for a in (30, 3, 0.1))
    yield from (segment_on_facet(a) for a in (45, 10, 1, 0.1))
    yield broom(30, 20)
    yield broom(100, 5)
    yield from (random_complex(seed) for seed in range(random_cases))
    yield lumpy_surface(500, 1)
    yield lumpy_surface(500, 1, (1.0, 1.0, 0.1))
