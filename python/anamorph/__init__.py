"""A multi-perspective renderer: triangles through cameras whose rays do not meet in a point, exactly.

>>> import anamorph as am
>>> scene = am.Scene()
>>> scene.add(am.Mesh([[-1, -1, 0], [1, -1, 0], [0, 1, 0]], [[0, 1, 2]], name="sail"))
>>> cam = am.camera.fisheye(eye=[0, 0, 2], target=[0, 0, 0], fov=200)
>>> frame = am.render(scene, cam, size=(64, 48), channels=["Z", "triangle.id"])
>>> frame["Z"].shape
(48, 64)

Arrays of an image are (height, width), row 0 on top. World units are those of the meshes; axes are right-handed, and nothing says which
of them is up. Angles are in degrees. Triangles are numbered through all meshes of a scene, from 0, in the order in which they were added.
"""

from . import camera
from ._camera import colmap_images
from ._cast import Hits, RayCaster, cast
from ._frame import NO_ID, Comparison, Frame, Views, compare
from ._gradients import Gradients, Parameter
from ._mesh import Mesh
from ._points import Projections, Splat, project_many, splat
from ._render import Projection, Renderer, check, gradients, project, render
from ._scene import Scene
from ._view import Viewer, view
from .camera import Camera

__all__ = [
    "NO_ID",
    "Camera",
    "Comparison",
    "Frame",
    "Gradients",
    "Hits",
    "Mesh",
    "Parameter",
    "Projection",
    "Projections",
    "RayCaster",
    "Renderer",
    "Scene",
    "Splat",
    "Viewer",
    "Views",
    "camera",
    "cast",
    "check",
    "colmap_images",
    "compare",
    "gradients",
    "project",
    "project_many",
    "render",
    "splat",
    "view",
]
