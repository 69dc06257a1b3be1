# SPDX-License-Identifier: Apache-2.0
"""What the drivers read and write, apart from what they count."""
import re


def number_in(text, pattern):
    found = re.search(pattern + r"\s*([-+0-9.eE]+)", text)
    return float(found.group(1)) if found else None


def read_off(path):
    """Vertices and polygons of a plain OFF file."""
    with open(path) as stream:
        lines = [line for line in (line.split("#")[0].split() for line in stream) if line]
    vertices, faces = int(lines[1][0]), int(lines[1][1])
    return [tuple(map(float, line[:3])) for line in lines[2:2 + vertices]], [tuple(map(int, line[1:1 + int(line[0])])) for line in lines[2 + vertices:2 + vertices + faces]]


def write_stl(path, vertices, polygons):
    with open(path, "w") as out:
        out.write("solid surface\n")
        for p in polygons:
            for i in range(1, len(p) - 1):
                a, b, c = (vertices[k] for k in (p[0], p[i], p[i + 1]))
                u, v = [b[k] - a[k] for k in range(3)], [c[k] - a[k] for k in range(3)]
                n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
                length = sum(x * x for x in n) ** 0.5 or 1.0
                out.write(f" facet normal {n[0] / length!r} {n[1] / length!r} {n[2] / length!r}\n  outer loop\n")
                out.writelines(f"   vertex {q[0]!r} {q[1]!r} {q[2]!r}\n" for q in (a, b, c))
                out.write("  endloop\n endfacet\n")
        out.write("endsolid surface\n")


def write_medit(path, points, tets):
    with open(path, "w") as out:
        out.write(f"MeshVersionFormatted 2\nDimension 3\nVertices\n{len(points)}\n")
        out.writelines(f"{x!r} {y!r} {z!r} 0\n" for x, y, z in map(lambda p: p.tolist() if hasattr(p, 'tolist') else p, points))
        out.write(f"Tetrahedra\n{len(tets)}\n")
        out.writelines(f"{t[0]} {t[1]} {t[2]} {t[3]} 1\n" for t in (tets + 1).tolist())
        out.write("End\n")
