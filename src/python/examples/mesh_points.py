"""Meshes the points of a file: mesh_points.py scan.pcd mesh.ply page.html"""
import sys

import spherical_param

mesh = spherical_param.reconstruct(sys.argv[1], progress=True)  # or an array of shape (n, 3)
print(mesh, *mesh.findings, sep="\n")
mesh.write(sys.argv[2])
mesh.report(sys.argv[3])
