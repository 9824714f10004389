"""The part of spherical_param that is in C++; use the package's own functions."""

from typing import Any, Callable, Optional

import numpy as np
from numpy.typing import NDArray

__version__: str
has_report: bool

def option_table() -> list[dict[str, Any]]: ...
def result_table() -> list[dict[str, Any]]: ...
def reconstruct(
    points: NDArray[np.float64],
    options: dict[str, object],
    *,
    normals: Optional[NDArray[np.float64]],
    viewpoint: Optional[list[float]],
    unused: Optional[NDArray[np.int32]],
    details: bool,
    progress: Optional[Callable[[str, float], object]],
) -> dict[str, Any]: ...
def read_cloud(
    path: bytes,
    *,
    columns: Optional[str],
    progress: Optional[Callable[[str, float], object]],
) -> dict[str, Any]: ...
def write_mesh(
    path: bytes,
    points: NDArray[np.float64],
    triangles: NDArray[np.int32],
    normals: Optional[NDArray[np.float64]],
    colors: Optional[NDArray[np.uint8]],
    added: Optional[NDArray[np.uint8]],
    scalars: dict[str, NDArray[np.float64]],
    offset: Optional[tuple[float, float, float]],
) -> list[float]: ...
def write_report(
    path: bytes,
    points: NDArray[np.float64],
    colors: Optional[NDArray[np.uint8]],
    options: dict[str, object],
    *,
    normals: Optional[NDArray[np.float64]],
    viewpoint: Optional[list[float]],
    unused: Optional[NDArray[np.int32]],
    part: int,
    input: str,
    command: str,
    progress: Optional[Callable[[str, float], object]],
) -> None: ...
def morph(
    first: tuple[Any, ...],
    second: tuple[Any, ...],
    *,
    pairs: NDArray[np.int32],
    align: bool,
    connectivity: str,
    samples: int,
    fit: str,
    threads: int,
    progress: Optional[Callable[[str, float], object]],
) -> dict[str, Any]: ...
def find_outliers(
    points: NDArray[np.float64],
    options: dict[str, object],
    *,
    progress: Optional[Callable[[str, float], object]],
) -> NDArray[np.int32]: ...
def find_parts(
    points: NDArray[np.float64],
    options: dict[str, object],
    *,
    progress: Optional[Callable[[str, float], object]],
) -> tuple[NDArray[np.int32], ...]: ...
def sphere_map(
    points: NDArray[np.float64],
    triangles: NDArray[np.int32],
    sphere: NDArray[np.float64],
    *,
    area_weight: float,
    sweeps: int,
    threads: int,
    progress: Optional[Callable[[str, float], object]],
) -> dict[str, Any]: ...
def measure_map_distortion(
    points: NDArray[np.float64],
    triangles: NDArray[np.int32],
    sphere: NDArray[np.float64],
    *,
    threads: int,
) -> dict[str, Any]: ...
def remesh(
    points: NDArray[np.float64],
    triangles: NDArray[np.int32],
    sphere: NDArray[np.float64],
    *,
    caps: NDArray[np.float64],
    grid: str,
    count: int,
    fit: str,
    seed: int,
    threads: int,
    progress: Optional[Callable[[str, float], object]],
) -> dict[str, Any]: ...
def texture_coordinates(
    points: Optional[NDArray[np.float64]],
    triangles: NDArray[np.int32],
    sphere: NDArray[np.float64],
    *,
    chart: str,
    margin: float,
) -> dict[str, Any]: ...
