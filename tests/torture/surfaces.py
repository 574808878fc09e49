"""Clean surfaces and ways to break them, for the torture test.

A surface is a list of points [x, y, z] and a list of triangles (a, b, c). Everything is made from a seed, so that each file is
the same on every machine. A way of breaking takes a surface, a strength from 1 to 10 and a random.Random, and returns the broken
surface; strength 1 is what careful software lets slip, strength 10 is hardly a shape any more.
"""
import math
import random

# ---- clean shapes ----


def grid(rows, columns, place, close_rows, close_columns):
    """Triangles between the points place(i, j); closed round where said."""
    points = [place(i, j) for i in range(rows) for j in range(columns)]
    faces = []
    for i in range(rows if close_rows else rows - 1):
        for j in range(columns if close_columns else columns - 1):
            a, b = i * columns + j, i * columns + (j + 1) % columns
            c, d = ((i + 1) % rows) * columns + (j + 1) % columns, ((i + 1) % rows) * columns + j
            faces += [(a, b, c), (a, c, d)]
    return points, faces


def revolution(profile, around):
    """A closed profile of (radius, height) from the lower to the upper point of the axis, turned about it."""
    points, faces = [[0, 0, profile[0][1]]], []
    rings = profile[1:-1]
    for radius, height in rings:
        for j in range(around):
            angle = 2 * math.pi * j / around
            points.append([radius * math.cos(angle), radius * math.sin(angle), height])
    points.append([0, 0, profile[-1][1]])
    for j in range(around):
        k = (j + 1) % around
        faces.append((0, 1 + k, 1 + j))
        for i in range(len(rings) - 1):
            a, b, c, d = 1 + i * around + j, 1 + i * around + k, 1 + (i + 1) * around + k, 1 + (i + 1) * around + j
            faces += [(a, b, c), (a, c, d)]
        last = 1 + (len(rings) - 1) * around
        faces.append((last + j, last + k, len(points) - 1))
    return points, faces


def prism(outline, height, layers):
    """An outline, counter-clockwise and star-shaped about its first point's opposite, drawn out along z."""
    count = len(outline)
    centre = [sum(p[0] for p in outline) / count, sum(p[1] for p in outline) / count]
    points = [[x, y, height * i / layers] for i in range(layers + 1) for x, y in outline]
    points += [[*centre, 0], [*centre, height]]
    low, high = len(points) - 2, len(points) - 1
    faces = []
    for j in range(count):
        k = (j + 1) % count
        for i in range(layers):
            a, b, c, d = i * count + j, i * count + k, (i + 1) * count + k, (i + 1) * count + j
            faces += [(a, b, c), (a, c, d)]
        faces += [(low, k, j), (high, layers * count + j, layers * count + k)]
    return points, faces


def ball(radius=1.0, rings=9, around=16):
    angles = [math.pi * i / rings for i in range(rings + 1)]
    return revolution([(radius * math.sin(a), -radius * math.cos(a)) for a in angles], around)


def split(surface, times):
    """Each triangle in four, so many times; the shape stays."""
    points, faces = [list(p) for p in surface[0]], list(surface[1])
    for _ in range(times):
        middles, smaller = {}, []

        def middle(a, b):
            key = (min(a, b), max(a, b))
            if key not in middles:
                middles[key] = len(points)
                points.append([(u + v) / 2 for u, v in zip(points[a], points[b])])
            return middles[key]

        for a, b, c in faces:
            d, e, f = middle(a, b), middle(b, c), middle(c, a)
            smaller += [(a, d, f), (d, b, e), (f, e, c), (d, e, f)]
        faces = smaller
    return points, faces


def turned(surface):
    return surface[0], [(a, c, b) for a, b, c in surface[1]]


def joined(*surfaces):
    points, faces = [], []
    for p, f in surfaces:
        faces += [tuple(i + len(points) for i in face) for face in f]
        points += [list(q) for q in p]
    return points, faces


def moved(surface, by=(0, 0, 0), scale=1.0):
    return [[scale * x + d for x, d in zip(p, by)] for p in surface[0]], surface[1]


def torus():
    def place(i, j):
        u, v = 2 * math.pi * i / 24, 2 * math.pi * j / 12
        return [(1 + 0.4 * math.cos(v)) * math.cos(u), (1 + 0.4 * math.cos(v)) * math.sin(u), 0.4 * math.sin(v)]

    return turned(grid(24, 12, place, True, True)) if volume(grid(24, 12, place, True, True)) < 0 else grid(24, 12, place, True, True)


def gear():
    outline = []
    for j in range(24):
        radius = 1.0 if j % 4 < 2 else 0.75
        outline.append((radius * math.cos(2 * math.pi * j / 24), radius * math.sin(2 * math.pi * j / 24)))
    return prism(outline, 0.6, 3)


def ell():
    outline = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
    count = len(outline)
    points = [[x, y, z] for z in (0, 1) for x, y in outline]
    faces = []
    for j in range(count):
        k = (j + 1) % count
        faces += [(j, k, count + k), (j, count + k, count + j)]
    for a, b, c in ((0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)):
        faces += [(c, b, a), (count + a, count + b, count + c)]
    return split((points, faces), 2)


def wavy():
    """A ball with waves, smooth and without symmetry."""
    points, faces = ball(1.0, 14, 24)

    def wave(p):
        r = 1 + 0.15 * math.sin(5 * p[0] + 1) * math.sin(4 * p[1] + 2) + 0.1 * math.sin(6 * p[2])
        return [r * x for x in p]

    return [wave(p) for p in points], faces


SHAPES = {
    "ball": ball,
    "box": lambda: split(prism([(0, 0), (1, 0), (1, 1), (0, 1)], 1, 1), 2),
    "torus": torus,
    "cone": lambda: revolution([(0, 0), (0.5, 0), (1, 0), (0.66, 0.66), (0.33, 1.33), (0, 2)], 20),
    "cylinder": lambda: revolution([(0, 0), (0.35, 0), (0.7, 0), (0.7, 0.7), (0.7, 1.4), (0.35, 1.4), (0, 1.4)], 24),
    "ell": ell,
    "gear": gear,
    "hollow": lambda: joined(ball(1.0), turned(ball(0.5, 7, 12))),
    "plate": lambda: split(prism([(0, 0), (2, 0), (2, 1.4), (0, 1.4)], 0.25, 1), 2),
    "wavy": wavy,
}

# ---- measures ----


def volume(surface):
    points, faces = surface
    total = 0.0
    for a, b, c in faces:
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = points[a], points[b], points[c]
        total += ax * (by * cz - bz * cy) - ay * (bx * cz - bz * cx) + az * (bx * cy - by * cx)
    return total / 6


def diagonal(points):
    return math.sqrt(sum((max(p[k] for p in points) - min(p[k] for p in points)) ** 2 for k in range(3)))


def centroid(points, face):
    return [sum(points[i][k] for i in face) / 3 for k in range(3)]


def distance(p, q):
    return math.sqrt(sum((a - b) ** 2 for a, b in zip(p, q)))


def mean_edge(surface):
    points, faces = surface
    return sum(distance(points[a], points[b]) for a, b, _ in faces) / len(faces)


# ---- twenty ways of breaking ----


def some(faces, share, rng):
    """Indices of so large a share of the faces, at least one."""
    return rng.sample(range(len(faces)), max(1, min(len(faces) - 1, round(share * len(faces)))))


def small_holes(s, k, rng):
    gone = set(some(s[1], 0.012 * k, rng))
    return s[0], [f for i, f in enumerate(s[1]) if i not in gone]


def large_hole(s, k, rng):
    at, reach = rng.choice(s[0]), 0.04 * k * diagonal(s[0])
    kept = [f for f in s[1] if distance(centroid(s[0], f), at) > reach]
    return s[0], kept or s[1][:1]


def turned_faces(s, k, rng):
    over = set(some(s[1], 0.03 * k, rng))
    return s[0], [(a, c, b) if i in over else (a, b, c) for i, (a, b, c) in enumerate(s[1])]


def repeated_faces(s, k, rng):
    return s[0], s[1] + [s[1][i] for i in some(s[1], 0.08 * k, rng)]


def opposite_faces(s, k, rng):
    return s[0], s[1] + [s[1][i][::-1] for i in some(s[1], 0.01 * k, rng)]


def cracks(s, k, rng):
    """Every face has corners of its own, each a little off."""
    off = 10 ** (-8 + 0.45 * k) * diagonal(s[0])
    points, faces = [], []
    for face in s[1]:
        faces.append((len(points), len(points) + 1, len(points) + 2))
        points += [[x + rng.uniform(-off, off) for x in s[0][i]] for i in face]
    return points, faces


def noise(s, k, rng):
    off = 0.08 * k * mean_edge(s)
    return [[x + rng.uniform(-off, off) for x in p] for p in s[0]], s[1]


def slivers(s, k, rng):
    """Faces are split at a point almost on an edge, on one side of it only."""
    points, faces = [list(p) for p in s[0]], list(s[1])
    for i in some(faces, 0.2, rng):
        a, b, c = faces[i]
        t, h = rng.uniform(0.2, 0.8), 10.0 ** (-2 - k)
        points.append([(1 - h) * ((1 - t) * x + t * y) + h * z for x, y, z in zip(points[a], points[b], points[c])])
        d = len(points) - 1
        faces[i] = (a, d, c)
        faces += [(d, b, c), (a, b, d)]
    return points, faces


def degenerate_faces(s, k, rng):
    faces = list(s[1])
    for i in some(faces, 0.05 * k, rng):
        a, b, c = s[1][i]
        faces.append(rng.choice([(a, a, b), (a, b, a), (c, c, c), (b, c, b)]))
    rng.shuffle(faces)
    return s[0], faces


def t_junctions(s, k, rng):
    """Faces are split in the middle of an edge, which the face across is not."""
    points, faces = [list(p) for p in s[0]], list(s[1])
    for i in some(faces, 0.04 * k, rng):
        a, b, c = faces[i]
        points.append([(x + y) / 2 for x, y in zip(points[a], points[b])])
        d = len(points) - 1
        faces[i] = (a, d, c)
        faces.append((d, b, c))
    return points, faces


def overlapping_copies(s, k, rng):
    d = diagonal(s[0])
    copies = [s]
    for _ in range(1 + k // 4):
        copies.append(moved(s, [rng.uniform(-1, 1) * 0.05 * k * d for _ in range(3)]))
    return joined(*copies)


def inner_walls(s, k, rng):
    """Triangles between points of the surface, through its inside."""
    faces = list(s[1])
    for _ in range(2 * k):
        faces.append(tuple(rng.sample(range(len(s[0])), 3)))
    return s[0], faces


def stray_faces(s, k, rng):
    points, faces = [list(p) for p in s[0]], list(s[1])
    d = diagonal(points)
    for _ in range(3 * k):
        at = [p + rng.uniform(-0.5, 0.5) * d for p in rng.choice(s[0])]
        faces.append((len(points), len(points) + 1, len(points) + 2))
        points += [[x + rng.uniform(-0.05, 0.05) * d for x in at] for _ in range(3)]
    return points, faces


def fins(s, k, rng):
    """Faces that stand on edges, which then have three."""
    points, faces = [list(p) for p in s[0]], list(s[1])
    out = 0.3 * mean_edge(s)
    for i in some(s[1], 0.02 * k, rng):
        a, b, _ = s[1][i]
        points.append([(x + y) / 2 + rng.uniform(-out, out) for x, y in zip(points[a], points[b])])
        faces.append((a, b, len(points) - 1))
    return points, faces


def merged_points(s, k, rng):
    """Far points become one, so that the surface is pinched."""
    points, number = [list(p) for p in s[0]], list(range(len(s[0])))
    for _ in range(k):
        a, b = rng.sample(range(len(points)), 2)
        number[a] = b
    return points, [tuple(number[i] for i in f) for f in s[1]]


def far_and_scaled(s, k, rng):
    """From a nanometre beside the origin to a kilometre a thousand diagonals away."""
    scale = 10.0 ** (-9 + 1.2 * k)
    far = 10.0 ** (0.4 * k) * scale
    return moved(s, [rng.uniform(-far, far) for _ in range(3)], scale)


def rounded(s, k, rng):
    """Coordinates on a grid that gets coarse: points fall together, faces into one plane."""
    step = diagonal(s[0]) / (4096 / 1.8 ** k)
    return [[round(x / step) * step for x in p] for p in s[0]], s[1]


def many_parts(s, k, rng):
    d = diagonal(s[0])
    parts = [s]
    for _ in range(12 * k):
        small = moved(ball(0.03 * d, 3, 5), [rng.uniform(-0.6, 0.6) * d for _ in range(3)])
        parts.append(small if rng.random() < 0.7 else turned(small))
    return joined(*parts)


def nested_parts(s, k, rng):
    centre = [sum(p[i] for p in s[0]) / len(s[0]) for i in range(3)]
    parts = [s]
    for i in range(k):
        scale = 1 - (i + 1) / (k + 2)
        inner = moved(s, [c * (1 - scale) for c in centre], scale)
        parts.append(inner if rng.random() < 0.5 else turned(inner))
    return joined(*parts)


def cut_open(s, k, rng):
    """What lies beyond a plane is gone; at full strength little more than a sheet is left."""
    normal = [rng.gauss(0, 1) for _ in range(3)]
    heights = sorted(sum(a * b for a, b in zip(normal, centroid(s[0], f))) for f in s[1])
    limit = heights[min(len(heights) - 1, int(len(heights) * (1 - 0.08 * k)))]
    return s[0], [f for f in s[1] if sum(a * b for a, b in zip(normal, centroid(s[0], f))) <= limit]


def not_numbers(s, k, rng):
    points = [list(p) for p in s[0]]
    for i in rng.sample(range(len(points)), k):
        points[i][rng.randrange(3)] = rng.choice([math.nan, math.inf, -math.inf])
    return points, s[1]


def wrong_indices(s, k, rng):
    faces = [list(f) for f in s[1]]
    for i in rng.sample(range(len(faces)), k):
        faces[i][rng.randrange(3)] = len(s[0]) + rng.randrange(2**20)
    return s[0], faces


# way: (function, what must come of it, strength up to which the mesh has the volume of the clean shape within a tenth)
#   mesh    a valid mesh at every strength
#   either  a valid mesh, or a refusal because there is no inside or nothing of it is resolved
#   refuse  a refusal
WAYS = {
    "small-holes": (small_holes, "mesh", 4),
    "large-hole": (large_hole, "either", 2),
    "turned-faces": (turned_faces, "mesh", 10),
    "repeated-faces": (repeated_faces, "mesh", 10),
    "opposite-faces": (opposite_faces, "either", 3),
    "cracks": (cracks, "either", 6),
    "noise": (noise, "mesh", 2),
    "slivers": (slivers, "mesh", 10),
    "degenerate-faces": (degenerate_faces, "mesh", 10),
    "t-junctions": (t_junctions, "mesh", 10),
    "overlapping-copies": (overlapping_copies, "mesh", 0),
    "inner-walls": (inner_walls, "either", 0),
    "stray-faces": (stray_faces, "either", 3),
    "fins": (fins, "mesh", 5),
    "merged-points": (merged_points, "either", 1),
    "far-and-scaled": (far_and_scaled, "mesh", 10),
    "rounded": (rounded, "either", 5),
    "many-parts": (many_parts, "either", 0),
    "nested-parts": (nested_parts, "mesh", 0),
    "cut-open": (cut_open, "either", 0),
    "not-numbers": (not_numbers, "refuse", 0),
    "wrong-indices": (wrong_indices, "refuse", 0),
}

# ---- files ----


def number(x):
    return repr(float(x))


def write_off(path, s):
    with open(path, "w") as file:
        file.write(f"OFF\n{len(s[0])} {len(s[1])} 0\n")
        file.writelines(" ".join(map(number, p)) + "\n" for p in s[0])
        file.writelines("3 " + " ".join(map(str, f)) + "\n" for f in s[1])


def write_obj(path, s):
    with open(path, "w") as file:
        file.writelines("v " + " ".join(map(number, p)) + "\n" for p in s[0])
        file.writelines("f " + " ".join(str(i + 1) for i in f) + "\n" for f in s[1])


def write_ply(path, s):
    with open(path, "w") as file:
        file.write(f"ply\nformat ascii 1.0\nelement vertex {len(s[0])}\nproperty double x\nproperty double y\nproperty double z\n")
        file.write(f"element face {len(s[1])}\nproperty list uchar int vertex_indices\nend_header\n")
        file.writelines(" ".join(map(number, p)) + "\n" for p in s[0])
        file.writelines("3 " + " ".join(map(str, f)) + "\n" for f in s[1])


def write_stl(path, s):
    with open(path, "w") as file:
        file.write("solid broken\n")
        for f in s[1]:
            file.write("facet normal 0 0 0\nouter loop\n")
            file.writelines("vertex " + " ".join(map(number, s[0][i])) + "\n" for i in f)
            file.write("endloop\nendfacet\n")
        file.write("endsolid broken\n")


WRITERS = {"off": write_off, "obj": write_obj, "ply": write_ply, "stl": write_stl}


def case(shape, way, strength):
    """The broken surface, and the extension of its file: STL where indices need not be told, else the rest in turn."""
    rng = random.Random(f"{shape} {way} {strength}")
    surface = WAYS[way][0](SHAPES[shape](), strength, rng)
    kinds = ["off", "obj", "ply"] if way == "wrong-indices" else ["stl", "off", "obj", "ply"]
    return surface, kinds[rng.randrange(len(kinds))]
