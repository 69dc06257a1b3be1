#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Meshes domains made by code, in several orientations, places and scales; an independent referee judges each mesh; one row a run.

    benchmarks/synthetic_domains.py --referee JUDGE [--program build/release/bin/wellmesh] [--quick]

Each row meshes one domain with --size H (H for about the asked number of tetrahedra) and demands: exit status 0, the referee's `ok` at
radius-edge ratio 2 and dihedral angle 20, region volumes as the domain has them, and at most 1.10 times the vertices of the same run with
--min-dihedral 0. The first seed of each size also runs with --max-volume V --min-dihedral 0 and must need at most 1.10 times the vertices of
`tetgen -pq2 -aV` on the same file (on the domain as it is, marked *, where TetGen fails). Exit status 1 if anything misses.
"""
import argparse
import json
import math
import os
import random
import shlex
import sys
import tempfile
from dataclasses import dataclass, field

from common import DEFAULT_PROGRAM, diagonal, judge, package_version, run, tetgen

RATIO_LIMIT = 1.10

# Edge length h and tetrahedra per volume: a mesh has about 1 / (0.112 h^3) of them (fewer where the lattice fills most of it, more where it is thin).
VOLUME_OVER_CUBED_SIZE = 0.112
# Mean volume of a tetrahedron is about half the greatest.
GREATEST_OVER_MEAN_VOLUME = 2.1


@dataclass
class Domain:
    name: str
    vertices: list                                  # coordinates
    facets: list                                    # (polygons, points in holes of the facet)
    volumes: dict                                   # region's number -> volume
    holes: list = field(default_factory=list)       # points in cavities
    regions: list = field(default_factory=list)     # (point, number)


def polycube(name, cells, side=1.0, **seeds):
    """Union of unit cells {(x, y, z): region}: each facet is a largest connected set of squares in one plane between the same two regions."""
    numbers, vertices, facets = {}, [], []

    def vertex(corner):
        if corner not in numbers:
            numbers[corner] = len(vertices)
            vertices.append(tuple(side * c for c in corner))
        return numbers[corner]

    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        sheets = {}
        for cell in cells:
            for low in (cell, tuple(c - (k == axis) for k, c in enumerate(cell))):
                high = tuple(c + (k == axis) for k, c in enumerate(low))
                below, above = cells.get(low, 0), cells.get(high, 0)
                if below != above:
                    sheets.setdefault((high[axis], below, above), set()).add((low[u], low[v]))
        for (plane, _, _), squares in sorted(sheets.items()):
            while squares:
                stack, piece = [min(squares)], set()
                squares.remove(stack[0])
                while stack:
                    x, y = stack.pop()
                    piece.add((x, y))
                    for near in ((x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1)):
                        if near in squares:
                            squares.remove(near)
                            stack.append(near)
                facets.append(([[vertex(tuple(dict(((axis, plane), (u, x), (v, y)))[k] for k in range(3))) for x, y in loop]
                                for loop in outline(piece)], []))
    volumes = {}
    for region in cells.values():
        volumes[region] = volumes.get(region, 0) + side ** 3
    return Domain(name, vertices, facets, volumes, **seeds)


def outline(piece):
    """Loops of corners around a set of unit squares, straight corners left out."""
    following = {}
    for x, y in piece:
        for near, a, b in (((x, y - 1), (x, y), (x + 1, y)), ((x + 1, y), (x + 1, y), (x + 1, y + 1)),
                           ((x, y + 1), (x + 1, y + 1), (x, y + 1)), ((x - 1, y), (x, y + 1), (x, y))):
            if near not in piece:
                following[a] = b
    while following:
        p, loop = min(following), []
        while p in following:
            loop.append(p)
            p = following.pop(p)
        count = len(loop)
        yield [b for i, b in enumerate(loop)
               if (b[0] - loop[i - 1][0]) * (loop[(i + 1) % count][1] - b[1]) != (b[1] - loop[i - 1][1]) * (loop[(i + 1) % count][0] - b[0])]


def stepped_shaft():
    """Two octagonal prisms of different width on one axis: dihedral angles of 135 and 90 degrees, one facet with a hole."""
    vertices, facets = [], []
    slope = math.sqrt(2) - 1

    def ring(a, z):
        b = a * slope
        first = len(vertices)
        vertices.extend((x, y, z) for x, y in ((a, b), (b, a), (-b, a), (-a, b), (-a, -b), (-b, -a), (b, -a), (a, -b)))
        return list(range(first, first + 8))

    def sides(low, high):
        facets.extend(([[low[i], low[(i + 1) % 8], high[(i + 1) % 8], high[i]]], []) for i in range(8))

    rings = [ring(1, 0), ring(1, 1.5), ring(0.5, 1.5), ring(0.5, 3)]
    facets.append(([rings[0]], []))
    sides(rings[0], rings[1])
    facets.append(([rings[1], rings[2]], [(0, 0, 1.5)]))
    sides(rings[2], rings[3])
    facets.append(([rings[3]], []))
    # an octagon whose inscribed circle has radius a: area 8 slope a^2
    return Domain("shaft", vertices, facets, {0: 8 * slope * 1.5 * (1 + 0.25)})


def domains():
    around = {(x, y, z): 1 for x in range(3) for y in range(3) for z in range(3) if (x, y, z) != (1, 1, 1)}
    return [polycube("cube", {(0, 0, 0): 1}),
            polycube("l_block", {(0, 0, 0): 1, (1, 0, 0): 1, (0, 1, 0): 1}),
            polycube("cavity", around, holes=[(1.5, 1.5, 1.5)]),
            polycube("two_regions", {(0, 0, 0): 1, (1, 0, 0): 2}, regions=[((0.5, 0.5, 0.5), 1), ((1.5, 0.5, 0.5), 2)]),
            stepped_shaft()]


@dataclass
class Transform:
    name: str
    rotated: bool = False
    shift: float = 0.0      # along (1, 1, 1), in diagonals
    scale: float = 1.0
    tolerance: float = None  # the referee's, if not its own: coordinates of 1e6 diagonals are rounded to 1e-10 of a diagonal and more


TRANSFORMS = [Transform("as_is"), Transform("rotated", True),
              Transform("shift_1e3", False, 1e3), Transform("shift_1e3_rotated", True, 1e3),
              Transform("shift_1e6", False, 1e6, 1.0, 1e-7), Transform("shift_1e6_rotated", True, 1e6, 1.0, 1e-7),
              Transform("scale_1e-6", False, 0.0, 1e-6), Transform("scale_1e6", False, 0.0, 1e6)]


def moved(domain, transform, rotation_seed):
    """The domain rotated about the origin, then scaled, then shifted."""
    generator = random.Random(rotation_seed)
    w, *axis = (generator.gauss(0, 1) for _ in range(4))
    length = math.sqrt(w * w + sum(a * a for a in axis))
    w, axis = w / length, [a / length for a in axis]

    def cross(a, b):
        return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]

    shift = transform.shift * transform.scale * diagonal(domain.vertices)

    def place(p):
        if transform.rotated:
            t = [2 * c for c in cross(axis, p)]
            p = [c + w * d + e for c, d, e in zip(p, t, cross(axis, t))]
        return tuple(transform.scale * c + shift for c in p)

    return Domain(domain.name, [place(p) for p in domain.vertices],
                  [(polygons, [place(p) for p in holes]) for polygons, holes in domain.facets],
                  {region: volume * transform.scale ** 3 for region, volume in domain.volumes.items()},
                  [place(p) for p in domain.holes], [(place(p), number) for p, number in domain.regions])


def write_poly(domain, path):
    def coordinates(p):
        return " ".join(repr(float(c)) for c in p)

    with open(path, "w") as out:
        out.write(f"{len(domain.vertices)} 3 0 0\n")
        out.writelines(f"{i} {coordinates(p)}\n" for i, p in enumerate(domain.vertices, 1))
        out.write(f"{len(domain.facets)} 0\n")
        for polygons, holes in domain.facets:
            out.write(f"{len(polygons)} {len(holes)}\n")
            out.writelines(f"{len(polygon)} {' '.join(str(i + 1) for i in polygon)}\n" for polygon in polygons)
            out.writelines(f"{i} {coordinates(p)}\n" for i, p in enumerate(holes, 1))
        out.write(f"{len(domain.holes)}\n")
        out.writelines(f"{i} {coordinates(p)}\n" for i, p in enumerate(domain.holes, 1))
        out.write(f"{len(domain.regions)}\n")
        out.writelines(f"{i} {coordinates(p)} {number} -1\n" for i, (p, number) in enumerate(domain.regions, 1))


def volume_failures(domain, verdict, tolerance):
    """Region volumes against the domain's: a relative rounding of the coordinates moves them by some such parts."""
    found = {int(region): volume for region, volume in verdict.get("region_volumes", {}).items()}
    if len(found) != len(domain.volumes):
        return [f"{len(found)} regions, the domain has {len(domain.volumes)}"]
    pairs = zip([found[r] for r in sorted(found)], [domain.volumes[r] for r in sorted(domain.volumes)])
    return [f"a region's volume is {a!r}, the domain's {b!r}" for a, b in pairs if not abs(a - b) <= 10 * tolerance * b]


class Bench:
    def __init__(self, arguments, folder):
        self.arguments, self.folder = arguments, folder
        self.rows = self.failed_rows = 0
        self.misses = []
        self.worst = {"dihedral": math.inf, "ratio": 0.0, "rival": 0.0}
        self.rivals = {}

    def mesh(self, model, options):
        """A run and the report it wrote (None if it wrote none); the mesh is in the folder's out.mesh."""
        mesh, report = os.path.join(self.folder, "out.mesh"), os.path.join(self.folder, "report.json")
        for path in (mesh, report):
            if os.path.exists(path):
                os.remove(path)
        result = run([self.arguments.program, "mesh", model, "-o", mesh, "--quiet", "--json", report, *options], self.arguments.limit)
        data = None
        if os.path.exists(report):
            with open(report) as stream:
                data = json.load(stream)
        return result, data if os.path.exists(mesh) else None

    def rival_vertices(self, domain, transform, tets, model, volume):
        """TetGen's vertices at the same greatest volume; (count, whether on the very same file)."""
        def count(file, greatest):
            return tetgen(self.arguments.tetgen, f"-pq2a{greatest:.17g}NEF", file, self.arguments.limit)[1]

        key = (domain.name, tets)
        if transform.name == "as_is":
            self.rivals[key] = count(model, volume)
            return self.rivals[key], True
        here = count(model, volume)
        if here is not None:
            return here, True
        if key not in self.rivals:
            plain = os.path.join(self.folder, f"{domain.name}-plain.poly")
            write_poly(domain, plain)
            self.rivals[key] = count(plain, volume / transform.scale ** 3)
        return self.rivals[key], False

    def row(self, domain, transform, tets, seed, with_rival):
        model = os.path.join(self.folder, f"{domain.name}-{transform.name}.poly")
        here = moved(domain, transform, self.arguments.rotation_seed)
        write_poly(here, model)
        volume = sum(here.volumes.values())
        size = (volume / tets / VOLUME_OVER_CUBED_SIZE) ** (1 / 3)
        start = f"{domain.name:12} {transform.name:18} {tets:7d} {seed:4d}"
        failures = []
        common = ["--size", repr(size), "--seed", str(seed)]
        result, report = self.mesh(model, [*common, "--min-dihedral", self.arguments.min_dihedral])
        if result.code != 0:
            failures.append(f"exit {result.code}: {result.errors[-300:] or (report or {}).get('termination', '')}")
        elif not report:
            failures.append("exit 0 without a mesh and a report")
        cells = f"{start} {result.code:4d}"
        tolerance = transform.tolerance or 1e-9
        if report:
            verdict = judge(self.arguments.referee, os.path.join(self.folder, "out.mesh"), model, self.arguments.min_dihedral, transform.tolerance,
                            compare_with=self.arguments.program if self.arguments.compare else None)
            failures += [f"referee: {f}" for f in verdict["failures"]] or ([] if verdict["ok"] else ["referee: not ok"])
            failures += volume_failures(here, verdict, tolerance)
            quality = verdict.get("quality", {}).get("all", {})
            angle = quality.get("min_dihedral", math.nan)
            self.worst["dihedral"] = min(self.worst["dihedral"], angle)
            edge = report["certificate"]["shape"]["all"]["mean_edge"] / size
            cells += (f" {report['vertices']:8d} {report['tets']:8d} {angle:7.2f} {quality.get('max_radius_edge', math.nan):5.2f} "
                      f"{quality.get('max_aspect', math.nan):6.1f} {edge:6.3f} {result.seconds:7.2f} {result.memory / 2**20:6.0f}")
            plain_run, plain = self.mesh(model, [*common, "--min-dihedral", "0", "--seeding", self.arguments.plain_seeding])
            if plain_run.code != 0 or not plain:
                failures.append(f"exit {plain_run.code} with --min-dihedral 0: {plain_run.errors[-300:]}")
            if plain:
                ratio = report["vertices"] / plain["vertices"]
                self.worst["ratio"] = max(self.worst["ratio"], ratio)
                cells += f" {ratio:6.3f}"
                if ratio > RATIO_LIMIT:
                    failures.append(f"{report['vertices']} vertices are {ratio:.3f} times the {plain['vertices']} of --min-dihedral 0")
            if with_rival:
                text, failed = self.compare(domain, transform, tets, seed, model, GREATEST_OVER_MEAN_VOLUME * volume / tets)
                cells += text
                failures += failed
        self.rows += 1
        self.failed_rows += bool(failures)
        print(f"{cells}  {'ok' if not failures else 'MISS'}", flush=True)
        for failure in failures:
            print(f"    {failure}", flush=True)
            self.misses.append((start, failure))
        if failures:
            print(f"    {shlex.join(result.command)}", flush=True)
            if self.arguments.keep:
                os.makedirs(self.arguments.keep, exist_ok=True)
                write_poly(here, os.path.join(self.arguments.keep, os.path.basename(model)))

    def compare(self, domain, transform, tets, seed, model, greatest):
        """At a greatest volume, slivers ignored, against TetGen."""
        result, report = self.mesh(model, ["--max-volume", repr(greatest), "--seed", str(seed), "--min-dihedral", "0"])
        if result.code != 0 or not report:
            return "", [f"exit {result.code} with --max-volume {greatest!r} --min-dihedral 0: {result.errors[-300:]}"]
        rival, same = self.rival_vertices(domain, transform, tets, model, greatest)
        if not rival:
            return f" {report['vertices']:8d}   failed", [f"{self.arguments.tetgen} meshed neither this domain nor the one as it is"]
        ratio = report["vertices"] / rival
        self.worst["rival"] = max(self.worst["rival"], ratio)
        failures = [f"{report['vertices']} vertices with --max-volume {greatest!r} are {ratio:.3f} times TetGen's {rival}"] if ratio > RATIO_LIMIT else []
        return f" {report['vertices']:8d} {rival:8d}{' ' if same else '*'} {ratio:5.3f}", failures


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--referee", required=True)
    parser.add_argument("--compare", action="store_true", help="`wellmesh check` must agree with the referee, claim by claim")
    parser.add_argument("--program", default=DEFAULT_PROGRAM)
    parser.add_argument("--tetgen", default="tetgen")
    parser.add_argument("--quick", action="store_true", help="as they are and rotated, 1k and 20k tetrahedra, one seed")
    parser.add_argument("--domain", action="append", help="only this one (may be repeated)")
    parser.add_argument("--transform", action="append", choices=[t.name for t in TRANSFORMS], help="only this one (may be repeated)")
    parser.add_argument("--tets", action="append", type=int, help="about so many tetrahedra (may be repeated; default 1000, 20000, 200000)")
    parser.add_argument("--seed", action="append", type=int, help="default: 1, and 1 to 5 at 20000")
    parser.add_argument("--rotation-seed", type=int, default=1)
    parser.add_argument("--min-dihedral", default="20", metavar="DEG")
    parser.add_argument("--plain-seeding", choices=["auto", "off"], default="auto", help="of the run with --min-dihedral 0 that vertices are compared with")
    parser.add_argument("--limit", type=float, default=300, help="seconds for a run of a mesh generator")
    parser.add_argument("--keep", help="folder for the inputs of rows that miss")
    arguments = parser.parse_args()
    chosen = [d for d in domains() if not arguments.domain or d.name in arguments.domain]
    if not chosen:
        parser.error(f"domains are {', '.join(d.name for d in domains())}")
    names = arguments.transform or (["as_is", "rotated"] if arguments.quick else [t.name for t in TRANSFORMS])
    counts = arguments.tets or ([1000, 20000] if arguments.quick else [1000, 20000, 200000])
    print(f"rival: {package_version('tetgen')}, -pq2 -aV; wellmesh with --max-volume V --min-dihedral 0 beside it")
    print(f"{'domain':12} {'transform':18} {'asked':>7} {'seed':>4} {'exit':>4} {'vertices':>8} {'tets':>8} {'min dih':>7} {'R/L':>5} {'R/r':>6} "
          f"{'edge/h':>6} {'seconds':>7} {'MiB':>6} {'/dih 0':>6} {'at V':>8} {'TetGen':>8}  ratio  verdict")
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(arguments, folder)
        for domain in chosen:
            for transform in (t for t in TRANSFORMS if t.name in names):
                for tets in counts:
                    seeds = arguments.seed or ([1, 2, 3, 4, 5] if tets == 20000 and not arguments.quick else [1])
                    for seed in seeds:
                        bench.row(domain, transform, tets, seed, seed == seeds[0])
    print(f"{bench.rows} rows, {bench.failed_rows} with a miss; least dihedral angle {bench.worst['dihedral']:.3f}, "
          f"most vertices over --min-dihedral 0 {bench.worst['ratio']:.3f}, over TetGen {bench.worst['rival']:.3f}")
    for start, failure in bench.misses:
        print(f"  {start}: {failure}")
    return 1 if bench.misses else 0


if __name__ == "__main__":
    sys.exit(main())
