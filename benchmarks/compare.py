#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Speed, memory and shape beside other meshers', each a separate program of the same run on the same machine; ratios of medians.

    benchmarks/compare.py --part delaunay --points 1000000 --python VENV/bin/python
    benchmarks/compare.py --part mesh --tets 1000000 [--model joint.off ...] --json compare.json
    benchmarks/compare.py --part growth --tets 10000 --tets 1000000 --tets 30000000

delaunay    the triangulation of one file of uniform points; wellmesh's `delaunay_seconds` and what the drivers in rivals/ count
mesh        the unit cube and other models at equal numbers of tetrahedra (within 3 %, sizes tuned): closed surfaces (plain .off), or complexes with inner
            facets (.poly, .smesh), of the rivals for TetGen 1.5 only: wellmesh at --min-dihedral 20 and 30
            (all stages but reading, certificate and writing, which stand beside), TetGen 1.5 and 1.6 `-pq1.4/14`, Gmsh-HXT, CGAL with perturbation, Netgen
growth      wellmesh alone on the cube: time, certificate and memory by the number of tetrahedra, with exponents

Programs take turns, --repeats times; what takes longer than --patience seconds runs once. README.md says what is counted for whom. A rival that isn't there,
fails or misses the number of tetrahedra has a row that says so; none of this is a goal, so the exit status is 1 only if wellmesh fails.
"""
import argparse
import json
import math
import os
import platform
import random
import statistics
import subprocess
import sys
import tempfile

from common import DEFAULT_PROGRAM, HERE, number_in, package_version, run, tetgen

COUNT_TOLERANCE = 0.03  # "the same number" of tetrahedra: within this part
# A first guess of edges and volumes for n tetrahedra of a domain of volume V: regular tetrahedra of V/n have edges of 2.04 (V/n)^(1/3), which all exceed.
EDGE_OVER_ROOT = 2.04
DRIVERS = os.path.join(HERE, "rivals")
CUBE = ("OFF\n8 12 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n3 0 2 1\n3 0 3 2\n3 4 5 6\n3 4 6 7\n3 0 1 5\n3 0 5 4\n3 1 2 6\n3 1 6 5\n"
        "3 2 3 7\n3 2 7 6\n3 3 0 4\n3 3 4 7\n")


class Missing(Exception):
    """Why a rival has no numbers."""


def cost(result):
    return {"wall_seconds": result.seconds, "cpu_seconds": result.cpu_seconds, "peak_bytes": result.memory}


def driver_row(command, limit):
    """What a driver of rivals/ printed, and what its process cost."""
    if not os.path.exists(command[0]):
        raise Missing(f"{os.path.basename(command[0])} is not there")
    result = run(command, limit)
    if result.code != 0:
        last = (result.errors or result.output or "no message").splitlines()[-1]
        raise Missing(f"over {limit:g} s" if result.code == -9 and result.seconds >= limit else f"exit {result.code}: {last[-150:]}")
    return {**json.loads(result.output.strip().splitlines()[-1]), **cost(result)}


class Contestant:
    """A program with one parameter: with its `power` the number of tetrahedra falls."""

    def __init__(self, name, power, once, first):
        self.name, self.power, self.once, self.parameter = name, power, once, first
        self.rows, self.missing = [], None

    def attempt(self, target):
        """One run, the parameter tuned until there are about `target` tetrahedra."""
        for _ in range(6):
            row = self.once(self.parameter)
            if abs(row["tets"] / target - 1) <= COUNT_TOLERANCE:
                return row
            self.parameter *= (row["tets"] / target) ** (1 / self.power)
        raise Missing(f"no parameter found for {target} tetrahedra (last {row['tets']})")

    def median(self):
        return {key: statistics.median(r[key] for r in self.rows) if isinstance(value, (int, float)) else value for key, value in self.rows[-1].items()}


class Comparison:
    def __init__(self, arguments, folder):
        self.arguments, self.folder, self.program = arguments, folder, arguments.program
        self.out = os.path.join(folder, "out.mesh")

    def rounds(self, contestants, attempt):
        """All in turns. @return nothing: rows are in the contestants."""
        for repeat in range(self.arguments.repeats):
            for c in contestants:
                if c.missing or (repeat > 0 and c.rows[-1]["wall_seconds"] > self.arguments.patience):
                    continue
                try:
                    self.warm_memory()
                    c.rows.append(attempt(c))
                except Missing as reason:
                    c.missing = str(reason)

    def warm_memory(self):
        """A process touches so much memory and gives it back: else it depends on who ran before whether the host has to bring it first."""
        if self.arguments.warm:
            subprocess.run([sys.executable, "-c", f"bytearray({self.arguments.warm} << 20)"], check=False)

    # --- Delaunay

    def delaunay(self, count):
        points = os.path.join(self.folder, "points.node")
        write_points(points, count, self.arguments.seed)
        limit, threads, a = self.arguments.limit, str(self.arguments.threads), self.arguments

        def ours(_):
            result = run([self.program, "delaunay", points, "--threads", threads], limit)
            if result.code != 0:
                raise Missing(f"exit {result.code}: {result.errors[-200:]}")
            report = json.loads(result.output)
            return {"version": f"wellmesh {report['wellmesh']}", "seconds": report["delaunay_seconds"], "tets": report["tets"], **cost(result)}

        def tetgen15(_):
            result, _, tets = tetgen(self.found(a.tetgen), "-NEFV", points, limit)
            seconds = number_in(result.output, "Delaunay seconds:")
            if result.code != 0 or seconds is None or tets is None:
                raise Missing(f"exit {result.code}, no times")
            return {"version": package_version(a.tetgen), "seconds": seconds, "tets": tets, **cost(result)}

        contestants = [Contestant(name, 1, once, None) for name, once in (
            ("wellmesh", ours), ("TetGen 1.5 -NEFV", tetgen15),
            ("HXT", lambda _: driver_row([os.path.join(a.rivals, "hxt_delaunay"), points, threads], limit)),
            ("Gmsh tetrahedralize()", lambda _: driver_row([a.python, os.path.join(DRIVERS, "gmsh_wheel.py"), "delaunay", points, threads], limit)),
            ("CGAL Delaunay", lambda _: driver_row([os.path.join(a.rivals, "cgal_delaunay"), points], limit)))]
        self.leave_out(contestants)
        self.rounds(contestants, lambda c: c.once(None))
        os.remove(points)
        return contestants

    def leave_out(self, contestants):
        for c in contestants:
            if any(c.name.startswith(skipped) for skipped in self.arguments.skip or []):
                c.missing = "left out by --skip"

    @staticmethod
    def found(program):
        from shutil import which
        path = which(program)
        if not path:
            raise Missing(f"{program} is not installed")
        return path

    # --- meshing

    def mesh_once(self, model, size, degrees):
        report = os.path.join(self.folder, "report.json")
        result = run([self.program, "mesh", model, "-o", self.out, "--size", repr(size), "--min-dihedral", str(degrees), "--seed", str(self.arguments.seed), "--quiet",
                      "--threads", str(self.arguments.threads), "--json", report], self.arguments.limit)
        if result.code not in (0, 1):
            raise Missing(f"exit {result.code}: {result.errors[-200:]}")
        with open(report) as stream:
            data = json.load(stream)
        stages = {t["stage"]: t["seconds"] for t in data["timings"] if t["stage"] != "total"}
        apart = ("read", "certify", "write")
        return {"version": f"wellmesh {data['wellmesh']}", "tets": data["tets"], "seconds": sum(s for stage, s in stages.items() if stage not in apart),
                "certify_seconds": stages.get("certify", 0.0), "write_seconds": stages.get("write", 0.0), "goals_met": result.code == 0,
                **cost(result), **{f"stage_{stage}": s for stage, s in stages.items()}}

    def tetgen15_once(self, model, volume):
        name = os.path.join(self.folder, "tetgen" + os.path.splitext(model)[1])
        with open(model) as source, open(name, "w") as copy:
            copy.write(source.read())
        result, points, tets = tetgen(self.found(self.arguments.tetgen), f"-pq1.4/14ga{volume:.17g}", name, self.arguments.limit)
        total, output = (number_in(result.output, key) for key in ("Total running seconds:", "Output seconds:"))
        if result.code != 0 or None in (total, output, tets):
            raise Missing(f"exit {result.code}: {(result.output or result.errors).strip().splitlines()[-1][-150:]}")
        os.replace(os.path.join(self.folder, "tetgen.1.mesh"), self.out)
        return {"version": package_version(self.arguments.tetgen), "seconds": total - output, "tets": tets, "vertices": points, **cost(result)}

    def contestants(self, model, target, volume):
        a, python = self.arguments, self.arguments.python
        size, cell = EDGE_OVER_ROOT * (volume / target) ** (1 / 3), volume / target * 2.5

        def driver(*command):
            if not is_surface(model):
                raise Missing("its driver reads closed surfaces only")
            return driver_row(list(command), a.limit)

        def wheel(name, *words):
            return driver(python, os.path.join(DRIVERS, name), *words)

        return [Contestant(f"wellmesh {d}", 3, lambda h, d=d: self.mesh_once(model, h, d), size) for d in a.min_dihedral] + [
            Contestant("TetGen 1.5 -pq1.4/14", 1, lambda v: self.tetgen15_once(model, v), cell),
            Contestant("TetGen 1.6 -pq1.4/14", 1, lambda v: wheel("tetgen_wheel.py", model, f"pq1.4/14a{v:.17g}", self.out), cell),
            Contestant("Gmsh -algo hxt", 3, lambda h: wheel("gmsh_wheel.py", "mesh", model, repr(h), str(a.threads), self.out), size * 0.75),
            Contestant("CGAL, perturbed to 19", 3, lambda h: driver(os.path.join(a.rivals, "cgal_mesh"), model, repr(h), "19", self.out), size),
            Contestant("Netgen", 3, lambda h: wheel("netgen_wheel.py", model, repr(h), self.out), size)]

    def volume_of(self, model):
        """Of all that is to be filled, as wellmesh counts it for a complex: a first guess of sizes rests on it, no more."""
        if is_surface(model):
            return volume_of_surface(model)
        result = run([self.program, "doctor", model, "--json", "-"], self.arguments.limit)
        try:
            return sum(cell["volume"] for cell in json.loads(result.output)["cells"] if cell["filled"])
        except (ValueError, KeyError):
            raise Missing(f"no volume: wellmesh doctor ended {result.code}: {result.errors[-150:]}") from None

    def mesh(self, model, target):
        try:
            contestants = self.contestants(model, target, self.volume_of(model))
        except Missing as reason:
            contestants = self.contestants(model, target, 1)
            for c in contestants:
                c.missing = str(reason)
        self.leave_out(contestants)

        def attempt(c):
            if os.path.exists(self.out):
                os.remove(self.out)
            row = c.attempt(target)
            return row if c.rows else {**row, **self.shape(self.out)}

        self.rounds(contestants, attempt)
        for c in contestants:
            if c.rows:
                c.rows = [{**c.rows[0], **row} for row in c.rows]
        return contestants

    def shape(self, mesh):
        """By `wellmesh check`, of whoever made the mesh, as one mesh without the input: claims about the domain are for the referee."""
        result = run([self.program, "check", mesh, "--json", "-", "--quiet"], self.arguments.limit)
        try:
            certificate = json.loads(result.output)["certificate"]
        except ValueError:
            return {"check": result.errors[-150:]}
        shape = certificate["shape"]["all"]
        below = shape["min_dihedral_histogram"]
        refuted = {c["name"]: c["violations"] for c in certificate["claims"] if c["state"] == "refuted"}
        return {"min_dihedral": shape["min_dihedral_angle_deg"], "max_radius_edge": shape["max_radius_edge_ratio"], "max_aspect": shape["max_aspect_ratio"],
                "below_20": sum(below[:4]) / shape["tets"], "not_delaunay": refuted.get("delaunay", 0), "refuted": ", ".join(sorted(refuted))}

    def growth(self, targets):
        model, rows = cube(self.folder), []
        for target in targets:
            c = Contestant("wellmesh", 3, lambda h: self.mesh_once(model, h, 20), (1 / target / 0.112) ** (1 / 3))
            self.rounds([c], lambda c: c.attempt(target))
            if c.missing:
                raise Missing(c.missing)
            rows.append(c.median())
            print(growth_line(rows), flush=True)
        return rows


def write_points(path, count, seed):
    generator = random.Random(seed)
    with open(path, "w") as out:
        out.write(f"{count} 3 0 0\n")
        for i in range(1, count + 1):
            out.write(f"{i} {generator.random()!r} {generator.random()!r} {generator.random()!r}\n")


def cube(folder):
    path = os.path.join(folder, "cube.off")
    with open(path, "w") as out:
        out.write(CUBE)
    return path


def is_surface(model):
    return os.path.splitext(model)[1].lower() not in (".poly", ".smesh")


def volume_of_surface(model):
    """Of a closed triangulated surface in a plain .off."""
    sys.path.insert(0, DRIVERS)
    from meshes import read_off
    points, faces = read_off(model)
    total = 0.0
    for f in faces:
        for i in range(1, len(f) - 1):
            (ax, ay, az), (bx, by, bz), (cx, cy, cz) = points[f[0]], points[f[i]], points[f[i + 1]]
            total += ax * (by * cz - bz * cy) - ay * (bx * cz - bz * cx) + az * (bx * cy - by * cx)
    return abs(total) / 6


def exponent(rows, key):
    """Slope of the least-squares line of log key over log tetrahedra."""
    x, y = [math.log(r["tets"]) for r in rows], [math.log(r[key]) for r in rows]
    mx, my = statistics.fmean(x), statistics.fmean(y)
    return sum((a - mx) * (b - my) for a, b in zip(x, y)) / sum((a - mx) ** 2 for a in x)


def growth_line(rows):
    r = rows[-1]
    step = f"{exponent(rows[-2:], 'seconds'):10.3f} {exponent(rows[-2:], 'peak_bytes'):8.3f}" if len(rows) > 1 else ""
    return (f"  {r['tets']:9.0f} {r['seconds']:8.2f} {r['tets'] / r['seconds'] / 1e3:8.0f} {r['certify_seconds']:8.2f} {r['certify_seconds'] / r['seconds']:7.2f} "
            f"{r['write_seconds']:7.2f} {r['peak_bytes'] / 2**20:7.0f} {r['peak_bytes'] / r['tets']:6.0f} {step}")


def print_contestants(contestants, shapes):
    print(f"  {'':24} {'tets':>9} {'seconds':>8} {'ktets/s':>8} {'ratio':>6} {'wall s':>7} {'cpu s':>7} {'MiB':>6} {'B/tet':>6} {'runs':>4}"
          + (f" {'min dih':>7} {'<20 deg':>8} {'R/L':>6} {'R/r':>7} {'not Del.':>8}" if shapes else "") + "  version")
    first = contestants[0].median() if contestants[0].rows else None
    for c in contestants:
        if c.missing or not c.rows:
            print(f"  {c.name:24} missing: {c.missing}")
            continue
        r = c.median()
        ratio = f"{first['tets'] / first['seconds'] / (r['tets'] / r['seconds']):6.2f}" if first else "     -"
        line = (f"  {c.name:24} {r['tets']:9.0f} {r['seconds']:8.2f} {r['tets'] / r['seconds'] / 1e3:8.0f} {ratio} {r['wall_seconds']:7.1f} {r['cpu_seconds']:7.1f} "
                f"{r['peak_bytes'] / 2**20:6.0f} {r['peak_bytes'] / r['tets']:6.0f} {len(c.rows):4}")
        if shapes and "min_dihedral" in r:
            line += f" {r['min_dihedral']:7.2f} {r['below_20']:8.1e} {r['max_radius_edge']:6.2f} {r['max_aspect']:7.1f} {r['not_delaunay']:8.0f}"
        print(f"{line}  {r.get('version', '')}")
        if "certify_seconds" in r:
            print(f"  {'  certificate':24} {'':9} {r['certify_seconds']:8.2f} = {r['certify_seconds'] / r['seconds']:.2f} of meshing; writing {r['write_seconds']:.2f}; "
                  + ", ".join(f"{k[6:]} {v:.2f}" for k, v in r.items() if k.startswith("stage_") and v >= 0.01))
    sys.stdout.flush()


def machine():
    try:
        with open("/proc/cpuinfo") as stream:
            name = next(line.split(":", 1)[1].strip() for line in stream if line.startswith("model name"))
    except (OSError, StopIteration):
        name = platform.processor()
    return f"{name}, {os.cpu_count()} processors"


def parsed():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=DEFAULT_PROGRAM)
    parser.add_argument("--rivals", default=os.path.normpath(os.path.join(HERE, "..", "build", "rivals")), help="where the drivers of rivals/ are built")
    parser.add_argument("--python", default=sys.executable, help="an interpreter with the wheels gmsh, tetgen and netgen-mesher")
    parser.add_argument("--tetgen", default="tetgen", help="TetGen 1.5, a package")
    parser.add_argument("--part", action="append", choices=["delaunay", "mesh", "growth"], help="only this one (may be repeated)")
    parser.add_argument("--points", type=int, action="append", help="of the triangulations (default 1000000; may be repeated)")
    parser.add_argument("--tets", type=int, action="append", help="of meshes (default 1000000), of the growth 10k, 100k, 1M (may be repeated)")
    parser.add_argument("--model", action="append", default=[], help="a closed surface, plain .off, or a complex, .poly or .smesh with its points in it, besides the cube (may be repeated)")
    parser.add_argument("--min-dihedral", type=float, action="append", help="wellmesh's goals (default 20 and 30)")
    parser.add_argument("--skip", action="append", help="leave out rivals whose name begins so")
    parser.add_argument("--threads", type=int, default=1, help="of wellmesh, HXT and Gmsh; the others have one")
    parser.add_argument("--warm", type=int, default=0, metavar="MIB", help="before each run so much memory is touched and given back, for virtual machines whose host takes back what is free")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--patience", type=float, default=60, help="seconds of a run above which it isn't repeated")
    parser.add_argument("--limit", type=float, default=1200, help="seconds after which a run is ended")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--json", help="file for all numbers")
    arguments = parser.parse_args()
    arguments.min_dihedral = arguments.min_dihedral or [20.0, 30.0]
    if arguments.repeats < 1 or arguments.threads < 1 or arguments.warm < 0 or min(arguments.points or [4]) < 4 or min(arguments.tets or [100]) < 100:
        parser.error("--repeats and --threads are at least 1, --warm at least 0, --points at least 4, --tets at least 100")
    if not os.path.exists(arguments.program):
        parser.error(f"no program {arguments.program}: build the preset release, or name one by --program")
    return arguments


def main():
    a = parsed()
    os.environ["OMP_NUM_THREADS"] = str(a.threads)  # HXT takes all cores otherwise, whatever its option says
    data = {"machine": machine(), "load_before": os.getloadavg()[0], "threads": a.threads, "repeats": a.repeats, "warm_mib": a.warm, "seed": a.seed}
    print(f"{data['machine']}; load before {data['load_before']:.2f}; {a.threads} thread{'s' if a.threads > 1 else ''} where a program has any; medians of {a.repeats}{f'; {a.warm} MiB touched before each run' if a.warm else ''}")
    good, parts = True, a.part or ["delaunay", "mesh", "growth"]
    with tempfile.TemporaryDirectory() as folder:
        comparison = Comparison(a, folder)

        def show(key, title, contestants, shapes):
            nonlocal good
            print(f"\n{title}")
            print_contestants(contestants, shapes)
            data.setdefault(key, []).append({"title": title, "rows": [{"name": c.name, "missing": c.missing, "runs": c.rows} for c in contestants]})
            good = good and all(c.rows and not c.missing for c in contestants if c.name.startswith("wellmesh"))

        if "delaunay" in parts:
            for count in a.points or [1_000_000]:
                show("delaunay", f"Delaunay triangulation of {count} uniform points; ratio: wellmesh's rate over the row's", comparison.delaunay(count), False)
        if "mesh" in parts:
            for model in [cube(folder), *a.model]:
                for target in a.tets or [1_000_000]:
                    show("mesh", f"{os.path.basename(model)}, about {target} tetrahedra; ratio: the first row's rate over the row's", comparison.mesh(model, target), True)
        if "growth" in parts:
            print(f"\nGrowth, cube at 20 degrees\n  {'tets':>9} {'seconds':>8} {'ktets/s':>8} {'certify':>8} {'/ mesh':>7} {'write':>7} {'MiB':>7} {'B/tet':>6} {'d log s':>10} {'d log B':>8}")
            try:
                data["growth"] = rows = comparison.growth(sorted(a.tets or [10_000, 100_000, 1_000_000]))
                if len(rows) > 1:
                    print("  exponents: " + ", ".join(f"{label} {exponent(rows, key):.3f}" for label, key in (("meshing", "seconds"), ("certificate", "certify_seconds"), ("memory", "peak_bytes"))))
            except Missing as reason:
                print(f"  failed: {reason}")
                good = False
    data["load_after"] = os.getloadavg()[0]
    print(f"\nload after {data['load_after']:.2f}")
    if a.json:
        with open(a.json + ".tmp", "w") as out:
            json.dump(data, out, indent=1)
            out.write("\n")
        os.replace(a.json + ".tmp", a.json)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
