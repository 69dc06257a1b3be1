#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""netgen_wheel.py SURFACE.off SIZE OUT.mesh: the `netgen-mesher` wheel on a triangulated surface; prints one JSON object.

Counted: GenerateMesh(), from edges to volume and its optimisation, on one thread; reading is not, nor is writing. Netgen takes STL: the surface is written as such first.
"""
import json
import os
import sys
import tempfile
import time

from meshes import read_off, write_medit, write_stl


def main():
    surface, size, out = sys.argv[1], float(sys.argv[2]), sys.argv[3]
    import netgen
    from netgen.meshing import SetMessageImportance
    from netgen.stl import STLGeometry
    SetMessageImportance(0)
    with tempfile.TemporaryDirectory() as folder:
        stl = os.path.join(folder, "surface.stl")
        write_stl(stl, *read_off(surface))
        geometry = STLGeometry(stl)
        start = time.monotonic()
        mesh = geometry.GenerateMesh(maxh=size)
        seconds = time.monotonic() - start
    tets = mesh.Elements3D().NumPy()["nodes"][:, :4] - 1
    tets = tets[:, [0, 2, 1, 3]]  # Netgen's tetrahedra are negative by the sign that is used here
    print(json.dumps({"version": f"Netgen {netgen.__version__}", "seconds": seconds, "tets": len(tets), "vertices": len(mesh.Coordinates())}))
    write_medit(out, mesh.Coordinates(), tets)


if __name__ == "__main__":
    main()
