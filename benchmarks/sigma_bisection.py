#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How far the paper's two ways with slivers reach: the largest threshold for which each ends with the goal met, by bisection.

    benchmarks/sigma_bisection.py [--program build/release/bin/wellmesh] [--tets 20000] [--criterion sigma0|angle]

Five synthetic domains; `--slivers refine` (the paper's sections 3 and 4) and `--slivers improve` (its section 6). A run reaches sigma0 (or the angle)
if it ends with status 0; it fails with status 1, when it has grown to its bound or nothing improves any more. Whether a run succeeds is not
quite monotone in the threshold; the table's value is one that was reached, beside one that was not. Exit status 1 if a run ends
otherwise, or a mesh of no slivers at all (threshold 0) can't be had.
"""
import argparse
import json
import os
import sys
import tempfile

from common import DEFAULT_PROGRAM, run
from synthetic_domains import TRANSFORMS, VOLUME_OVER_CUBED_SIZE, domains, moved, write_poly

# Criterion -> (flag, largest value tried, width at which bisection ends)
CRITERIA = {"sigma0": ("--sigma0", 0.2, 0.001), "angle": ("--min-dihedral", 60.0, 0.25)}


class Unexpected(Exception):
    pass


def mesh(arguments, folder, model, options):
    """(goals met, report) of one run."""
    report = os.path.join(folder, "report.json")
    result = run([arguments.program, "mesh", model, "-o", os.path.join(folder, "out.mesh"), "--quiet", "--json", report, *options], arguments.limit)
    if result.code not in (0, 1):
        raise Unexpected(f"exit {result.code}: {' '.join(result.command)}: {result.errors[-300:]}")
    with open(report) as stream:
        return result.code == 0, json.load(stream), result


def bisect(arguments, folder, model, common, strategy):
    flag, high, width = CRITERIA[arguments.criterion]

    def attempt(value):
        return mesh(arguments, folder, model, [*common, "--slivers", strategy, flag, repr(value)])

    low, best = 0.0, None
    while high - low > width:
        middle = round((low + high) / 2, 6)
        met, report, result = attempt(middle)
        if met:
            low, best = middle, (report, result)
        else:
            high = middle
    return low, high, best


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=DEFAULT_PROGRAM)
    parser.add_argument("--criterion", choices=sorted(CRITERIA), default="sigma0")
    parser.add_argument("--strategy", action="append", choices=["refine", "improve"], help="only this one (may be repeated)")
    parser.add_argument("--domain", action="append", help="only this one (may be repeated)")
    parser.add_argument("--transform", default="as_is", choices=[t.name for t in TRANSFORMS])
    parser.add_argument("--tets", type=int, default=20000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--limit", type=float, default=300, help="seconds for a run")
    parser.add_argument("options", nargs="*", help="passed on to every run, after --")
    arguments = parser.parse_args()
    transform = next(t for t in TRANSFORMS if t.name == arguments.transform)
    print(f"{'domain':12} {'strategy':8} {'reached':>8} {'failed':>8} {'vertices':>8} {'ratio':>6} {'min dih':>7} {'sigma':>7} {'R/r':>6} {'seconds':>7}")
    failed = False
    with tempfile.TemporaryDirectory() as folder:
        for domain in (d for d in domains() if not arguments.domain or d.name in arguments.domain):
            here = moved(domain, transform, 1)
            model = os.path.join(folder, "model.poly")
            write_poly(here, model)
            size = (sum(here.volumes.values()) / arguments.tets / VOLUME_OVER_CUBED_SIZE) ** (1 / 3)
            common = ["--size", repr(size), "--seed", str(arguments.seed), *arguments.options]
            try:
                plain = mesh(arguments, folder, model, ["--size", repr(size), "--seed", str(arguments.seed), "--slivers", "none"])[1]
                print(f"{domain.name:12} {'none':8} {'':8} {'':8} {cells(plain, plain)}", flush=True)
                for strategy in arguments.strategy or ["refine", "improve"]:
                    low, high, best = bisect(arguments, folder, model, common, strategy)
                    start = f"{domain.name:12} {strategy:8} {low:8.4f} {high:8.4f}"
                    print(f"{start} {cells(best[0], plain)} {best[1].cpu_seconds:7.2f}" if best else f"{start} nothing was reached", flush=True)
                    failed |= best is None
            except Unexpected as problem:
                failed = True
                print(f"{domain.name:12} {problem}", flush=True)
    return 1 if failed else 0


def cells(report, plain):
    shape = report["certificate"]["shape"]["all"]
    return (f"{report['vertices']:8d} {report['vertices'] / plain['vertices']:6.3f} {shape['min_dihedral_angle_deg']:7.2f} {shape['min_sigma']:7.4f} "
            f"{shape['max_aspect_ratio']:6.1f}")


if __name__ == "__main__":
    sys.exit(main())
