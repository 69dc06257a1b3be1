#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Adds TetGen and Gmsh to the table and the page of a study: one row a rival, model and size, at about as many vertices, in the same columns.

    wellmesh study MODEL.poly ... --size-over-diagonal 0.05 -o DIR
    benchmarks/study_rivals.py DIR/study.csv [--program build/release/bin/wellmesh] [--rival tetgen|gmsh ...]

The number of vertices to meet is the median over the rows of strategy `best` with the largest goal that all its seeds met (--theta: that goal). Each rival's
own measure of size is tuned until its mesh has as many, within 5 per cent or as near as 12 attempts lead. Everything in a row is measured by `wellmesh check`
on the rival's output; only the seconds, of the nearest attempt, are the rival's own process by the wall clock. Table and page (study.html beside it, if it is
there) are written anew when all is done; rows of the same rivals from before are replaced. Rivals that aren't installed are skipped and named. Exit status 0 if every rival that is there made
a mesh of every model, 1 if not.

TetGen runs as `-pq1.4/14aV`, on .poly and .smesh in place of which it writes beside a copy. Gmsh gets the facets of a .poly as plane surfaces and its
cells as volumes, and runs with its default optimisation; models of other formats are no input for it. It writes 14 digits, so that `check` may find the
input's vertices moved.
"""
import argparse
import csv
import html
import io
import json
import os
import shutil
import statistics
import sys
import tempfile

from common import DEFAULT_PROGRAM, package_version, run

CLOSE_ENOUGH, ATTEMPTS = 0.05, 12
BELOW = [5, 10, 15, 20]


class Failed(Exception):
    pass


def read_poly(path):
    """Vertices, and facets as (polygons, hole points), of a .poly or .smesh with its points in the file; numbers from 0."""
    lines = [line.split("#")[0].split() for line in open(path)]
    lines = iter([line for line in lines if line])
    count = int(next(lines)[0])
    rows = [next(lines) for _ in range(count)]
    if not rows:
        raise Failed("points in a .node file of their own are not read")
    first = int(rows[0][0])
    vertices = [tuple(map(float, row[1:4])) for row in rows]
    facets = []
    for _ in range(int(next(lines)[0])):
        header = next(lines)
        if path.endswith(".smesh"):
            facets.append(([[int(v) - first for v in header[1:1 + int(header[0])]]], []))
            continue
        words = []
        polygons = []
        for _ in range(int(header[0])):
            words = next(lines)
            size = int(words[0])
            while len(words) < 1 + size:
                words += next(lines)
            polygons.append([int(v) - first for v in words[1:1 + size]])
        holes = [tuple(map(float, next(lines)[1:4])) for _ in range(int(header[1]) if len(header) > 1 else 0)]
        facets.append((polygons, holes))
    return vertices, facets


def read_medit(path):
    """Vertices, triangles with references, and tetrahedra of a .mesh as this program writes it; numbers from 0."""
    sections, words = {}, iter(open(path).read().split())
    for word in words:
        width = {"Vertices": 4, "Edges": 3, "Triangles": 4, "Tetrahedra": 5}.get(word)
        if width:
            sections[word] = [[next(words) for _ in range(width)] for _ in range(int(next(words)))]
    triangles = [([int(v) - 1 for v in row[:3]], int(row[3]) - 1) for row in sections["Triangles"]]
    return triangles, [[int(v) - 1 for v in row[:4]] for row in sections["Tetrahedra"]]


def cells_of(program, model, folder):
    """Facets (from 0) around each cell that is meshed, as a coarse mesh of the model shows them."""
    mesh = os.path.join(folder, "cells.mesh")
    result = run([program, "mesh", model, "--min-dihedral", "0", "--quiet", "-o", mesh])
    if not os.path.exists(mesh):
        raise Failed(f"no mesh to find the cells in: {result.errors[-200:]}")
    triangles, tets = read_medit(mesh)
    facet_of = {tuple(sorted(corners)): facet for corners, facet in triangles}
    beside, walls = {}, [set() for _ in tets]
    for t, corners in enumerate(tets):
        for skipped in range(4):
            face = tuple(sorted(corners[:skipped] + corners[skipped + 1:]))
            if face in facet_of:
                walls[t].add(facet_of[face])
            else:
                beside.setdefault(face, []).append(t)
    neighbours = [[] for _ in tets]
    for pair in beside.values():
        if len(pair) == 2:
            neighbours[pair[0]].append(pair[1])
            neighbours[pair[1]].append(pair[0])
    seen, cells = [False] * len(tets), []
    for start in range(len(tets)):
        if seen[start]:
            continue
        seen[start], stack, facets = True, [start], set()
        while stack:
            t = stack.pop()
            facets |= walls[t]
            for n in neighbours[t]:
                if not seen[n]:
                    seen[n] = True
                    stack.append(n)
        cells.append(sorted(facets))
    return cells


def shells(cell, facets):
    """The facets of a cell in connected pieces: its outside and its cavities."""
    edges = {}
    for f in cell:
        for polygon in facets[f][0]:
            for a, b in zip(polygon, polygon[1:] + polygon[:1]):
                edges.setdefault(tuple(sorted((a, b))), []).append(f)
    pieces, left = [], set(cell)
    while left:
        stack, piece = [min(left)], set()
        left.discard(stack[0])
        while stack:
            f = stack.pop()
            piece.add(f)
            for polygon in facets[f][0]:
                for a, b in zip(polygon, polygon[1:] + polygon[:1]):
                    for other in edges[tuple(sorted((a, b)))]:
                        if other in left:
                            left.discard(other)
                            stack.append(other)
        pieces.append(sorted(piece))
    return pieces


def write_geo(model, cells, path):
    """The model in Gmsh's own language: plane surfaces, the first polygon of each its outline unless another has a greater extent."""
    vertices, facets = read_poly(model)
    lines, out = {}, []
    for i, p in enumerate(vertices, 1):
        out.append(f"Point({i}) = {{{p[0]!r}, {p[1]!r}, {p[2]!r}}};")

    def extent(polygon):
        return sum((max(vertices[v][k] for v in polygon) - min(vertices[v][k] for v in polygon)) ** 2 for k in range(3))

    number = 0
    for f, (polygons, _) in enumerate(facets, 1):
        loops = []
        for polygon in sorted((p for p in polygons if len(p) > 2), key=extent, reverse=True):
            loop = []
            for a, b in zip(polygon, polygon[1:] + polygon[:1]):
                key = (min(a, b), max(a, b))
                if key not in lines:
                    lines[key] = len(lines) + 1
                    out.append(f"Line({lines[key]}) = {{{key[0] + 1}, {key[1] + 1}}};")
                loop.append(lines[key] if (a, b) == key else -lines[key])
            number += 1
            out.append(f"Curve Loop({number}) = {{{', '.join(map(str, loop))}}};")
            loops.append(number)
        out.append(f"Plane Surface({f}) = {{{', '.join(map(str, loops))}}};")
    shell = 0
    for c, cell in enumerate(cells, 1):
        names = []
        for piece in shells(cell, facets):
            shell += 1
            out.append(f"Surface Loop({shell}) = {{{', '.join(str(f + 1) for f in piece)}}};")
            names.append((max(extent([v for f in piece for polygon in facets[f][0] for v in polygon]), 0), shell))
        out.append(f"Volume({c}) = {{{', '.join(str(s) for _, s in sorted(names, reverse=True))}}};")
    with open(path, "w") as stream:
        stream.write("\n".join(out) + "\n")


class TetGen:
    name, label = "tetgen", "tetgen -pq1.4/14"
    power = 1  # vertices grow with 1 / volume

    def __init__(self, program, model, folder):
        self.model = os.path.join(folder, "model" + os.path.splitext(model)[1])
        self.mesh = os.path.join(folder, "model.1.ele")
        shutil.copy(model, self.model)
        node = os.path.splitext(model)[0] + ".node"
        if os.path.exists(node):
            shutil.copy(node, os.path.join(folder, "model.node"))

    def attempt(self, volume, limit):
        return run(["tetgen", f"-pq1.4/14a{volume:.12g}Q", self.model], limit)


class Gmsh:
    name, label = "gmsh", "gmsh -algo hxt"
    power = 3  # vertices grow with 1 / length^3

    def __init__(self, program, model, folder):
        if not model.endswith((".poly", ".smesh")):
            raise Failed("no .poly: not tried")
        self.model, self.mesh = os.path.join(folder, "model.geo"), os.path.join(folder, "model.mesh")
        write_geo(model, cells_of(program, model, folder), self.model)

    def attempt(self, length, limit):
        return run(["gmsh", "-3", "-algo", "hxt", "-nt", "1", "-clmax", f"{length:.12g}", "-clmin", f"{length:.12g}", "-format", "mesh", "-o", self.mesh, self.model], limit)


def measured(program, mesh, model):
    """Shape and verdict, by `wellmesh check`."""
    result = run([program, "check", mesh, "--plc", model, "--json", "-", "--quiet"])
    try:
        return json.loads(result.output)
    except ValueError:
        raise Failed(result.errors[-300:]) from None


def meet(rival, program, model, target, start, limit):
    """Runs the rival until its mesh has about `target` vertices. @return the run, the report on its mesh."""
    size, best = start, None
    for _ in range(ATTEMPTS):
        if os.path.exists(rival.mesh):
            os.remove(rival.mesh)
        result = rival.attempt(size, limit)
        if result.code != 0 or not os.path.exists(rival.mesh):
            if best:
                break
            raise Failed(f"exit {result.code}: {(result.errors or result.output)[-200:]}")
        report = measured(program, rival.mesh, model)
        off = abs(report["vertices"] / target - 1)
        if best is None or off < best[0]:
            best = (off, result, report)
        if off <= CLOSE_ENOUGH:
            break
        size *= (report["vertices"] / target) ** (1 / rival.power)
    return best[1], best[2]


def row_of(rival, model, size, almost_good, result, report):
    shape, certificate = report["certificate"]["shape"], report["certificate"]
    interior, boundary, whole = shape["interior"], shape["boundary"], shape["all"]
    refuted = [f"{c['name']}: {c['violations']} of {c['checked']}" for c in certificate["claims"] if c["state"] == "refuted"]
    row = {"model": model, "strategy": rival.label, "size": size, "status": "rival", "vertices": report["vertices"], "almost_good_vertices": almost_good,
           "vertices_over_almost_good": report["vertices"] / float(almost_good) if almost_good else "", "tets": report["tets"],
           "max_radius_edge": whole["max_radius_edge_ratio"], "max_aspect_ratio": whole["max_aspect_ratio"], "min_sigma": whole["min_sigma"],
           "seconds": f"{result.seconds:.4f}", "certificate": "refuted" if refuted else "proven", "error": "; ".join(refuted), "histogram": whole["min_dihedral_histogram"]}
    for part, s in (("interior", interior), ("boundary", boundary)):
        if s["tets"]:
            row[f"min_dihedral_{part}_deg"], row[f"max_dihedral_{part}_deg"] = s["min_dihedral_angle_deg"], s["max_dihedral_angle_deg"]
    for degrees in BELOW:
        row[f"tets_below_{degrees}_deg"] = sum(whole["min_dihedral_histogram"][:degrees // 5])
    return row


def targets(rows, theta):
    """(model, size) -> (median vertices of `best`, vertices of the almost-good mesh)."""
    found = {}
    for key in dict.fromkeys((r["model"], r["size"]) for r in rows):
        mine = [r for r in rows if (r["model"], r["size"]) == key and r["strategy"] == "best" and r["vertices"]]
        goals = {}
        for r in mine:
            goals.setdefault(float(r["theta_deg"]), []).append(r)
        met = [t for t, group in goals.items() if (t == theta if theta is not None else all(r["status"] == "goals_met" for r in group))]
        if met:
            group = goals[max(met)]
            found[key] = statistics.median(int(r["vertices"]) for r in group), group[0]["almost_good_vertices"]
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("table", help="study.csv")
    parser.add_argument("--program", default=DEFAULT_PROGRAM)
    parser.add_argument("--rival", action="append", choices=["tetgen", "gmsh"])
    parser.add_argument("--theta", type=float, help="goal, in degrees, of the rows whose vertices are met")
    parser.add_argument("--limit", type=float, default=300, help="seconds a run of a rival may take")
    arguments = parser.parse_args()
    with open(arguments.table, newline="") as stream:
        reader = csv.DictReader(stream)
        columns, rows = reader.fieldnames, list(reader)
    wanted = targets([r for r in rows if r["status"] != "rival"], arguments.theta)
    if not wanted:
        sys.exit("no rows of strategy best whose goals were met: nothing to compare with")
    good = True
    for rival_type in (TetGen, Gmsh):
        if arguments.rival and rival_type.name not in arguments.rival:
            continue
        if not shutil.which(rival_type.name):
            print(f"{rival_type.name} is not installed: skipped")
            continue
        print(f"{rival_type.label}: {package_version(rival_type.name)}")
        rows = [r for r in rows if r["strategy"] != rival_type.label]
        for (model, size), (target, almost_good) in wanted.items():
            with tempfile.TemporaryDirectory() as folder:
                try:
                    rival = rival_type(arguments.program, model, folder)
                    # TetGen makes about 0.4 vertices a volume bound, as wellmesh does; Gmsh an edge near its bound, six tetrahedra of sqrt(1/72) h^3 a vertex.
                    volume = total_volume(arguments.program, model, folder)
                    start = volume / target * 0.4 if rival.power == 1 else (volume / target * 1.4) ** (1 / 3)
                    result, report = meet(rival, arguments.program, model, target, start, arguments.limit)
                except (Failed, OSError) as failure:
                    print(f"  {model}: {failure}")
                    good = False
                    continue
                row = row_of(rival, model, size, almost_good, result, report)
                rows.append(row)
                print(f"  {model}: {row['vertices']} vertices for {target:.0f}, {row.get('min_dihedral_interior_deg', '-')} / {row.get('min_dihedral_boundary_deg', '-')} degrees, "
                      f"{row['certificate']} {row['error']}", flush=True)
    table = io.StringIO()
    writer = csv.DictWriter(table, columns, restval="", lineterminator="\n", extrasaction="ignore")
    writer.writeheader()
    writer.writerows(rows)
    replace_file(arguments.table, table.getvalue())
    page = os.path.splitext(arguments.table)[0] + ".html"
    if os.path.exists(page):
        add_to_page(page, columns, [r for r in rows if r["status"] == "rival"])
    return 0 if good else 1


def replace_file(path, text):
    with open(path + ".tmp", "w", newline="") as stream:
        stream.write(text)
    os.replace(path + ".tmp", path)


def add_to_page(path, columns, rivals):
    """Puts rows into the page's data and table, instead of those of the same strategies from before."""
    with open(path) as stream:
        page = stream.read()
    start, end = '<script type="application/json" id="data">', "</script>"
    head, _, rest = page.partition(start)
    data, _, tail = rest.partition(end)
    old = {(r["model"], r["strategy"], r["size"]): r for r in json.loads(data)}
    for row in rivals:
        key = row["model"], row["strategy"], row["size"]
        histogram = row.get("histogram", old.get(key, {}).get("histogram"))  # the table has none
        text = {column: str(row.get(column, "")) for column in columns}
        row["page"] = text if histogram is None else {**text, "histogram": histogram}
    data = json.dumps([r for r in json.loads(data) if r["status"] != "rival"] + [row["page"] for row in rivals]).replace("<", "\\u003c")
    lines = [line for line in head.split("\n") if not (line.startswith("<tr>") and "<td>rival</td>" in line)]
    at = next(i for i, line in enumerate(lines) if line.startswith("</tbody>"))
    lines[at:at] = ["<tr>" + "".join(f"<td>{shown(row['page'][column])}</td>" for column in columns) + "</tr>" for row in rivals]
    replace_file(path, "\n".join(lines) + start + data + end + tail)


def shown(text):
    try:
        return f"{float(text):.5g}" if len(text) > 8 else html.escape(text)
    except ValueError:
        return html.escape(text)


def total_volume(program, model, folder):
    report = run([program, "doctor", model, "--json", os.path.join(folder, "doctor.json")])
    if report.code != 0:
        raise Failed(f"doctor: {report.errors[-200:]}")
    with open(os.path.join(folder, "doctor.json")) as stream:
        return sum(cell["volume"] for cell in json.load(stream)["cells"] if cell["filled"])


if __name__ == "__main__":
    sys.exit(main())
