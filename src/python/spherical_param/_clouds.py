"""What a cloud may be given as, with its normals and colours."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Any, Optional, Protocol, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arguments as arguments
from . import _core
from ._arguments import ByteArray, FloatArray, IndexArray
from ._errors import InvalidInput
from ._progress import ProgressFunction


class HasPoints(Protocol):
    """A point cloud of Open3D."""

    @property
    def points(self) -> Any: ...

class HasVertices(Protocol):
    """A mesh of Open3D, or a point cloud or mesh of trimesh."""

    @property
    def vertices(self) -> Any: ...

#: An array, a file, or a cloud of another library.
CloudLike = Union[ArrayLike, os.PathLike[str], HasPoints, HasVertices]


@dataclass(frozen=True, eq=False)
class Cloud:
    """Points and what belongs to each of them."""

    points: FloatArray  #: (n, 3): the caller's own array, if it is one
    normals: Optional[FloatArray]  #: (n, 3)
    colors: Optional[ByteArray]  #: (n, 3)
    name: Optional[str] = None  #: of the file
    viewpoint: Optional[list[float]] = None  #: of the sensor, if the file says it
    unused: Optional[IndexArray] = None  #: rows in no face of the file
    scalars: dict[str, FloatArray] = field(default_factory=dict)  #: (n,) other numbers of the file

    @property
    def info(self) -> dict[str, Any]:
        """What the core may know besides the points."""
        return {"normals": self.normals, "viewpoint": self.viewpoint, "unused": self.unused}


def read(name: str, value: Any, progress: Optional[ProgressFunction] = None, columns: Optional[str] = None) -> Cloud:
    """The cloud that a caller gave as ``name``."""
    if isinstance(value, (str, bytes, os.PathLike)):
        fields = _core.read_cloud(os.fsencode(value), columns=columns, progress=progress)
        return Cloud(**fields, name=os.fsdecode(value))
    if columns is not None:
        raise InvalidInput(f"columns are of a file, which {name} is not; leave them out")
    libraries = {base.__module__.partition(".")[0] for base in type(value).__mro__}
    if "open3d" in libraries:
        return _of_open3d(name, value)
    if "trimesh" in libraries:
        visual: Any = getattr(value, "visual", None)
        has_colors = getattr(visual, "kind", None) == "vertex"
        return _cloud(name, value.vertices, None, visual.vertex_colors if has_colors else None)
    if isinstance(value, np.ndarray) and value.dtype.names is not None:
        return _of_fields(name, value)
    return Cloud(arguments.positions(name, value), None, None)


def _of_open3d(name: str, value: Any) -> Cloud:
    if hasattr(value, "to_legacy"):  # tensors
        value = value.to_legacy()
    if hasattr(value, "points"):
        return _cloud(name, value.points, value.normals, value.colors)
    if hasattr(value, "vertices"):
        return _cloud(name, value.vertices, value.vertex_normals, value.vertex_colors)
    raise InvalidInput(f"{name} is a {type(value).__name__} of Open3D; give a point cloud")


def _of_fields(name: str, value: NDArray[Any]) -> Cloud:
    known = value.dtype.names or ()
    stack: Any = np.ma.column_stack if isinstance(value, np.ma.MaskedArray) else np.column_stack

    def columns(*choices: tuple[str, str, str]) -> Any:
        for fields in choices:
            if all(field in known for field in fields):
                return stack([value[field].ravel() for field in fields])
        return None

    points = columns(("x", "y", "z"))
    if points is None:
        raise InvalidInput(
            f"{name} is a structured array with the fields {', '.join(known)}; give one with x, y and z"
        )
    colors = columns(("red", "green", "blue"), ("r", "g", "b"))
    packed = next((field for field in ("rgb", "rgba") if field in known), None)
    if colors is None and packed is not None and value.dtype[packed].itemsize == 4:
        # As PCL packs them, in the bytes of one number.
        numbers = np.asarray(value[packed]).ravel()
        bits = numbers.astype(numbers.dtype.newbyteorder("=")).view(np.uint32)
        colors = np.column_stack([(bits >> shift) & 255 for shift in (16, 8, 0)])
    normals = columns(("nx", "ny", "nz"), ("normal_x", "normal_y", "normal_z"))
    return _cloud(name, points, normals, colors)


def _cloud(name: str, points: Any, normals: Any, colors: Any) -> Cloud:
    """A cloud of arrays; normals and colours may be None or empty."""
    array = arguments.positions(name, points)
    directions = None if normals is None or len(normals) == 0 else np.asarray(normals)
    shades = None if colors is None or len(colors) == 0 else np.asarray(colors)[:, :3]
    for what, rows in (("normals", directions), ("colours", shades)):
        if rows is not None and rows.shape != array.shape:
            raise InvalidInput(
                f"{name} has {what} of the shape {rows.shape} for points of the shape "
                f"{array.shape}; give one row for each point"
            )
    normal_rows = None if directions is None else arguments.positions("normals", directions)
    return Cloud(array, normal_rows, None if shades is None else _bytes(name, shades))


def _bytes(name: str, colors: NDArray[Any]) -> ByteArray:
    """Integers are 0 to 255, real numbers 0 to 1."""
    most = 1 if colors.dtype.kind == "f" else 255
    if colors.dtype.kind not in "fiu" or not ((colors >= 0) & (colors <= most)).all():
        raise InvalidInput(
            f"{name} has colours of {colors.dtype} out of range; give integers from 0 to 255, or "
            "real numbers from 0 to 1"
        )
    return np.ascontiguousarray(np.rint(colors * (255 / most)), dtype=np.uint8)
