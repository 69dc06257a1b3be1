# SPDX-License-Identifier: Apache-2.0
"""What the benchmark scripts share: running a program under a limit, the referee, rivals' versions, reading coordinates."""
import json
import math
import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import threading
import time
from dataclasses import dataclass

HERE = os.path.dirname(os.path.abspath(__file__))
DEFAULT_PROGRAM = os.path.normpath(os.path.join(HERE, "..", "build", "release", "bin", "wellmesh"))


@dataclass
class Run:
    command: list
    code: int             # exit status; the negative number of a signal that ended it
    seconds: float        # by the clock on the wall
    cpu_seconds: float    # user and system time
    memory: int           # peak resident bytes, by the kernel's count
    output: str
    errors: str


def run(command, limit=3600.0):
    """Runs one process to its end, or for `limit` seconds.

    The kernel's peak counts what the child shared with this interpreter before it became the program: keep large data out of this process.
    """
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        start = time.monotonic()
        child = subprocess.Popen(command, stdout=out, stderr=err)
        alarm = threading.Timer(limit, child.kill)
        alarm.start()
        try:
            _, status, usage = os.wait4(child.pid, 0)
        except BaseException:
            child.kill()
            raise
        finally:
            alarm.cancel()
        seconds = time.monotonic() - start
        child.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        err.seek(0)
        return Run(command, child.returncode, seconds, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024,
                   out.read().decode(errors="replace"), err.read().decode(errors="replace").strip())


def judge(referee, mesh, plc, min_dihedral=20.0, tolerance=None, max_radius_edge=2.0, compare_with=None):
    """The referee's verdict, its JSON as a dictionary; `ok` and `failures` always exist.

    compare_with: the wellmesh program, whose `check` must then agree with the referee claim by claim.
    """
    options = ["--plc", plc, "--max-radius-edge", f"{max_radius_edge:g}", "--min-dihedral", f"{float(min_dihedral):g}"]
    if tolerance is not None:
        options += ["--tolerance", f"{tolerance:g}"]
    result = subprocess.run([referee, mesh, *options], capture_output=True, text=True)
    try:
        verdict = json.loads(result.stdout)
    except ValueError:
        return {"ok": False, "failures": [f"referee ended {result.returncode}: {result.stderr.strip()[-300:]}"]}
    verdict.setdefault("failures", [])
    verdict["ok"] = bool(verdict.get("ok")) and result.returncode == 0
    if compare_with is not None:
        tool = os.path.normpath(os.path.join(HERE, "..", "tools", "compare_with_referee.py"))
        compared = subprocess.run([sys.executable, tool, compare_with, referee, mesh, *options], capture_output=True, text=True)
        if compared.returncode != 0:
            verdict["ok"] = False
            verdict["failures"].append(f"wellmesh check and the referee differ: {(compared.stdout + compared.stderr).strip()[-300:]}")
    return verdict


def number_in(text, pattern):
    """The number that follows what `pattern` matches in a program's output, None if it isn't there."""
    found = re.search(pattern + r"\s*([-+0-9.eE]+)", text)
    return float(found.group(1)) if found else None


def package_version(name):
    """Of an installed Debian package; programs from elsewhere are named by their path."""
    if shutil.which("dpkg-query"):
        result = subprocess.run(["dpkg-query", "-W", "-f", "${Package} ${Version}", name], capture_output=True, text=True)
        if result.returncode == 0:
            return result.stdout.strip()
    return f"{shutil.which(name)}, version unknown"


def tetgen(program, switches, model, limit=3600.0):
    """Runs TetGen on `model` in place (it writes beside its input); the run and its counts, None where the output doesn't tell them."""
    result = run([program, switches, model], limit)
    good = result.code == 0
    points, tets = (number_in(result.output, name) if good else None for name in ("Mesh points:", "Mesh tetrahedra:"))
    return result, points and int(points), tets and int(tets)


def points_of(model):
    """Coordinates in a surface or `.poly` file, read independently of the program."""
    extension = os.path.splitext(model)[1].lower()
    if extension == ".stl":
        with open(model, "rb") as stream:
            data = stream.read()
        n = struct.unpack_from("<I", data, 80)[0] if len(data) >= 84 else 0
        if len(data) == 84 + 50 * n:
            for i in range(n):
                v = struct.unpack_from("<9f", data, 84 + 50 * i + 12)
                yield from (v[0:3], v[3:6], v[6:9])
        else:
            words = data.split()
            for i, word in enumerate(words):
                if word == b"vertex":
                    yield tuple(map(float, words[i + 1:i + 4]))
        return
    with open(model, errors="replace") as stream:
        lines = [line.split("#")[0].split() for line in stream]
    lines = [line for line in lines if line]
    if extension == ".off":
        count = int(lines[1][0])
        yield from (tuple(map(float, line[:3])) for line in lines[2:2 + count])
    elif extension in (".poly", ".smesh"):
        count = int(lines[0][0])
        yield from (tuple(map(float, line[1:4])) for line in lines[1:1 + count])
    elif extension == ".obj":
        yield from (tuple(map(float, line[1:4])) for line in lines if line[0] == "v")


def diagonal(points):
    """Of the bounding box."""
    low, high = [math.inf] * 3, [-math.inf] * 3
    for p in points:
        for k in range(3):
            low[k], high[k] = min(low[k], p[k]), max(high[k], p[k])
    return math.dist(low, high)
