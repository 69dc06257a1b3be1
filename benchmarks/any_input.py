#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Meshes every model of a folder, whatever its angles and defects; an independent referee judges each mesh; one row a model.

    benchmarks/any_input.py --models DIR --referee JUDGE [--program build/release/bin/wellmesh] [--only PATTERN] [--tetgen tetgen] [--place rotated] [--json FILE]

DIR/manifest.tsv names the models and says which are closed and free of self-intersections. Each of these must yield a mesh that the referee finds
Delaunay, Gabriel and conforming, with radius-edge ratio 2 and 20 degrees outside the tetrahedra that the run lists as exempt, within 600 s and
8 GiB. Every other must end within 60 s in such a mesh, or in a diagnosis that names defects; then the repaired input is meshed within
600 s, or the repair says why not. The referee gets the tolerances that the run's own report states. Exit status 1 if anything misses.
"""
import argparse
import csv
import fnmatch
import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor

from common import DEFAULT_PROGRAM, diagonal, judge, package_version, plain_copy, points_of, run, tetgen
from transformed_models import PLACES, transformed

MEMORY = 8 * 2 ** 30
SOUND_LIMIT, LIMIT = 600, 60  # seconds
# of the greatest tetrahedron, where vertices are compared: a thirtieth of the diagonal is the edge of a regular one
VOLUME_OF_DIAGONAL = (1 / 30) ** 3 / 8.5


def read_json(path):
    if not os.path.exists(path):
        return {}
    with open(path) as stream:
        return json.load(stream)


def first_line(text):
    """It says what is wrong; more lines list it. The middle of a long one is the least of it."""
    line = text.split("\n")[0]
    return line if len(line) < 240 else f"{line[:120]} ... {line[-110:]}"


class Models:
    def __init__(self, arguments):
        self.arguments = arguments
        usage = subprocess.run([arguments.program, "mesh", "--help"], capture_output=True, text=True).stdout
        self.lists_exemptions = "--exemptions" in usage
        usage = subprocess.run([arguments.program, "doctor", "--help"], capture_output=True, text=True).stdout
        self.repairs = "--repair" in usage
        self.cap = ["prlimit", f"--as={MEMORY}"] if shutil.which("prlimit") else []

    def run(self, command, limit):
        return run([*self.cap, self.arguments.program, *command], limit)

    def mesh(self, model, plain, folder, limit):
        """Meshes and judges one file; a dictionary with `ok` and `why`."""
        mesh, report, exempt = (os.path.join(folder, name) for name in ("out.mesh", "mesh.json", "exempt.txt"))
        for path in (mesh, report, exempt):
            if os.path.exists(path):
                os.remove(path)
        listed = ["--exemptions", exempt] if self.lists_exemptions else []
        result = self.run(["mesh", model, "-o", mesh, "--quiet", "--json", report, *listed, *self.arguments.option], limit)
        cells = {"exit": result.code, "seconds": result.seconds, "memory": result.memory, "ok": False}
        if not os.path.exists(mesh):
            cells["why"] = f"killed after {limit:g} s" if result.code < 0 else first_line(result.errors)
            return cells
        said = read_json(report).get("statistics", {})
        tolerance, bend = said.get("certificate_tolerance"), said.get("certificate_flat_angle_rad")
        verdict = judge(self.arguments.referee, mesh, plain, 20, tolerance, exempt=exempt if os.path.exists(exempt) else None, flat_angle=bend)
        cells.update(tolerance=tolerance, flat_angle=bend, ok=verdict["ok"], why="; ".join(verdict["failures"]))
        if "quality" in verdict:
            quality = verdict["quality"]["all"] or {"min_dihedral": float("nan"), "max_radius_edge": float("nan")}
            cells.update(vertices=verdict["vertices"], tets=verdict["tets"], exempt=verdict["exempt"], min_dihedral=quality["min_dihedral"],
                         max_radius_edge=quality["max_radius_edge"])
        if result.code not in (0, 1):
            cells.update(ok=False, why=f"exit {result.code} with a mesh")
        if result.memory > MEMORY:
            cells.update(ok=False, why=f"{result.memory / 2**30:.1f} GiB")
        return cells

    def diagnose(self, model, folder, limit):
        """What the doctor finds: counts of errors by kind."""
        report = os.path.join(folder, "doctor.json")
        result = self.run(["doctor", model, "--json", report], limit)
        defects = read_json(report).get("defects") or read_json(report).get("diagnosis", {}).get("defects", [])
        found = Counter(d["kind"] for d in defects if d["severity"] == "error")
        return {"exit": result.code, "seconds": result.seconds, "memory": result.memory, "errors": dict(found), "why": first_line(result.errors)}

    def row(self, entry):
        model = os.path.join(self.arguments.models, entry["file"])
        sound = entry["closed"] == "yes" and entry["self_intersecting"] == "no"
        limit = (SOUND_LIMIT if sound else LIMIT) if self.arguments.limit is None else self.arguments.limit
        row = {"model": entry["file"], "sound": sound, "input_vertices": int(entry["vertices"]), "manifest_tetgen": entry["tetgen15_pq"]}
        with tempfile.TemporaryDirectory() as folder:
            plain = plain_copy(model, folder)
            if self.arguments.place != "as given":
                model = plain = transformed(plain, folder, self.arguments.place)
            row["mesh"] = made = self.mesh(model, plain, folder, limit)
            row["verdict"], row["ok"] = "ok" if made["ok"] else made["why"], made["ok"]
            if "vertices" not in made:
                self.treat(row, model, folder, limit)
                row["ok"] = row["ok"] and not sound
            if self.arguments.tetgen and sound and "vertices" in made:
                self.compare(row, model, plain, folder)
        return row

    def treat(self, row, model, folder, limit):
        """The way of a broken input: diagnosis, repair, mesh."""
        row["doctor"] = found = self.diagnose(model, folder, limit)
        named = ", ".join(f"{n} {kind}" for kind, n in found["errors"].items())
        if not named:
            row["verdict"] = f"no mesh and no diagnosis: {made_of(row)}"
            return
        row["ok"] = made_of(row) is not None and row["mesh"]["exit"] == 2
        row["verdict"] = f"diagnosed: {named}"
        if not row["ok"]:
            row["verdict"] += f"; but exit {row['mesh']['exit']}: {made_of(row)}"
        if not self.repairs:
            return
        repaired, report = os.path.join(folder, "repaired.poly"), os.path.join(folder, "repair.json")
        result = self.run(["doctor", model, "--repair", repaired, "--json", report], limit)
        row["repair"] = {"exit": result.code, "seconds": result.seconds, "report": read_json(report).get("repair", {})}
        if not os.path.exists(repaired):
            reason = result.errors or row["repair"]["report"].get("summary", "")
            row["verdict"] += f"; not repaired: {first_line(reason) or 'no reason given'}"
            row["ok"] = row["ok"] and bool(reason)
            return
        # a repaired copy is as closed and free of self-intersections as those that may take longest
        row["mesh_of_repaired"] = again = self.mesh(repaired, repaired, folder, self.arguments.limit or SOUND_LIMIT)
        row["verdict"] += "; repaired: " + (f"ok, {again['vertices']} vertices" if again["ok"] else again["why"])
        # whatever is left must be said: a mesh that the referee refutes is none
        row["ok"] = row["ok"] and (again["ok"] or ("vertices" not in again and again["exit"] in (2, 4)))

    def compare(self, row, model, plain, folder):
        """Vertices beside TetGen's `-pq2`: without a size, and with the same bound on volumes. Bounds on the volumes of regions that the file states
        count for both (TetGen's `aA`). TetGen writes beside its input, which is a copy."""
        copy = os.path.join(folder, "rival" + os.path.splitext(plain)[1])
        shutil.copyfile(plain, copy)
        limit = self.arguments.tetgen_limit
        row["rival"] = {"plain": tetgen(self.arguments.tetgen, "-pq2aANEF", copy, limit)[1]}
        volume = diagonal(points_of(plain)) ** 3 * VOLUME_OF_DIAGONAL
        theirs = tetgen(self.arguments.tetgen, f"-pq2a{volume:.17g}aANEF", copy, limit)[1]
        if theirs:
            mesh, report = os.path.join(folder, "sized.mesh"), os.path.join(folder, "sized.json")
            result = self.run(["mesh", model, "-o", mesh, "--quiet", "--json", report, "--max-volume", repr(volume), *self.arguments.option], limit)
            row["rival"].update(sized=theirs, ours_sized=read_json(report).get("vertices") if result.code in (0, 1) else None)


def made_of(row):
    return row["mesh"].get("why")


def ratios(row):
    """Vertices over TetGen's, without a size and with one; None where either has no mesh."""
    rival = row.get("rival", {})
    plain = row["mesh"]["vertices"] / rival["plain"] if rival.get("plain") else None
    sized = rival["ours_sized"] / rival["sized"] if rival.get("sized") and rival.get("ours_sized") else None
    return plain, sized


def text_of(row):
    made = row["mesh"]
    text = f"{row['model']:40} {row['input_vertices']:6d} {made['exit']:4d}"
    if "vertices" in made:
        text += f" {made['vertices']:8d} {made['tets']:9d} {made['min_dihedral']:7.2f} {made['max_radius_edge']:6.3g} {made['exempt']:7d}"
    else:
        text += f" {'-':>8} {'-':>9} {'-':>7} {'-':>6} {'-':>7}"
    text += f" {made['seconds']:7.1f} {made['memory'] / 2**20:6.0f} {row['manifest_tetgen']:>10}"
    for ratio in ratios(row):
        text += f" {ratio:6.2f}" if ratio else f" {'-':>6}"
    return f"{text}  {'' if row['ok'] else 'MISS '}{row['verdict']}"


def summarise(rows):
    sound = [r for r in rows if r["sound"]]
    print(f"{len(sound)} closed models without self-intersections: {sum(r['ok'] for r in sound)} judged ok, "
          f"{sum('vertices' in r['mesh'] and not r['ok'] for r in sound)} meshes refuted, {sum('vertices' not in r['mesh'] for r in sound)} without a mesh")
    others = [r for r in rows if not r["sound"]]
    print(f"{len(others)} others: {sum(r['mesh']['ok'] for r in others)} meshed as they are, {sum('doctor' in r and r['ok'] for r in others)} diagnosed, "
          f"{sum(r.get('mesh_of_repaired', {}).get('ok', False) for r in others)} of these meshed after repair; {sum(not r['ok'] for r in others)} miss")
    meshed = [r for r in rows if "vertices" in r["mesh"]]
    for what, key, largest in (("slowest", lambda r: r["mesh"]["seconds"], True), ("most memory", lambda r: r["mesh"]["memory"], True),
                               ("largest share of exempt tetrahedra", lambda r: r["mesh"]["exempt"] / r["mesh"]["tets"], True),
                               ("most vertices per input vertex", lambda r: r["mesh"]["vertices"] / r["input_vertices"], True)):
        worst = sorted(meshed, key=key, reverse=largest)[:3]
        print(f"{what}: " + ", ".join(f"{r['model']} {key(r) / 2**20 if what == 'most memory' else key(r):.3g}{' MiB' if what == 'most memory' else ''}" for r in worst))
    for what, index in (("without a size", 0), ("at the same greatest volume", 1)):
        found = sorted((ratios(r)[index], r["model"]) for r in rows if ratios(r)[index])
        if found:
            print(f"vertices over TetGen's -pq2 {what}: median {statistics.median(x for x, _ in found):.3f} of {len(found)}, most "
                  + ", ".join(f"{x:.2f} {name}" for x, name in reversed(found[-3:])))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--models", required=True)
    parser.add_argument("--referee", required=True)
    parser.add_argument("--program", default=DEFAULT_PROGRAM)
    parser.add_argument("--only", action="append", metavar="PATTERN", help="models whose path matches, like 'plc/*' (may be repeated)")
    parser.add_argument("--jobs", type=int, default=1, help="models at a time; more than cores are there for makes limits unfair")
    parser.add_argument("--limit", type=float, help="seconds a model, instead of 600 and 60")
    parser.add_argument("--place", choices=list(PLACES), default="as given", help="mesh copies that are rotated and shifted, in diagonals")
    parser.add_argument("--sound", action="store_true", help="only models that are closed and free of self-intersections")
    parser.add_argument("--option", action="append", default=[], help="passed on to `wellmesh mesh`, like --option=--seed=1 (may be repeated)")
    parser.add_argument("--tetgen", nargs="?", const="tetgen", help="compare vertices with this program's -pq2")
    parser.add_argument("--tetgen-limit", type=float, default=120, help="seconds for each run of the comparison")
    parser.add_argument("--json", help="file for all rows")
    arguments = parser.parse_args()
    with open(os.path.join(arguments.models, "manifest.tsv")) as stream:
        entries = [e for e in csv.DictReader(stream, delimiter="\t") if e["class"] != "malformed"]
    entries = [e for e in entries if not arguments.only or any(fnmatch.fnmatch(e["file"], p) for p in arguments.only)]
    if arguments.sound:
        entries = [e for e in entries if e["closed"] == "yes" and e["self_intersecting"] == "no"]
    if not entries:
        parser.error("no model has such a name")
    if arguments.tetgen:
        print(f"rival: {package_version(arguments.tetgen)}, -pq2aA; `size`: both with a greatest volume of (diagonal / 30)^3 / 8.5")
    print(f"{'':40} {'input':>6} {'':4} {'':8} {'':9} {'outside exemptions':>22} {'':7} {'':6} {'manifest':>10} {'over -pq2':>13}")
    print(f"{'model':40} {'verts':>6} exit {'vertices':>8} {'tets':>9} {'min dih':>7} {'R/L':>6} {'exempt':>7} {'seconds':>7} {'MiB':>6} {'TetGen -pq':>10} {'plain':>6} {'size':>6}  verdict")
    models, rows = Models(arguments), []
    with ThreadPoolExecutor(arguments.jobs) as pool:
        for row in pool.map(models.row, entries):
            rows.append(row)
            print(text_of(row), flush=True)
    for lacks, what in ((models.lists_exemptions, "--exemptions: every tetrahedron is judged"), (models.repairs, "--repair: diagnosis only")):
        if not lacks:
            print(f"the program has no {what}")
    summarise(rows)
    if arguments.json:
        with open(arguments.json, "w") as out:
            json.dump(rows, out, indent=1)
    return 0 if all(r["ok"] for r in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
