#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Edge lengths against the size field that was asked for, on the unit cube and on models, judged by a referee.

    benchmarks/size_fields.py --referee JUDGE [--program build/release/bin/wellmesh] [--field NAME ...]

Fields on the cube: linear (1:4, a background mesh), point (a vertex of 0.01), thousand (a vertex of 0.001 in a cube of 1: 1:1000 with a gradation of 0.3 and a
size of 1), jump (a facet of 0.03 in a cube of 0.5), regions (0.05 beside 0.5). A row is one run: vertices, median of edge length over field at the edge's middle, the median of its
distance from 1 (at most 0.25), the 5th and the 95th percentile, the longest, which shows that the gradation is kept (at most 1.93), seconds, and the referee's
verdict. The field is computed here, from what was asked for.
Exit status 0 if all rows hold.
"""
import argparse
import math
import os
import sys
import tempfile

from common import DEFAULT_PROGRAM, judge, run

MEDIAN_BOUND = 0.25
GRADATION = 0.3
# An edge is at most the diameter of a circumsphere within the bound, which moves may exceed (docs/sizing.md); and the field's interpolation.
LONGEST = 2 * 0.70 * 1.2 * 1.15


def box(path, cells, marker=None, vertex=None):
    """`cells` unit cubes in a row along x, region k in the k-th; facet x = 0 gets `marker`, the origin `vertex`."""
    at = {}
    points = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in range(cells + 1)]
    for i, p in enumerate(points):
        at[p] = i + 1
    facets = [([at[x, 0, 0], at[x, 1, 0], at[x, 1, 1], at[x, 0, 1]], marker if x == 0 and marker else 1) for x in range(cells + 1)]
    for x in range(cells):
        for side in (0, 1):
            facets.append(([at[x, side, 0], at[x + 1, side, 0], at[x + 1, side, 1], at[x, side, 1]], 1))
            facets.append(([at[x, 0, side], at[x + 1, 0, side], at[x + 1, 1, side], at[x, 1, side]], 1))
    with open(path, "w") as out:
        out.write(f"{len(points)} 3 0 1\n")
        for i, p in enumerate(points):
            out.write(f"{i + 1} {p[0]} {p[1]} {p[2]} {vertex if vertex and i == 0 else 0}\n")
        out.write(f"{len(facets)} 1\n")
        for corners, mark in facets:
            out.write(f"1 0 {mark}\n{len(corners)} {' '.join(map(str, corners))}\n")
        out.write(f"0\n{cells}\n")
        for x in range(cells):
            out.write(f"{x + 1} {x + 0.5} 0.5 0.5 {x + 1}\n")


def background(stem, size):
    """A tetrahedron about the cube, with a linear size."""
    points = [(-0.1, -0.1, -0.1), (5, -0.1, -0.1), (-0.1, 5, -0.1), (-0.1, -0.1, 5)]
    with open(stem + ".node", "w") as out:
        out.write("4 3 0 0\n" + "".join(f"{i + 1} {p[0]} {p[1]} {p[2]}\n" for i, p in enumerate(points)))
    with open(stem + ".ele", "w") as out:
        out.write("1 4 0\n1 1 2 3 4\n")
    with open(stem + ".mtr", "w") as out:
        out.write("4 1\n" + "".join(f"{size(*p)!r}\n" for p in points))


def linear(x, y, z):
    return 0.05 + 0.05 * (x + y + z)


def cube_fields(folder):
    """Name, input, arguments, field by point."""
    cube, marked, pair = (os.path.join(folder, name + ".poly") for name in ("cube", "marked", "pair"))
    box(cube, 1)
    box(marked, 1, marker=7, vertex=9)
    box(pair, 2)
    stem = os.path.join(folder, "sizes")
    background(stem, linear)
    origin = lambda x, y, z: math.sqrt(x * x + y * y + z * z)
    yield "linear", cube, ["--background", stem + ".node"], linear
    yield "point", marked, ["--size-vertex", "9=0.01"], lambda x, y, z: 0.01 + GRADATION * origin(x, y, z)
    yield "thousand", marked, ["--size-vertex", "9=0.001", "--size", "1"], lambda x, y, z: min(1, 0.001 + GRADATION * origin(x, y, z))
    yield "jump", marked, ["--size-facet", "7=0.03", "--size", "0.5"], lambda x, y, z: min(0.5, 0.03 + GRADATION * x)
    yield "regions", pair, ["--size-region", "1=0.05", "--size", "0.5"], lambda x, y, z: 0.05 + GRADATION * max(0, x - 1)


def read_mesh(path):
    """Vertices, and every edge of a tetrahedron once."""
    with open(path) as stream:
        lines = iter(stream.read().split("\n"))
    vertices, edges = [], set()
    for line in lines:
        if line.strip() == "Vertices":
            for _ in range(int(next(lines))):
                vertices.append(tuple(map(float, next(lines).split()[:3])))
        elif line.strip() == "Tetrahedra":
            for _ in range(int(next(lines))):
                corners = [int(word) - 1 for word in next(lines).split()[:4]]
                for i in range(4):
                    for j in range(i + 1, 4):
                        edges.add((min(corners[i], corners[j]), max(corners[i], corners[j])))
    return vertices, edges


def compare(mesh, field):
    """Sorted ratios of edge lengths to the field at their middles."""
    vertices, edges = read_mesh(mesh)
    return len(vertices), sorted(math.dist(vertices[a], vertices[b]) / field(*((p + q) / 2 for p, q in zip(vertices[a], vertices[b]))) for a, b in edges)


def show(name, result, mesh, model, field, arguments):
    if result.code != 0:
        print(f"{name:<12} exit {result.code}: {result.errors[-200:]}")
        return False
    verdict = judge(arguments.referee, mesh, model, compare_with=arguments.program)
    count, ratios = compare(mesh, field)
    away = sorted(abs(r - 1) for r in ratios)
    median, off = ratios[len(ratios) // 2], away[len(away) // 2]
    good = verdict["ok"] and off <= MEDIAN_BOUND and ratios[-1] <= LONGEST
    print(f"{name:<12}{count:>9}{median:>9.3f}{off:>9.3f}{ratios[len(ratios) // 20]:>8.2f}{ratios[-(len(ratios) // 20) - 1]:>8.2f}{ratios[-1]:>8.2f}"
          f"{result.seconds:>9.1f}  {'ok' if verdict['ok'] else verdict['failures'][:1]}{'' if good else '  MISS'}", flush=True)
    return good


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--referee", required=True)
    parser.add_argument("--program", default=DEFAULT_PROGRAM)
    parser.add_argument("--field", action="append")
    arguments = parser.parse_args()
    good = True
    print(f"{'field':<12}{'vertices':>9}{'median':>9}{'off by':>9}{'5 %':>8}{'95 %':>8}{'longest':>8}{'seconds':>9}  referee")
    with tempfile.TemporaryDirectory() as folder:
        mesh = os.path.join(folder, "out.mesh")
        for name, model, flags, field in cube_fields(folder):
            if arguments.field and name not in arguments.field:
                continue
            for seeding in ("auto", "off"):
                result = run([arguments.program, "mesh", model, *flags, "--gradation", str(GRADATION), "--seeding", seeding, "-o", mesh, "--quiet"], 300)
                good = show(name if seeding == "auto" else name + "*", result, mesh, model, field, arguments) and good
    print("* without seeding")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
