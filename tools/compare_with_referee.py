#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs `wellmesh check` and an independent referee on the same mesh and compares them claim by claim.

    tools/compare_with_referee.py WELLMESH REFEREE MESH... [--plc INPUT] [--max-radius-edge X] [--min-dihedral X]
                                  [--max-aspect X] [--min-sigma X] [--tolerance X] [--flat-angle X] [--quiet]

REFEREE is a program that takes the same options and prints one JSON object: counts (`not_delaunay`,
`encroached_triangles`, ...), `conformity`, `quality`, and `failures`, a list of sentences "what: count".
Counts must be equal. Measured values must agree to the digits that the referee prints (shape: 6, volumes: 12;
distances: to 1e-15 of the diagonal). Exit status 0 if all claims of all meshes agree, 1 if one differs, 2 if a program fails.
"""
import argparse
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path


def run_wellmesh(arguments, mesh, options):
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.json"
        done = subprocess.run([arguments.wellmesh, "check", mesh, "--quiet", "--json", str(report), *options], capture_output=True, text=True)
        if not report.exists():
            return None, done.stderr.strip()
        return json.loads(report.read_text()), ""


def run_referee(arguments, mesh, options):
    done = subprocess.run([arguments.referee, mesh, *options], capture_output=True, text=True)
    try:
        return json.loads(done.stdout), ""
    except json.JSONDecodeError:
        return None, done.stderr.strip()


def failure_count(referee, words):
    """Count in the failure sentence that starts with `words`; 0 if there is none."""
    for sentence in referee["failures"]:
        if sentence.startswith(words):
            return int(sentence.rsplit(":", 1)[1])
    return 0


def failed(referee, words):
    return any(sentence.startswith(words) for sentence in referee["failures"])


class Comparison:
    """One row a claim: name, wellmesh's value, the referee's, whether they agree."""

    def __init__(self, ours, theirs):
        self.rows = []
        self.claims = {claim["name"]: claim for claim in ours["certificate"]["claims"]}
        self.ours, self.theirs = ours, theirs

    def equal(self, name, ours, theirs):
        self.rows.append((name, ours, theirs, ours == theirs))

    def close(self, name, ours, theirs, relative=1e-5, absolute=0.0):
        self.rows.append((name, ours, theirs, math.isclose(ours, theirs, rel_tol=relative, abs_tol=absolute)))

    def verdict(self, name, theirs_failed):
        state = self.claims[name]["state"]
        if state != "not_checked" or theirs_failed:
            self.rows.append((name, state, "refuted" if theirs_failed else "proven", (state == "refuted") == theirs_failed))

    def run(self):
        referee, violations = self.theirs, {name: claim["violations"] for name, claim in self.claims.items()}
        self.equal("vertices", self.ours["vertices"], referee["vertices"])
        self.equal("tets", self.ours["tets"], referee["tets"])
        for name, words in (("positive_tets", "inverted or flat"), ("face_sharing", "faces shared by more"), ("distinct_vertices", "duplicate vertices"),
                            ("used_vertices", "vertices in no tetrahedron"), ("listed_subfaces_exist", "listed triangles that are no face")):
            self.equal(name, violations[name], failure_count(referee, words))
        self.equal("gabriel_subfaces checked", self.claims["gabriel_subfaces"]["checked"], referee["constraint_triangles"])
        self.equal("gabriel_subsegments checked", self.claims["gabriel_subsegments"]["checked"], referee["constraint_segments"])
        self.equal("delaunay", violations["delaunay"], referee["not_delaunay"])
        self.equal("gabriel_subfaces", violations["gabriel_subfaces"], referee["encroached_triangles"])
        self.equal("gabriel_subsegments", violations["gabriel_subsegments"], referee["encroached_segments"])
        self.volumes()
        if referee["conformity"] is not None:
            self.verdict("plc_distance", failed(referee, "constraint triangles leave the PLC"))
            self.verdict("plc_area", failed(referee, "constraint area differs"))
            self.equal("plc_vertices", violations["plc_vertices"], referee["conformity"]["lost_plc_vertices"])
        for name, words in (("radius_edge", "radius-edge"), ("dihedral", "dihedral"), ("aspect_ratio", "aspect"), ("sigma", "sigma")):
            self.verdict(name, failed(referee, words))
        for part in ("all", "interior", "boundary"):
            self.shape(part, self.ours["certificate"]["shape"][part], referee["quality"][part])
        return self.rows

    def volumes(self):
        ours = {str(region["region"]): region["volume"] for region in self.ours["certificate"]["regions"]}
        theirs = self.theirs["region_volumes"]
        self.equal("regions", sorted(ours), sorted(theirs))
        for region in sorted(set(ours) & set(theirs)):
            total = sum(abs(volume) for volume in theirs.values())
            self.close(f"volume of region {region}", ours[region], theirs[region], 1e-12, 1e-12 * total)

    def shape(self, part, ours, theirs):
        if theirs is None:
            self.equal(f"{part}: tets", ours["tets"], 0)
            return
        self.equal(f"{part}: tets", ours["tets"], theirs["tets"])
        for name, mine, other in (("radius-edge", "max_radius_edge_ratio", "max_radius_edge"), ("sigma", "min_sigma", "min_sigma"),
                                  ("aspect", "max_aspect_ratio", "max_aspect"), ("min dihedral", "min_dihedral_angle_deg", "min_dihedral"),
                                  ("max dihedral", "max_dihedral_angle_deg", "max_dihedral")):
            self.close(f"{part}: {name}", ours[mine], theirs[other], 1e-5)
        bins = theirs["min_dihedral_histogram_5deg"]
        self.equal(f"{part}: histogram", ours["min_dihedral_histogram"][: len(bins)], bins)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("wellmesh")
    parser.add_argument("referee")
    parser.add_argument("mesh", nargs="+")
    flags = ("--plc", "--max-radius-edge", "--min-dihedral", "--max-aspect", "--min-sigma", "--tolerance", "--flat-angle")
    for flag in flags:
        parser.add_argument(flag)
    parser.add_argument("--quiet", action="store_true", help="print only what differs")
    arguments = parser.parse_args()
    options = [word for flag in flags if (value := getattr(arguments, flag[2:].replace("-", "_"))) is not None for word in (flag, value)]

    status = 0
    for mesh in arguments.mesh:
        ours, our_error = run_wellmesh(arguments, mesh, options)
        theirs, their_error = run_referee(arguments, mesh, options)
        if ours is None and theirs is None:
            print(f"{mesh}: both refuse to read it ({our_error}) ({their_error})")
            continue
        if ours is None or theirs is None:
            print(f"{mesh}: only {'the referee' if ours is None else 'wellmesh'} can look at it ({our_error or their_error})")
            status = max(status, 2)
            continue
        rows = Comparison(ours, theirs).run()
        differing = [row for row in rows if not row[3]]
        for name, mine, other, agree in differing if arguments.quiet else rows:
            print(f"  {'  ' if agree else '! '}{name:34} {mine!s:>24} {other!s:>24}")
        print(f"{mesh}: {len(rows) - len(differing)} of {len(rows)} agree")
        status = max(status, 1 if differing else 0)
    return status


if __name__ == "__main__":
    sys.exit(main())
