# SPDX-License-Identifier: Apache-2.0
"""Valid inputs with gaps far narrower than any mesh can fill, made by code: features that come near each other without a point in common.

Each is a unit cube with something in it. Filling a gap of width w and area A takes about A / w^2 vertices, so what is asked is an end: a conforming
mesh that says which gaps it left.
"""
import math
from itertools import product

from acute_inputs import Builder, radians


def cube():
    builder = Builder()
    return builder, builder.box()


def square(b, centre, side, turn=0.0, tilt=0.0):
    """A square, turned about z and then tilted about the x-axis through its centre: its corners' numbers."""
    corners = []
    for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
        u, v = x * side / 2, y * side / 2
        u, v = u * math.cos(turn) - v * math.sin(turn), u * math.sin(turn) + v * math.cos(turn)
        corners.append(b.vertex(centre[0] + u, centre[1] + v * math.cos(tilt), centre[2] + v * math.sin(tilt)))
    return corners


def over_wall(width, tilt=0.0):
    """A square over the cube's floor: its lowest point is `width` above it."""
    b, volume = cube()
    (angle,) = radians(tilt)
    b.facet(square(b, (0.5, 0.5, width + 0.2 * math.sin(angle)), 0.4, 0.0, angle))
    return b.acute("gap", f"over_wall_{width:g}" + (f"_tilt_{tilt:g}" if tilt else ""), volume)


def plates(width, tilt=0.0):
    """Two squares turned against each other, one over the other."""
    b, volume = cube()
    angle, turn = radians(tilt, 30)
    b.facet(square(b, (0.5, 0.5, 0.5), 0.4))
    b.facet(square(b, (0.52, 0.49, 0.5 + width + 0.25 * math.sin(angle)), 0.35, turn, angle))
    return b.acute("gap", f"plates_{width:g}" + (f"_tilt_{tilt:g}" if tilt else ""), volume)


def ribbon(width):
    """A long square of height `width` whose plane is across the gap: two long edges near each other."""
    b, volume = cube()
    b.facet([b.vertex(*p) for p in ((0.2, 0.5, 0.5), (0.8, 0.5, 0.5), (0.8, 0.5, 0.5 + width), (0.2, 0.5, 0.5 + width))])
    return b.acute("gap", f"ribbon_{width:g}", volume)


def flat_box(width, hollow=False):
    """A box as flat as a sheet of paper, meshed inside, or a slit of that form."""
    b, volume = cube()
    inside = b.box((0.3, 0.3, 0.5), (0.7, 0.7, 0.5 + width))
    acute = b.acute("gap", f"{'slit' if hollow else 'flat_box'}_{width:g}", volume - inside if hollow else volume)
    if hollow:
        acute.domain.holes.append((0.5, 0.5, 0.5 + width / 2))
    return acute


def layer(width):
    """A layer over the whole cube's floor."""
    b = Builder()
    volume = b.box((0, 0, 0), (1, 1, width))
    low = [i for i, p in enumerate(b.vertices) if p[2] > 0]
    high = [b.vertex(x, y, 1) for x, y in product((0, 1), repeat=2)]
    for polygon in ((0, 1, 3, 2),):
        b.facet([high[i] for i in polygon])
    for i, j in ((0, 1), (1, 3), (3, 2), (2, 0)):
        b.facet([low[i], low[j], high[j], high[i]])
    return b.acute("gap", f"layer_{width:g}", volume + 1 - width)


def tip(width):
    """The tip of a needle over the middle of the floor."""
    b, volume = cube()
    b.segment(b.vertex(0.5, 0.5, width), b.vertex(0.55, 0.6, 0.7))
    return b.acute("gap", f"tip_{width:g}", volume)


def crossing(width):
    """Two segments that pass each other."""
    b, volume = cube()
    b.segment(b.vertex(0.2, 0.5, 0.5), b.vertex(0.8, 0.55, 0.5))
    b.segment(b.vertex(0.5, 0.2, 0.5 + width), b.vertex(0.45, 0.8, 0.5 + width))
    return b.acute("gap", f"crossing_{width:g}", volume)


def sheets(width, number):
    """A stack of equal squares."""
    b, volume = cube()
    for k in range(number):
        b.facet(square(b, (0.5, 0.5, 0.5 + k * width), 0.4))
    return b.acute("gap", f"sheets_{number}_{width:g}", volume)


def gap_inputs():
    """All of them in a fixed order."""
    for width in (1e-3, 1e-5, 1e-6, 1e-7):
        yield from (make(width) for make in (over_wall, plates, ribbon, flat_box, layer, tip, crossing))
        yield flat_box(width, hollow=True)
        yield over_wall(width, 1e-2)
        yield over_wall(width, 1.0)
        yield plates(width, 1e-2)
        yield plates(width, 1.0)
    yield sheets(1e-4, 5)
    yield sheets(1e-6, 20)
