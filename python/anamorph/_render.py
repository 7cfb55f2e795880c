"""Rendering, on a device or by the reference on the CPU."""

from __future__ import annotations

import json
import os
import threading
import warnings
from collections.abc import Iterable, Sequence
from types import TracebackType
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from . import _native
from ._frame import Comparison, Frame, Views
from ._gradients import Gradients, _gradients
from ._scene import Scene
from ._values import Numbers, array, quiet_window_system
from .camera import Camera

NO_DRIVER = (
    "no Vulkan, Metal or DirectX 12 adapter: pictures come from the reference on the CPU, which is slow. "
    "A driver for the CPU is far faster (Debian, Ubuntu: apt-get install mesa-vulkan-drivers)"
)

FORKED = (
    "this process was forked from one that had opened a device, which not every driver survives; start processes by "
    'multiprocessing.get_context("spawn"), or open the first renderer in them'
)


class Renderer:
    """A device with a scene on it: what does not change from image to image stays there.

    Args:
        scene: what is rendered; scenes may also be given to :meth:`render`.
        adapter: a part of an adapter's name; without it the fastest kind is taken. Without any adapter, and after one warning, the
            reference renders, in float64 on the CPU, slowly.
        reference: render by the reference in any case.

    A renderer can be pickled, with its scene and camera. In another process, forked or not, it opens a device of that process at its first
    use there.

    Raises:
        ValueError: there is no such adapter.
        RuntimeError: the adapter cannot be used.
    """

    scene: Scene | None
    camera: Camera | None
    _device: _native.Renderer
    #: The process that opened the device; 0: none has.
    _process: int

    def __init__(self, scene: Scene | None = None, adapter: str | None = None, reference: bool = False) -> None:
        self._named, self._reference = adapter, reference
        self.scene = scene
        self.camera = None
        self._process = 0
        self._open(stacklevel=3)

    @property
    def _native(self) -> _native.Renderer:
        """The device of this process."""
        if self._process != os.getpid():
            self._open(stacklevel=4)
        return self._device

    def _open(self, stacklevel: int) -> None:
        try:
            with quiet_window_system():
                self._device = _native.Renderer(self._named, self._reference)
        except RuntimeError as error:
            if self._process == 0:
                raise
            raise RuntimeError(f"{error}; {FORKED}") from None
        self._process = os.getpid()
        if self._device.adapter is None and not self._reference:
            warnings.warn(NO_DRIVER, RuntimeWarning, stacklevel=stacklevel)

    def __getstate__(self) -> dict[str, Any]:
        return {**{name: value for name, value in self.__dict__.items() if name != "_device"}, "_process": 0}

    @property
    def adapter(self) -> str | None:
        """The adapter's name; ``None`` if the reference renders."""
        return self._native.adapter

    def aim(self, camera: Camera) -> None:
        """Sets the camera of the images to come."""
        self.camera = camera

    def move(self, mesh: str, matrix: Numbers) -> None:
        """:meth:`Scene.move` of the renderer's scene."""
        self._scene().move(mesh, matrix)

    def update(self, mesh: str, vertices: Numbers) -> None:
        """:meth:`Scene.update` of the renderer's scene."""
        self._scene().update(mesh, vertices)

    def _scene(self) -> Scene:
        if self.scene is None:
            raise ValueError("there is no scene; give one")
        return self.scene

    def render(
        self,
        channels: Sequence[str] | None = None,
        size: tuple[int, int] | None = None,
        samples: int = 1,
        analytic: bool = False,
        *,
        scene: Scene | None = None,
        camera: Camera | None = None,
    ) -> Frame:
        """Renders an image.

        Args:
            channels: names, such as ``["Z", "triangle.id"]``; without any, those of the camera, and colour.
            size: width and height, pixels; that of the scene file, or of the camera, where it has one.
            samples: rays per pixel, 1 to 64. Colour and coverage are averaged; other channels use the pixel's centre.
            analytic: weight triangles by their visible area in the pixel, not by the number of samples that see them.
            scene: instead of the renderer's.
            camera: instead of the one that was aimed; without any, that of the scene file.

        Raises:
            ValueError: the scene, the camera and the rest cannot be combined; there is no camera, size or such channel.
            RuntimeError: memory does not suffice, or the device is lost.
        """
        scene = scene or self._scene()
        aimed = camera or self.camera or scene.camera
        if aimed is None:
            raise ValueError("there is no camera; give one")
        own = aimed._bind(scene, size)
        names, color = _wanted(own, channels)
        planes, rgba, report = self._native.render(scene._native, own, names, color, samples, analytic)
        return Frame(dict(planes), rgba, report)

    def render_many(
        self,
        cameras: Iterable[Camera],
        channels: Sequence[str] | None = None,
        size: tuple[int, int] | None = None,
        samples: int = 1,
        analytic: bool = False,
        *,
        scene: Scene | None = None,
    ) -> Views:
        """Renders an image through each camera, all in one frame where they fit and where that is faster than a frame for each.

        On a CPU adapter of two cores, scenes of 6,400 to 100,000 triangles and cameras that have all moved, a call for each takes 1.0 to 4.2
        times as long for pinholes of 64 x 64 pixels, 1.7 to 1.9 for 256 x 256, and 1.0 to 1.4 for 512 x 512; for fisheyes 1.9 or more for
        64 x 64, and 0.8 to 1.9 for 128 x 128.

        Triangles and pieces are those of :meth:`render`; ``t`` and ``Z`` may differ in the last bit, and ``certified`` where a bound is close.
        Positions, normals, texture coordinates and colours may be off by some 2^-24 of the distance from the camera in the middle. Cameras
        with mirrors, lenses or curved rays, or of unlike kinds, are rendered one after another, each exactly as by :meth:`render`, as are
        cameras with a ray for each pixel, such as fisheyes, above 128 x 128 pixels; the report's ``left_out`` then says why.

        Args:
            cameras: one for each image; their images have one size.
            channels, size, samples, analytic, scene: as of :meth:`render`.

        Raises:
            ValueError: there is no camera, or the images differ in size; and what :meth:`render` raises.
            RuntimeError: memory does not suffice, or the device is lost.
        """
        scene = scene or self._scene()
        own = [camera._bind(scene, size) for camera in cameras]
        if not own:
            raise ValueError("there is no camera; give one or more")
        names, color = _wanted(own[0], channels)
        planes, rgba, report = self._native.render_many(scene._native, own, names, color, samples, analytic)
        return Views(dict(planes), rgba, report)

    def gradients(
        self,
        quantities: Sequence[str],
        of: Sequence[str] = ("vertices",),
        size: tuple[int, int] | None = None,
        *,
        scene: Scene | None = None,
        camera: Camera | None = None,
    ) -> Gradients:
        """How what each pixel shows changes with the corners of its triangle, and with numbers of the camera.

        Args:
            quantities: ``"depth"`` (Z), ``"t"``, ``"position"``, ``"barycentrics"``, ``"coverage"``.
            of: ``"vertices"``, and numbers of the camera's keys, such as ``"camera.fov"`` or ``"camera.eye.0"``, or of its calibration
                file, such as ``"camera.fx"`` or ``"camera.k1"``.
            size, scene, camera: as of :meth:`render`.

        Raises:
            ValueError: an unknown name, a number that the camera has not or that its rays do not change smoothly with, or a scene and a
                camera without gradients.
            RuntimeError: memory does not suffice, or the device is lost.
        """
        scene = scene or self._scene()
        aimed = camera or self.camera or scene.camera
        if aimed is None:
            raise ValueError("there is no camera; give one")
        return _gradients(*self._native.gradients(scene._native, aimed._bind(scene, size), list(quantities), list(of)))

    def __enter__(self) -> Renderer:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.scene = self.camera = None


def _wanted(camera: _native.Camera, channels: Sequence[str] | None) -> tuple[list[str], bool]:
    """The names of the channels, and whether colour is wanted."""
    if isinstance(channels, str):
        raise ValueError(f'channels: a list of names is needed, as in ["{channels}"], not the text {channels!r}')
    names = list(camera.channels if channels is None else channels)
    return names, channels is None or any(name in ("R", "G", "B") for name in names)


_default: Renderer | None = None
_opening = threading.Lock()


def _forked() -> None:
    """Another thread of the parent may have held the lock; it is not in this process."""
    global _opening
    _opening = threading.Lock()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forked)


def _renderer() -> Renderer:
    """The renderer of calls that name none: opened once."""
    global _default
    with _opening:
        if _default is None:
            _default = Renderer()
        return _default


def render(
    scene: Scene,
    camera: Camera | None = None,
    size: tuple[int, int] | None = None,
    channels: Sequence[str] | None = None,
    samples: int = 1,
    analytic: bool = False,
) -> Frame:
    """Renders an image on the machine's fastest adapter, which stays open for the next call; arguments as of :meth:`Renderer.render`."""
    return _renderer().render(channels, size, samples, analytic, scene=scene, camera=camera)


def gradients(
    scene: Scene,
    camera: Camera | None,
    quantities: Sequence[str],
    of: Sequence[str] = ("vertices",),
    size: tuple[int, int] | None = None,
) -> Gradients:
    """How an image changes with the corners of its triangles, and with numbers of its camera; arguments as of :meth:`Renderer.gradients`.

    >>> import anamorph as am
    >>> scene = am.Scene()
    >>> scene.add_builtin("icosphere")
    >>> camera = am.camera.fisheye(eye=[0, 0, 3], target=[0, 0, 0], fov=60)
    >>> found = am.gradients(scene, camera, ["depth"], ["vertices", "camera.fov"], size=(48, 32))
    >>> found["depth.vertices"].shape, found["depth.camera"].shape
    ((32, 48, 3, 3), (32, 48, 1))
    """
    return _renderer().gradients(quantities, of, size, scene=scene, camera=camera)


def check(scene: Scene, camera: Camera | None, frame: Frame) -> Comparison:
    """How a frame differs from the reference, which finds each pixel's triangle in float64 on the CPU.

    ``wrong_safe`` counts the wrong pixels among the safe ones, whose answer is the same within 1/16 pixel of their centre: it is 0.
    """
    height, width = frame.shape
    seen_by = camera or scene.camera
    if seen_by is None:
        raise ValueError("there is no camera; give one")
    own = seen_by._bind(scene, (width, height))
    return Comparison(json.loads(_native.check(scene._native, own, list(frame.items()))))


class Projection(NamedTuple):
    """Where a camera shows a point."""

    images: npt.NDArray[np.float64]
    """(K, 2): column and row of each image, pixels; (0, 0) is the upper left corner of the upper left pixel."""
    t: npt.NDArray[np.float64]
    """(K,): the ray parameter at the point."""
    piece: npt.NDArray[np.uint32]
    """(K,): the camera's piece that owns the image."""
    degenerate: str | None
    """Why a whole curve of pixels shows the point (it lies on a slit, or is an eye); else ``None``."""


def project(
    scene: Scene | None, camera: Camera, points: Numbers, size: tuple[int, int] | None = None
) -> list[Projection]:
    """All images of each point: every place whose ray, or curve, passes through it.

    Args:
        scene: for cameras that look at the scene, and its size; else ``None``.
        camera: the camera.
        points: (N, 3), world units.
        size: width and height of the image, pixels.

    Raises:
        ValueError: the camera has a mirror or a lens.
    """
    own = camera._bind(scene or Scene(), size)
    found = _native.project(own, array(points, np.float64, 3, "points"))
    return [
        Projection(
            np.array([p[:2] for p in places], dtype=np.float64).reshape(-1, 2),
            np.array([p[2] for p in places], dtype=np.float64),
            np.array([p[3] for p in places], dtype=np.uint32),
            degenerate,
        )
        for places, degenerate in found
    ]


