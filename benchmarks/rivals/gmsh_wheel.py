#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Gmsh from the `gmsh` wheel; prints one JSON object.

    gmsh_wheel.py mesh SURFACE.off SIZE THREADS OUT.mesh     -algo hxt; counted: meshing from edges to volume, with its optimisation
    gmsh_wheel.py delaunay POINTS.node THREADS               gmsh.algorithm.tetrahedralize(): Gmsh's own kernel, which is not HXT's; by its log

The surface is taken in as Gmsh's tutorial t13 does: STL, surfaces told apart at edges of more than 40 degrees, re-parametrised. That, reading and writing are not counted.
"""
import json
import math
import os
import re
import sys
import tempfile
import time

import gmsh

from meshes import read_off, write_stl


def mesh(surface, size, threads, out):
    with tempfile.TemporaryDirectory() as folder:
        stl = os.path.join(folder, "surface.stl")
        write_stl(stl, *read_off(surface))
        gmsh.merge(stl)
    gmsh.model.mesh.classifySurfaces(40 * math.pi / 180, True, True, math.pi)
    gmsh.model.mesh.createGeometry()
    loop = gmsh.model.geo.addSurfaceLoop([tag for _, tag in gmsh.model.getEntities(2)])
    gmsh.model.geo.addVolume([loop])
    gmsh.model.geo.synchronize()
    for name, value in (("Mesh.MeshSizeMin", size), ("Mesh.MeshSizeMax", size), ("Mesh.MeshSizeFromPoints", 0), ("Mesh.MeshSizeExtendFromBoundary", 0),
                        ("Mesh.Algorithm3D", 10), ("General.NumThreads", threads)):
        gmsh.option.setNumber(name, value)
    start = time.monotonic()
    gmsh.model.mesh.generate(3)
    seconds = time.monotonic() - start
    tets = sum(len(tags) for tags in gmsh.model.mesh.getElements(3)[1])
    gmsh.write(out)
    return seconds, tets


def delaunay(points, threads):
    with open(points) as stream:
        next(stream)
        coordinates = [float(x) for line in stream for x in line.split()[1:]]
    gmsh.option.setNumber("General.NumThreads", threads)
    gmsh.logger.start()
    tets = len(gmsh.algorithm.tetrahedralize(coordinates)[0]) // 4
    found = re.search(r"Done tetrahedrizing.*Wall ([0-9.eE+-]+)s", "\n".join(gmsh.logger.get()))
    if not found:
        sys.exit("Gmsh logged no time")
    return float(found.group(1)), tets


def main():
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    what, *arguments = sys.argv[1:]
    if what == "mesh":
        seconds, tets = mesh(arguments[0], float(arguments[1]), int(arguments[2]), arguments[3])
    else:
        seconds, tets = delaunay(arguments[0], int(arguments[1]))
    print(json.dumps({"version": f"Gmsh {gmsh.__version__}", "seconds": seconds, "tets": tets}))
    gmsh.finalize()


if __name__ == "__main__":
    main()
