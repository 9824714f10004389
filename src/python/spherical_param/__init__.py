"""Meshes of point clouds by spherical parameterisation.

    >>> import numpy as np, spherical_param
    >>> points = np.random.default_rng(1).normal(size=(1000, 3))
    >>> points /= np.linalg.norm(points, axis=1, keepdims=True)
    >>> mesh = spherical_param.reconstruct(points)
    >>> mesh.triangles.shape
    (1996, 3)

``reconstruct`` makes a manifold triangle mesh through the points of a cloud, with the parts,
openings and handles that it shows; with ``topology="sphere"`` one closed surface through every
point. A mesh without handles maps to the sphere: ``sphere_map`` makes a map that is one to one and
of low distortion; ``remesh`` samples the surface anew by it, ``morph`` changes it into another:
with ``handles="none"`` also of objects with handles, which are cut. ``texture_coordinates`` lays
any mesh out in the plane. ``find_outliers`` finds points to leave out before, ``find_parts`` the
surfaces of a cloud.

Arrays are NumPy's: points (n, 3) float64, triangles (m, 3) int32, counter-clockwise seen from
outside. All functions let other Python threads run while they work, may be called from several
threads at once, give the same bytes for the same input whatever the number of threads, and end with
KeyboardInterrupt at Ctrl-C. Errors are ``InvalidInput``, a ValueError, ``ComputeError`` and
``Cancelled``.
"""

from . import _errors, _figures, _maps, _morph, _outliers, _results
from ._core import __version__
from ._errors import *
from ._figures import *
from ._maps import *
from ._morph import *
from ._outliers import *
from ._reconstruct import reconstruct
from ._results import *

__all__ = ["__version__", "reconstruct"]
__all__ += _errors.__all__
__all__ += _figures.__all__
__all__ += _maps.__all__
__all__ += _morph.__all__
__all__ += _outliers.__all__
__all__ += _results.__all__
