#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes deliberately damaged copies of a MEDIT mesh, to see whether a checker notices.

    tools/damage_mesh.py MESH FOLDER [--seed N]

One file for each way of damaging, named after it. Deterministic for equal input and seed.
"""
import argparse
import copy
import random
from pathlib import Path

SECTIONS = ("Vertices", "Edges", "Triangles", "Tetrahedra")


def read(path):
    words = " ".join(line.split("#")[0] for line in Path(path).read_text().splitlines()).split()
    width = {"Vertices": 4, "Edges": 3, "Triangles": 4, "Tetrahedra": 5}
    mesh, i = {name: [] for name in SECTIONS}, 0
    while i < len(words):
        name = words[i]
        if name in width:
            count, start = int(words[i + 1]), i + 2
            rows = [words[start + width[name] * k: start + width[name] * (k + 1)] for k in range(count)]
            convert = (lambda row: [*map(float, row[:3]), int(row[3])]) if name == "Vertices" else (lambda row: [*map(int, row)])
            mesh[name] = [convert(row) for row in rows]
            i = start + width[name] * count
        elif name in ("MeshVersionFormatted", "Dimension"):
            i += 2
        elif name == "End":
            break
        else:  # Corners and the like: a count and that many numbers
            i += 2 + int(words[i + 1])
    return mesh


def write(mesh, path):
    with open(path, "w") as out:
        out.write("MeshVersionFormatted 2\nDimension 3\n")
        for name in SECTIONS:
            out.write(f"{name}\n{len(mesh[name])}\n")
            out.writelines(" ".join(repr(word) for word in row) + "\n" for row in mesh[name])
        out.write("End\n")


class Damage:
    """Every method that starts with `way_` changes the mesh in one way."""

    def __init__(self, mesh, rng):
        self.mesh, self.rng = mesh, rng
        self.vertices, self.edges, self.triangles, self.tets = (mesh[name] for name in SECTIONS)
        count = {}
        for tet in self.tets:
            for k in range(4):
                face = tuple(sorted(tet[:k] + tet[k + 1: 4]))
                count[face] = count.get(face, 0) + 1
        self.hull = sorted(face for face, n in count.items() if n == 1)
        on_constraint = {v for face in self.hull for v in face} | {v for t in self.triangles for v in t[:3]}
        used = sorted({v for tet in self.tets for v in tet[:4]})
        self.inner = [v for v in used if v not in on_constraint] or used
        self.at_hull = sorted({v for face in self.hull for v in face})
        self.size = max(max(v[k] for v in self.vertices) - min(v[k] for v in self.vertices) for k in range(3))

    def centroid(self, numbers):
        return [sum(self.vertices[v - 1][k] for v in numbers) / len(numbers) for k in range(3)]

    def edge_length(self, tet):
        a, b = self.vertices[tet[0] - 1], self.vertices[tet[1] - 1]
        return sum((a[k] - b[k]) ** 2 for k in range(3)) ** 0.5

    def pick_tet(self):
        return self.rng.choice(self.tets)

    def move(self, vertex, distance):
        for k in range(3):
            self.vertices[vertex - 1][k] += distance * self.rng.uniform(-1, 1)

    def way_inner_vertex_moved_a_little(self):
        self.move(self.rng.choice(self.inner), 0.3 * self.edge_length(self.pick_tet()))

    def way_inner_vertex_moved_far(self):
        self.move(self.rng.choice(self.inner), 3 * self.size)

    def way_hull_vertex_moved_off(self):
        self.move(self.rng.choice(self.at_hull), 0.05 * self.edge_length(self.pick_tet()))

    def way_hull_vertex_moved_by_1e_12(self):
        self.move(self.rng.choice(self.at_hull), 1e-12 * self.size)

    def way_hull_vertex_moved_by_1e_7(self):
        self.move(self.rng.choice(self.at_hull), 1e-7 * self.size)

    def way_vertex_put_on_another(self):
        a, b = self.rng.sample(self.inner if len(self.inner) > 1 else self.at_hull, 2)
        self.vertices[a - 1][:3] = self.vertices[b - 1][:3]

    def way_vertex_unused(self):
        self.vertices.append([*self.centroid(self.pick_tet()[:4]), 0])

    def way_vertex_outside(self):
        self.vertices.append([*(c + 10 * self.size for c in self.centroid(self.pick_tet()[:4])), 0])

    def way_vertex_not_a_number(self):
        self.vertices[self.rng.randrange(len(self.vertices))][0] = float("nan")

    def way_tet_inverted(self):
        tet = self.pick_tet()
        tet[0], tet[1] = tet[1], tet[0]

    def way_all_tets_inverted(self):
        for tet in self.tets:
            tet[0], tet[1] = tet[1], tet[0]

    def way_tet_dropped(self):
        self.tets.remove(self.pick_tet())

    def way_ten_tets_dropped(self):
        for _ in range(min(10, len(self.tets) - 1)):
            self.tets.remove(self.pick_tet())

    def way_tet_twice(self):
        self.tets.append(list(self.pick_tet()))

    def way_tet_twice_permuted(self):
        a, b, c, d, region = self.pick_tet()
        self.tets.append([b, c, a, d, region])

    def way_tet_with_another_vertex(self):
        tet = self.pick_tet()
        tet[self.rng.randrange(4)] = self.rng.choice([v for v in self.inner + self.at_hull if v not in tet[:4]])

    def way_tet_with_a_vertex_twice(self):
        tet = self.pick_tet()
        tet[2] = tet[1]

    def way_tet_out_of_range(self):
        self.pick_tet()[3] = len(self.vertices) + 5

    def way_tet_split_flat(self):
        """A vertex on a hull face makes a flat tetrahedron there."""
        face = self.rng.choice(self.hull)
        self.vertices.append([*self.centroid(face), 0])
        self.tets.append([*face, len(self.vertices), self.tets[0][4]])

    def way_tet_split_at_centroid(self):
        tet = self.pick_tet()
        self.tets.remove(tet)
        self.vertices.append([*self.centroid(tet[:4]), 0])
        for k in range(4):
            part = list(tet)
            part[k] = len(self.vertices)
            self.tets.append(part)

    def way_hull_face_split(self):
        """A vertex in a hull face, close to an edge: conforming, but not Delaunay."""
        face = self.rng.choice(self.hull)
        tet = next(t for t in self.tets if set(face) <= set(t[:4]))
        self.tets.remove(tet)
        a, b, c = (self.vertices[v - 1] for v in face)
        self.vertices.append([*(0.45 * a[k] + 0.45 * b[k] + 0.1 * c[k] for k in range(3)), 0])
        for v in face:
            part = list(tet)
            part[part.index(v)] = len(self.vertices)
            self.tets.append(part)
        listed = [t for t in self.triangles if set(t[:3]) == set(face)]
        for old in listed:
            self.triangles.remove(old)
            for v in face:
                part = list(old)
                part[part.index(v)] = len(self.vertices)
                self.triangles.append(part)

    def way_two_vertices_swapped(self):
        a, b = self.rng.sample(self.inner if len(self.inner) > 1 else self.at_hull, 2)
        self.vertices[a - 1], self.vertices[b - 1] = self.vertices[b - 1], self.vertices[a - 1]

    def way_region_of_a_tet(self):
        self.pick_tet()[4] += 17

    def way_region_of_all_one(self):
        for tet in self.tets:
            tet[4] = 1

    def way_triangle_dropped(self):
        if self.triangles:
            self.triangles.remove(self.rng.choice(self.triangles))

    def way_triangle_inside(self):
        tet = self.pick_tet()
        self.triangles.append([*tet[:3], 1])

    def way_triangle_missing(self):
        self.triangles.append([*sorted(self.rng.sample(range(1, len(self.vertices) + 1), 3)), 1])

    def way_triangle_twice(self):
        self.triangles.append(list(self.rng.choice(self.triangles)) if self.triangles else [*self.hull[0], 1])

    def way_triangle_degenerate(self):
        a, b = self.rng.choice(self.hull)[:2]
        self.triangles.append([a, a, b, 1])

    def way_edge_inside(self):
        tet = self.pick_tet()
        self.edges.append([tet[0], tet[3], 1])

    def way_edge_missing(self):
        self.edges.append([*sorted(self.rng.sample(range(1, len(self.vertices) + 1), 2)), 1])

    def way_edge_degenerate(self):
        vertex = self.pick_tet()[0]
        self.edges.append([vertex, vertex, 1])

    def way_copy_shifted_over_itself(self):
        n, shift = len(self.vertices), 0.37 * self.size
        self.vertices += [[x + shift, y + shift / 3, z, r] for x, y, z, r in self.vertices]
        self.tets += [[*(v + n for v in tet[:4]), tet[4]] for tet in self.tets]

    def way_copy_in_place(self):
        n = len(self.vertices)
        self.vertices += [list(v) for v in self.vertices]
        self.tets += [[*(v + n for v in tet[:4]), tet[4]] for tet in self.tets]

    def way_squashed(self):
        for v in self.vertices:
            v[2] *= 1e-9


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("mesh")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    original = read(arguments.mesh)
    arguments.folder.mkdir(parents=True, exist_ok=True)
    ways = [name for name in vars(Damage) if name.startswith("way_")]
    for name in ways:
        damaged = Damage(copy.deepcopy(original), random.Random(f"{arguments.seed} {name}"))
        getattr(damaged, name)()
        write(damaged.mesh, arguments.folder / f"{name[4:]}.mesh")
    print(f"{len(ways)} damaged meshes in {arguments.folder}")


if __name__ == "__main__":
    main()
