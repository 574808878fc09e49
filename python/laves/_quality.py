"""Quality of each tetrahedron, by NumPy; laves.Mesh.check() has the library's own statistics of the same."""
import numpy as np

_BLOCK = 65536  # tets at once, so that memory stays small


class Quality:
    """Arrays with one value for each tetrahedron: float64 (m,).

    min_dihedral, max_dihedral: degrees; radius_ratio: 3 r / R, 1 for the regular tetrahedron, 0 for a flat one; radius_edge: R over the
    shortest edge, over that of the regular one: 1 and up; volume_length: sqrt(2) 6 V / rms(edge)^3, 1 for the regular one, negative
    for one that is turned over; volume: in the units of the mesh, cubed."""

    NAMES = ("min_dihedral", "max_dihedral", "radius_ratio", "radius_edge", "volume_length", "volume")

    def __init__(self, points, tets):
        for name in self.NAMES:
            setattr(self, name, np.empty(len(tets)))
        for begin in range(0, len(tets), _BLOCK):
            part = slice(begin, begin + _BLOCK)
            with np.errstate(divide="ignore", invalid="ignore"):
                for name, values in zip(self.NAMES, _shapes(points[tets[part]])):
                    getattr(self, name)[part] = values

    def __repr__(self):
        rows = [f"  {name:14} min {v.min():.6g}  mean {v.mean():.6g}  max {v.max():.6g}" if len(v) else f"  {name}: no tets"
                for name, v in ((name, getattr(self, name)) for name in self.NAMES)]
        return f"Quality of {len(self.volume):,} tets\n" + "\n".join(rows)


def _dot(a, b):
    return np.einsum("ij,ij->i", a, b)


def _shapes(p):
    a, b, c, d = (p[:, k] for k in range(4))
    six_volume = _dot(np.cross(b - a, c - a), d - a)
    # Inward normals, twice the area long, of the faces opposite to a, b, c, d.
    normals = [np.cross(d - b, c - b), np.cross(c - a, d - a), np.cross(d - a, b - a), np.cross(b - a, c - a)]
    areas = [np.sqrt(_dot(n, n)) for n in normals]
    cosines = np.stack([-_dot(normals[i], normals[j]) / (areas[i] * areas[j]) for i in range(4) for j in range(i)])
    angles = np.degrees(np.arccos(np.clip(cosines, -1, 1)))
    edges = np.stack([_dot(e, e) for e in (b - a, c - a, d - a, c - b, d - b, d - c)])
    # By the products of opposite edges: 24 V R is the root of Heron's formula for them.
    u, v, w = (np.sqrt(edges[i] * edges[j]) for i, j in ((0, 5), (1, 4), (2, 3)))
    heron = np.sqrt(np.maximum((u + v + w) * (u + v - w) * (u - v + w) * (v + w - u), 0))
    inner = six_volume / sum(areas)
    outer = heron / (4 * np.abs(six_volume))
    regular = np.sqrt(6) / 4
    return (angles.min(0), angles.max(0), 3 * inner / outer, outer / np.sqrt(edges.min(0)) / regular,
            np.sqrt(2) * six_volume / np.mean(edges, 0) ** 1.5, six_volume / 6)
