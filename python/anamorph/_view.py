"""A page in the browser that shows a scene."""

from __future__ import annotations

import os
import webbrowser
from collections.abc import Mapping
from types import TracebackType

from . import _native
from ._scene import Scene
from ._values import Path, Value, assignment, image_size, quiet_window_system, table
from .camera import Camera


class Viewer:
    """A page that shows a scene, as long as this object lives: :func:`view` makes it. A notebook shows it as a frame."""

    #: Where the page is, on this machine.
    address: str
    #: Height of the frame in a notebook, px.
    height: int

    def __init__(self, native: _native.Viewer, height: int) -> None:
        self._native = native
        self.address = native.address
        self.height = height

    def open(self) -> None:
        """Opens the page in the default browser."""
        webbrowser.open(self.address)

    def close(self) -> None:
        """Ends the page."""
        self._native.close()

    def __enter__(self) -> Viewer:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def _repr_html_(self) -> str:
        style = f"width: 100%; height: {self.height}px; border: 0"
        return f'<iframe src="{self.address}" style="{style}" allow="clipboard-write"></iframe>'

    def __repr__(self) -> str:
        return f"Viewer({self.address})"


def view(
    scene: Scene | Path,
    camera: Camera | None = None,
    size: tuple[int, int] | None = None,
    *,
    overrides: Mapping[str, Value] | None = None,
    frame: float = 0,
    port: int = 0,
    height: int = 760,
) -> Viewer:
    """Shows a scene on a page in the browser, to look at and to change: in a notebook as the value of a cell, elsewhere by
    :meth:`Viewer.open`. The page is served on 127.0.0.1 alone, to those who have its address.

    Args:
        scene: a scene file, whose text the page changes and can save; or a scene, as it is now: the page changes a copy of it.
        camera: for a scene: its camera (default: its own).
        size: width and height of the image, pixels (default: the scene's own).
        overrides: for a scene file: values that replace its own, as of :meth:`Scene.load`.
        frame: for a scene file: the frame that is shown first.
        port: the port; 0 for any that is free.
        height: height of the frame in a notebook, px.

    Raises:
        ValueError: the scene or the camera is wrong, or there is no camera.
        OSError: the file cannot be read; ``FileNotFoundError`` if it does not exist.
        RuntimeError: the adapter or the port cannot be used.
    """
    size = image_size(size)
    with quiet_window_system():
        if not isinstance(scene, Scene):
            if camera is not None:
                raise ValueError("a scene file has its own camera; load it by Scene.load to look at it through another one")
            changes = [assignment(key, value) for key, value in (overrides or {}).items()]
            if size is not None:
                changes += [f"image.width={size[0]}", f"image.height={size[1]}"]
            return Viewer(_native.Viewer.of_file(os.fspath(scene), changes, frame, port), height)
        if overrides is not None or frame != 0:
            raise ValueError("overrides and frame go with a scene file; give them to Scene.load")
        keys = None
        if camera is not None and camera._scene is not scene:
            if not camera.kind or camera._rays is not None:
                raise ValueError("this camera was made from arrays or belongs to another scene, so it has no keys to change; make one with anamorph.camera")
            keys = table({"kind": camera.kind, **camera.keys})
        return Viewer(_native.Viewer.of_scene(scene._native, keys, os.getcwd(), size, port), height)
