#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Instructions of fixed workloads, counted by callgrind, beside the numbers of instructions.json. Times vary with load, these don't.

    benchmarks/instructions.py [--program build/dev/bin/wellmesh] [--update] [--tolerance 5]

Exit status 1 if a count is above the committed one by more than the tolerance, or a workload can't be run; 0 otherwise, also where valgrind isn't there, the program
was made by another compiler than the file's, or this processor lacks the vectors that the file's had: then nothing can be compared, and that is said.
"""
import argparse
import concurrent.futures
import json
import math
import os
import random
import re
import shutil
import sys
import tempfile

from common import HERE, run

TABLE = os.path.join(HERE, "instructions.json")
CUBE = """8 3 0 0
1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n7 1 1 1\n8 0 1 1
6 0
1 0\n4 1 2 3 4\n1 0\n4 5 6 7 8\n1 0\n4 1 2 6 5\n1 0\n4 2 3 7 6\n1 0\n4 3 4 8 7\n1 0\n4 4 1 5 8
0
0
"""
# Edges for about 20000 tetrahedra of the unit cube.
SIZE = (1 / 20000 / 0.112) ** (1 / 3)
# What is counted: from the call of a function to its return. Names as the linker has them, with any arguments.
WORKLOADS = {
    "bulk Delaunay, 20k points": (["delaunay", "points.node"], "wellmesh::triangulate_points(*"),
    "seeding, cube 20k tets": (["mesh", "cube.poly", "--size", repr(SIZE), "--min-dihedral", "20"], "wellmesh::LatticeSeeder::seed(*"),
    "refinement, cube 20k tets": (["mesh", "cube.poly", "--size", repr(SIZE), "--min-dihedral", "0", "--seeding", "off"], "wellmesh::Refiner::refine(*"),
    "shape to 30 degrees, cube 20k tets": (["mesh", "cube.poly", "--size", repr(SIZE), "--min-dihedral", "30"], "wellmesh::remove_slivers(*"),
    "certificate, cube 20k tets": (["mesh", "cube.poly", "--size", repr(SIZE), "--min-dihedral", "20"], "wellmesh::certify(*"),
}


def compiler_of(program):
    """What GCC and Clang leave in the file of a program."""
    with open(program, "rb") as stream:
        found = sorted(set(re.findall(rb"GCC: \([^)]*\) [0-9.]+|clang version [0-9.]+", stream.read())))
    return ", ".join(name.decode() for name in found) or "unknown"


def vectors():
    """The program takes other paths on processors without these."""
    try:
        with open("/proc/cpuinfo") as stream:
            found = re.search(r"^flags\s*:(.*)$", stream.read(), re.MULTILINE)
            words = found[1].split() if found else []
            return "+".join(word for word in ("avx2", "fma") if word in words) or "none"
    except OSError:
        return "unknown"


def write_inputs(folder):
    generator = random.Random(1)
    with open(os.path.join(folder, "points.node"), "w") as out:
        out.write("20000 3 0 0\n")
        for i in range(1, 20001):
            out.write(f"{i} {generator.random()!r} {generator.random()!r} {generator.random()!r}\n")
    with open(os.path.join(folder, "cube.poly"), "w") as out:
        out.write(CUBE)


def count(program, arguments, function, folder):
    """Instructions in millions, and why there are none."""
    words = [os.path.join(folder, a) if a.endswith((".node", ".poly")) else a for a in arguments]
    if words[0] == "mesh":
        words += ["-o", os.path.join(folder, re.sub(r"\W", "", function) + ".mesh"), "--quiet"]
    # What is switched on at a call is counted in the calling thread only: with more of them the count would depend on the machine's cores.
    words += ["--threads", "1"]
    result = run(["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", f"--toggle-collect={function}", program, *words], 300)
    found = re.search(r"Collected : ([0-9]+)", result.errors)
    if result.code != 0 or not found:
        return None, f"exit {result.code}: {(result.errors or result.output)[-200:]}"
    if int(found[1]) == 0:
        return None, f"{function} was never called: has it another name now?"
    return int(found[1]) / 1e6, None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=os.path.join(os.path.dirname(HERE), "build", "dev", "bin", "wellmesh"))
    parser.add_argument("--table", default=TABLE, help="the committed numbers")
    parser.add_argument("--tolerance", type=float, default=5, help="per cent")
    parser.add_argument("--update", action="store_true", help="write the numbers instead of comparing them")
    arguments = parser.parse_args()
    if not math.isfinite(arguments.tolerance) or not 0 < arguments.tolerance <= 100:
        parser.error("--tolerance is above 0 and at most 100")
    if not os.path.exists(arguments.program):
        parser.error(f"no program {arguments.program}: build the preset dev, or name one by --program")
    if not shutil.which("valgrind"):
        print("instructions.py: SKIPPED: there is no valgrind (Debian: apt install valgrind)")
        return 0
    compiler, table = f"{compiler_of(arguments.program)}, vectors: {vectors()}", {"compiler": None, "millions": {}}
    if os.path.exists(arguments.table):
        with open(arguments.table) as stream:
            table = json.load(stream)
    comparable = compiler == table["compiler"]
    print(f"instructions in millions; {compiler}" + ("" if comparable or arguments.update else f"; the committed ones are of {table['compiler']}: reported, not judged"))
    counts, bad = {}, False
    with tempfile.TemporaryDirectory() as folder:
        write_inputs(folder)
        # Counts don't depend on what else runs.
        pool = concurrent.futures.ThreadPoolExecutor(os.cpu_count())
        found = pool.map(lambda workload: count(arguments.program, *workload, folder), WORKLOADS.values())
        for name, (counts[name], why) in zip(WORKLOADS, found):
            if counts[name] is None:
                print(f"  {name:36} FAILED: {why}")
                bad = True
                continue
            before = table["millions"].get(name)
            change = 100 * (counts[name] / before - 1) if before else None
            verdict = ""
            if change is None:
                verdict = "new"
            elif change > arguments.tolerance:
                verdict = "MORE than committed"
                bad = bad or (comparable and not arguments.update)
            elif change < -arguments.tolerance:
                verdict = "less: write it down with --update"
            print(f"  {name:36} {counts[name]:10.1f} " + (f"{before:10.1f} {change:+6.1f} % " if before else " " * 20) + verdict, flush=True)
    if arguments.update and not bad:
        with open(arguments.table + ".tmp", "w") as out:
            json.dump({"compiler": compiler, "millions": {name: round(value, 1) for name, value in counts.items()}}, out, indent=1)
            out.write("\n")
        os.replace(arguments.table + ".tmp", arguments.table)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
