"""Values of scene files: what Python programs give, as JSON or TOML."""

from __future__ import annotations

import contextlib
import json
import math
import operator
import os
import threading
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Union

import numpy as np
import numpy.typing as npt

#: What a key of a scene file may be: a number, a truth value, a text, a path, an array, or lists and tables of these.
Value = Any
#: Anything that NumPy makes an array of numbers of.
Numbers = npt.ArrayLike
Path = Union[str, "os.PathLike[str]"]


#: How many threads are within :func:`quiet_window_system`, and what the variable was before the first of them.
_quiet = threading.Lock()
_quiet_threads = 0
_before: str | None = None


@contextlib.contextmanager
def quiet_window_system() -> Iterator[None]:
    """Vulkan asks for a Wayland display, whose library complains on stderr where this variable is missing; a folder that does not exist is no
    display either, silently."""
    global _quiet_threads, _before
    variable = "XDG_RUNTIME_DIR"
    with _quiet:
        if _quiet_threads == 0:
            _before = os.environ.get(variable)
            if not (_before or "").startswith("/"):
                os.environ[variable] = "/nonexistent"
        _quiet_threads += 1
    try:
        yield
    finally:
        with _quiet:
            _quiet_threads -= 1
            if _quiet_threads == 0 and _before is None:
                os.environ.pop(variable, None)
            elif _quiet_threads == 0 and _before is not None:
                os.environ[variable] = _before


def plain(value: Value, key: str) -> Any:
    """The value in lists, dicts, texts and numbers; infinities as texts, as JSON has none."""
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, bool) or value is None:
        return value
    if isinstance(value, float):
        if math.isnan(value):
            raise ValueError(f"{key}: NaN is no value")
        return value if math.isfinite(value) else ("inf" if value > 0 else "-inf")
    if isinstance(value, (int, str)):
        return value
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, Mapping):
        return {str(k): plain(v, f"{key}.{k}") for k, v in value.items()}
    if isinstance(value, np.ndarray):
        return plain(value.tolist(), key)
    if isinstance(value, Sequence):
        return [plain(v, f"{key}.{k}") for k, v in enumerate(value)]
    raise TypeError(f"{key}: {type(value).__name__} is no value of a scene; use numbers, texts, lists or dicts of these")


def table(keys: Mapping[str, Value]) -> str:
    """A table of a scene file as JSON. Keys without a value (None) are left out."""
    return json.dumps({key: plain(value, key) for key, value in keys.items() if value is not None})


def assignment(key: str, value: Value) -> str:
    """``key=value`` as the program's ``--set`` takes it, the value in TOML."""
    return f"{key}={_toml(plain(value, key), key)}"


def _toml(value: Any, key: str) -> str:
    if value is None:
        raise ValueError(f"{key}: None is no value; leave the key out")
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_text(k)} = {_toml(v, key)}" for k, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(_toml(v, key) for v in value) + "]"
    return _text(value)


def _text(value: Any) -> str:
    # TOML has no pairs of surrogates
    return json.dumps(value, ensure_ascii=False)


def as_array(values: Any) -> npt.NDArray[Any]:
    """An array of what NumPy takes or what only speaks DLPack (on the CPU), without a copy where that is possible: numbers that lie between
    others, as in records of several types, may be whole numbers of bytes apart, and not of numbers."""
    only_dlpack = hasattr(values, "__dlpack__") and not hasattr(values, "__array__")
    given = np.from_dlpack(values) if only_dlpack else np.asarray(values)
    return given.copy() if given.itemsize and any(step % given.itemsize for step in given.strides) else given


def as_numbers(values: Numbers, dtype: type[Any]) -> npt.NDArray[Any]:
    """An array of this type, its rows one after another, without a copy where it is one already."""
    return np.asarray(as_array(values), dtype=dtype, order="C")


def array(values: Numbers, dtype: type[Any], width: int, name: str) -> npt.NDArray[Any]:
    """An (N, width) array of this type, without a copy where it is one already; wrong shapes and types say so."""
    given = as_array(values)
    if given.ndim != 2 or given.shape[1] != width:
        raise ValueError(f"{name}: an array of shape (N, {width}) is needed, not {given.shape}")
    whole = np.issubdtype(dtype, np.integer)
    is_real = np.issubdtype(given.dtype, np.number) and not np.issubdtype(given.dtype, np.complexfloating)
    if given.size and not (np.issubdtype(given.dtype, np.integer) if whole else is_real):
        raise TypeError(f"{name}: {'whole numbers' if whole else 'numbers'} are needed, not {given.dtype}")
    if whole and given.size and (given.min() < 0 or given.max() > np.iinfo(dtype).max):
        raise ValueError(f"{name}: indices are 0 and above, not {given.min()} to {given.max()}")
    return given.astype(dtype, copy=False)


def image_size(size: Sequence[int] | None) -> tuple[int, int] | None:
    """Width and height of an image, pixels, from any two whole numbers."""
    if size is None:
        return None
    try:
        width, height = (operator.index(n) for n in size)
    except (TypeError, ValueError):
        raise ValueError(f"size: width and height in pixels are needed, two whole numbers, not {size!r}") from None
    if not (0 < width < 2**32 and 0 < height < 2**32):
        raise ValueError(f"size: an image of {width} x {height} pixels is not possible")
    return width, height
