#!/usr/bin/env python3
"""Writes demo/knot.ply: a tube along a (p, q) torus knot, as a closed triangle surface.

    tools/make_knot.py > demo/knot.ply

The tube's cross sections are turned so that they twist as little as the closed curve lets them (parallel transport, with what
is left over spread evenly), and the triangles are near to equilateral.
"""
import math

P, Q = 2, 3  # times around the axis, times through the hole
OUTER, INNER = 1.0, 0.42  # radii of the torus that the knot winds on
TUBE = 0.21  # radius of the tube
ALONG, AROUND = 132, 16  # cross sections, and points of each


def curve(t):
    r = OUTER + INNER * math.cos(Q * t)
    return (r * math.cos(P * t), r * math.sin(P * t), INNER * 1.25 * math.sin(Q * t))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def unit(a):
    length = math.sqrt(dot(a, a))
    return tuple(x / length for x in a)


def spread(count, fine=20000):
    """Parameters of `count` points at equal distances along the curve."""
    lengths = [0.0]
    for i in range(fine):
        a, b = curve(2 * math.pi * i / fine), curve(2 * math.pi * (i + 1) / fine)
        lengths.append(lengths[-1] + math.dist(a, b))
    out, k = [], 0
    for i in range(count):
        while lengths[k + 1] <= lengths[-1] * i / count:
            k += 1
        out.append(2 * math.pi * k / fine)
    return out


def frames(parameters):
    """At each parameter: centre, and two directions across the curve, carried along without twisting."""
    centres = [curve(t) for t in parameters]
    tangents = [unit(tuple(b - a for a, b in zip(curve(t - 1e-4), curve(t + 1e-4)))) for t in parameters]
    normal = unit(cross(tangents[0], (0, 0, 1)))
    first, normals = normal, []
    for tangent in tangents + [tangents[0]]:
        normal = unit(tuple(n - dot(normal, tangent) * t for n, t in zip(normal, tangent)))
        normals.append(normal)
    # The angle by which the frame fails to close is taken back a little at every step.
    last, side = normals.pop(), cross(tangents[0], first)
    gap = math.atan2(dot(last, side), dot(last, first))
    out = []
    for i, (centre, tangent, n) in enumerate(zip(centres, tangents, normals)):
        b, angle = cross(tangent, n), -gap * i / len(centres)
        c, s = math.cos(angle), math.sin(angle)
        out.append((centre, tuple(c * x + s * y for x, y in zip(n, b)), tuple(c * y - s * x for x, y in zip(n, b))))
    return out


def main():
    points, faces = [], []
    for i, (centre, n, b) in enumerate(frames(spread(ALONG))):
        for j in range(AROUND):
            angle = 2 * math.pi * j / AROUND
            c, s = TUBE * math.cos(angle), TUBE * math.sin(angle)
            points.append(tuple(p + c * x + s * y for p, x, y in zip(centre, n, b)))
            k = (i + 1) % ALONG
            corners = [i * AROUND + j, k * AROUND + j, k * AROUND + (j + 1) % AROUND, i * AROUND + (j + 1) % AROUND]
            # Diagonals alternate, so that the tube has no hand of its own.
            if (i + j) % 2:
                faces += [(corners[0], corners[2], corners[1]), (corners[0], corners[3], corners[2])]
            else:
                faces += [(corners[0], corners[3], corners[1]), (corners[1], corners[3], corners[2])]
    print("ply\nformat ascii 1.0\ncomment made by tools/make_knot.py")
    print(f"element vertex {len(points)}\nproperty double x\nproperty double y\nproperty double z")
    print(f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header")
    for point in points:
        print(*(f"{x:.5f}" for x in point))
    for face in faces:
        print(3, *face)


main()
