"""Measures the Python package beside the C library in one process, in turn; run by section `python` of bench/run under a Python with NumPy.

Prints a line of JSON for each run: what, tets, CPU seconds of the whole process (all threads), wall seconds, the hash of the mesh.
"C library" makes the same calls of the same shared library, with no progress callback, no report in Python and no arrays."""
import ctypes
import json
import sys
import time

import numpy as np

import laves
from laves import _header
from laves._library import lib

BOX = [[-1.2] * 3, [1.2] * 3]
SIZE = 0.0414  # about 500 thousand tets of the unit sphere
calls = [0, 0]


def by_library(make_domain, thread_count, **given):
    options = lib.laves_context_options_default()
    options.thread_count = thread_count
    context = lib.laves_context_create(ctypes.byref(options))
    domain, mesh, wished = ctypes.c_void_p(), ctypes.c_void_p(), lib.laves_options_default()
    for name, value in given.items():
        setattr(wished, name, value)
    result = make_domain(context, ctypes.byref(domain))
    result = result or lib.laves_generate(context, domain, ctypes.byref(wished), ctypes.byref(mesh), None, None)
    if result:
        sys.exit(f"python_calls: result {result}")
    digits = ctypes.create_string_buffer(33)
    facts = lib.laves_mesh_tet_count(mesh), lambda: (lib.laves_mesh_hash(mesh, ctypes.cast(digits, ctypes.c_char_p)), digits.value.decode())[1]
    return facts, lambda: (lib.laves_mesh_free(mesh), lib.laves_domain_free(domain), lib.laves_context_free(context))


def by_package(**given):
    mesh = laves.mesh(**given)
    arrays = mesh.points, mesh.tets, mesh.faces, mesh.face_tags
    return (mesh.tet_count, lambda: mesh.hash), arrays


def timed(what, function):
    calls[:] = [0, 0]
    wall, cpu = time.perf_counter(), time.process_time()
    (tets, digits), keep = function()
    cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
    print(json.dumps({"what": what, "tets": tets, "cpu": cpu, "wall": wall, "hash": digits(), "calls": calls[0], "points": calls[1]}), flush=True)
    if callable(keep):
        keep()


def sphere(levels):
    """A sphere of triangles: an octahedron, divided."""
    points = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], float)
    faces = np.array([[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]])
    for _ in range(levels):
        edges = np.sort(np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
        unique, index = np.unique(edges, axis=0, return_inverse=True)
        ab, bc, ca = index.reshape(3, -1) + len(points)
        middle = points[unique].sum(axis=1)
        points = np.vstack([points, middle / np.linalg.norm(middle, axis=1)[:, None]])
        a, b, c = faces.T
        faces = np.vstack([np.stack(t, 1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    return points, faces


def from_arrays(runs):
    points, faces = sphere(6)
    p, f = np.ascontiguousarray(points), faces.astype(np.uint32)

    def make(context, domain):
        return lib.laves_domain_from_triangles(context, p.ctypes.data_as(ctypes.POINTER(ctypes.c_double)), len(p),
                                               f.ctypes.data_as(ctypes.POINTER(ctypes.c_uint32)), len(f), None, domain, None)

    for _ in range(runs):
        timed("arrays, C library", lambda: by_library(make, 1, size=SIZE))
        timed("arrays, Python", lambda: by_package(source=points, faces=faces, size=SIZE, threads=1))


def ball(points):
    calls[0] += 1
    calls[1] += len(points)
    return np.linalg.norm(points, axis=1) - 1


def from_callable(runs, module):
    field = dict(_header.laves_function._fields_)["evaluate"]
    about = _header.laves_function(ctypes.cast(ctypes.CDLL(module).ball, field), None, tuple(BOX[0]), tuple(BOX[1]), 0)

    def make(context, domain):
        return lib.laves_domain_from_function(context, ctypes.byref(about), domain, None)

    for threads in (1, 2):
        for _ in range(runs):
            timed(f"callable, C callback, {threads}", lambda: by_library(make, threads, size=SIZE))
            timed(f"callable, Python, {threads}", lambda: by_package(source=ball, bounds=BOX, size=SIZE, threads=threads))


from_arrays(int(sys.argv[1]))
from_callable(int(sys.argv[1]), sys.argv[2])
