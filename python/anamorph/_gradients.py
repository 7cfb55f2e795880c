"""How images change with triangles and cameras, as arrays."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple, Union

import numpy as np
import numpy.typing as npt

from ._values import Numbers, as_numbers

Array = Union[npt.NDArray[np.float32], npt.NDArray[np.uint32]]

#: The id of what is not there.
_NONE = 0xFFFFFFFF


class Parameter(NamedTuple):
    """A number of the camera, and how the derivatives of the rays by it were found."""

    name: str
    """As in ``camera.fov``."""
    value: float
    step: float
    """The largest step from the value: derivatives are extrapolated from three."""
    origin_error: float
    """Bound on the error of the derivatives of ray origins, world units a unit of the number."""
    direction_error: float
    """Bound on that of ray directions."""


class Gradients(Mapping[str, Array]):
    """Arrays by their names, each (H, W, ...), row 0 on top; the user guide, ``docs/guide/gradients.md``, says what they hold.

    ``gradients["depth.vertices"]`` is (H, W, 3, 3): by the three corners of the pixel's triangle, and their x, y and z.
    ``gradients["depth.camera"]`` is (H, W, P): by the numbers of the camera, in the order of :attr:`parameters`. Those of ``position``
    and ``barycentrics`` have an axis of 3 before these. ``gradients["triangle"]`` has the triangle of each pixel. Where nothing is hit, or no
    edge passes, they are 0; NaN where a pixel has no ray at slightly other values of a number.
    """

    _arrays: dict[str, Array]
    parameters: list[Parameter]

    def __init__(self, arrays: Mapping[str, Array], parameters: list[Parameter]) -> None:
        self._arrays = dict(arrays)
        self.parameters = parameters

    def __getitem__(self, name: str) -> Array:
        if name not in self._arrays:
            raise KeyError(f"{name}: not asked for; there are {', '.join(self._arrays)}")
        return self._arrays[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._arrays)

    def __len__(self) -> int:
        return len(self._arrays)

    def blend(self, colors: Numbers) -> npt.NDArray[np.float64]:
        """The image with smooth edges: at an edge the colours of both sides, by the coverage of the triangle.

        Args:
            colors: (H, W) or (H, W, C), one sample a pixel, as of a frame's channels.

        Returns:
            An array of the same shape.
        """
        inside, outside = self._sides(colors)
        share = self["coverage"].astype(np.float64).reshape(inside.shape[:2] + (1,) * (inside.ndim - 2))
        blended: npt.NDArray[np.float64] = share * inside + (1 - share) * outside
        return blended

    def of_blend(self, colors: Numbers, by: str = "camera") -> npt.NDArray[np.float64]:
        """How :meth:`blend` changes as edges move; the colours stay.

        Args:
            colors: as of :meth:`blend`.
            by: ``"camera"``; or ``"vertices"``, those of the triangle ``gradients["coverage.triangle"]``.

        Returns:
            (H, W, P) or (H, W, C, P); or (..., 3, 3) in place of P.
        """
        inside, outside = self._sides(colors)
        change = self[f"coverage.{by}"].astype(np.float64)
        extra = change.ndim - 2
        step = (inside - outside).reshape(inside.shape + (1,) * extra)
        return step * change.reshape(change.shape[:2] + (1,) * (inside.ndim - 2) + change.shape[2:])

    def _sides(self, colors: Numbers) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        """The colours on both sides of each pixel's edge; without one, twice the pixel's own."""
        own = as_numbers(colors, np.float64)
        height, width = self["coverage"].shape
        if own.ndim not in (2, 3) or own.shape[:2] != (height, width):
            raise ValueError(f"colors needs an array of shape ({height}, {width}) or ({height}, {width}, C), not {own.shape}")
        flat = own.reshape(height * width, *own.shape[2:])
        pixels = self["coverage.pixels"].reshape(-1, 2)
        numbers = np.arange(height * width)
        inside, outside = (np.where(pixels[:, k] == _NONE, numbers, pixels[:, k]) for k in (0, 1))
        return flat[inside].reshape(own.shape), flat[outside].reshape(own.shape)

    def __repr__(self) -> str:
        height, width = self["triangle"].shape
        return f"<anamorph.Gradients {width}x{height}: {', '.join(self._arrays)}>"


def _gradients(arrays: list[tuple[str, Any]], parameters: list[tuple[str, float, float, float, float]]) -> Gradients:
    return Gradients(dict(arrays), [Parameter(*parameter) for parameter in parameters])
