"""Improves a tetrahedral mesh by Netgen's volume optimiser, for section `improve` of bench/run.

    netgen_improve.py MESH.mesh OUTPUT.msh

MESH is Medit's text format with the boundary's triangles, which stay as they are. Prints the CPU seconds of the optimisation alone.
Writes Gmsh's format 2.2. Netgen (LGPL) runs in this process alone.
"""

import sys
import time

from netgen.meshing import Element2D, Element3D, FaceDescriptor, Mesh, MeshPoint, Pnt


def read_medit(path):
    """Points, tets and triangles, numbered from 1."""
    with open(path) as file:
        words = iter([word for line in file if not line.startswith("#") for word in line.split()])
    found = {"Vertices": [], "Tetrahedra": [], "Triangles": []}
    widths = {"Vertices": 3, "Tetrahedra": 4, "Triangles": 3}
    for word in words:
        if word not in found:
            continue
        for _ in range(int(next(words))):
            row = [next(words) for _ in range(widths[word] + 1)][:-1]
            found[word].append([float(x) for x in row] if word == "Vertices" else [int(x) for x in row])
    return found["Vertices"], found["Tetrahedra"], found["Triangles"]


def main():
    source, target = sys.argv[1:]
    points, tets, triangles = read_medit(source)
    mesh = Mesh()
    numbers = [mesh.Add(MeshPoint(Pnt(*p))) for p in points]
    mesh.SetMaterial(1, "inside")
    face = mesh.Add(FaceDescriptor(surfnr=1, domin=1, domout=0, bc=1))
    for t in triangles:
        mesh.Add(Element2D(face, [numbers[i - 1] for i in t]))
    for t in tets:
        mesh.Add(Element3D(1, [numbers[t[i] - 1] for i in (0, 2, 1, 3)]))
    start = time.process_time()
    mesh.OptimizeVolumeMesh()
    print(time.process_time() - start)
    mesh.Export(target, "Gmsh2 Format")


main()
