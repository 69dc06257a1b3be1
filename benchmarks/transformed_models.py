# SPDX-License-Identifier: Apache-2.0
"""Copies of input files that are rotated and shifted: what a mesher does must not depend on where its input lies."""
import math
import os

from common import diagonal, points_of, surface_of

PLACES = {"as given": (False, 0.0), "rotated": (True, 0.0), "1e3 away": (True, 1e3), "1e6 away": (True, 1e6)}  # rotated?, shift in diagonals


def placement(model, place):
    """A function of points."""
    rotated, away = PLACES[place]
    shift = away * diagonal(points_of(model)) / math.sqrt(3)
    # By 77 degrees about (2, -1, 3): no axis or plane of a right-angled part stays one.
    angle, axis = math.radians(77), [c / math.sqrt(14) for c in (2, -1, 3)]

    def put(p):
        if rotated:
            cross = [axis[1] * p[2] - axis[2] * p[1], axis[2] * p[0] - axis[0] * p[2], axis[0] * p[1] - axis[1] * p[0]]
            along = sum(a * c for a, c in zip(axis, p)) * (1 - math.cos(angle))
            p = [c * math.cos(angle) + x * math.sin(angle) + along * a for c, x, a in zip(p, cross, axis)]
        return [c + shift for c in p]

    return put


def write_off(model, path, put):
    """A copy of a surface as plain OFF."""
    points, polygons = surface_of(model)
    with open(path, "w") as out:
        out.write(f"OFF\n{len(points)} {len(polygons)} 0\n")
        for p in points:
            out.write(" ".join(repr(c) for c in put(p)) + "\n")
        for polygon in polygons:
            out.write(f"{len(polygon)} {' '.join(map(str, polygon))}\n")


def write_poly(model, path, put):
    """A copy of a .poly or .smesh file with nodes, points in holes and points in regions placed. One polygon a line, as most programs write them."""
    lines = [line.split("#")[0].split() for line in open(model)]
    lines = iter([line for line in lines if line])

    def placed(line):
        return [line[0], *(repr(c) for c in put([float(x) for x in line[1:4]])), *line[4:]]

    with open(path, "w") as out:
        def copy(change=None):
            line = next(lines, ["0"])
            out.write(" ".join(change(line) if change else line) + "\n")
            return line

        for _ in range(int(copy()[0])):
            copy(placed)
        facets = int(copy()[0])
        for _ in range(facets if model.lower().endswith(".smesh") else 0):
            copy()
        for _ in range(0 if model.lower().endswith(".smesh") else facets):
            header = copy()
            for _ in range(int(header[0])):
                polygon = copy()
                listed = len(polygon) - 1
                while listed < int(polygon[0]):
                    listed += len(copy())
            for _ in range(int(header[1]) if len(header) > 1 else 0):
                copy(placed)
        for _ in range(int(copy()[0])):
            copy(placed)
        for _ in range(int(copy()[0])):
            copy(placed)


def transformed(model, folder, place):
    """Path of the copy in `folder`; a format that the referee reads, too."""
    put = placement(model, place)
    if model.lower().endswith((".poly", ".smesh")):
        path = os.path.join(folder, "placed" + os.path.splitext(model)[1].lower())
        write_poly(model, path, put)
    else:
        path = os.path.join(folder, "placed.off")
        write_off(model, path, put)
    return path
