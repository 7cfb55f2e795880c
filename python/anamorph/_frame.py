"""Rendered images as arrays."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Mapping
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from . import _native
from ._values import Path



class _NoId(int):
    """``NO_ID``, 4294967295 (0xFFFFFFFF): the id where nothing is hit, in channels of ids such as ``triangle.id``.

    ``frame.ids == am.NO_ID`` finds the pixels that show nothing. Of hits of :func:`anamorph.cast`, which are signed, it is -1 instead.
    """


NO_ID: int = _NoId(0xFFFFFFFF)

Plane = Union[npt.NDArray[np.float32], npt.NDArray[np.uint32]]


class _Channels(Mapping[str, Plane]):
    """Channels by their names, colour, and a report."""

    _planes: dict[str, Plane]
    _rgba: npt.NDArray[np.uint8] | None
    _report: Callable[[], str] | str

    def __init__(
        self,
        planes: Mapping[str, Plane],
        rgba: npt.NDArray[np.uint8] | None = None,
        report: Callable[[], str] | str = "{}",
    ) -> None:
        self._planes = dict(planes)
        self._rgba = rgba
        self._report = report

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_report": self._json()}

    def _json(self) -> str:
        if not isinstance(self._report, str):
            self._report = self._report()
        return self._report

    def __getitem__(self, name: str) -> Plane:
        if name in self._planes:
            return self._planes[name]
        try:
            parts = _native.channels_named(name)
        except ValueError as unknown:
            raise KeyError(str(unknown)) from None
        missing = [part for part in parts if part not in self._planes]
        if missing:
            raise KeyError(f"{', '.join(missing)}: not rendered; there are {', '.join(self._planes)}")
        # of several channels all are float32
        stacked: npt.NDArray[np.float32] = np.stack([self._planes[part] for part in parts], axis=-1).astype(np.float32, copy=False)
        return stacked

    def __iter__(self) -> Iterator[str]:
        return iter(self._planes)

    def __len__(self) -> int:
        return len(self._planes)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, type(self)):
            return NotImplemented
        same = (np.array_equal(self[name], other[name], equal_nan=True) for name in self if name in other)
        return list(self) == list(other) and all(same)

    __hash__ = None  # type: ignore[assignment]

    def _any(self) -> npt.NDArray[Any]:
        return self._rgba[..., 0] if self._rgba is not None else next(iter(self._planes.values()))

    @property
    def rgb(self) -> npt.NDArray[np.uint8]:
        """(..., H, W, 3): 8-bit sRGB colour."""
        return self.rgba[..., :3]

    @property
    def rgba(self) -> npt.NDArray[np.uint8]:
        """(..., H, W, 4): 8-bit sRGB colour; the fourth is coverage."""
        if self._rgba is None:
            raise KeyError("rendered without colour; ask for channels R, G and B, or for none")
        return self._rgba

    @property
    def ids(self) -> npt.NDArray[np.uint32]:
        """(..., H, W): the triangle that each pixel shows; :data:`NO_ID` for none."""
        return self["triangle.id"].view(np.uint32)

    @property
    def report(self) -> dict[str, Any]:
        """Times and counts, as the program's ``--report`` writes them."""
        report: dict[str, Any] = json.loads(self._json())
        return report


class Frame(_Channels):
    """The channels of one image.

    ``frame["Z"]`` is an (H, W) array, row 0 on top: float32, or uint32 where the channel holds ids. ``frame["N"]``, ``"P"``, ``"view"``,
    ``"albedo"`` and ``"uv"`` are (H, W, 3) or (H, W, 2) arrays of several channels. Where nothing is hit ``Z`` and ``t`` are infinite and ids are
    :data:`NO_ID`.
    """

    @staticmethod
    def read(path: Path) -> Frame:
        """The channels of an EXR file that are named like channels of this package."""
        return Frame(dict(_native.read_exr(os.fspath(path))))

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width, pixels."""
        height, width = self._any().shape
        return (height, width)

    def save(self, path: Path) -> None:
        """Writes all channels as .exr, or the colour as .png.

        Raises:
            ValueError: the name has another ending.
            OSError: the file cannot be written.
        """
        name = os.fspath(path)
        ending = os.path.splitext(name)[1].lower()
        if ending == ".exr":
            _native.write_exr(name, list(self._planes.items()))
        elif ending == ".png":
            _native.write_png(name, self.rgb)
        else:
            raise ValueError(f"{name}: images are written as .exr or .png")

    def __repr__(self) -> str:
        height, width = self.shape
        return f"<anamorph.Frame {width}x{height}: {', '.join(self._planes)}>"


class Views(_Channels):
    """The channels of N images of one size, as :meth:`Renderer.render_many` makes them.

    ``views["Z"]`` is an (N, H, W) array; otherwise all is as in :class:`Frame`.
    """

    @property
    def shape(self) -> tuple[int, int, int]:
        """Number of images, height and width, pixels."""
        count, height, width = self._any().shape
        return (count, height, width)

    def frame(self, index: int) -> Frame:
        """One of the images; its arrays are parts of these, not copies."""
        rgba = None if self._rgba is None else self._rgba[index]
        return Frame({name: plane[index] for name, plane in self._planes.items()}, rgba, self._report)

    def __repr__(self) -> str:
        count, height, width = self.shape
        return f"<anamorph.Views {count} of {width}x{height}: {', '.join(self._planes)}>"


class Comparison(Mapping[str, Any]):
    """How two frames differ: the numbers that ``anamorph compare --json`` prints, as a mapping."""

    def __init__(self, numbers: Mapping[str, Any]) -> None:
        self._numbers = dict(numbers)

    def __getitem__(self, name: str) -> Any:
        return self._numbers[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._numbers)

    def __len__(self) -> int:
        return len(self._numbers)

    def __repr__(self) -> str:
        return f"<anamorph.Comparison {json.dumps(self._numbers)}>"


def compare(a: Frame, b: Frame) -> Comparison:
    """How ``a`` differs from ``b``, in the channels that both have.

    Raises:
        ValueError: they differ in size, or have no channel in common.
    """
    return Comparison(json.loads(_native.compare(list(a.items()), list(b.items()))))
