#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What an angle costs: vertices and time over those of the almost-good mesh, on real models and made domains, in four places, judged by a referee.

    benchmarks/thirty_degrees.py --referee JUDGE --models DIR [FILE ...] [--program build/release/bin/wellmesh] [--angle 30] [--seeds 5]
    benchmarks/thirty_degrees.py --referee JUDGE --tets 20000 --tets 200000

The almost-good mesh has the same input, size and seed, but --min-dihedral 0 --seeding off. A row is one input, size and place: medians over the
seeds of the almost-good mesh's vertices and seconds of processor time, then vertices and time over those, without seeding and with it; the
greatest R/r and the least angle of all; and whether the referee said `ok` to all at radius-edge ratio 2 and that angle. Exit status 0 if all
were ok and, from 30 degrees on, R/r is at most 8.
"""
import argparse
import os
import statistics
import sys
import tempfile
from dataclasses import dataclass, field

from common import DEFAULT_PROGRAM, diagonal, judge, points_of, run
from real_models import RIGHT_ANGLED
from synthetic_domains import VOLUME_OVER_CUBED_SIZE, domains, moved, write_poly
from synthetic_domains import TRANSFORMS
from transformed_models import PLACES, transformed

MAX_ASPECT = 8 * (1 + 1e-4)  # the referee prints six digits
TRANSFORM_OF_PLACE = {"as given": "as_is", "rotated": "rotated", "1e3 away": "shift_1e3_rotated", "1e6 away": "shift_1e6_rotated"}


@dataclass
class Job:
    name: str
    case: str
    place: str
    model: str
    size: list
    tolerance: float


@dataclass
class Costs:
    vertices: list = field(default_factory=list)
    time: list = field(default_factory=list)


def vertex_count(mesh):
    with open(mesh) as stream:
        for line in stream:
            if line.strip() == "Vertices":
                return int(next(stream))
    return 0


def jobs_of_models(arguments, folder):
    for name in arguments.files:
        for place in arguments.place or PLACES:
            model = transformed(os.path.join(arguments.models, name), folder, place)
            tolerance = 1e-7 if place == "1e6 away" or name.endswith(".stl") else None
            for case in arguments.case or ["none", "size"]:
                yield Job(name, case, place, model, ["--size", repr(diagonal(points_of(model)) / 30)] if case == "size" else [], tolerance)


def jobs_of_domains(arguments, folder):
    for domain in domains():
        if arguments.files and domain.name not in arguments.files:
            continue
        for place in arguments.place or ["as given", "rotated"]:
            transform = next(t for t in TRANSFORMS if t.name == TRANSFORM_OF_PLACE[place])
            here = moved(domain, transform, 1)
            model = os.path.join(folder, "domain.poly")
            write_poly(here, model)
            for tets in arguments.tets:
                size = (sum(here.volumes.values()) / tets / VOLUME_OVER_CUBED_SIZE) ** (1 / 3)
                yield Job(domain.name, f"{tets // 1000}k", place, model, ["--size", repr(size)], transform.tolerance)


class Table:
    def __init__(self, arguments, folder):
        self.arguments, self.out = arguments, os.path.join(folder, "out.mesh")
        self.good = True
        print(f"{'input':26} {'size':5} {'place':9} {'n0':>7} {'t0 s':>7} | {'plain':>6} {'time':>6} | {'seeded':>6} {'time':>6} | {'R/r':>5} {'angle':>6}  verdict")

    def mesh(self, job, seed, options):
        if os.path.exists(self.out):
            os.remove(self.out)
        return run([self.arguments.program, "mesh", job.model, "-o", self.out, "--quiet", *job.size, "--seed", str(seed), *options], self.arguments.limit)

    def row(self, job):
        costs = {"off": Costs(), "auto": Costs()}
        counts, seconds, aspects, angles, problems = [], [], [], [], []
        for seed in range(1, self.arguments.seeds + 1):
            base = self.mesh(job, seed, ["--min-dihedral", "0", "--seeding", "off"])
            if base.code != 0:
                problems.append(f"almost-good mesh: exit {base.code}")
                continue
            counts.append(vertex_count(self.out))
            seconds.append(base.cpu_seconds)
            for seeding in ("off", "auto") if job.size else ("off",):  # the lattice needs a size
                result = self.mesh(job, seed, ["--min-dihedral", repr(self.arguments.angle), "--seeding", seeding])
                if result.code != 0:
                    problems.append(f"seed {seed}, seeding {seeding}: exit {result.code} {result.errors[-120:]}")
                    continue
                verdict = judge(self.arguments.referee, self.out, job.model, self.arguments.angle, job.tolerance)
                if not verdict["ok"]:
                    problems.append(f"seed {seed}, seeding {seeding}: {verdict['failures'][:3]}")
                    continue
                costs[seeding].vertices.append(verdict["vertices"] / counts[-1])
                costs[seeding].time.append(result.cpu_seconds / max(seconds[-1], 1e-3))
                aspects.append(verdict["quality"]["all"]["max_aspect"])
                angles.append(verdict["quality"]["all"]["min_dihedral"])
        if aspects and max(aspects) > MAX_ASPECT and self.arguments.angle >= 30:
            problems.append(f"R/r {max(aspects):.3f}")

        def median(values, digits):
            return f"{statistics.median(values):.{digits}f}" if values else "-"

        cells = " | ".join(f"{median(c.vertices, 3):>6} {median(c.time, 1):>6}" for c in costs.values())
        print(f"{job.name:26} {job.case:5} {job.place:9} {median(counts, 0):>7} {median(seconds, 3):>7} | {cells} | {max(aspects, default=0):5.2f} "
              f"{min(angles, default=0):6.2f}  {'ok' if not problems else problems}", flush=True)
        self.good = self.good and not problems


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="*", help="models, or names of made domains; default: all right-angled ones")
    parser.add_argument("--models", help="folder of the models; without: made domains")
    parser.add_argument("--tets", type=int, action="append", help="of made domains, about (may be repeated; default 20000)")
    parser.add_argument("--referee", required=True)
    parser.add_argument("--program", default=DEFAULT_PROGRAM)
    parser.add_argument("--angle", type=float, default=30)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--case", action="append", choices=["none", "size"], help="of models: no size, a thirtieth of the diagonal; default both")
    parser.add_argument("--place", action="append", choices=list(PLACES))
    parser.add_argument("--limit", type=float, default=600, help="seconds for a run")
    arguments = parser.parse_args()
    arguments.tets = arguments.tets or [20000]
    if arguments.models and not arguments.files:
        arguments.files = RIGHT_ANGLED
    with tempfile.TemporaryDirectory() as folder:
        table = Table(arguments, folder)
        for job in jobs_of_models(arguments, folder) if arguments.models else jobs_of_domains(arguments, folder):
            table.row(job)
    return 0 if table.good else 1


if __name__ == "__main__":
    sys.exit(main())
