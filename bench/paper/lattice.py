"""Drawings for figures 4, 5 and 11 of the paper: the coloured lattice as SVG, and the ways a plane parts a tetrahedron as a mesh.

Units are those in which the body-centred cubic lattice is Z^3 with its cells' centres; a period of the tiling has side 2.
"""

import itertools
import math

COLOURS = {0: "#e8c33b", 1: "#c2479b", 2: "#3d6fb4", 3: "#4c9f57", 2.5: "#35b5c4"}
SCALE, WIDTH, HEIGHT = 112, 420, 380
TURN, TILT = math.radians(24), math.radians(18)


def project(p):
    """Picture coordinates and depth (larger: nearer) of a point: orthographic, the middle of the period in the middle."""
    x, y, z = (c - 1 for c in p)
    right = x * math.cos(TURN) + y * math.sin(TURN)
    away = -x * math.sin(TURN) + y * math.cos(TURN)
    up = z * math.cos(TILT) + away * math.sin(TILT)
    return WIDTH / 2 + SCALE * right, HEIGHT / 2 - SCALE * up, z * math.sin(TILT) - away * math.cos(TILT)


def nodes():
    """The nodes of a period with their colours: (sum of the doubled coordinates) mod 4."""
    for doubled in itertools.product(range(5), repeat=3):
        if len({c % 2 for c in doubled}) == 1:
            yield tuple(c / 2 for c in doubled), sum(doubled) % 4


def pairs(coloured):
    """The shortest segments that join a node of colour 2 to one of colour 3."""
    twos, threes = ([p for p, colour in coloured if colour == wanted] for wanted in (2, 3))
    return [(a, b) for a in twos for b in threes if math.dist(a, b) < 0.9]


def line(a, b, style):
    (x0, y0, depth0), (x1, y1, depth1) = project(a), project(b)
    return (depth0 + depth1) / 2 - 0.5, f'<path d="M{x0:.1f} {y0:.1f}L{x1:.1f} {y1:.1f}" {style}/>'


def ball(p, colour, radius=9.0, opacity=1.0):
    x, y, depth = project(p)
    name = str(colour).replace(".", "_")
    return depth, f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius:.1f}" fill="url(#c{name})" opacity="{opacity}"/>'


def cube_edges():
    """The edges of the eight unit cubes."""
    for a in itertools.product(range(3), repeat=3):
        for axis in range(3):
            b = tuple(c + (k == axis) for k, c in enumerate(a))
            if max(b) <= 2:
                yield line(a, b, 'stroke="#b9b9b9" stroke-width="1.2"')


def drawing(items, title):
    """An SVG of what project() placed, the furthest first."""
    gradients = "".join(
        f'<radialGradient id="c{str(name).replace(".", "_")}" cx="35%" cy="30%"><stop offset="0" stop-color="#fff"/>'
        f'<stop offset="0.35" stop-color="{rgb}"/><stop offset="1" stop-color="{rgb}" stop-opacity="0.85"/></radialGradient>'
        for name, rgb in COLOURS.items())
    body = "\n".join(text for _, text in sorted(items))
    return (f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}" viewBox="0 0 {WIDTH} {HEIGHT}" role="img">\n'
            f'<title>{title}</title>\n<defs>{gradients}</defs>\n<rect width="100%" height="100%" fill="#fff"/>\n{body}\n</svg>\n')


def figure_4():
    return drawing([*cube_edges(), *(ball(p, colour) for p, colour in nodes())], "The body-centred cubic lattice in four colours")


def figure_5():
    coloured = list(nodes())
    items = [*cube_edges()]
    for a, b in pairs(coloured):
        items.append(line(a, b, 'stroke="#35b5c4" stroke-width="1.6"'))
        items.append(ball(tuple((p + q) / 2 for p, q in zip(a, b)), 2.5))
    for p, colour in coloured:
        items.append(ball(p, colour) if colour < 2 else ball(p, colour, 5, 0.35))
    return drawing(items, "Nodes of two colours replaced by the midpoints between them")


# ---- figure 11 ----

CORNERS = [(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)]


def between(p, q, share):
    return tuple(a + share * (b - a) for a, b in zip(p, q))


def prism(a, b):
    """Three tetrahedra between the triangles a and b."""
    return [(a[0], a[1], a[2], b[2]), (a[0], a[1], b[2], b[1]), (a[0], b[1], b[2], b[0])]


def parts(inside_count, share):
    """Tetrahedra within and beyond the surface, which crosses each edge at this share of its way out."""
    within, beyond = CORNERS[:inside_count], CORNERS[inside_count:]
    if inside_count == 2:
        (a, b), (c, d) = within, beyond
        ac, ad, bc, bd = (between(p, q, share) for p in within for q in beyond)
        return prism((a, ac, ad), (b, bc, bd)), prism((c, ac, bc), (d, ad, bd))
    tip, base = (within[0], beyond) if inside_count == 1 else (beyond[0], within)
    cut = [between(tip, p, share if inside_count == 1 else 1 - share) for p in base]
    small, large = [(tip, *cut)], prism(cut, base)
    return (small, large) if inside_count == 1 else (large, small)


def determinant(tet):
    a, b, c, d = tet
    u, v, w = ([q - p for p, q in zip(a, corner)] for corner in (b, c, d))
    return (u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) + u[2] * (v[0] * w[1] - v[1] * w[0]))


def moved(tets, by):
    return [tuple(tuple(c + d for c, d in zip(p, by)) for p in tet) for tet in tets]


def figure_11_mesh():
    """Medit text. Above: tetrahedra parted, the halves drawn away from one another; below: what is kept. Columns: one, two and three
    corners inside, and one again where the surface passes close to it."""
    pieces = []
    for column, (count, share) in enumerate([(1, 0.5), (2, 0.5), (3, 0.5), (3, 0.08)]):
        within, beyond = parts(count, share)
        x, gap = 3.8 * column, 0.5
        centre = [sum(p[k] for p in CORNERS[:count]) / count - sum(p[k] for p in CORNERS[count:]) / (4 - count) for k in range(3)]
        length = math.hypot(*centre)
        away = [gap * c / length for c in centre]
        pieces += moved(within, (x + away[0], away[1], 4.2 + away[2]))
        pieces += moved(beyond, (x - away[0], -away[1], 4.2 - away[2]))
        pieces += moved(within, (x, 0, 0))
    pieces = [tet if determinant(tet) > 0 else (tet[1], tet[0], tet[2], tet[3]) for tet in pieces]
    points = list(dict.fromkeys(p for tet in pieces for p in tet))
    number = {p: i + 1 for i, p in enumerate(points)}
    lines = ["MeshVersionFormatted 2", "Dimension 3", "Vertices", str(len(points))]
    lines += [" ".join(repr(float(c)) for c in p) + " 0" for p in points]
    lines += ["Tetrahedra", str(len(pieces))] + [" ".join(str(number[p]) for p in tet) + " 1" for tet in pieces] + ["End", ""]
    return "\n".join(lines)
