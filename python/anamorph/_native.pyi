"""
The library's facade, as the package's own modules use it.
"""

from _typeshed import Incomplete, SupportsGetItem, SupportsLenAndGetItem
from os import PathLike
from typing import Any, SupportsFloat, SupportsIndex, final

__all__ = ["Camera", "Renderer", "Scene", "Viewer", "camera_kinds", "cast", "cast_all", "channels_named", "check", "colmap_images", "compare", "meets_any", "program", "project", "project_many", "read_exr", "splat", "write_exr", "write_png"]

@final
class Camera:
    """
    A camera for an image of one size.
    """
    @property
    def channels(self, /) -> list[str]:
        """
        The names of its channels.
        """
    @property
    def height(self, /) -> int: ...
    @property
    def kind(self, /) -> str: ...
    @staticmethod
    def of_rays(origins: Incomplete, directions: Incomplete, t_range: tuple[SupportsFloat | SupportsIndex, SupportsFloat | SupportsIndex]) -> Camera:
        """
        A ray for each pixel: (H, W, 3) origins and directions.
        """
    @staticmethod
    def of_scene(scene: Scene, size: tuple[SupportsIndex, SupportsIndex] | None) -> Camera:
        """
        The scene's own.
        """
    @staticmethod
    def of_table(table: str, folder: str | PathLike[str], scene: Scene, size: tuple[SupportsIndex, SupportsIndex] | None) -> Camera:
        """
        Of the keys of a scene file's `[camera]`, as JSON; for an image of the scene's size, or of this one.
        """
    @property
    def piece_count(self, /) -> int: ...
    def rays(self, /) -> tuple[Incomplete, Incomplete]:
        """
        Origins and directions of the rays through the pixels' centres, (H, W, 3) each; NaN where a pixel has none.
        """
    @property
    def width(self, /) -> int: ...

@final
class Renderer:
    """
    A device, or the reference on the CPU, with what it holds.
    """
    def __new__(cls, /, adapter: str | None, reference: bool) -> Renderer: ...
    @property
    def adapter(self, /) -> str | None:
        """
        The adapter's name; `None`: the reference renders.
        """
    def gradients(self, /, scene: Scene, camera: Camera, quantities: SupportsGetItem[int, str], of: SupportsGetItem[int, str]) -> tuple[list[tuple[str, Any]], list[tuple[str, float, float, float, float]]]:
        """
        Arrays of gradients by their names; and of each number of the camera its name, value, step, and errors of origins and directions.
        """
    def render(self, /, scene: Scene, camera: Camera, names: SupportsGetItem[int, str], color: bool, samples: SupportsIndex, analytic: bool) -> tuple[list[tuple[str, Any]], Incomplete | None, Any]:
        """
        The planes of the channels, 8-bit sRGB colour (H, W, 4) where it is wanted, and the report as JSON.
        """
    def render_many(self, /, scene: Scene, cameras: SupportsGetItem[int, Camera], names: SupportsGetItem[int, str], color: bool, samples: SupportsIndex, analytic: bool) -> tuple[list[tuple[str, Any]], Incomplete | None, Any]:
        """
        The same of an image through each camera: planes (N, H, W), colour (N, H, W, 4).
        """

@final
class Scene:
    """
    A scene. A call that runs keeps what it has begun with: a change then makes a new one inside.
    """
    def __new__(cls, /) -> Scene: ...
    def add_arrays(self, /, positions: Incomplete, triangles: Incomplete, normals: Incomplete | None, uvs: Incomplete | None, colors: Incomplete | None, name: str, table: str, folder: str | PathLike[str], texture: Incomplete | None) -> None:
        """
        Adds a mesh of arrays with the keys of a `[[mesh]]` table, and an image of 8-bit sRGB colours (H, W, 3), or (H, W, 4).
        """
    def add_projector_light(self, /, table: str, folder: str | PathLike[str]) -> None:
        """
        Throws the picture of a `[[projector_light]]` table onto surfaces.
        """
    def add_capsules(self, /, ends: Incomplete, radii: SupportsGetItem[int, SupportsFloat | SupportsIndex], colors: Incomplete | None, name: str, table: str, folder: str | PathLike[str]) -> None:
        """
        Adds capsules of arrays, the two ends of each one after the other, with the keys of a `[[mesh]]` table that they may have.
        """
    def add_spheres(self, /, centers: Incomplete, radii: SupportsGetItem[int, SupportsFloat | SupportsIndex], colors: Incomplete | None, name: str, table: str, folder: str | PathLike[str]) -> None:
        """
        Adds spheres of arrays with the keys of a `[[mesh]]` table that they may have.
        """
    def add_table(self, /, table: str, folder: str | PathLike[str]) -> None:
        """
        Adds the mesh of a `[[mesh]]` table.
        """
    def animate(self, /, name: str, times: SupportsGetItem[int, SupportsFloat | SupportsIndex], vertices: Incomplete) -> None:
        """
        Lets an object move while an image is taken.
        """
    @property
    def bounds(self, /) -> list[list[float]] | None: ...
    @property
    def has_camera(self, /) -> bool: ...
    @staticmethod
    def load(path: str | PathLike[str], overrides: SupportsGetItem[int, str], frame: SupportsFloat | SupportsIndex) -> Scene: ...
    @property
    def missing(self, /) -> list[str]: ...
    def move_object(self, /, name: str, matrix: SupportsLenAndGetItem[SupportsLenAndGetItem[SupportsFloat | SupportsIndex]]) -> None:
        """
        Places an object by the rows of an affine matrix.
        """
    @property
    def objects(self, /) -> list[tuple[str, int]]: ...
    @staticmethod
    def parse(text: str, folder: str | PathLike[str]) -> Scene: ...
    @property
    def projector_light_count(self, /) -> int: ...
    def set_exposure(self, /, line_time: SupportsFloat | SupportsIndex, line_order: str, times: Incomplete | None, shutter: SupportsFloat | SupportsIndex) -> None:
        """
        Sets when the pixels of images are exposed.
        """
    def set_picture(self, /, light: SupportsIndex, picture: Incomplete) -> None:
        """
        Gives a projector light another picture of 8-bit sRGB colours (H, W, 3), or (H, W, 4).
        """
    def set_vertices(self, /, name: str, vertices: Incomplete) -> None:
        """
        Gives an object other vertices.
        """
    def set_volume(self, /, values: Incomplete | None, table: str, folder: str | PathLike[str]) -> None:
        """
        Gives the scene a volume of these numbers (z, y, x) with the keys of a `[volume]` table, or none.
        """
    @property
    def triangle_count(self, /) -> int: ...

@final
class Viewer:
    """
    A server of a scene's page.
    """
    @property
    def address(self, /) -> str: ...
    def close(self, /) -> None: ...
    @staticmethod
    def of_file(path: str | PathLike[str], overrides: SupportsGetItem[int, str], frame: SupportsFloat | SupportsIndex, port: SupportsIndex) -> Viewer: ...
    @staticmethod
    def of_scene(scene: Scene, camera: str | None, folder: str | PathLike[str], size: tuple[SupportsIndex, SupportsIndex] | None, port: SupportsIndex) -> Viewer: ...

def camera_kinds() -> list[tuple[str, str]]:
    """
    The kinds of cameras and their help: a line, the keys, the formula.
    """

def cast(scene: Scene, origins: Incomplete, directions: Incomplete, t_range: SupportsLenAndGetItem[SupportsFloat | SupportsIndex]) -> tuple[tuple[Incomplete, Incomplete, Incomplete, Incomplete, Incomplete, Incomplete], Incomplete]:
    """
    The first hit of each ray, and whether it is certain; of one that meets nothing t is infinite, the ids are -1, and the rest is NaN.
    """

def cast_all(scene: Scene, origins: Incomplete, directions: Incomplete, t_range: SupportsLenAndGetItem[SupportsFloat | SupportsIndex]) -> tuple[tuple[Incomplete, Incomplete, Incomplete, Incomplete, Incomplete, Incomplete], Incomplete, Incomplete]:
    """
    All hits of all rays, how many each ray has, and whether they are certain.
    """

def channels_named(name: str) -> list[str]:
    """
    The names of the channels that a name stands for: several of `N`, `P`, `albedo`, `uv` and `view`.
    """

def check(scene: Scene, camera: Camera, planes: SupportsGetItem[int, tuple[str, Any]]) -> str:
    """
    Compares a frame with the reference; the comparison as JSON.
    """

def colmap_images(folder: str | PathLike[str]) -> list[str]:
    """
    The names of the images of a COLMAP model, in order.
    """

def compare(a: SupportsGetItem[int, tuple[str, Any]], b: SupportsGetItem[int, tuple[str, Any]]) -> str:
    """
    Compares two frames; the comparison as JSON.
    """

def meets_any(scene: Scene, origins: Incomplete, directions: Incomplete, t_range: SupportsLenAndGetItem[SupportsFloat | SupportsIndex]) -> Incomplete:
    """
    Whether each ray meets anything.
    """

def program(arguments: SupportsGetItem[int, str]) -> int:
    """
    Runs the program on these arguments, the first of which is its name; its exit code.
    """

def project(camera: Camera, points: Incomplete) -> list[tuple[list[tuple[float, float, float, int]], str | None]]:
    """
    Of each of the (N, 3) points: its images, and why it has a whole curve of them, if it has.
    """

def project_many(camera: Camera, points: Incomplete, device: str | None, within_px: SupportsFloat | SupportsIndex) -> tuple[Incomplete, Incomplete, Incomplete, Incomplete, Incomplete, Incomplete, int]:
    """
    All images of (N, 3) points as arrays. `device`: none, the CPU; empty, the fastest adapter; else a part of an adapter's name.
    """

def read_exr(path: str | PathLike[str]) -> list[tuple[str, Any]]:
    """
    The channels of an EXR.
    """

def splat(camera: Camera, points: Incomplete, device: str | None) -> tuple[Incomplete, Incomplete, int]:
    """
    Each pixel's nearest of (N, 3) points: its number and its t, (H, W) each; how many points are degenerate.
    """

def write_exr(path: str | PathLike[str], planes: SupportsGetItem[int, tuple[str, Any]]) -> None:
    """
    Writes planes as EXR.
    """

def write_png(path: str | PathLike[str], srgb8: Incomplete) -> None:
    """
    Writes (H, W, 3) or (H, W, 4) sRGB bytes as PNG.
    """
