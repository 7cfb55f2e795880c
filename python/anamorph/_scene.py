"""Scenes."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import _native
from ._mesh import Mesh, nodes
from ._record import Record
from ._values import Numbers, Path, Value, array, as_array, as_numbers, assignment, table

if TYPE_CHECKING:
    from .camera import Camera


class Scene:
    """Triangles with materials and lights; one that was loaded from a file has a camera, too.

    A new scene is empty and is lit by a headlight, which shines along each pixel's ray.

    A scene can be pickled, as for worker processes: it keeps the calls that made it, with a copy of each array that it was given, and the
    other process makes them again. Files are then read again: they must be there, and unchanged. Of moves, updates and pictures only the
    last of each object is kept.
    """

    _native: _native.Scene
    _record: Record

    def __init__(self) -> None:
        self._native = _native.Scene()
        self._record = Record()

    def _do(self, method: str, *arguments: Any) -> None:
        """Changes the scene by a method of the native one, and notes the call."""
        getattr(self._native, method)(*arguments)
        self._record.add(method, *arguments)

    def __getstate__(self) -> dict[str, Any]:
        kept = {name: value for name, value in self.__dict__.items() if name != "_native"}
        return {**kept, "_record": self._record.copy()}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._native = self._record.replay()

    @staticmethod
    def load(path: Path, overrides: Mapping[str, Value] | None = None, frame: float = 0) -> Scene:
        """Loads a scene file, .toml or .json, and all files that it names.

        Args:
            path: the scene file.
            overrides: values that replace those of the file, as in ``{"camera.vfov": 40, "mesh.0.scale": 2}``.
            frame: where keyframed values are evaluated.

        Raises:
            ValueError: one line with the file, the line and the key.
            OSError: a file cannot be read; ``FileNotFoundError`` if it does not exist.
        """
        scene = Scene()
        changes = [assignment(key, value) for key, value in (overrides or {}).items()]
        scene._native = _native.Scene.load(os.fspath(path), changes, frame)
        scene._record.add("load", os.path.abspath(path), changes, frame)
        return scene

    @staticmethod
    def parse(text: str, folder: Path = ".") -> Scene:
        """A scene from the text of a scene file in TOML, whose relative paths start from ``folder``."""
        scene = Scene()
        scene._native = _native.Scene.parse(text, os.fspath(folder))
        scene._record.add("parse", text, os.path.abspath(folder))
        return scene

    def add(self, mesh: Any, texture: Numbers | Path | Mapping[str, Value] | bool | None = None, **keys: Value) -> None:
        """Adds triangles after the existing ones.

        Args:
            mesh: a mesh file (.obj, .gltf, .glb, .ply, .stl, .off, .dae, or heights in .asc, .png, .tif), a :class:`Mesh`, an object with
                ``vertices`` and ``faces`` (or ``triangles``), such as a mesh of trimesh or open3d, or a ``trimesh.Scene``, each node of
                which becomes an object with its name, transform and texture. With ``objects="file"`` each node or group of a file does.
            texture: the key ``texture`` of ``[[mesh]]``: an image's file, a table, or a truth value; or, for a mesh of arrays that has
                uvs, an image: (H, W, 3) or (H, W, 4), uint8, sRGB.
            keys: the keys of a scene file's ``[[mesh]]``, such as ``translate``, ``rotate``, ``scale``, ``color``, ``two_sided``,
                ``smooth`` and ``name``.

        Raises:
            ValueError: a key or a value is wrong; the file or an array is.
            OSError: the file cannot be read; ``FileNotFoundError`` if it does not exist.
        """
        image = None
        if texture is None or isinstance(texture, (str, os.PathLike, Mapping, bool)):
            keys = {**keys, "texture": texture}
        else:
            image = _image(texture)
        if isinstance(mesh, (str, os.PathLike)):
            if image is not None:
                raise TypeError("texture: the mesh of a file takes an image's file, not an array; make a Mesh of arrays")
            self._do("add_table", table({"file": os.path.abspath(mesh), **keys}), os.getcwd())
            return
        if hasattr(mesh, "graph") and hasattr(mesh, "geometry"):
            for name, part, matrix in nodes(mesh):
                own = Mesh.of(part)
                own.vertices = own.vertices @ matrix[:3, :3].T + matrix[:3, 3]
                own.normals = None
                own.name = name
                self._add_mesh(own, image, keys)
            return
        self._add_mesh(Mesh.of(mesh), image, keys)

    def _add_mesh(self, own: Mesh, image: npt.NDArray[np.uint8] | None, keys: dict[str, Value]) -> None:
        """Adds a mesh with an image, or where none is given with the look of the object that it was made of."""
        if image is None and own.colors is None and keys.get("texture") is None and keys.get("color") is None:
            image, color, left_out = own._look
            keys = {**keys, "color": color}
            for what in left_out:
                warnings.warn(f"left out: {own.name}: {what}", stacklevel=3)
        self._do(
            "add_arrays", own.vertices, own.faces, own.normals, own.uvs, own.colors, own.name, table(keys), os.getcwd(), image
        )

    def add_builtin(self, builtin: str, /, **keys: Value) -> None:
        """Adds a generated mesh: ``teapot``, ``icosphere``, ``box``, ``plane``, ``city`` and others, with the keys of ``[[mesh]]``."""
        self._do("add_table", table({"builtin": builtin, **keys}), os.getcwd())

    def throw(self, image: Path, camera: Camera | Mapping[str, Value], **keys: Value) -> int:
        """Throws a camera's picture onto the surfaces of the scene, back along the rays of the camera that took it.

        Args:
            image: the picture's file: PNG, JPEG, Radiance, WebP, BMP, TGA, TIFF or GIF.
            camera: the camera that took it, of :mod:`anamorph.camera` or a table of ``kind`` and its keys; of any kind with straight rays.
                Its image is as large as the picture.
            keys: the other keys of a scene file's ``[[projector_light]]``: ``mode``, ``opacity``, ``strength``, ``feather``,
                ``angle_power``, ``distance_power``, ``distance`` and ``occlusion``.

        Returns:
            The picture's number, for :meth:`show`.

        Raises:
            ValueError: a key or a value is wrong, or the camera's rays are not straight.
            OSError: the file cannot be read; ``FileNotFoundError`` if it does not exist.
        """
        number = self._native.projector_light_count
        taken_by = camera if isinstance(camera, Mapping) else {"kind": camera.kind, **camera.keys}
        own = table({"image": os.path.abspath(image), "camera": taken_by, **keys})
        self._do("add_projector_light", own, os.getcwd())
        return number

    def show(self, number: int, picture: Numbers) -> None:
        """Replaces a picture that is thrown onto surfaces, as by the next frame of a video.

        Args:
            number: which one: what :meth:`throw` returned, or from 0 those of a scene file, in its order.
            picture: (H, W, 3) or (H, W, 4), uint8, sRGB; one of another size is stretched over the camera's image.

        Raises:
            ValueError: there is no such picture, or the array is wrong. The scene is unchanged.
        """
        self._do("set_picture", number, _image(picture, "picture"))

    def add_spheres(
        self, centers: Numbers, radii: Numbers | float, colors: Numbers | None = None, name: str = "spheres", **keys: Value
    ) -> None:
        """Adds exact spheres after the existing meshes.

        Args:
            centers: (N, 3), world units.
            radii: (N,), above 0; or one number for all.
            colors: (N, 3), linear RGB from 0 to 1; without them all are light grey, or have the key ``color``.
            name: the object's name.
            keys: the keys of a scene file's ``[[spheres]]`` that say where they are and what they look like, such as ``translate``,
                ``scale`` (one number), ``color``, ``roughness`` and ``two_sided``.

        Raises:
            ValueError: a key or a value is wrong; a shape is, a center is not finite, a radius not above 0, a color not in [0, 1].
        """
        places = array(centers, np.float64, 3, "centers")
        sizes = _radii(radii, len(places))
        own = None if colors is None else array(colors, np.float32, 3, "colors")
        self._do("add_spheres", places, sizes, own, name, table(keys), os.getcwd())

    def add_capsules(
        self, ends: Numbers, radii: Numbers | float, colors: Numbers | None = None, name: str = "capsules", **keys: Value
    ) -> None:
        """Adds exact capsules after the existing meshes, such as hair, pipes or bonds: all points within a radius of a segment.

        Args:
            ends: (N, 2, 3), the two ends of each segment, world units.
            radii: (N,), above 0; or one number for all.
            colors: (N, 3), linear RGB from 0 to 1; without them all are light grey, or have the key ``color``.
            name: the object's name.
            keys: as of :meth:`add_spheres`.

        Raises:
            ValueError: a key or a value is wrong; a shape is, an end is not finite, a radius not above 0, a color not in [0, 1].
        """
        places = as_numbers(ends, np.float64)
        if places.ndim != 3 or places.shape[1:] != (2, 3):
            raise ValueError(f"ends: an array of shape (N, 2, 3) is needed, not {places.shape}")
        sizes = _radii(radii, len(places))
        own = None if colors is None else array(colors, np.float32, 3, "colors")
        points = np.ascontiguousarray(places.reshape(-1, 3))
        self._do("add_capsules", points, sizes, own, name, table(keys), os.getcwd())

    def move(self, mesh: str, matrix: Numbers) -> None:
        """Places an object: each of its vertices p, as last added or updated, comes to lie at M p; the identity takes the object back.

        Args:
            mesh: the object's name, as in :attr:`objects`.
            matrix: (3, 4) or (4, 4), affine: to the world, in which the object was added, world units.

        Raises:
            ValueError: there is no such object; the matrix is wrong. The scene is unchanged.
        """
        rows = as_numbers(matrix, np.float64)
        if rows.shape not in ((3, 4), (4, 4)):
            raise ValueError(f"matrix: an affine matrix of shape (3, 4) or (4, 4) is needed, not {rows.shape}")
        if rows.shape == (4, 4) and rows[3].tolist() != [0, 0, 0, 1]:
            raise ValueError(f"matrix: its last row must be 0, 0, 0, 1, not {rows[3].tolist()}")
        self._do("move_object", mesh, rows[:3].tolist())

    def update(self, mesh: str, vertices: Numbers) -> None:
        """Gives an object other vertices; later moves start from these. Its normals are dropped: it is shaded flat.

        Args:
            mesh: the object's name, as in :attr:`objects`.
            vertices: (N, 3), as many as the object has, world units.

        Raises:
            ValueError: there is no such object; the array is wrong. The scene is unchanged.
        """
        rows = as_numbers(vertices, np.float64)
        if rows.ndim != 2 or rows.shape[1] != 3:
            raise ValueError(f"vertices: an array of shape (N, 3) is needed, not {rows.shape}")
        self._do("set_vertices", mesh, rows)

    def animate(self, mesh: str, times: Numbers, vertices: Numbers) -> None:
        """Lets an object move while an image is taken: each pixel sees it where it is at the pixel's own time.

        Between two times vertices move straight; before the first and after the last they stand still. For all that has no time of its own
        the object is where it is at time 0. Its normals are dropped: it is shaded flat. :meth:`move` and :meth:`update` let it stand still
        again. :meth:`expose` says when pixels are exposed.

        Args:
            mesh: the object's name, as in :attr:`objects`.
            times: (K,), ascending, in the unit of :meth:`expose`; at most 256 for all objects together.
            vertices: (K, N, 3), where the object's N vertices are at each time, world units.

        Raises:
            ValueError: there is no such object; an array is wrong. The scene is unchanged.
        """
        steps = as_numbers(vertices, np.float64)
        moments = as_numbers(times, np.float64)
        if moments.ndim != 1 or steps.ndim != 3 or steps.shape[0] != len(moments) or steps.shape[2] != 3:
            raise ValueError(f"times of shape (K,) and vertices of shape (K, N, 3) are needed, not {moments.shape} and {steps.shape}")
        self._do("animate", mesh, moments.tolist(), steps)

    def expose(
        self, line_time: float = 0, line_order: str = "down", times: Numbers | None = None, shutter: float = 0
    ) -> None:
        """Sets when the pixels of images are exposed; what moves is seen at these times.

        Args:
            line_time: the time from one line to the next; the first line is read at time 0.
            line_order: ``"down"`` or ``"up"`` for rows, ``"right"`` or ``"left"`` for columns.
            times: instead, (H, W): the time of each pixel; (1, W) or (H, 1) holds for all rows or columns.
            shutter: how long the shutter is open at each pixel, about the pixel's own time; images of several samples are blurred by it.

        Raises:
            ValueError: a value is wrong.
        """
        table = None if times is None else as_numbers(times, np.float64)
        if table is not None and table.ndim != 2:
            raise ValueError(f"times: an array of shape (H, W) is needed, not {table.shape}")
        self._do("set_exposure", line_time, line_order, table, shutter)

    def set_volume(self, values: Numbers | None, **keys: Value) -> None:
        """Gives the scene a volume, in place of one that it has: a grid of numbers in space that glow and absorb light.

        Args:
            values: (Z, Y, X), as f32; ``None``: the scene then has no volume.
            keys: the keys of a scene file's ``[volume]`` but those of its file: ``min`` and ``max``, or ``origin`` and ``spacing``;
                ``transfer``, a list of [value, red, green, blue, extinction]; ``rotate``, ``mode`` and ``lit``.

        Raises:
            ValueError: a key or a value is wrong, or a number is not finite. The scene is unchanged.
        """
        grid = None if values is None else as_numbers(values, np.float32)
        if grid is not None and grid.ndim != 3:
            raise ValueError(f"values: an array of shape (Z, Y, X) is needed, not {grid.shape}")
        self._do("set_volume", grid, table(keys), os.getcwd())

    @property
    def camera(self) -> Camera | None:
        """The scene file's camera; ``None`` if the scene has none."""
        from .camera import Camera

        return Camera._of_scene(self) if self._native.has_camera else None

    @property
    def triangle_count(self) -> int:
        """The number of triangles."""
        return self._native.triangle_count

    @property
    def bounds(self) -> npt.NDArray[np.float64] | None:
        """(2, 3): least and greatest corner of the box around all vertices, world units; ``None`` without vertices."""
        bounds = self._native.bounds
        return None if bounds is None else np.array(bounds)

    @property
    def objects(self) -> list[tuple[str, int]]:
        """Name and triangle count of each object, in the order of ``object.id``."""
        return self._native.objects

    @property
    def missing(self) -> list[str]:
        """What mesh files refer to and is not there, one line each. The scene was loaded without it."""
        return self._native.missing

    def __repr__(self) -> str:
        return f"<anamorph.Scene: {len(self.objects)} objects, {self.triangle_count} triangles>"


def _image(texture: Numbers, key: str = "texture") -> npt.NDArray[np.uint8]:
    image = as_array(texture)
    if image.ndim != 3 or image.shape[2] not in (3, 4) or image.dtype != np.uint8:
        raise ValueError(f"{key}: an array of shape (H, W, 3) or (H, W, 4) and type uint8, not {image.shape}, {image.dtype}")
    return image


def _radii(radii: Numbers | float, count: int) -> list[float]:
    """A radius for each of so many spheres or capsules."""
    sizes = as_numbers(radii, np.float64)
    if sizes.shape not in ((), (count,)):
        raise ValueError(f"radii: one number, or {count} of shape ({count},), are needed, not {sizes.shape}")
    each: list[float] = np.broadcast_to(sizes, (count,)).tolist()
    return each
