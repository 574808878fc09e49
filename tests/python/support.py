"""What the tests of the Python package share. They use unittest alone; where NumPy is missing they say so and are skipped."""
import os
import pathlib
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]

try:
    import numpy as np
except ImportError:
    print(f"SKIPPED: {sys.executable} has no NumPy (Debian: python3-numpy, for /usr/bin/python3)")
    sys.exit(77)


def cube(half=0.5):
    """A box: points (8, 3), triangles (12, 3) that face outwards, and a tag for each of its sides (12,)."""
    points = half * np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], dtype=float)
    quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    faces = np.array([t for a, b, c, d in quads for t in ([a, b, c], [a, c, d])])
    return points, faces, np.repeat(np.arange(6), 2)


def ball(points):
    """Distance to the unit sphere."""
    return np.sqrt((points ** 2).sum(axis=1)) - 1


BOX = ([-1.2, -1.2, -1.2], [1.2, 1.2, 1.2])


def program():
    return os.environ["LAVES_PROGRAM"]


def main():
    unittest.main(verbosity=1)
