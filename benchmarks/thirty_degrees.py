#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What an angle costs on real models: vertices over those of the almost-good mesh, in four places; a referee judges each mesh.

    benchmarks/thirty_degrees.py --models DIR --referee JUDGE [--program build/release/bin/wellmesh] [--angle 30] [--seeds 5] [FILE ...]

The almost-good mesh has the same input, size and seed, but --min-dihedral 0 --seeding off. Each row is one model, size and place: medians over the
seeds of vertices over the almost-good mesh's without and with seeding, of the time over its time, the greatest R/r, the least angle, and
whether the referee said `ok` to all meshes at radius-edge ratio 2 and that angle. Exit status 0 if all were ok and R/r is at most 8.
"""
import argparse
import os
import statistics
import sys
import tempfile

from common import DEFAULT_PROGRAM, diagonal, judge, points_of, run
from real_models import RIGHT_ANGLED
from transformed_models import PLACES, transformed


def mesh_once(program, model, out, options, limit):
    if os.path.exists(out):
        os.remove(out)
    result = run([program, "mesh", model, "-o", out, "--quiet", *options], limit)
    return result if os.path.exists(out) else None, result


def vertex_count(mesh):
    with open(mesh) as stream:
        for line in stream:
            if line.strip() == "Vertices":
                return int(next(stream))
    return 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="*", default=RIGHT_ANGLED)
    parser.add_argument("--models", required=True)
    parser.add_argument("--referee", required=True)
    parser.add_argument("--program", default=DEFAULT_PROGRAM)
    parser.add_argument("--angle", type=float, default=30)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--case", action="append", choices=["none", "size"])
    parser.add_argument("--place", action="append", choices=list(PLACES))
    parser.add_argument("--limit", type=float, default=600)
    arguments = parser.parse_args()
    good = True
    print(f"{'model':26} {'case':5} {'place':9} {'n0':>7} {'plain':>6} {'seeded':>6} {'time':>6} {'seconds':>8} {'R/r':>5} {'angle':>6}  verdict")
    for name in arguments.files:
        for place in arguments.place or PLACES:
            with tempfile.TemporaryDirectory() as folder:
                model = transformed(os.path.join(arguments.models, name), folder, place)
                d = diagonal(points_of(model))
                tolerance = 1e-7 if place == "1e6 away" or name.endswith(".stl") else None
                for case in arguments.case or ["none", "size"]:
                    size = ["--size", repr(d / 30)] if case == "size" else []
                    plain, seeded, times, seconds, aspects, angles, counts, problems = [], [], [], [], [], [], [], []
                    for seed in range(1, arguments.seeds + 1):
                        out = os.path.join(folder, "out.mesh")
                        common = [*size, "--seed", str(seed)]
                        _, base = mesh_once(arguments.program, model, out, [*common, "--min-dihedral", "0", "--seeding", "off"], arguments.limit)
                        if base.code != 0:
                            problems.append(f"almost-good mesh: exit {base.code}")
                            continue
                        n0 = vertex_count(out)
                        counts.append(n0)
                        for seeding, ratios in (("off", plain), ("auto", seeded)):
                            if case == "none" and seeding == "auto":
                                continue  # the lattice needs a size
                            made, result = mesh_once(arguments.program, model, out, [*common, "--min-dihedral", repr(arguments.angle), "--seeding", seeding], arguments.limit)
                            if result.code != 0 or not made:
                                problems.append(f"seed {seed} exit {result.code}: {result.errors[-120:]}")
                                continue
                            verdict = judge(arguments.referee, out, model, arguments.angle, tolerance)
                            if not verdict["ok"]:
                                problems.append(f"seed {seed}: {verdict['failures'][:3]}")
                                continue
                            ratios.append(verdict["vertices"] / n0)
                            aspects.append(verdict["quality"]["all"]["max_aspect"])
                            angles.append(verdict["quality"]["all"]["min_dihedral"])
                            if seeding == "off":
                                times.append(result.cpu_seconds / max(base.cpu_seconds, 1e-3))
                                seconds.append(result.cpu_seconds)
                    if aspects and max(aspects) > 8.0005 and arguments.angle >= 30:
                        problems.append(f"R/r {max(aspects):.2f}")
                    median = lambda values, digits: f"{statistics.median(values):.{digits}f}" if values else "-"  # noqa: E731
                    print(f"{name:26} {case:5} {place:9} {median(counts, 0):>7} {median(plain, 3):>6} {median(seeded, 3):>6} {median(times, 1):>6} {median(seconds, 2):>8} "
                          f"{max(aspects, default=0):5.2f} {min(angles, default=0):6.2f}  {'ok' if not problems else problems}", flush=True)
                    good = good and not problems
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
