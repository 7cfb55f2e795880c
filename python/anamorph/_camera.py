"""A camera: its kind, and the values of its keys."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from . import _native
from ._values import Value, image_size, plain, table

if TYPE_CHECKING:
    from ._scene import Scene

Vectors = npt.NDArray[np.float64]


class CompiledRays(NamedTuple):
    """Rays of arrays as they were when their camera was made, compiled once."""

    native: _native.Camera
    t_range: tuple[float, float]

    @staticmethod
    def of(origins: Vectors, directions: Vectors, t_range: tuple[float, float]) -> CompiledRays:
        return CompiledRays(_native.Camera.of_rays(origins, directions, t_range), t_range)

    def __reduce__(self) -> tuple[Any, ...]:
        return CompiledRays.of, (*self.native.rays(), self.t_range)

    def equals(self, other: CompiledRays) -> bool:
        pairs = zip(self.native.rays(), other.native.rays())
        return self.t_range == other.t_range and all(np.array_equal(a, b, equal_nan=True) for a, b in pairs)


class Camera:
    """A camera for images of any size: one function of :mod:`anamorph.camera` for each kind makes it."""

    kind: str
    keys: dict[str, Value]
    _rays: CompiledRays | None
    _scene: Scene | None

    def __init__(self, kind: str, keys: Mapping[str, Value]) -> None:
        self.kind = kind
        self.keys = {key: value for key, value in keys.items() if value is not None}
        self._rays = None
        self._scene = None

    @classmethod
    def _of_scene(cls, scene: Scene) -> Camera:
        camera = cls("", {})
        camera._scene = scene
        return camera

    def with_(self, **changes: Value) -> Camera:
        """The same camera with other values of some keys; ``None`` takes a key out.

        >>> import anamorph as am
        >>> am.camera.pinhole(eye=[0, 0, 4], target=[0, 0, 0], vfov=40).with_(vfov=20).keys["vfov"]
        20
        """
        if self._rays is not None or not self.kind:
            raise ValueError("this camera has no keys; make it anew")
        return Camera(self.kind, {**self.keys, **changes})

    def rays(self, size: tuple[int, int] | None = None, scene: Scene | None = None) -> tuple[Vectors, Vectors]:
        """Origins P and directions D of the rays P + t D through the pixels' centres.

        Args:
            size: width and height, pixels; cameras of rays have their own.
            scene: for cameras that look at the scene.

        Returns:
            Two (H, W, 3) arrays, world axes and units; NaN where a pixel has no ray. Of a curved ray it is the chord.
        """
        return self._bind(scene, size).rays()

    def piece_count(self, size: tuple[int, int], scene: Scene | None = None) -> int:
        """Number of pieces (general linear cameras, or pieces of curves) of an image of this size; 0 if each pixel has its own ray."""
        return self._bind(scene, size).piece_count

    def _bind(self, scene: Scene | None, size: tuple[int, int] | None) -> _native.Camera:
        size = image_size(size)
        own = _native.Scene() if scene is None else scene._native
        if self._rays is not None:
            own_rays = self._rays.native
            width, height = own_rays.width, own_rays.height
            if size is not None and size != (width, height):
                raise ValueError(f"the camera's rays are {width}x{height}, not {size[0]}x{size[1]}; leave the size out")
            return own_rays
        if self._scene is not None:
            return _native.Camera.of_scene(self._scene._native, size)
        return _native.Camera.of_table(table({"kind": self.kind, **self.keys}), os.getcwd(), own, size)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Camera):
            return NotImplemented
        if self._rays is None or other._rays is None:
            own, their = [(c.kind, {k: plain(v, k) for k, v in c.keys.items()}) for c in (self, other)]
            return self._rays is other._rays and self._scene is other._scene and own == their
        return self._rays.equals(other._rays)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        keys = ", ".join(f"{key}={value!r}" for key, value in self.keys.items())
        return f"<anamorph.Camera {self.kind or 'of the scene file'}{': ' if keys else ''}{keys}>"


def colmap_images(folder: str | os.PathLike[str]) -> list[str]:
    """The names of the images of a COLMAP model, in order: values of ``image`` for :func:`anamorph.camera.calibrated`.

    Args:
        folder: has ``cameras`` and ``images``, as ``.bin`` or ``.txt``; or a file with images, such as ``transforms.json``.

    Raises:
        OSError: the file of images cannot be read.
        ValueError: it has no images.
    """
    return _native.colmap_images(os.fspath(folder))
