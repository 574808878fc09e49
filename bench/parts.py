"""Machine parts of our own as triangle surfaces, written as OBJ: the same bytes on every run.

Each maker returns points and triangles, the triangles facing outwards. PARTS names those that section `features` of bench/run meshes.
"""

import math


class Surface:
    def __init__(self):
        self.points, self.number, self.triangles = [], {}, []

    def point(self, *at):
        """The number of a point; equal ones are one."""
        key = tuple(round(x, 9) + 0.0 for x in at)
        if key not in self.number:
            self.number[key] = len(self.points)
            self.points.append(key)
        return self.number[key]

    def polygon(self, corners):
        """A convex polygon, fanned from its first corner."""
        numbers = [self.point(*c) for c in corners]
        self.triangles += [(numbers[0], numbers[i], numbers[i + 1]) for i in range(1, len(numbers) - 1)]

    def write(self, path):
        with open(path, "w") as file:
            file.writelines(f"v {x!r} {y!r} {z!r}\n" for x, y, z in self.points)
            file.writelines("f " + " ".join(str(i + 1) for i in t) + "\n" for t in self.triangles)


def extruded(pieces, outline, low, high):
    """What stands over a plane figure between two heights: convex pieces that make the figure up, counter-clockwise, and the
    loops round it, the outer one counter-clockwise, those of holes clockwise."""
    s = Surface()
    for piece in pieces:
        s.polygon([(x, y, high) for x, y in piece])
        s.polygon([(x, y, low) for x, y in reversed(piece)])
    for loop in outline:
        for (ax, ay), (bx, by) in zip(loop, loop[1:] + loop[:1]):
            s.polygon([(ax, ay, low), (bx, by, low), (bx, by, high), (ax, ay, high)])
    return s


def box(width, depth, height, at=(0, 0, 0)):
    (x, y, z), w, d = at, width, depth
    square = [(x, y), (x + w, y), (x + w, y + d), (x, y + d)]
    return extruded([square], [square], z, z + height)


def joined(*parts):
    s = Surface()
    for part in parts:
        numbers = [s.point(*p) for p in part.points]
        s.triangles += [tuple(numbers[i] for i in t) for t in part.triangles]
    return s


def cube():
    return box(2, 2, 2)


def plate(thickness, side=14):
    return box(side, side, thickness)


def plates_with_gap(gap, side=14, thickness=3):
    """Two plates one above the other."""
    return joined(box(side, side, thickness), box(side, side, thickness, (0, 0, thickness + gap)))


def l_block():
    """An L, 1 thick, its arms 1 wide and 2 long: one edge is concave."""
    pieces = [[(0, 0), (1, 0), (1, 1), (0, 1)], [(1, 0), (2, 0), (2, 1), (1, 1)], [(0, 1), (1, 1), (1, 2), (0, 2)]]
    outline = [(0, 0), (1, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2), (0, 1)]
    return extruded(pieces, [outline], 0, 1)


def wedge(degrees):
    """A prism over a triangle with two equal sides of 2 and this angle between them; 2 high."""
    half = math.radians(degrees / 2)
    x, y = 2 * math.cos(half), 2 * math.sin(half)
    triangle = [(0, 0), (x, -y), (x, y)]
    return extruded([triangle], [triangle], 0, 2)


def drilled_plate(columns=4, rows=2, corners=24, pitch=1.0, radius=0.3, thickness=0.4):
    """A plate of squares each of which has a hole in its middle with that many corners, a multiple of four."""
    pieces, holes = [], []
    quarter = corners // 4
    for cx in range(columns):
        for cy in range(rows):
            x, y = (cx + 0.5) * pitch, (cy + 0.5) * pitch
            turn = [math.pi / 4 + 2 * math.pi * k / corners for k in range(corners)]
            ring = [(x + radius * math.cos(t), y + radius * math.sin(t)) for t in turn]
            square = [(x + dx * pitch / 2, y + dy * pitch / 2) for dx, dy in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
            for side in range(4):  # corners of square and ring stand in the same directions, ring[quarter * side] at each
                first, end = square[side], square[(side + 1) % 4]
                part = [ring[(quarter * side + k) % corners] for k in range(quarter + 1)]
                middle = quarter // 2
                pieces += [[first, part[k + 1], part[k]] for k in range(middle)]
                pieces.append([first, end, part[middle]])
                pieces += [[end, part[k + 1], part[k]] for k in range(middle, quarter)]
            holes.append(ring[::-1])
    w, d = columns * pitch, rows * pitch
    outline = [(i * pitch, 0.0) for i in range(columns)] + [(w, i * pitch) for i in range(rows)]
    outline += [(w - i * pitch, d) for i in range(columns)] + [(0.0, d - i * pitch) for i in range(rows)]
    return extruded(pieces, [outline, *holes], 0, thickness)


PARTS = {"cube": cube, "l_block": l_block, "wedge_30": lambda: wedge(30), "wedge_45": lambda: wedge(45),
         "wedge_60": lambda: wedge(60), "wedge_75": lambda: wedge(75), "drilled_plate": drilled_plate}
