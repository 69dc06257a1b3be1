#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How fast every model of some folders is meshed at about the same number of tetrahedra, not only those that suit.

    benchmarks/every_model.py MODELS [--tets 1000000] [--angles 20,30] [--threads 1,2] [--referee REFEREE]

Edge lengths are tuned until the number is within 7 %, with slivers nearly ignored. Then, model by model, each angle and number of threads once (--repeats), all
stages but reading, certificate and writing: thousands of tetrahedra a second. `x` before a rate: a goal was missed, or --time-limit ended the run.
What is no valid input, has no mesh in time or not the number is listed with the reason. Once more for each angle and number of threads, not timed, the mesh is
written: the exit status is 1 only if one that --time-limit did not end is not, byte by byte, that of another number of threads, or the referee refuses it.
"""
import argparse
import hashlib
import json
import os
import statistics
import sys
import tempfile

from common import DEFAULT_PROGRAM, diagonal, judge, plain_copy, points_of, run

EXTENSIONS = (".off", ".poly", ".smesh", ".stl", ".obj", ".ply", ".vtp")
TOLERANCE = 0.07
ROUNDS = 6  # of tuning


class NoMesh(Exception):
    """Why a model has no row of rates."""


class Runs:
    def __init__(self, arguments, folder):
        self.arguments, self.folder = arguments, folder
        self.mesh, self.report, self.exempt = (os.path.join(folder, name) for name in ("mesh.mesh", "report.json", "exempt.txt"))

    def once(self, model, size, degrees, threads, writes=False):
        command = [self.arguments.program, "mesh", model, "--size", repr(size), "--min-dihedral", str(degrees), "--threads", str(threads), "--quiet", "--json", self.report,
                   "--time-limit", str(self.arguments.time_limit)]
        result = run(command + (["-o", self.mesh, "--exemptions", self.exempt] if writes else []))
        if result.code not in (0, 1):
            raise NoMesh(f"exit {result.code}: {result.errors.splitlines()[0][:100] if result.errors else 'no message'}")
        with open(self.report) as stream:
            data = json.load(stream)
        seconds = sum(t["seconds"] for t in data["timings"] if t["stage"] not in ("total", "read", "certify", "write"))
        return {"tets": data["tets"], "seconds": seconds, "met": result.code == 0, "in_time": data["termination"] != "time_budget_reached", "statistics": data["statistics"]}

    def size_for(self, model):
        try:
            size = diagonal(points_of(model)) / 60
        except (ValueError, IndexError, OSError) as reason:
            raise NoMesh(f"can't be read: {reason}") from reason
        for _ in range(ROUNDS):
            row = self.once(model, size, 1, 0)
            if not row["in_time"]:
                raise NoMesh(f"over {self.arguments.time_limit:g} s")
            if abs(row["tets"] / self.arguments.tets - 1) < TOLERANCE:
                return size
            size *= (row["tets"] / self.arguments.tets) ** (1 / 3)
        raise NoMesh(f"{row['tets']} tetrahedra at last")

    def rates(self, model, size, degrees):
        """By number of threads; and what the referee, and equal bytes, have to say."""
        runs, first, complaints = {}, None, []
        for threads in self.arguments.threads:
            runs[threads] = [self.once(model, size, degrees, threads) for _ in range(self.arguments.repeats)]
            row = self.once(model, size, degrees, threads, writes=True)
            if not row["in_time"]:
                continue
            with open(self.mesh, "rb") as stream:
                digest = hashlib.md5(stream.read()).hexdigest()
            if first is not None:
                complaints += [f"other bytes with {threads} threads"] if digest != first else []
                continue
            first = digest
            if self.arguments.referee:
                met, told = row["met"], row["statistics"]  # what misses a goal conforms and is Delaunay all the same
                verdict = judge(self.arguments.referee, self.mesh, plain_copy(model, self.folder), degrees if met else 0, told["certificate_tolerance"],
                                2 if met else 0, exempt=self.exempt, flat_angle=told["certificate_flat_angle_rad"])
                if not verdict["ok"]:
                    complaints.append(f"referee: {'; '.join(map(str, verdict['failures']))[:100]}")
        return runs, complaints


def cell(runs):
    seconds = statistics.median(r["seconds"] for r in runs)
    return f"{'' if all(r['met'] for r in runs) else 'x '}{runs[0]['tets'] / seconds / 1000:.0f}"


def main():
    def numbers(text):
        return [int(word) for word in text.split(",")]

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="+", help="folders, looked through for models, or models")
    parser.add_argument("--program", default=DEFAULT_PROGRAM)
    parser.add_argument("--tets", type=float, default=1e6)
    parser.add_argument("--angles", type=numbers, default=[20, 30])
    parser.add_argument("--threads", type=numbers, default=[1, 2])
    parser.add_argument("--repeats", type=int, default=1)
    parser.add_argument("--time-limit", type=float, default=30)
    parser.add_argument("--referee", help="judges the meshes of the first number of threads")
    arguments = parser.parse_args()
    models = []
    for place in arguments.folder:
        models += [place] if os.path.isfile(place) else [os.path.join(at, name) for at, _, names in sorted(os.walk(place)) for name in sorted(names)]
    models = [m for m in models if os.path.splitext(m)[1].lower() in EXTENSIONS]
    print("| model | size | tetrahedra |" + "".join(f" {a} degrees, threads {t} |" for a in arguments.angles for t in arguments.threads) + "\n|---|---|---|" + "---|" *
          (len(arguments.angles) * len(arguments.threads)))
    bad = 0
    with tempfile.TemporaryDirectory() as folder:
        runs = Runs(arguments, folder)
        for model in models:
            name = os.path.basename(model)
            try:
                size = runs.size_for(model)
                cells, complaints, tets = [], [], 0
                for degrees in arguments.angles:
                    by_threads, more = runs.rates(model, size, degrees)
                    cells += [cell(by_threads[t]) for t in arguments.threads]
                    complaints += more
                    tets = tets or by_threads[arguments.threads[0]][0]["tets"]
                bad += bool(complaints)
                print(f"| {name} | {size:.6g} | {tets} | " + " | ".join(cells) + " |" + "".join(f" {c}" for c in complaints), flush=True)
            except NoMesh as reason:
                print(f"| {name} | {reason} |", flush=True)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
