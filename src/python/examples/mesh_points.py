"""Meshes the points of a text file: mesh_points.py scan.xyz mesh.ply"""
import sys

import numpy as np
import spherical_param

points = np.loadtxt(sys.argv[1], usecols=(0, 1, 2))  # any array of shape (n, 3) will do
mesh = spherical_param.reconstruct(points)
print(mesh, *mesh.findings, sep="\n")
mesh.write(sys.argv[2])  # .ply by itself, other formats by meshio, trimesh or Open3D
