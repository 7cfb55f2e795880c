"""The calls that made a scene, so that another process can make the same."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import _native

#: Calls of which only the last counts, and the calls that each makes superfluous. All but those of :data:`_OF_ALL` concern the object or the
#: picture that their first argument names.
_LAST = {
    "move_object": ("move_object",),
    "set_vertices": ("set_vertices", "move_object", "animate"),
    "animate": ("animate", "move_object"),
    "set_picture": ("set_picture",),
    "set_exposure": ("set_exposure",),
    "set_volume": ("set_volume",),
}
_OF_ALL = ("set_exposure", "set_volume")

_Arguments = tuple[Any, ...]


class Record:
    """The calls of the native scene, in their order, with copies of arrays."""

    def __init__(self) -> None:
        self._calls: list[tuple[str, _Arguments]] = []
        #: The calls since the last of :attr:`_calls` of which only the last counts, by method and name.
        self._last: dict[tuple[str, object], _Arguments] = {}

    def add(self, method: str, *arguments: Any) -> None:
        """Notes a call that succeeded."""
        kept = tuple(a.copy() if isinstance(a, np.ndarray) else a for a in arguments)
        if method not in _LAST:
            # names may mean other objects from here on
            self._calls += self._of_last()
            self._calls.append((method, kept))
            self._last = {}
            return
        name = None if method in _OF_ALL else arguments[0]
        for superfluous in _LAST[method]:
            self._last.pop((superfluous, name), None)
        self._last[method, name] = kept

    def _of_last(self) -> list[tuple[str, _Arguments]]:
        return [(method, arguments) for (method, _), arguments in self._last.items()]

    def copy(self) -> Record:
        """The same calls; what is added to either is not added to the other."""
        copied = Record()
        copied._calls, copied._last = list(self._calls), dict(self._last)
        return copied

    def replay(self) -> _native.Scene:
        """Makes the scene again; files are read again."""
        scene = _native.Scene()
        for method, arguments in self._calls + self._of_last():
            made = getattr(scene, method)(*arguments)
            # load and parse make a scene
            scene = scene if made is None else made
        return scene
