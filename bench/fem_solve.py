#!/usr/bin/python3
"""Solves Poisson's equation and linear elasticity on a tetrahedral mesh by linear finite elements, and tells as JSON how well: for
section `fem` of bench/run.

    fem_solve.py MESH [MESH ...]      VTU, Gmsh or TetGen; needs NumPy, SciPy and meshio

Solutions are known smooth functions: their values are prescribed on the boundary and their loads inside, so that any solid will do.
Systems are solved by conjugate gradients to a residual of 1e-8, without and with division by the diagonal. The coefficients of that
iteration make a tridiagonal matrix (Lanczos) whose extreme eigenvalues are those of the system: the condition number.
"""
import json
import sys
import time

import meshio
import numpy
from scipy.linalg import eigh_tridiagonal
from scipy.sparse import coo_matrix

# A rule of four points that is exact to the second degree: barycentric coordinates, equal weights.
NEAR, FAR = (5 + 3 * 5**0.5) / 20, (5 - 5**0.5) / 20
RULE = numpy.full((4, 4), FAR) + (NEAR - FAR) * numpy.eye(4)
TOLERANCE, ITERATIONS_MAX = 1e-8, 20000
POISSON_RATIO = 0.3
MU, LAMBDA = 1.0, 2 * POISSON_RATIO / (1 - 2 * POISSON_RATIO)


class Scalar:
    """u = sin 2x + cos 3y + sin 2z sin x: -laplace u = f."""

    components = 1

    @staticmethod
    def value(p):
        x, y, z = p.T
        return (numpy.sin(2 * x) + numpy.cos(3 * y) + numpy.sin(2 * z) * numpy.sin(x))[:, None]

    @staticmethod
    def gradient(p):
        x, y, z = p.T
        return numpy.stack([2 * numpy.cos(2 * x) + numpy.sin(2 * z) * numpy.cos(x), -3 * numpy.sin(3 * y),
                            2 * numpy.cos(2 * z) * numpy.sin(x)], axis=1)[:, None, :]

    @staticmethod
    def load(p):
        x, y, z = p.T
        return (4 * numpy.sin(2 * x) + 9 * numpy.cos(3 * y) + 5 * numpy.sin(2 * z) * numpy.sin(x))[:, None]

    @staticmethod
    def stiffness(gradients):
        """(tets, 4, 1, 4, 1) for gradients (tets, 4, 3) of the four hats."""
        return numpy.einsum("tik,tjk->tij", gradients, gradients)[:, :, None, :, None]

    @staticmethod
    def energy(g):
        """Density of the energy of a gradient (n, 1, 3)."""
        return numpy.einsum("nck,nck->n", g, g)


class Elastic:
    """u_i = sin 2x_j + cos 2x_i with j the axis behind i: -mu laplace u - (lambda + mu) grad div u = f."""

    components = 3

    @staticmethod
    def value(p):
        return numpy.sin(2 * numpy.roll(p, -1, axis=1)) + numpy.cos(2 * p)

    @staticmethod
    def gradient(p):
        g = numpy.zeros((len(p), 3, 3))
        for i in range(3):
            g[:, i, i] = -2 * numpy.sin(2 * p[:, i])
            g[:, i, (i + 1) % 3] = 2 * numpy.cos(2 * p[:, (i + 1) % 3])
        return g

    @staticmethod
    def load(p):
        return 4 * MU * Elastic.value(p) + 4 * (LAMBDA + MU) * numpy.cos(2 * p)

    @staticmethod
    def stiffness(gradients):
        dots = numpy.einsum("tik,tjk->tij", gradients, gradients)
        outer = numpy.einsum("tia,tjb->tiajb", gradients, gradients)
        return LAMBDA * outer + MU * (numpy.einsum("tij,ab->tiajb", dots, numpy.eye(3)) + outer.transpose(0, 1, 4, 3, 2))

    @staticmethod
    def energy(g):
        strain = (g + g.transpose(0, 2, 1)) / 2
        return LAMBDA * numpy.trace(g, axis1=1, axis2=2)**2 + 2 * MU * numpy.einsum("nck,nck->n", strain, strain)


# ---- the mesh ----


def read(path):
    """Points in a box whose longest side is 2, tets of positive volume, and which vertices are on the boundary; vertices that no tet uses are
    dropped."""
    mesh = meshio.read(path)
    tets = numpy.vstack([block.data for block in mesh.cells if block.type == "tetra"]).astype(int)
    used, tets = numpy.unique(tets, return_inverse=True)
    points, tets = mesh.points[used].astype(float), tets.reshape(-1, 4)
    low, high = points.min(axis=0), points.max(axis=0)
    points = (points - (low + high) / 2) * 2 / (high - low).max()  # the solutions have waves of about this length
    turned = volumes(points, tets) < 0
    tets[turned] = tets[turned][:, [0, 2, 1, 3]]
    faces = numpy.sort(numpy.vstack([tets[:, [1, 2, 3]], tets[:, [0, 2, 3]], tets[:, [0, 1, 3]], tets[:, [0, 1, 2]]]), axis=1)
    once, counts = numpy.unique(faces, axis=0, return_counts=True)
    boundary = numpy.zeros(len(points), dtype=bool)
    boundary[once[counts == 1].ravel()] = True
    return points, tets, boundary


def edges(points, tets):
    return points[tets[:, 1:]] - points[tets[:, :1]]


def volumes(points, tets):
    return numpy.linalg.det(edges(points, tets)) / 6


# ---- elements ----


def assemble(problem, points, tets):
    """Stiffness matrix and load vector, vertex by vertex, its components together."""
    volume = volumes(points, tets)
    inner = numpy.linalg.inv(edges(points, tets)).transpose(0, 2, 1)  # gradients of the hats of corners 1 to 3
    gradients = numpy.concatenate([-inner.sum(axis=1, keepdims=True), inner], axis=1)
    c, n = problem.components, problem.components * len(points)
    matrix = problem.stiffness(gradients) * volume[:, None, None, None, None]
    unknowns = (c * tets[:, :, None] + numpy.arange(c)).reshape(len(tets), -1)
    rows = numpy.repeat(unknowns, 4 * c, axis=1).ravel()
    columns = numpy.tile(unknowns, (1, 4 * c)).ravel()
    stiffness = coo_matrix((matrix.ravel(), (rows, columns)), shape=(n, n)).tocsr()
    load = numpy.zeros((len(points), c))
    for weights in RULE:
        values = problem.load(numpy.einsum("i,tik->tk", weights, points[tets])) * volume[:, None] / 4
        for corner in range(4):
            numpy.add.at(load, tets[:, corner], weights[corner] * values)
    return stiffness, load.ravel(), gradients


def conjugate_gradients(matrix, right, scale):
    """The solution, the number of iterations, the seconds, and the extreme eigenvalues of the system divided by `scale`."""
    start = time.process_time()
    x, r = numpy.zeros_like(right), right.copy()
    z = r / scale
    p, rho, target = z.copy(), r @ z, TOLERANCE * numpy.linalg.norm(right)
    alphas, betas = [], []
    while numpy.linalg.norm(r) > target and len(alphas) < ITERATIONS_MAX:
        q = matrix @ p
        alpha = rho / (p @ q)
        x += alpha * p
        r -= alpha * q
        z = r / scale
        rho, before = r @ z, rho
        beta = rho / before
        p = z + beta * p
        alphas.append(alpha)
        betas.append(beta)
    seconds = time.process_time() - start
    a, b = numpy.array(alphas), numpy.array(betas)
    diagonal = 1 / a + numpy.concatenate([[0], b[:-1] / a[:-1]])
    values = eigh_tridiagonal(diagonal, numpy.sqrt(b[:-1]) / a[:-1], eigvals_only=True)
    return x, len(alphas), seconds, values[0], values[-1]


def errors(problem, points, tets, gradients, solution):
    """Of the values, in the mean square, and of the energy: both relative to those of the exact solution."""
    volume = volumes(points, tets)
    nodal = solution.reshape(len(points), -1)[tets]
    slope = numpy.einsum("tic,tik->tck", nodal, gradients)
    sums = numpy.zeros(4)
    for weights in RULE:
        p = numpy.einsum("i,tik->tk", weights, points[tets])
        exact, exact_slope = problem.value(p), problem.gradient(p)
        found = numpy.einsum("i,tic->tc", weights, nodal)
        parts = [((found - exact)**2).sum(axis=1), (exact**2).sum(axis=1), problem.energy(slope - exact_slope), problem.energy(exact_slope)]
        sums += [(volume * part).sum() / 4 for part in parts]
    return float(numpy.sqrt(sums[0] / sums[1])), float(numpy.sqrt(sums[2] / sums[3]))


def solve(problem, points, tets, boundary):
    stiffness, load, gradients = assemble(problem, points, tets)
    fixed = numpy.repeat(boundary, problem.components)
    solution = problem.value(points).ravel()
    inner = stiffness[~fixed][:, ~fixed]
    right = load[~fixed] - stiffness[~fixed][:, fixed] @ solution[fixed]
    facts = {"unknowns": int((~fixed).sum())}
    for name, scale in (("plain", numpy.ones(len(right))), ("scaled", inner.diagonal())):
        x, iterations, seconds, low, high = conjugate_gradients(inner, right, scale)
        facts[name] = {"iterations": iterations, "cpu": seconds, "condition": float(high / low)}
    solution[~fixed] = x
    facts["value_error"], facts["energy_error"] = errors(problem, points, tets, gradients, solution)
    return facts


if __name__ == "__main__":
    for path in sys.argv[1:]:
        points, tets, boundary = read(path)
        print(json.dumps({"tets": len(tets), "vertices": len(points), "poisson": solve(Scalar, points, tets, boundary),
                          "elastic": solve(Elastic, points, tets, boundary)}))
