"""Writes anamorph/camera.py: a function for each kind of camera, from the help texts of the library."""

from __future__ import annotations

import json
import keyword
import pathlib
import re

from anamorph import _native

HEADER = '''"""Kinds of cameras: one function each, with the keys of a scene file's ``[camera]``.

This file is made by generate_cameras.py from the texts of ``anamorph camera --help KIND``.
"""

from __future__ import annotations

import numpy as np

from ._camera import Camera, CompiledRays
from ._values import Numbers, Value, as_numbers

'''

RAYS = '''
def rays(origins: Numbers, directions: Numbers, t_range: tuple[float, float] = (0.0, np.inf)) -> Camera:
    """A camera of the rays P + t D, one for each pixel.

    Args:
        origins: (H, W, 3) points P, world units.
        directions: (H, W, 3) vectors D of any length; a pixel whose ray is not finite, or whose D is 0, has no ray.
        t_range: the ends of t, inclusive.

    Raises:
        ValueError: the arrays have other shapes, or hold no ray.
    """
    given = [as_numbers(vectors, np.float64) for vectors in (origins, directions)]
    for name, vectors in zip(("origins", "directions"), given):
        if vectors.ndim != 3 or vectors.shape[2] != 3 or vectors.shape != given[0].shape:
            raise ValueError(f"{name}: an array of shape (H, W, 3) is needed, as of the other, not {vectors.shape}")
    camera = Camera("rays", {})
    camera._rays = CompiledRays.of(given[0], given[1], (float(t_range[0]), float(t_range[1])))
    return camera
'''

# A line of a key, or of several: two blanks, names, and what follows them.
KEYS = re.compile(r"^  ([a-z_]+(?:, [a-z_]+)*)(?=  | \[| \"|$)")

# Keys that the help has for all kinds with an eye and a target, also where these are in tables of their own.
POSE = ("matrix", "quaternion", "convention", "distance")


def keys(kind: str, text: str) -> list[str]:
    """The keys of a kind: those that its help lists, in its order, and others that the library knows."""
    known = known_keys(kind)
    found: list[str] = []
    for line in text.splitlines():
        match = KEYS.match(line)
        for key in match.group(1).split(", ") if match else []:
            if key not in found and (key in known or key not in POSE):
                found.append(key)
    return found + [key for key in known if key not in found]


def known_keys(kind: str) -> list[str]:
    """The keys that the refusal of an unknown one names."""
    try:
        _native.Camera.of_table(json.dumps({"kind": kind, "unknown": 1}), ".", _native.Scene(), (8, 6))
    except ValueError as refused:
        listed = str(refused).rpartition("(known: ")[2].rstrip(")")
        return [key for key in listed.split(", ") if key != "kind"]
    raise RuntimeError(f"{kind}: an unknown key is not refused")


def function(kind: str, text: str) -> str:
    """The function of a kind."""
    names = {key: key + "_" if keyword.iskeyword(key) else key for key in keys(kind, text)}
    parameters = "".join(f"    {name}: Value | None = None,\n" for name in names.values())
    head = f"def {kind}(\n    *,\n{parameters}) -> Camera:" if names else f"def {kind}() -> Camera:"
    first, _, rest = text.rstrip().partition("\n")
    summary = first.split(": ", 1)[1]
    summary = summary[0].upper() + summary[1:] + "."
    body = "".join(f"    {line}\n" if line else "\n" for line in rest.splitlines()).replace("\\", "\\\\")
    values = ", ".join(f'"{key}": {name}' for key, name in names.items())
    return f'\n{head}\n    """{summary}\n{body}    """\n    return Camera("{kind}", {{{values}}})\n'


def module(kinds: list[tuple[str, str]]) -> str:
    """The text of camera.py."""
    names = sorted(["Camera", "rays", *(kind for kind, _ in kinds)])
    exported = "__all__ = [\n" + "".join(f'    "{name}",\n' for name in names) + "]\n"
    return HEADER + exported + "\n" + "\n".join(function(*kind) for kind in kinds) + "\n" + RAYS


if __name__ == "__main__":
    path = pathlib.Path(__file__).parent / "anamorph" / "camera.py"
    path.write_text(module(_native.camera_kinds()), encoding="utf-8")
