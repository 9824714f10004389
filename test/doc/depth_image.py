#!/usr/bin/python3
"""Writes what a depth camera sees of a person in a room: one point a pixel, nan where it sees nothing.

    depth_image.py OUT.pcd

The camera looks along z, y points down, lengths are in metres. Noise along the rays grows with the
square of the distance, as that of structured light does.
"""

import pathlib
import sys

import numpy as np

WIDTH, HEIGHT, FOCAL = 320, 240, 270.0
BODY = [  # ellipsoids: center and radii
    ((0.0, -0.22, 1.0), (0.08, 0.11, 0.1)),
    ((0.0, -0.08, 1.02), (0.05, 0.12, 0.05)),
    ((0.0, 0.23, 1.05), (0.22, 0.27, 0.13)),
]


def depths(rays):
    """The least distance along z at which each ray, (n, 3) with z = 1, meets something."""
    nearest = np.full(len(rays), 3.0)  # the wall
    nearest = np.where(rays[:, 1] > 0.0, np.minimum(nearest, 0.6 / np.maximum(rays[:, 1], 1e-9)), nearest)  # the floor
    for center, radii in BODY:
        d, c = rays / radii, np.divide(center, radii)
        a, b = (d * d).sum(axis=1), d @ c
        inside = b * b - a * (c @ c - 1.0)
        met = (b - np.sqrt(np.maximum(inside, 0.0))) / a
        nearest = np.where(inside > 0.0, np.minimum(nearest, met), nearest)
    return nearest


def main(path):
    v, u = np.mgrid[:HEIGHT, :WIDTH].reshape(2, -1)
    rays = np.stack([(u - WIDTH / 2) / FOCAL, (v - HEIGHT / 2) / FOCAL, np.ones(u.size)], axis=1)
    z = depths(rays)
    # Where the depth jumps, the camera sees nothing.
    image = z.reshape(HEIGHT, WIDTH)
    jumps = np.hypot(*np.gradient(image)) > 0.05
    z = np.where(jumps.ravel(), np.nan, z + np.random.default_rng(1).normal(0.0, 0.001, z.size) * z * z)
    head = ("VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n"
            f"WIDTH {WIDTH}\nHEIGHT {HEIGHT}\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {z.size}\nDATA binary\n")  # fmt: skip
    pathlib.Path(path).write_bytes(head.encode() + (rays * z[:, None]).astype("<f4").tobytes())


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]) if len(sys.argv) == 2 else __doc__)
