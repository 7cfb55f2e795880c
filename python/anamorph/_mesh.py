"""Meshes from arrays."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from ._values import Numbers, array


class Look(NamedTuple):
    """What the material of another library's mesh gives."""

    image: npt.NDArray[np.uint8] | None = None
    """(H, W, 3) or (H, W, 4): sRGB, the first row on top."""
    color: list[float] | None = None
    """Linear RGB, without an image."""
    left_out: tuple[str, ...] = ()
    """What is not taken."""


class Mesh:
    """Triangles from arrays.

    Args:
        vertices: (N, 3) places, world units; kept in float64.
        faces: (M, 3) indices of each triangle's corners, counter-clockwise seen from its front.
        normals: (N, 3) normals of any length; without them each triangle is flat.
        uvs: (N, 2) texture coordinates; (0, 0) is an image's lower left corner.
        colors: (N, 3) linear RGB from 0 to 1, interpolated over each triangle.
        name: the object's name, for ``object.id`` and mattes.

    Raises:
        ValueError: an array has another shape; a place is not finite; an index has no vertex.
        TypeError: an array holds no numbers.
    """

    vertices: npt.NDArray[np.float64]
    faces: npt.NDArray[np.uint32]
    normals: npt.NDArray[np.float32] | None
    uvs: npt.NDArray[np.float32] | None
    colors: npt.NDArray[np.float32] | None
    name: str
    _look: Look

    def __init__(
        self,
        vertices: Numbers,
        faces: Numbers,
        normals: Numbers | None = None,
        uvs: Numbers | None = None,
        colors: Numbers | None = None,
        name: str = "mesh",
    ) -> None:
        self.vertices = array(vertices, np.float64, 3, "vertices")
        self.faces = array(faces, np.uint32, 3, "faces")
        self.normals = None if normals is None else array(normals, np.float32, 3, "normals")
        self.uvs = None if uvs is None else array(uvs, np.float32, 2, "uvs")
        self.colors = None if colors is None else array(colors, np.float32, 3, "colors")
        self.name = name
        self._look = Look()

    @staticmethod
    def of(other: Any) -> Mesh:
        """The mesh of a trimesh, an open3d, or any object that has ``vertices`` and ``faces`` (or ``triangles``).

        Vertex colours, which both hold in sRGB, texture coordinates of trimesh, and vertex normals of open3d are taken along. Normals of
        trimesh are left out: it computes some where a mesh has none. :meth:`Scene.add` takes the image or colour of its material, too, and
        warns of what it leaves out: colours of faces, and other images of a material.
        """
        if isinstance(other, Mesh):
            return other
        is_open3d = not hasattr(other, "faces")
        faces = getattr(other, "triangles" if is_open3d else "faces", None)
        if not hasattr(other, "vertices") or faces is None:
            kind = type(other).__name__
            raise TypeError(f"{kind} is no mesh: it has no vertices and faces (or triangles)")
        normals, srgb, uvs = None, None, None
        if is_open3d:
            normals, srgb = _rows(other, "vertex_normals"), _rows(other, "vertex_colors")
        elif getattr(getattr(other, "visual", None), "kind", None) == "vertex":
            srgb = np.asarray(other.visual.vertex_colors)[:, :3] / 255.0
        elif getattr(getattr(other, "visual", None), "kind", None) == "texture":
            uvs = _rows(other.visual, "uv")
        colors = None if srgb is None else np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
        mesh = Mesh(np.asarray(other.vertices), np.asarray(faces), normals, uvs, colors)
        mesh._look = _look(other)
        return mesh

    def __repr__(self) -> str:
        return f"<anamorph.Mesh {self.name!r}: {len(self.vertices)} vertices, {len(self.faces)} triangles>"


def _rows(other: Any, name: str) -> npt.NDArray[Any] | None:
    """An attribute as an array; ``None`` if it has no rows."""
    values = getattr(other, name, None)
    values = np.asarray(() if values is None else values)
    return values if len(values) else None


#: Images of trimesh's materials that are not taken.
_OTHER_IMAGES = ("emissiveTexture", "metallicRoughnessTexture", "normalTexture", "occlusionTexture")


def _look(other: Any) -> Look:
    """The look of a trimesh."""
    visual = getattr(other, "visual", None)
    if getattr(visual, "kind", None) == "face":
        return Look(left_out=("colours of faces; give vertex colours, or a mesh for each colour",))
    if getattr(visual, "kind", None) != "texture":
        return Look()
    material = getattr(visual, "material", None)
    left_out = tuple(f"the material's {name}" for name in _OTHER_IMAGES if getattr(material, name, None) is not None)
    image = getattr(material, "baseColorTexture", None)
    image = getattr(material, "image", None) if image is None else image
    if image is not None and getattr(visual, "uv", None) is not None:
        convert = getattr(image, "convert", None)
        return Look(np.asarray(image if convert is None else convert("RGBA"), dtype=np.uint8), None, left_out)
    if image is not None:
        left_out += ("the material's image, as the mesh has no texture coordinates",)
    color = getattr(material, "main_color", None)
    return Look(None, None if color is None else [float(c) / 255 for c in color[:3]], left_out)


def nodes(scene: Any) -> Iterator[tuple[str, Any, npt.NDArray[np.float64]]]:
    """The names, meshes and transforms of a trimesh.Scene's nodes; points and lines are left out with a warning."""
    for name in scene.graph.nodes_geometry:
        matrix, geometry = scene.graph[name]
        mesh = scene.geometry[geometry]
        if not hasattr(mesh, "faces"):
            warnings.warn(f"left out: {name} of the scene is no mesh of triangles", stacklevel=3)
            continue
        yield name, mesh, np.asarray(matrix, dtype=np.float64)
