"""Many points at once: their images as arrays, and pictures of them."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from . import _native
from ._camera import Camera
from ._scene import Scene
from ._values import Numbers, array, as_array, quiet_window_system


class Projections(NamedTuple):
    """The images of N points, M in all, point by point."""

    first: npt.NDArray[np.uint64]
    """(N + 1,): the images of point k are those from ``first[k]`` up to, and without, ``first[k + 1]``."""
    images: npt.NDArray[np.float64]
    """(M, 2): column and row of each, pixels; (0, 0) is the upper left corner of the upper left pixel."""
    t: npt.NDArray[np.float64]
    """(M,): the ray parameter at the point."""
    piece: npt.NDArray[np.uint32]
    """(M,): the camera's piece that owns the image."""
    degenerate: npt.NDArray[np.uint8]
    """(N,): 1 where the point is on a slit and a curve of the image shows it, 2 where it is an eye and an area does; else 0."""
    by_kernel: int
    """How many points a kernel finished: their images may be off by ``within_px``."""


class Splat(NamedTuple):
    """What each pixel shows: the nearest point."""

    point: npt.NDArray[np.uint32]
    """(H, W): the point, by its row in `points`; 0xFFFFFFFF where there is none."""
    t: npt.NDArray[np.float64]
    """(H, W): its ray parameter; inf where there is none."""
    colors: npt.NDArray[Any] | None
    """(H, W, C): its row of ``colors``, zeros where there is none; ``None`` without colours."""
    degenerate: int
    """How many points are on a slit or an eye: their curves and areas of images are not drawn."""


def project_many(
    camera: Camera,
    points: Numbers,
    *,
    scene: Scene | None = None,
    size: tuple[int, int] | None = None,
    device: str | None = None,
    within_px: float = 0.0,
) -> Projections:
    """All images of many points as arrays: those of :func:`anamorph.project`, in its order.

    Args:
        camera: the camera.
        points: (N, 3), world units; one that is not finite has no image.
        scene: for cameras that look at the scene, and its size.
        size: width and height of the image, pixels.
        device: ``None``: the CPU; ``""``: the fastest adapter; else a part of an adapter's name. With an adapter, kernels prove where cameras of
            pieces do not show a point. The numbers are the same to the last bit.
        within_px: over 0, images whose place a kernel proves to be within so many pixels are taken from it, with t in float32.

    Raises:
        ValueError: there is no such adapter, the bound is negative, or the camera has a mirror or a lens.
        RuntimeError: the adapter cannot be used.
    """
    own = camera._bind(scene, size)
    with quiet_window_system():
        first, x, y, t, piece, degenerate, by_kernel = _native.project_many(
            own, array(points, np.float64, 3, "points"), device, within_px
        )
    return Projections(first, np.stack([x, y], axis=-1), t, piece, degenerate, by_kernel)


def splat(
    camera: Camera,
    points: Numbers,
    colors: Numbers | None = None,
    *,
    scene: Scene | None = None,
    size: tuple[int, int] | None = None,
    device: str | None = None,
) -> Splat:
    """Draws points: each pixel shows the nearest of those whose images lie in it, by t; of several at one t the one of the lowest row.

    Every image of a point counts. The result is the same on every device.

    Args:
        camera: the camera.
        points: (N, 3), world units.
        colors: (N, C), of any type: what each pixel takes from its point.
        scene: for cameras that look at the scene, and its size.
        size: width and height of the image, pixels.
        device: as of :func:`anamorph.project_many`.

    Raises:
        ValueError: there is no such adapter, ``colors`` has another number of rows, or the camera has a mirror or a lens.
        RuntimeError: the adapter cannot be used.
    """
    own = camera._bind(scene, size)
    places = array(points, np.float64, 3, "points")
    rows = None if colors is None else as_array(colors)
    if rows is not None and (rows.ndim != 2 or len(rows) != len(places)):
        raise ValueError(f"colors: {rows.shape} for {len(places)} points; give an array (N, C)")
    with quiet_window_system():
        point, t, degenerate = _native.splat(own, places, device)
    if rows is None:
        return Splat(point, t, None, degenerate)
    # a row of zeros behind the last one, for pixels without a point
    padded = np.concatenate([rows, np.zeros((1, rows.shape[1]), rows.dtype)])
    return Splat(point, t, padded[np.minimum(point, len(rows))], degenerate)
