#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Meshes inputs with acute angles and narrow gaps made by code (acute_inputs.py, gap_inputs.py); an independent referee judges each mesh; one row each.

    benchmarks/acute_families.py --referee JUDGE [--program build/release/bin/wellmesh] [--quick] [--family fan] [--tetgen tetgen]

Each input is meshed twice: for conformity alone (--slivers none, no bound on the radius-edge ratio), and with the default goals. A row demands
of both runs a mesh that is Delaunay, Gabriel and conforming by the referee, of the first no more vertices than the family allows, of the
second radius-edge ratio 2 and 20 degrees outside the tetrahedra that the run lists as exempt. Exit status 1 if anything misses.
"""
import argparse
import fnmatch
import json
import math
import os
import shlex
import subprocess
import sys
import tempfile

from acute_inputs import families
from common import DEFAULT_PROGRAM, judge, run, tetgen
from gap_inputs import gap_inputs
from synthetic_domains import TRANSFORMS, Transform, moved, write_poly

PLACES = {t.name: t for t in [*TRANSFORMS, Transform("rotated_1e-6", True, 0.0, 1e-6), Transform("rotated_1e6", True, 0.0, 1e6)]}
NO_QUALITY = ["--slivers", "none", "--min-dihedral", "0", "--max-radius-edge", "1e300"]


def vertices_of(mesh, section, corners):
    """Vertex numbers, one element after the other, of a section of a .mesh file."""
    with open(mesh) as stream:
        for line in stream:
            if line.strip() != section:
                continue
            for _ in range(int(next(stream))):
                yield from map(int, next(stream).split()[:corners])


def remove(*paths):
    for path in paths:
        if os.path.exists(path):
            os.remove(path)


class Bench:
    def __init__(self, arguments, folder):
        self.arguments = arguments
        self.mesh, self.report, self.exempt = (os.path.join(folder, name) for name in ("out.mesh", "report.json", "exempt.txt"))
        usage = subprocess.run([arguments.program, "mesh", "--help"], capture_output=True, text=True).stdout
        self.lists_exemptions = "--exemptions" in usage
        self.rows, self.misses = [], []

    def of_segments_too(self, failures):
        """To the referee only triangles are boundary: where the input has segments of their own, what exempt tetrahedra touch is counted here."""
        blind = [f for f in failures if f.startswith("exempt tetrahedra with fewer than two vertices on the boundary")]
        if not blind:
            return failures
        boundary = set(vertices_of(self.mesh, "Triangles", 3)) | set(vertices_of(self.mesh, "Edges", 2))
        tets = list(vertices_of(self.mesh, "Tetrahedra", 4))
        with open(self.exempt) as stream:
            exempt = [int(line.split()[0]) - 1 for line in stream if not line.startswith("#")]
        free = sum(sum(v in boundary for v in tets[4 * t:4 * t + 4]) < 2 for t in exempt)
        rest = [f for f in failures if f not in blind]
        return rest + [f"{free} exempt tetrahedra with fewer than two vertices on segments and facets"] if free else rest

    def attempt(self, model, acute, place, goals, options):
        """One run and its verdict, as the cells of a row and a list of what it misses."""
        remove(self.mesh, self.report, self.exempt)
        command = [self.arguments.program, "mesh", model, "-o", self.mesh, "--quiet", "--json", self.report, *options]
        if goals and self.lists_exemptions:
            command += ["--exemptions", self.exempt]
        result = run(command, self.arguments.limit)
        cells = {"exit": result.code, "seconds": result.seconds, "command": shlex.join(command)}
        if not os.path.exists(self.mesh):
            reason = result.errors.split("\n")[0]
            return cells, [f"exit {result.code} after {result.seconds:.1f} s: {reason if len(reason) < 240 else reason[:120] + ' ... ' + reason[-110:] or 'killed'}"]
        statistics = {}
        if os.path.exists(self.report):
            with open(self.report) as stream:
                statistics = json.load(stream).get("statistics", {})
        verdict = judge(self.arguments.referee, self.mesh, model, 20 if goals else 0, max(place.tolerance or 1e-9, statistics.get("certificate_tolerance", 0)),
                        2 if goals else 0, compare_with=self.arguments.program if self.arguments.compare else None,
                        exempt=self.exempt if os.path.exists(self.exempt) else None, flat_angle=statistics.get("certificate_flat_angle_rad") or None)
        if any(len(polygon) == 2 for polygons, _ in acute.domain.facets for polygon in polygons):
            verdict["failures"] = self.of_segments_too(verdict["failures"])
            verdict["ok"] = not verdict["failures"]
        failures = [f"referee: {f}" for f in verdict["failures"]] or ([] if verdict["ok"] else ["referee: not ok"])
        if "quality" not in verdict:
            return cells, failures
        volume, expected = sum(verdict["region_volumes"].values()), acute.volume * place.scale ** 3
        # rounded to 1e-16 of the largest coordinate, a thin domain loses that over its thickness
        if not math.isclose(volume, expected, rel_tol=1e-6 + 1e-13 * (1 + place.shift) * place.scale ** 3 / expected):
            failures.append(f"volume {volume!r}, the domain's {expected!r}")
        if result.code not in (0, 1):
            failures.append(f"exit {result.code} with a mesh")
        quality = verdict["quality"]["all"] or {"min_dihedral": math.nan, "max_radius_edge": math.nan}  # all are exempt
        cells.update(vertices=verdict["vertices"], tets=verdict["tets"], exempt=verdict.get("exempt", 0), min_dihedral=quality["min_dihedral"],
                     max_radius_edge=quality["max_radius_edge"])
        return cells, failures

    def row(self, acute, place, model):
        domain = moved(acute.domain, place, self.arguments.rotation_seed)
        write_poly(domain, model)
        entry = {"family": acute.family, "name": acute.name, "place": place.name, "input_vertices": len(domain.vertices)}
        text = f"{acute.name:24} {place.name:12} {len(domain.vertices):5d}"
        seed = ["--seed", str(self.arguments.seed)]
        plain, failures = self.attempt(model, acute, place, False, [*NO_QUALITY, *seed])
        entry["conformity"] = plain
        text += f" {plain['exit']:4d} {plain.get('vertices', '-'):>7} {plain['seconds']:6.1f}"
        if "vertices" in plain and acute.most_vertices and plain["vertices"] > acute.most_vertices:
            failures.append(f"{plain['vertices']} vertices for conformity, at most {acute.most_vertices} asked")
        failures = [f"conformity: {f}" for f in failures]
        if not self.arguments.conformity_only:
            good, missed = self.attempt(model, acute, place, True, seed)
            entry["quality"] = good
            failures += [f"quality: {f}" for f in missed]
            text += f" | {good['exit']:4d} {good.get('vertices', '-'):>7} {good['seconds']:6.1f}"
            if "tets" in good:
                text += f" {good['tets']:8d} {good['exempt']:7d} {good['min_dihedral']:7.3g} {good['max_radius_edge']:7.3g}"
            else:
                text += f" {'-':>8} {'-':>7} {'-':>7} {'-':>7}"
        if self.arguments.tetgen:
            entry["tetgen"] = tetgen(self.arguments.tetgen, "-pq2NEF", model, self.arguments.tetgen_limit)[1]
            text += f" {entry['tetgen'] or '-':>7}"
        entry["failures"] = failures
        self.rows.append(entry)
        print(f"{text}  {'ok' if not failures else 'MISS'}", flush=True)
        for failure in failures:
            print(f"    {failure}", flush=True)
        if failures and self.arguments.keep:
            os.makedirs(self.arguments.keep, exist_ok=True)
            write_poly(domain, os.path.join(self.arguments.keep, f"{acute.name}-{place.name}.poly"))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--referee", required=True)
    parser.add_argument("--compare", action="store_true", help="`wellmesh check` must agree with the referee, claim by claim")
    parser.add_argument("--program", default=DEFAULT_PROGRAM)
    parser.add_argument("--family", action="append", metavar="PATTERN", help="only these, by family or name; * matches anything (may be repeated)")
    parser.add_argument("--place", action="append", choices=list(PLACES), help="default: as_is, rotated, rotated_1e-6")
    parser.add_argument("--quick", action="store_true", help="as they are only, and six random complexes")
    parser.add_argument("--random", type=int, default=12, metavar="N", help="random complexes")
    parser.add_argument("--conformity-only", action="store_true", help="not with the default goals")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--rotation-seed", type=int, default=1)
    parser.add_argument("--limit", type=float, default=60, help="seconds for a run")
    parser.add_argument("--tetgen", help="a program to count vertices of with -pq2, for comparison")
    parser.add_argument("--tetgen-limit", type=float, default=8)
    parser.add_argument("--keep", help="folder for the inputs of rows that miss")
    parser.add_argument("--json", help="file for all rows")
    arguments = parser.parse_args()
    inputs = [*families(6 if arguments.quick else arguments.random), *gap_inputs()]
    chosen = [a for a in inputs
              if not arguments.family or any(fnmatch.fnmatch(word, p) for p in arguments.family for word in (a.family, a.name))]
    if not chosen:
        parser.error("no input has such a name; families are " + ", ".join(dict.fromkeys(a.family for a in inputs)))
    places = [PLACES[name] for name in arguments.place or (["as_is"] if arguments.quick else ["as_is", "rotated", "rotated_1e-6"])]
    print(f"{'':43} conformity alone    | default goals, 2 and 20 outside exemptions")
    print(f"{'input':24} {'place':12} {'in':>5} exit {'verts':>7} {'s':>6} | exit {'verts':>7} {'s':>6} {'tets':>8} {'exempt':>7} {'min dih':>7} {'R/L':>7}"
          + (f" {'TetGen':>7}" if arguments.tetgen else "") + "  verdict")
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(arguments, folder)
        for acute in chosen:
            for place in places:
                bench.row(acute, place, os.path.join(folder, "in.poly"))
    rows = bench.rows
    bad = sum(bool(r["failures"]) for r in rows)
    unfinished = sum("vertices" not in r[kind] for r in rows for kind in ("conformity", "quality") if kind in r)
    print(f"{len(rows)} rows, {bad} with a miss, {unfinished} runs without a mesh"
          + ("" if bench.lists_exemptions else "; the program lists no exemptions, so every tetrahedron is judged"))
    if arguments.json:
        with open(arguments.json, "w") as out:
            json.dump(rows, out, indent=1)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
