#!/usr/bin/python3
"""Makes a raw scan out of a clean one: paints its points, and adds points that are far off.

    make_scan.py CLEAN.xyz SCAN.ply [OUTLIERS]      default: 200 outliers

CLEAN.xyz is what pcl_spherical_param_scan writes: a point a line. SCAN.ply is PLY text with
colours, the outliers anywhere between the points. The same input gives the same output.
"""

import math
import random
import sys


def paint(point, low, size):
    """Stripes along the object, from blue to red: something to be seen on a texture."""
    share = [(c - l) / s for c, l, s in zip(point, low, size)]
    stripe = 0.65 if int(12 * share[2]) % 2 else 1.0
    height = share[2]
    color = (0.25 + 0.7 * height, 0.45 + 0.3 * math.sin(math.pi * height), 0.9 - 0.7 * height)
    return [round(255 * stripe * c) for c in color]


def main(arguments):
    if len(arguments) not in (2, 3) or arguments[0] in ("-h", "--help"):
        sys.exit(__doc__.strip())
    with open(arguments[0], encoding="ascii") as file:
        points = [[float(word) for word in line.split()[:3]] for line in file if line.strip()]
    outliers = int(arguments[2]) if len(arguments) == 3 else 200
    low = [min(axis) for axis in zip(*points)]
    size = [max(axis) - l for axis, l in zip(zip(*points), low)]

    dice = random.Random(1)
    for _ in range(outliers):
        # Somewhere in a box that is a fifth larger than the object's.
        far = [l + s * dice.uniform(-0.1, 1.1) for l, s in zip(low, size)]
        points.insert(dice.randrange(len(points)), far)

    with open(arguments[1], "w", encoding="ascii") as file:
        file.write(f"ply\nformat ascii 1.0\nelement vertex {len(points)}\n")
        file.write("".join(f"property float {axis}\n" for axis in "xyz"))
        file.write("".join(f"property uchar {name}\n" for name in ("red", "green", "blue")))
        file.write("end_header\n")
        for point in points:
            color = [min(255, max(0, c)) for c in paint(point, low, size)]
            file.write(" ".join([f"{c:.7g}" for c in point] + [str(c) for c in color]) + "\n")


if __name__ == "__main__":
    main(sys.argv[1:])
