"""Draws CPU time against tetrahedra, laves and peers, on log axes, as an SVG file that suits light and dark pages."""

import math

WIDTH, HEIGHT = 760, 460
LEFT, RIGHT, TOP, BOTTOM = 62, 190, 46, 52
# Light and dark colours of each program; laves stands out by its width too.
COLORS = {"laves": ("#c2410c", "#fb923c"), "TetGen": ("#1d4ed8", "#7aa5ff"), "Gmsh Delaunay": ("#0f766e", "#4fd1c5"),
          "Gmsh HXT": ("#4d7c0f", "#a3d65c"), "Netgen": ("#7e22ce", "#c792f5"), "CGAL": ("#a16207", "#e6c04d"),
          "CGAL, slivers removed": ("#9d174d", "#f28cb5")}
LABEL_GAP = 17  # pixels between the labels at the lines' ends


def class_of(name):
    return "c" + "".join(c for c in name if c.isalnum())


def style():
    rules = [".page{fill:#ffffff}.ink{fill:#1f2328}.soft{fill:#59636e}.grid{stroke:#d1d9e0;stroke-width:1}"
             "text{font-family:system-ui,-apple-system,'Segoe UI',Helvetica,Arial,sans-serif;font-size:13px}"
             ".title{font-size:15px;font-weight:600}"
             "path{fill:none;stroke-width:2;stroke-linejoin:round}.main{stroke-width:3.5}.bold{font-weight:600}"]
    dark = [".page{fill:#0d1117}.ink{fill:#e6edf3}.soft{fill:#9198a1}.grid{stroke:#30363d}"]
    for name, (light, night) in COLORS.items():
        for rule, color in ((rules, light), (dark, night)):
            rule.append(f"path.{class_of(name)}{{stroke:{color}}}circle.{class_of(name)},text.{class_of(name)}{{fill:{color}}}")
    return "<style>" + "".join(rules) + "@media (prefers-color-scheme:dark){" + "".join(dark) + "}</style>"


def limits(values, room):
    """Logarithms of the ends of an axis: the values with room round them."""
    return math.log10(min(values) / room), math.log10(max(values) * room)


def ticks(low, high):
    """Step and power of ten of each line of the grid: powers of ten, and 2 and 5 times those where there are few."""
    powers = range(math.floor(low), math.ceil(high) + 1)
    steps = (1, 2, 5) if high - low < 2.2 else (1,)
    return [(step, p) for p in powers for step in steps if low <= math.log10(step) + p <= high]


def tick_text(step, power):
    """A number in short words."""
    for unit, size in (("G", 9), ("M", 6), ("k", 3)):
        if power >= size:
            return f"{step * 10 ** (power - size)}{unit}"
    return f"{step * 10.0 ** power:g}"


class Axes:
    def __init__(self, points):
        self.x0, self.x1 = limits([p[0] for p in points], 1.2)
        self.y0, self.y1 = limits([p[1] for p in points], 1.6)

    def x(self, tets):
        return LEFT + (math.log10(tets) - self.x0) / (self.x1 - self.x0) * (WIDTH - LEFT - RIGHT)

    def y(self, seconds):
        return HEIGHT - BOTTOM - (math.log10(seconds) - self.y0) / (self.y1 - self.y0) * (HEIGHT - TOP - BOTTOM)


def grid(axes, title, across):
    parts, right, bottom = [], WIDTH - RIGHT, HEIGHT - BOTTOM
    for step, power in ticks(axes.y0, axes.y1):
        y = axes.y(step * 10.0 ** power)
        parts.append(f'<line class="grid" x1="{LEFT}" x2="{right}" y1="{y:.1f}" y2="{y:.1f}"/>'
                     f'<text class="soft" x="{LEFT - 8}" y="{y + 4:.1f}" text-anchor="end">{tick_text(step, power)}</text>')
    for step, power in ticks(axes.x0, axes.x1):
        x = axes.x(step * 10.0 ** power)
        parts.append(f'<line class="grid" x1="{x:.1f}" x2="{x:.1f}" y1="{TOP}" y2="{bottom}"/>'
                     f'<text class="soft" x="{x:.1f}" y="{bottom + 19}" text-anchor="middle">{tick_text(step, power)}</text>')
    parts.append(f'<text class="soft" x="{(LEFT + right) / 2:.0f}" y="{HEIGHT - 10}" text-anchor="middle">{across}</text>'
                 f'<text class="ink title" x="{LEFT}" y="24">{title}</text>')
    return parts


def spread(ends):
    """Heights of labels, as near to the ends of their lines as room allows; the ends with their names, by height."""
    placed = []
    for y, name in sorted(ends):
        placed.append([max(y, placed[-1][0] + LABEL_GAP) if placed else y, y, name])
    over = placed[-1][0] - (HEIGHT - BOTTOM) if placed else 0
    if over > 0:
        for i in range(len(placed) - 1, -1, -1):
            limit = HEIGHT - BOTTOM if i == len(placed) - 1 else placed[i + 1][0] - LABEL_GAP
            placed[i][0] = min(placed[i][0], limit)
    return placed


def line_parts(axes, name, points):
    places = [(axes.x(t), axes.y(s)) for t, s in points]
    wide = " main" if name == "laves" else ""
    path = "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in places)
    return [f'<path class="{class_of(name)}{wide}" d="{path}"/>',
            *(f'<circle class="{class_of(name)}" cx="{x:.1f}" cy="{y:.1f}" r="{4 if wide else 3}"/>' for x, y in places)]


def draw_plot(sections, path):
    """From the rows of section peers; whether there was anything to draw."""
    lines = {}
    for row in sections.get("peers", {}).get("rows", []):
        if row["part"] == "curve" and row["cpu"] > 0:
            lines.setdefault(row["program"], []).append((row["tets"], row["cpu"]))
    lines = {name: sorted(points) for name, points in lines.items() if name in COLORS and len(points) >= 2}
    if "laves" not in lines:
        return False
    write_plot(lines, path, "CPU seconds against tetrahedra, one thread, files included", "tetrahedra")
    return True


def write_plot(lines, path, title, across):
    """Lines by name, each a sorted list of (x, y) above zero, on log axes."""
    axes = Axes([p for points in lines.values() for p in points])
    parts = grid(axes, title, across)
    for name in sorted(lines, key=lambda n: n == "laves"):
        parts += line_parts(axes, name, lines[name])
    ends = [(axes.y(points[-1][1]), name) for name, points in lines.items()]
    for label, _, name in spread(ends):
        x = axes.x(lines[name][-1][0]) + 10
        bold = " bold" if name == "laves" else ""
        parts.append(f'<text class="{class_of(name)}{bold}" x="{x:.1f}" y="{label + 4:.1f}">{name}</text>')
    with open(path, "w") as file:
        file.write(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" height="{HEIGHT}" role="img">'
                   f"<title>{title}, for laves and other meshers, on log axes</title>"
                   + style() + f'<rect class="page" width="{WIDTH}" height="{HEIGHT}" rx="6"/>' + "\n".join(parts) + "</svg>\n")
