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


def judge(referee, mesh, plc, min_dihedral=20.0, tolerance=None, max_radius_edge=2.0, compare_with=None, exempt=None, flat_angle=None):
    """The referee's verdict, its JSON as a dictionary; `ok` and `failures` always exist. Bounds of 0 ask for nothing.

    exempt: a file whose lines begin with the numbers of tetrahedra that the two bounds leave out.
    compare_with: the wellmesh program, whose `check` must then agree with the referee claim by claim.
    """
    options = ["--plc", plc]
    for option, value in (("--max-radius-edge", max_radius_edge), ("--min-dihedral", min_dihedral), ("--tolerance", tolerance), ("--flat-angle", flat_angle)):
        if value is not None and float(value) > 0:
            options += [option, repr(float(value))]
    # compared below without exemptions: counts and measured values of all tetrahedra
    result = subprocess.run([referee, mesh, *options, *(["--exempt", exempt] if exempt else [])], capture_output=True, text=True)
    try:
        verdict = json.loads(re.sub(r":(-?)inf\b", r":\1Infinity", result.stdout))  # R/L of a flat tetrahedron, as C++ writes it
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


def surface_of(model):
    """Coordinates and polygons (vertex numbers from 0) of an .off, .obj, .stl or .ply file, read independently of the program.

    STL has no numbers: equal coordinates are one vertex there, as they are for wellmesh.
    """
    extension = os.path.splitext(model)[1].lower()
    if extension == ".stl":
        corners, numbers = list(stl_corners(model)), {}
        indices = [numbers.setdefault(p, len(numbers)) for p in corners]
        return list(numbers), [indices[i:i + 3] for i in range(0, len(indices), 3)]
    if extension == ".ply":
        return ply_surface(model)
    with open(model, errors="replace") as stream:
        text = stream.read()
    if extension == ".obj":
        lines = [line.split("#")[0].split() for line in text.replace("\\\n", " ").splitlines()]
        points, polygons = [], []
        for line in lines:
            if line and line[0] == "v":
                points.append(tuple(map(float, line[1:4])))
            elif line and line[0] == "f":
                corners = [int(word.split("/")[0]) for word in line[1:]]
                polygons.append([i - 1 if i > 0 else len(points) + i for i in corners])
        return points, polygons
    lines = [line.split("#")[0].split() for line in text.splitlines()]
    lines = [line for line in lines if line]
    # a header word, with or without the counts on its line
    counts = lines[0][1:] or lines[1]
    vertices, faces = int(counts[0]), int(counts[1])
    lines = lines[1 if lines[0][1:] else 2:]
    points = [tuple(map(float, line[:3])) for line in lines[:vertices]]
    return points, [[int(word) for word in line[1:1 + int(line[0])]] for line in lines[vertices:vertices + faces]]


PLY_TYPES = {"char": "b", "int8": "b", "uchar": "B", "uint8": "B", "short": "h", "int16": "h", "ushort": "H", "uint16": "H", "int": "i", "int32": "i",
             "uint": "I", "uint32": "I", "float": "f", "float32": "f", "double": "d", "float64": "d"}


def ply_surface(model):
    """Of a .ply file whose faces have one list, that of their vertices."""
    with open(model, "rb") as stream:
        header, body = stream.read().split(b"end_header\n", 1)
    lines = [line.split() for line in header.decode().splitlines()]
    form = next(line[1] for line in lines if line and line[0] == "format")
    elements = []
    for line in lines:
        if line and line[0] == "element":
            elements.append((line[1], int(line[2]), []))
        elif line and line[0] == "property":
            elements[-1][2].append(line[1:])
    words, place, order = iter(body.split()) if form == "ascii" else None, 0, "<" if form.endswith("little_endian") else ">"

    def value(kind):
        nonlocal place
        if words is not None:
            return float(next(words))
        code = order + PLY_TYPES[kind]
        place += struct.calcsize(code)
        return struct.unpack_from(code, body, place - struct.calcsize(code))[0]

    points, polygons = [], []
    for name, count, properties in elements:
        for _ in range(count):
            row = {p[-1]: [int(value(p[2])) for _ in range(int(value(p[1])))] if p[0] == "list" else value(p[0]) for p in properties}
            if name == "vertex":
                points.append((row["x"], row["y"], row["z"]))
            elif name == "face":
                polygons.append(next(v for v in row.values() if isinstance(v, list)))
    return points, polygons


def stl_corners(model):
    """Corners of the triangles, three each."""
    with open(model, "rb") as stream:
        data = stream.read()
    n = struct.unpack_from("<I", data, 80)[0] if len(data) >= 84 else 0
    if len(data) == 84 + 50 * n:
        for i in range(n):
            v = struct.unpack_from("<9f", data, 84 + 50 * i + 12)
            yield from (v[0:3], v[3:6], v[6:9])
        return
    words = data.split()
    for i, word in enumerate(words):
        if word == b"vertex":
            yield tuple(map(float, words[i + 1:i + 4]))


def plain_copy(model, folder):
    """The referee and rivals read plain files only: surfaces become OFF without normals, colours, continued lines; .poly and .smesh stay where they are."""
    if os.path.splitext(model)[1].lower() in (".poly", ".smesh"):
        return model
    points, polygons = surface_of(model)
    copy = os.path.join(folder, "plain.off")
    with open(copy, "w") as out:
        out.write(f"OFF\n{len(points)} {len(polygons)} 0\n")
        out.writelines(" ".join(map(repr, p)) + "\n" for p in points)
        out.writelines(f"{len(polygon)} {' '.join(map(str, polygon))}\n" for polygon in polygons)
    return copy


def points_of(model):
    """Coordinates in a surface or `.poly` file."""
    if os.path.splitext(model)[1].lower() not in (".poly", ".smesh"):
        return surface_of(model)[0]
    with open(model, errors="replace") as stream:
        lines = [line.split("#")[0].split() for line in stream]
    lines = [line for line in lines if line]
    return [tuple(map(float, line[1:4])) for line in lines[1:1 + int(lines[0][0])]]


def diagonal(points):
    """Of the bounding box."""
    low, high = [math.inf] * 3, [-math.inf] * 3
    for p in points:
        for k in range(3):
            low[k], high[k] = min(low[k], p[k]), max(high[k], p[k])
    return math.dist(low, high)
