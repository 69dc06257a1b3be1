#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Meshes a set of models and lets an independent referee judge each mesh; one row a run.

    benchmarks/real_models.py --models DIR --referee JUDGE [--program build/release/bin/wellmesh] [--case none|size|volume ...] [FILE ...]

Cases: `none` no size, `size` a thirtieth of the bounding box's diagonal, `volume` at most (diagonal / 30)^3 / 8.5 a tetrahedron.
Exit status 0 if every run ended 0 and every verdict was ok.
"""
import argparse
import os
import sys
import tempfile

from common import DEFAULT_PROGRAM, diagonal, judge, plain_copy, points_of, run

RIGHT_ANGLED = ["plc/bar2.poly", "plc/crux.poly", "cad/u_arch.off", "cad/part1.stl", "multimat/cubes.off", "multimat/eight_cubes.poly",
                "geosemi/dike_mod.poly", "geosemi/seissol_loh1.poly", "geosemi/gmsh_mos3d.poly"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="*", default=RIGHT_ANGLED)
    parser.add_argument("--models", required=True)
    parser.add_argument("--referee", required=True)
    parser.add_argument("--compare", action="store_true", help="`wellmesh check` must agree with the referee, claim by claim")
    parser.add_argument("--program", default=DEFAULT_PROGRAM)
    parser.add_argument("--case", action="append", choices=["none", "size", "volume"])
    parser.add_argument("--min-dihedral", default="20")
    parser.add_argument("--limit", type=float, default=300)
    parser.add_argument("--anchors", help="a table of rivals' vertex counts to print beside the case `volume`")
    arguments = parser.parse_args()
    anchors = {}
    if arguments.anchors:
        for row in open(arguments.anchors).read().splitlines()[1:]:
            cells = row.split("\t")
            if cells[1].startswith("TetGen 1.5"):
                anchors[cells[0]] = int(cells[4])
    good = True
    print(f"{'model':28} {'case':7} {'exit':>4} {'vertices':>9} {'tets':>9} {'min dih':>7} {'R/L':>5} {'R/r':>6} {'seconds':>8} {'MiB':>6} {'rival':>7}  verdict")
    for name in arguments.files:
        model = os.path.join(arguments.models, name)
        d = diagonal(points_of(model))
        for case in arguments.case or ["none", "size", "volume"]:
            with tempfile.TemporaryDirectory() as folder:
                mesh = os.path.join(folder, "out.mesh")
                command = [arguments.program, "mesh", model, "-o", mesh, "--quiet", "--min-dihedral", arguments.min_dihedral]
                if case == "size":
                    command += ["--size", repr(d / 30)]
                if case == "volume":
                    command += ["--max-volume", repr((d / 30) ** 3 / 8.5)]
                result = run(command, arguments.limit)
                row = f"{name:28} {case:7} {result.code:4d}"
                if not os.path.exists(mesh):
                    print(f"{row}  no mesh after {result.seconds:.1f} s: {result.errors[-300:]}", flush=True)
                    good = False
                    continue
                tolerance = 1e-7 if name.endswith(".stl") else None
                verdict = judge(arguments.referee, mesh, plain_copy(model, folder), arguments.min_dihedral, tolerance, compare_with=arguments.program if arguments.compare else None)
                if "quality" not in verdict:
                    print(f"{row}  {verdict['failures']}", flush=True)
                    good = False
                    continue
                quality = verdict["quality"]["all"]
                rival = str(anchors.get(name, "")) if case == "volume" else ""
                print(f"{row} {verdict['vertices']:9d} {verdict['tets']:9d} {quality['min_dihedral']:7.2f} {quality['max_radius_edge']:5.2f} {quality['max_aspect']:6.1f} "
                      f"{result.seconds:8.2f} {result.memory / 2**20:6.0f} {rival:>7}  {'ok' if verdict['ok'] else verdict['failures']}", flush=True)
                good = good and result.code == 0 and verdict["ok"] and not (rival and verdict["vertices"] > int(rival))
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
