#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Certified mode on models and on domains made by code: one row a run, with the violations of the paper's claims and the referee's verdict.

    benchmarks/certified_mode.py --models DIR --referee JUDGE [--program build/release/bin/wellmesh] [--claims] [FILE ...]

Each model runs without a size and with a thirtieth of the diagonal (--case picks), each domain as it is and rotated. `events` are all that the
claims speak of; `D` is the largest density ratio lfs / e_v, which Theorem 5.1 bounds; `edge` the shortest edge over l_org (Theorem 4.2:
at least (1 - delta) / 4, against l_org as lowered by splits for encroaching vertices); `/good` the vertices over the almost-good mesh's
(Theorem 5.3). --claims adds the table of all claims, worst over all rows. Exit status 0 if every run ended 0, no claim was violated and every verdict was ok.
"""
import argparse
import json
import os
import sys
import tempfile

from common import DEFAULT_PROGRAM, diagonal, judge, plain_copy, points_of, run
from real_models import RIGHT_ANGLED
from synthetic_domains import Transform, domains, moved, write_poly


def worst_of(claim):
    return claim["worst"] if claim["events"] and claim["worst"] is not None else None


class Table:
    def __init__(self, arguments):
        self.arguments, self.good, self.totals = arguments, True, {}

    def row(self, name, case, model, extra, tolerance):
        with tempfile.TemporaryDirectory() as folder:
            mesh, report = os.path.join(folder, "out.mesh"), os.path.join(folder, "report.json")
            command = [self.arguments.program, "mesh", model, "-o", mesh, "--quiet", "--json", report, "--mode", "certified", *self.arguments.option, *extra]
            result = run(command, self.arguments.limit)
            start = f"{name:28} {case:7} {result.code:4d}"
            data = json.load(open(report)) if os.path.exists(report) else {}
            if not os.path.exists(mesh) or "invariants" not in data:
                print(f"{start}  no mesh after {result.seconds:.1f} s: {result.errors[-600:]}", flush=True)
                self.good = False
                return
            invariants = data["invariants"]
            claims = {claim["name"]: claim for claim in invariants["claims"]}
            verdict = judge(self.arguments.referee, mesh, plain_copy(model, folder), 0, tolerance, invariants["rho0"])
            density = max((worst_of(c) for k, c in claims.items() if k.startswith("theorem_5_1") and worst_of(c) is not None), default=0.0)
            edge, growth = worst_of(claims["theorem_4_2"]), worst_of(claims["theorem_5_3"])
            self.add(claims.values())
            shape = data["certificate"]["shape"]["all"]
            ok = result.code == 0 and verdict["ok"] and invariants["violations"] == 0
            self.good = self.good and ok
            print(f"{start} {data['vertices']:8d} {data['tets']:8d} {shape['max_radius_edge_ratio']:6.2f} {shape['min_sigma']:8.5f} {sum(c['events'] for c in claims.values()):8d} "
                  f"{invariants['violations']:6d} {density:6.2f} {edge:6.3f} {growth:6.3f} {data['statistics']['guarded_insertions']:7d} {result.seconds:8.2f}  "
                  f"{'ok' if verdict['ok'] else verdict['failures']}", flush=True)

    def add(self, claims):
        for claim in claims:
            total = self.totals.setdefault(claim["name"], {**claim, "events": 0, "violations": 0, "worst": None})
            total["events"] += claim["events"]
            total["violations"] += claim["violations"]
            worst = worst_of(claim)
            if worst is not None:
                better = min if claim["relation"] == ">=" else max
                total["worst"] = worst if total["worst"] is None else better(worst, total["worst"])

    def print_claims(self):
        print(f"\n{'claim':24} {'bound':>14} {'worst':>12} {'events':>9} {'violations':>10}")
        for name, claim in self.totals.items():
            bound = "none" if claim["bound"] is None else f"{claim['relation']} {claim['bound']:.6g}"
            worst = "-" if claim["worst"] is None else f"{claim['worst']:.6g}"
            print(f"{name:24} {bound:>14} {worst:>12} {claim['events']:9d} {claim['violations']:10d}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="*", default=RIGHT_ANGLED)
    parser.add_argument("--models", required=True)
    parser.add_argument("--referee", required=True)
    parser.add_argument("--program", default=DEFAULT_PROGRAM)
    parser.add_argument("--case", action="append", choices=["none", "size"])
    parser.add_argument("--option", action="append", default=[], help="passed on to wellmesh, e.g. --option=--sigma0=0.02")
    parser.add_argument("--claims", action="store_true")
    parser.add_argument("--limit", type=float, default=300)
    arguments = parser.parse_args()
    table = Table(arguments)
    print(f"{'model':28} {'case':7} {'exit':>4} {'vertices':>8} {'tets':>8} {'R/L':>6} {'sigma':>8} {'events':>8} {'broken':>6} {'D':>6} {'edge':>6} {'/good':>6} {'refused':>7} {'seconds':>8}  verdict")
    cases = arguments.case or ["none", "size"]
    for name in arguments.files:
        model = os.path.join(arguments.models, name)
        size = repr(diagonal(points_of(model)) / 30)
        for case in cases:
            table.row(name, case, model, ["--size", size] if case == "size" else [], 1e-7 if name.endswith(".stl") else None)
    with tempfile.TemporaryDirectory() as folder:
        for domain in domains():
            for transform in (Transform("as_is"), Transform("rotated", True)):
                here = moved(domain, transform, 1)
                model = os.path.join(folder, f"{domain.name}.poly")
                write_poly(here, model)
                for case in cases:
                    table.row(f"{domain.name} {transform.name}", case, model, ["--size", repr(diagonal(here.vertices) / 30)] if case == "size" else [], None)
    if arguments.claims:
        table.print_claims()
    return 0 if table.good else 1


if __name__ == "__main__":
    sys.exit(main())
