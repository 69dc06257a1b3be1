#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Speed and memory, one process at a time, as ratios against the installed TetGen measured in the same run.

    benchmarks/speed.py [--program build/release/bin/wellmesh] [--scale 0.1] [--json FILE]

Delaunay    N uniform points: `wellmesh delaunay`'s delaunay_seconds over the "Delaunay seconds" of `tetgen -NEFV`; goal at most 0.5
Meshing     the unit cube at --min-dihedral 20: tetrahedra per second over those of `tetgen -pq1.4/14aV`, V tuned for the same number of
            tetrahedra; goal at least 1.7. Counted: wellmesh, all stages but reading and writing (with its certificate, and also without);
            TetGen, "Total running seconds" (which leave reading out) less "Output seconds". Wall and processor time of the processes beside them.
Memory      the kernel's peak resident size of that wellmesh process over its tetrahedra; goal at most 200 bytes
Growth      the same cube at 0.1, 0.3, 1 and 3 times the tetrahedra; exponent of the least-squares line of log seconds over log tetrahedra

Ratios are of medians of --repeats runs, the two programs taking turns. Exit status 1 if a goal is missed or a program fails.
"""
import argparse
import json
import math
import os
import platform
import random
import statistics
import sys
import tempfile

from common import DEFAULT_PROGRAM, number_in, package_version, run, tetgen
from synthetic_domains import VOLUME_OVER_CUBED_SIZE, polycube, write_poly

DELAUNAY_GOAL, MESHING_GOAL, MEMORY_GOAL = 0.5, 1.7, 200.0
# "The same number" of tetrahedra: within this part.
COUNT_TOLERANCE = 0.03
# TetGen's tetrahedra of the unit cube, times the greatest volume: a first guess (26165 at 1e-4), tuned from there.
TETGEN_TETS_TIMES_VOLUME = 2.5
# Growth: times the number of tetrahedra; runs with more than this many are made once.
GROWTH = [0.1, 0.3, 1.0, 3.0]
MOST_TETS_TO_REPEAT = 1_500_000


class Failed(Exception):
    pass


def checked(result):
    if result.code != 0:
        raise Failed(f"{' '.join(result.command)}: exit {result.code}: {result.errors[-300:]}")
    return result


def medians(runs):
    """Of every number in a list of dictionaries of the same shape."""
    return {key: statistics.median(r[key] for r in runs) for key in runs[0]}


def process_cost(result):
    return {"wall_seconds": result.seconds, "cpu_seconds": result.cpu_seconds, "peak_bytes": result.memory}


class Speed:
    def __init__(self, arguments, folder):
        self.program, self.tetgen, self.repeats, self.seed = arguments.program, arguments.tetgen, arguments.repeats, arguments.seed
        self.folder = folder
        self.cube = os.path.join(folder, "cube.poly")
        write_poly(polycube("cube", {(0, 0, 0): 1}), self.cube)

    def delaunay(self, count):
        """Both programs on one file of `count` points, in turns."""
        points = os.path.join(self.folder, "points.node")
        generator = random.Random(self.seed)
        with open(points, "w") as out:
            out.write(f"{count} 3 0 0\n")
            out.writelines(f"{i} {generator.random()!r} {generator.random()!r} {generator.random()!r}\n" for i in range(1, count + 1))
        ours, rival = [], []
        for _ in range(self.repeats):
            result = checked(run([self.program, "delaunay", points]))
            report = json.loads(result.output)
            ours.append({"seconds": report["delaunay_seconds"], "tets": report["tets"], **process_cost(result)})
            result, _, tets = tetgen(self.tetgen, "-NEFV", points)
            seconds = number_in(checked(result).output, "Delaunay seconds:")
            if seconds is None or tets is None:
                raise Failed("tetgen printed no Delaunay seconds")
            rival.append({"seconds": seconds, "tets": tets, **process_cost(result)})
        os.remove(points)
        if ours[0]["tets"] != rival[0]["tets"]:
            raise Failed(f"different triangulations: {ours[0]['tets']} and {rival[0]['tets']} tetrahedra")
        return medians(ours), medians(rival)

    def mesh_once(self, size):
        mesh, report = os.path.join(self.folder, "out.mesh"), os.path.join(self.folder, "report.json")
        result = checked(run([self.program, "mesh", self.cube, "-o", mesh, "--size", repr(size), "--min-dihedral", "20", "--seed", str(self.seed),
                              "--quiet", "--json", report]))
        with open(report) as stream:
            data = json.load(stream)
        stages = {timing["stage"]: timing["seconds"] for timing in data["timings"]}
        counted = sum(seconds for stage, seconds in stages.items() if stage not in ("read", "write", "total"))
        row = {"tets": data["tets"], "vertices": data["vertices"], "seconds": counted, "seconds_without_certificate": counted - stages.get("certify", 0.0)}
        return {**row, **process_cost(result), **{f"stage_{stage}": seconds for stage, seconds in stages.items()}}

    def tetgen_once(self, volume):
        result, points, tets = tetgen(self.tetgen, f"-pq1.4/14a{volume:.17g}", self.cube)
        total, output = (number_in(checked(result).output, name) for name in ("Total running seconds:", "Output seconds:"))
        if None in (total, output, tets):
            raise Failed("tetgen printed no times or counts")
        return {"tets": tets, "vertices": points, "seconds": total - output, **process_cost(result)}

    def tuned(self, once, parameter, power, target):
        """The parameter, scaled until `once` makes about `target` tetrahedra (their number goes with its power), and that run."""
        for _ in range(6):
            row = once(parameter)
            if abs(row["tets"] / target - 1) <= COUNT_TOLERANCE:
                return parameter, row
            parameter *= (row["tets"] / target) ** (1 / power)
        raise Failed(f"no parameter found for {target} tetrahedra (last {row['tets']})")

    def meshing(self, target, with_rival):
        size, first = self.tuned(self.mesh_once, (1 / target / VOLUME_OVER_CUBED_SIZE) ** (1 / 3), 3, target)
        ours, rival, volume = [first], [], None
        if with_rival:
            volume, first = self.tuned(self.tetgen_once, TETGEN_TETS_TIMES_VOLUME / target, 1, target)
            rival.append(first)
        for _ in range(self.repeats - 1 if target <= MOST_TETS_TO_REPEAT else 0):
            ours.append(self.mesh_once(size))
            if with_rival:
                rival.append(self.tetgen_once(volume))
        return {"size": size, **medians(ours)}, {"max_volume": volume, **medians(rival)} if rival else None


def exponent(rows):
    """Slope of the least-squares line of log seconds over log tetrahedra."""
    x, y = [math.log(r["tets"]) for r in rows], [math.log(r["seconds"]) for r in rows]
    mx, my = statistics.fmean(x), statistics.fmean(y)
    return sum((a - mx) * (b - my) for a, b in zip(x, y)) / sum((a - mx) ** 2 for a in x)


def processor():
    try:
        with open("/proc/cpuinfo") as stream:
            return next(line.split(":", 1)[1].strip() for line in stream if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor()


def goal(label, value, limit, most):
    met = value <= limit if most else value >= limit
    print(f"  {label}: {value:.2f}, goal {'at most' if most else 'at least'} {limit:g}: {'met' if met else 'MISSED'}", flush=True)
    return {"name": label, "value": value, "limit": limit, "at_most": most, "met": met}


def cost(row):
    return f"{row['wall_seconds']:8.2f} {row['cpu_seconds']:8.2f} {row['peak_bytes'] / 2**20:7.0f} {row['peak_bytes'] / row['tets']:7.0f}"


def measure(speed, scale, parts, points, data):
    goals, tets = [], max(1000, round(1e6 * scale))
    costs = f"{'wall s':>8} {'cpu s':>8} {'MiB':>7} {'B/tet':>7}"
    if "delaunay" in parts:
        count = points or max(1000, round(1e6 * scale))
        ours, rival = speed.delaunay(count)
        data["delaunay"] = {"points": count, "wellmesh": ours, "tetgen": rival}
        print(f"\nDelaunay triangulation of {count} uniform points\n  {'':10} {'tets':>9} {'seconds':>8} {'tets/s':>9} {costs}")
        for name, row in (("wellmesh", ours), ("tetgen", rival)):
            print(f"  {name:10} {row['tets']:9.0f} {row['seconds']:8.3f} {row['tets'] / row['seconds']:9.0f} {cost(row)}")
        goals.append(goal("Delaunay seconds over TetGen's", ours["seconds"] / rival["seconds"], DELAUNAY_GOAL, True))
    one = None
    if "meshing" in parts:
        one, rival = speed.meshing(tets, True)
        data["meshing"] = {"wellmesh": one, "tetgen": rival}
        print(f"\nUnit cube, about {tets} tetrahedra, dihedral angles of at least 20 and 14 degrees\n"
              f"  {'':24} {'tets':>9} {'vertices':>9} {'seconds':>8} {'tets/s':>9} {costs}")
        for name, row, seconds in (("wellmesh", one, one["seconds"]), ("  without certificate", one, one["seconds_without_certificate"]),
                                   ("tetgen", rival, rival["seconds"])):
            print(f"  {name:24} {row['tets']:9.0f} {row['vertices']:9.0f} {seconds:8.2f} {row['tets'] / seconds:9.0f} {cost(row)}")
        print("  stages: " + ", ".join(f"{key[6:]} {value:.2f}" for key, value in one.items() if key.startswith("stage_")))

        def ratio(key):
            return (one["tets"] / one[key]) / (rival["tets"] / rival.get(key, rival["seconds"]))

        print(f"  tets per second over TetGen's without the certificate {ratio('seconds_without_certificate'):.2f}, by wall time {ratio('wall_seconds'):.2f}, "
              f"by processor time {ratio('cpu_seconds'):.2f} (both with files read and written)")
        goals.append(goal("tets per second over TetGen's", ratio("seconds"), MESHING_GOAL, False))
        goals.append(goal("bytes of peak memory a tet", one["peak_bytes"] / one["tets"], MEMORY_GOAL, True))
    if "growth" in parts:
        rows = [one if factor == 1.0 and one else speed.meshing(round(tets * factor), False)[0] for factor in GROWTH]
        data["growth"] = {"rows": rows, "exponent": exponent(rows)}
        print(f"\nGrowth of the time\n  {'tets':>9} {'vertices':>9} {'seconds':>8} {'tets/s':>9} {costs}  exponent since the row above")
        for i, row in enumerate(rows):
            step = f"{exponent(rows[i - 1:i + 1]):.3f}" if i else ""
            print(f"  {row['tets']:9.0f} {row['vertices']:9.0f} {row['seconds']:8.2f} {row['tets'] / row['seconds']:9.0f} {cost(row)}  {step}")
        print(f"  seconds go with the {data['growth']['exponent']:.3f}th power of the number of tetrahedra")
    return goals


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=DEFAULT_PROGRAM)
    parser.add_argument("--tetgen", default="tetgen")
    parser.add_argument("--scale", type=float, default=1.0, help="times the numbers of points and tetrahedra")
    parser.add_argument("-n", type=int, help="points of the Delaunay part (default 1000000 x scale)")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--part", action="append", choices=["delaunay", "meshing", "growth"], help="only this one (may be repeated)")
    parser.add_argument("--json", help="file for all numbers")
    arguments = parser.parse_args()
    if arguments.scale <= 0 or arguments.repeats < 1 or (arguments.n or 1000) < 4:
        parser.error("--scale, --repeats and -n are positive")
    try:
        version = checked(run([arguments.program, "--version"])).output.strip()
    except (Failed, OSError) as failure:
        parser.error(str(failure))
    data = {"machine": processor(), "load_before": os.getloadavg()[0], "wellmesh": version, "rival": package_version("tetgen"), "scale": arguments.scale,
            "repeats": arguments.repeats, "seed": arguments.seed}
    print(f"{data['machine']}; load before {data['load_before']:.2f}; {version}; rival {data['rival']}")
    with tempfile.TemporaryDirectory() as folder:
        try:
            goals = measure(Speed(arguments, folder), arguments.scale, arguments.part or ["delaunay", "meshing", "growth"], arguments.n, data)
        except Failed as failure:
            print(f"failed: {failure}")
            goals, data["failed"] = [], str(failure)
    data["goals"], data["load_after"] = goals, os.getloadavg()[0]
    if arguments.json:
        with open(arguments.json, "w") as out:
            json.dump(data, out, indent=1)
            out.write("\n")
    met = "failed" not in data and all(g["met"] for g in goals)
    print(f"\n{'all goals met' if met else 'not all goals met'}; load after {data['load_after']:.2f}")
    return 0 if met else 1


if __name__ == "__main__":
    sys.exit(main())
