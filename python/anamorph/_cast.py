"""Rays from anywhere against a scene, exactly."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from . import _native
from ._scene import Scene
from ._values import Numbers, as_array

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Bools = npt.NDArray[np.bool_]


class Hits(NamedTuple):
    """What rays meet: an entry a ray, in the shape of the rays; with ``all=True`` an entry a hit, in the order of the rays and along each."""

    t: Floats
    """The hit is at ``origin + t * direction``, to within 2^-40 of t; infinite for a miss."""
    triangle: Ints
    """The id of the triangle or sphere in the scene, as in the channel ``triangle.id``; -1 for a miss."""
    mesh: Ints
    """The mesh that it is of, by its place in ``scene.objects``; -1 for a miss."""
    bary: Floats
    """(..., 2): weights of the triangle's second and third vertex; 0 of a sphere, NaN for a miss."""
    point: Floats
    """(..., 3): where on the triangle or sphere, world units; NaN for a miss."""
    normal: Floats
    """(..., 3): the triangle's unit normal, from where its vertices are counter-clockwise; of a sphere that outwards; NaN for a miss."""
    certified: Bools
    """Nothing was rounded in finding the triangle, or that there is none. So it is unless a coordinate is smaller than 1e-30 and not 0, or
    larger than 1e30; in a scene with spheres, 1e-12 and 1e24, of radii too."""
    ray: Ints
    """The ray's number, from 0 through all rays in their order."""


def cast(
    scene: Scene,
    origins: Numbers,
    directions: Numbers,
    t_range: tuple[float, float] = (0.0, math.inf),
    all: bool = False,
) -> Hits:
    """Finds what rays ``origin + t * direction`` meet, on all cores of the CPU.

    The triangles that a ray meets, and their order, are found without rounding. A ray that goes into a closed mesh, or out of it, through an
    edge or a vertex meets one triangle there; one that only touches it meets none, or two at the same t. It meets what it would meet if its
    origin were moved by (e, e**2, e**3), for an e smaller than all numbers. Of triangles at the same t the one of the lowest id comes first. A ray in a triangle's plane does not meet
    it; what a one-sided triangle shows at its back, or an alpha mask leaves out, is not met. A sphere is met where the ray enters it and,
    unless it is one-sided, where it leaves it; a ray that touches it does both at one t.

    The first call for a scene indexes its triangles, as does the first after a change of it.

    Args:
        scene: the triangles and spheres.
        origins: (..., 3), world units.
        directions: (..., 3), of any length; one for all rays may be given, as one origin may.
        t_range: least and largest t, both included.
        all: every hit, not only the first.

    Raises:
        ValueError: the shapes do not fit; a number is not finite, or a direction is 0.
    """
    from_, along, shape = _rays(origins, directions)
    ends = [float(t_range[0]), float(t_range[1])]
    if all:
        columns, counts, certain = _native.cast_all(scene._native, from_, along, ends)
        ray: Ints = np.repeat(np.arange(len(counts)), counts)
        return Hits(*columns, certain[ray], ray)
    columns, certain = _native.cast(scene._native, from_, along, ends)
    every: list[npt.NDArray[Any]] = [*columns, certain, np.arange(len(certain))]
    return Hits(*(column.reshape(shape + column.shape[1:]) for column in every))


class RayCaster:
    """A scene, or a mesh, with the methods of trimesh's ``mesh.ray``, so that it can stand in its place.

    >>> mesh.ray = am.RayCaster(mesh)  # doctest: +SKIP

    Rays begin at t = 0. Indices of triangles are those of the mesh's faces.

    Args:
        scene: a :class:`Scene`, or what :meth:`Scene.add` takes as a mesh.
    """

    scene: Scene

    def __init__(self, scene: Any) -> None:
        if not isinstance(scene, Scene):
            mesh, scene = scene, Scene()
            # rays see no colours, so that none can be left out
            scene.add(mesh, color=[1, 1, 1])
        self.scene = scene

    def intersects_first(self, ray_origins: Numbers, ray_directions: Numbers) -> Ints:
        """(N,): the first triangle that each ray meets; -1 for none."""
        return cast(self.scene, ray_origins, ray_directions).triangle

    def intersects_any(self, ray_origins: Numbers, ray_directions: Numbers) -> Bools:
        """(N,): whether each ray meets a triangle."""
        from_, along, shape = _rays(ray_origins, ray_directions)
        met: Bools = _native.meets_any(self.scene._native, from_, along, [0.0, math.inf])
        return met.reshape(shape)

    def intersects_id(
        self,
        ray_origins: Numbers,
        ray_directions: Numbers,
        return_locations: bool = False,
        multiple_hits: bool = True,
    ) -> tuple[Ints, Ints] | tuple[Ints, Ints, Floats]:
        """Triangles and the rays that meet them, (H,) each; with ``return_locations`` where, too, (H, 3)."""
        hits = self._hits(ray_origins, ray_directions, multiple_hits)
        return (hits.triangle, hits.ray, hits.point) if return_locations else (hits.triangle, hits.ray)

    def intersects_location(
        self, ray_origins: Numbers, ray_directions: Numbers, multiple_hits: bool = True
    ) -> tuple[Floats, Ints, Ints]:
        """Where rays meet triangles, (H, 3), the rays and the triangles, (H,) each."""
        hits = self._hits(ray_origins, ray_directions, multiple_hits)
        return hits.point, hits.ray, hits.triangle

    def contains_points(self, points: Numbers) -> Bools:
        """(N,): whether each point is inside of a closed mesh, two-sided as meshes are by default: a ray from it meets an odd number of triangles."""
        upward = cast(self.scene, points, [0.0, 0.0, 1.0], all=True)
        counts = np.bincount(upward.ray, minlength=as_array(points).reshape(-1, 3).shape[0])
        odd: Bools = counts % 2 == 1
        return odd

    def _hits(self, origins: Numbers, directions: Numbers, multiple: bool) -> Hits:
        hits = cast(self.scene, origins, directions, all=multiple)
        if multiple:
            return hits
        columns: list[npt.NDArray[Any]] = [column[hits.triangle >= 0] for column in hits]
        return Hits(*columns)


def _rays(origins: Numbers, directions: Numbers) -> tuple[Floats, Floats, tuple[int, ...]]:
    """Origins and directions, (N, 3) each, and the shape that they are given in."""
    given = [as_array(values) for values in (origins, directions)]
    for name, values in zip(("origins", "directions"), given):
        if values.ndim < 1 or values.shape[-1] != 3:
            raise ValueError(f"{name}: an array of shape (..., 3) is needed, not {values.shape}")
        if not np.issubdtype(values.dtype, np.number) or np.issubdtype(values.dtype, np.complexfloating):
            raise TypeError(f"{name}: numbers are needed, not {values.dtype}")
    try:
        shape = np.broadcast_shapes(given[0].shape, given[1].shape)
    except ValueError:
        shapes = " and ".join(str(values.shape) for values in given)
        raise ValueError(f"origins and directions have the shapes {shapes}; give as many of one as of the other, or one") from None
    from_, along = (np.broadcast_to(values, shape).reshape(-1, 3).astype(np.float64, copy=False) for values in given)
    return from_, along, shape[:-1]
