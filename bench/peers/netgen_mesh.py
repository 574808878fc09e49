"""Fills a closed triangle surface with tetrahedra by Netgen's Python module, for section `peers` of bench/run.

    netgen_mesh.py SURFACE.off SIZE OUTPUT.msh

The triangles are kept as they are; SIZE is Netgen's maxh. Everything else is Netgen's default, optimisation included. Writes Gmsh's format
2.2. Netgen (LGPL) runs in this process alone.
"""

import sys

from netgen.meshing import Element2D, FaceDescriptor, Mesh, MeshingParameters, MeshPoint, Pnt


def read_off(path):
    with open(path) as file:
        words = file.read().split()
    points, triangles = int(words[1]), int(words[2])
    at = [float(w) for w in words[4:4 + 3 * points]]
    corners = [int(w) for w in words[4 + 3 * points:]]
    return ([at[3 * i:3 * i + 3] for i in range(points)], [corners[4 * i + 1:4 * i + 4] for i in range(triangles)])


def main():
    source, size, target = sys.argv[1], float(sys.argv[2]), sys.argv[3]
    points, triangles = read_off(source)
    mesh = Mesh()
    numbers = [mesh.Add(MeshPoint(Pnt(*p))) for p in points]
    mesh.SetMaterial(1, "inside")
    face = mesh.Add(FaceDescriptor(surfnr=1, domin=1, domout=0, bc=1))
    for t in triangles:
        mesh.Add(Element2D(face, [numbers[i] for i in t]))
    mesh.GenerateVolumeMesh(mp=MeshingParameters(maxh=size))
    mesh.Export(target, "Gmsh2 Format")


main()
