#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""tetgen_wheel.py SURFACE.off SWITCHES OUT.mesh: the `tetgen` wheel (TetGen 1.6) on a triangulated surface; prints one JSON object.

Counted: TetGen's own "Total running seconds" less its "Output seconds", as for the program; reading and copying to and from NumPy are not in them.
"""
import json
import os
import sys
import tempfile

import numpy
import tetgen

from meshes import number_in, read_off, write_medit


def main():
    surface, switches, out = sys.argv[1:]
    vertices, polygons = read_off(surface)
    triangles = [(p[0], p[i], p[i + 1]) for p in polygons for i in range(1, len(p) - 1)]
    mesher = tetgen.TetGen(numpy.array(vertices, dtype=float), numpy.array(triangles, dtype=numpy.int32))
    with tempfile.TemporaryFile() as log:
        # TetGen prints from C, past sys.stdout
        sys.stdout.flush()
        console = os.dup(1)
        os.dup2(log.fileno(), 1)
        try:
            points, tets = mesher.tetrahedralize(switches=switches)[:2]
        finally:
            os.dup2(console, 1)
        log.seek(0)
        text = log.read().decode(errors="replace")
    total, output = (number_in(text, name) for name in ("Total running seconds:", "Output seconds:"))
    if total is None:
        sys.exit("TetGen printed no times:\n" + text[-500:])
    print(json.dumps({"version": f"TetGen 1.6 (wheel {tetgen.__version__})", "seconds": total - (output or 0), "tets": len(tets), "vertices": len(points)}))
    write_medit(out, points, tets)


if __name__ == "__main__":
    main()
