#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Names and markers as meshio, a reader of its own, sees them: meshio_test.py WELLMESH. Exit status 77: meshio is not installed."""
import collections
import os
import subprocess
import sys
import tempfile

try:
    import meshio
    import numpy
except ImportError:
    print("meshio is not installed (pip install meshio): not tried")
    sys.exit(77)

# Two cubes side by side with markers on all facets, a wire inside and a marked vertex.
POLY = """14 3 0 1
1 0 0 0 0
2 1 0 0 0
3 2 0 0 4
4 0 1 0 0
5 1 1 0 0
6 2 1 0 0
7 0 0 1 0
8 1 0 1 0
9 2 0 1 0
10 0 1 1 0
11 1 1 1 0
12 2 1 1 0
13 0.4 0.5 0.5 0
14 0.6 0.5 0.5 0
12 1
1 0 1
4 1 4 10 7
1 0 2
4 3 6 12 9
1 0 3
4 1 2 8 7
1 0 3
4 2 3 9 8
1 0 3
4 4 5 11 10
1 0 3
4 5 6 12 11
1 0 3
4 1 2 5 4
1 0 3
4 2 3 6 5
1 0 3
4 7 8 11 10
1 0 3
4 8 9 12 11
1 0 9
4 2 5 11 8
1 0 8
2 13 14
0
2
1 0.2 0.2 0.2 6
2 1.8 0.2 0.2 7
"""
AREAS = {1: 1.0, 2: 1.0, 3: 8.0, 9: 1.0}
FACES = {"inlet": (1, 2), "outlet": (2, 2), "wall & floor": (3, 2), "membrane": (9, 2)}
OTHERS = {"salt water": (6, 3), "brine": (7, 3), "probe": (8, 1), "corner": (4, 0)}


def main(program):
    failures = []

    def check(what, condition):
        if not condition:
            failures.append(what)

    def run(*arguments):
        result = subprocess.run([program, *arguments], capture_output=True, text=True, check=False)
        if result.returncode != 0:
            sys.exit(f"wellmesh {' '.join(arguments)}: status {result.returncode}\n{result.stderr}")

    def measures(mesh, markers, kind):
        """Area, volume or length by marker."""
        sums = collections.defaultdict(float)
        for block, values in zip(mesh.cells, markers):
            if block.type != kind:
                continue
            p = mesh.points[block.data]
            if kind == "tetra":
                size = numpy.einsum("ij,ij->i", p[:, 3] - p[:, 0], numpy.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])) / 6
            elif kind == "triangle":
                size = numpy.linalg.norm(numpy.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1) / 2
            else:
                size = numpy.linalg.norm(p[:, 1] - p[:, 0], axis=1)
            for marker, s in zip(values, size):
                sums[int(marker)] += float(s)
        return sums

    def same(a, b):
        return all(abs(a.get(k, 0) - b.get(k, 0)) < 1e-9 for k in set(a) | set(b))

    def judge(name, mesh, boundary, faces, regions):
        check(f"{name}: areas by marker", same(measures(boundary, faces, "triangle"), AREAS))
        check(f"{name}: volumes by region", same(measures(mesh, regions, "tetra"), {6: 1.0, 7: 1.0}))

    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        with open("plain.poly", "w", encoding="utf-8") as out:
            out.write(POLY)
        run("mesh", "plain.poly", "--min-dihedral", "0", "--quiet", "-o", "plain.msh", "--msh-version", "22")

        # Names as another program gives them: meshio adds them to groups that wellmesh has named by number.
        text = open("plain.msh", encoding="utf-8").read()
        for name, (tag, dimension) in {**FACES, **OTHERS}.items():
            generated = {0: "vertex_marker_", 1: "segment_marker_", 2: "facet_marker_", 3: "region_"}[dimension] + str(tag)
            check(f"group {generated}", f'{dimension} {tag} "{generated}"' in text)
            text = text.replace(f'{dimension} {tag} "{generated}"', f'{dimension} {tag} "{name}"')
        with open("named.msh", "w", encoding="utf-8") as out:
            out.write(text)

        names = {name: list(value) for name, value in {**FACES, **OTHERS}.items()}
        for target, version in (("a22.msh", "22"), ("a41.msh", "41"), ("a.vtu", "41")):
            run("convert", "named.msh", target, "--msh-version", version, "--quiet")
            run("convert", target, "back.msh", "--msh-version", "22", "--quiet")
            back = meshio.read("back.msh")
            mesh = meshio.read(target)
            for its in (mesh, back):
                stated = {k: [int(x) for x in v] for k, v in its.field_data.items() if k != "segment_marker_0"}  # what has no marker
                check(f"{target}: names {stated}", stated == names)
            judge(target + " and back", back, back, back.cell_data["gmsh:physical"], back.cell_data["gmsh:physical"])
            if target == "a.vtu":
                boundary = meshio.read("a.boundary.vtu")
                judge(target, mesh, boundary, boundary.cell_data["marker"], mesh.cell_data["region"])
                check("a.vtu: the wire", abs(measures(boundary, boundary.cell_data["marker"], "line")[8] - 0.2) < 1e-9)
                check("a.vtu: the vertex", [tuple(mesh.points[i]) for i in numpy.flatnonzero(mesh.point_data["marker"] == 4)] == [(2.0, 0.0, 0.0)])
            else:
                physical = mesh.cell_data["gmsh:physical"]
                judge(target, mesh, mesh, physical, physical)
                check(f"{target}: the wire", abs(measures(mesh, physical, "line")[8] - 0.2) < 1e-9)

        run("convert", "named.msh", "a.mesh", "--references", "marker", "--quiet")
        mesh = meshio.read("a.mesh")
        judge("a.mesh", mesh, mesh, mesh.cell_data["medit:ref"], mesh.cell_data["medit:ref"])
        check("a.mesh: the vertex", int(mesh.point_data["medit:ref"][numpy.flatnonzero((mesh.points == [2, 0, 0]).all(axis=1))[0]]) == 4)

        run("convert", "named.msh", "a.inp", "--quiet")
        mesh = meshio.read("a.inp")
        regions = {name: sum(len(block) for block in blocks if block is not None) for name, blocks in mesh.cell_sets.items() if name in ("salt_water", "brine")}
        check(f"a.inp: element sets {sorted(mesh.cell_sets)}", len(regions) == 2 and sum(regions.values()) == sum(len(c.data) for c in mesh.cells if c.type == "tetra"))
        check(f"a.inp: node sets {sorted(mesh.point_sets)}", set(mesh.point_sets) == {"probe", "corner"})

        # What meshio writes is read: binary .msh, .vtu in its three ways.
        source = meshio.read("a41.msh")
        source.cell_sets = {}
        for target, options in (("m.msh", {"file_format": "gmsh", "binary": True}), ("n.msh", {"file_format": "gmsh22", "binary": True}), ("m.vtu", {"binary": False}),
                                ("n.vtu", {"compression": None}), ("o.vtu", {"compression": "zlib"})):
            meshio.write(target, source, **options)
            run("convert", target, "again.msh", "--msh-version", "22", "--quiet")
            again = meshio.read("again.msh")
            tets = sum(len(c.data) for c in again.cells if c.type == "tetra")
            check(f"meshio's {target}: tetrahedra", tets == sum(len(c.data) for c in source.cells if c.type == "tetra"))
            if target != "m.msh":  # of version 4.1 meshio states only the entities that have nodes of their own: groups get lost
                judge("meshio's " + target, again, again, again.cell_data["gmsh:physical"], again.cell_data["gmsh:physical"])

    for failure in failures:
        print("FAILED:", failure)
    print(f"{'FAILED' if failures else 'all well'}")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
