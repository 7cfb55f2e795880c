"""Scenes: files, arrays, and meshes of other packages."""

import subprocess
import sys
import types
import warnings

import anamorph as am
import numpy as np
import pytest

SIZE = (40, 30)
SCENE = """
image = { width = 40, height = 30 }
camera = { kind = "pinhole", eye = [0, 0, 4], target = [0, 0, 0], vfov = 30 }
[[mesh]]
builtin = "box"
"""


def test_scene_files(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(SCENE)
    scene = am.Scene.load(path)
    assert scene.triangle_count == 12 and scene.objects == [("box", 12)] and scene.missing == []
    assert np.array_equal(scene.bounds, [[-0.5] * 3, [0.5] * 3])
    near = am.render(scene, channels=["Z"])
    assert near.shape == (30, 40)
    overrides = {"camera.eye": np.array([0.0, 0.0, 8.0]), "mesh.0.scale": 2, "mesh.0.name": "a b"}
    changed = am.Scene.load(str(path), overrides=overrides)
    assert changed.objects == [("a b", 12)] and changed.bounds[1, 0] == 1
    # twice as far and as large: every depth is doubled
    assert np.allclose(am.render(changed, channels=["Z"])["Z"], 2 * near["Z"])
    assert am.render(scene, scene.camera, size=(20, 15), channels=["Z"]).shape == (15, 20)
    assert am.Scene.parse(SCENE).triangle_count == 12
    named = am.Scene.load(path, {"mesh.0.name": "a \U0001f600 \"b\""})
    assert named.objects == [("a \U0001f600 \"b\"", 12)]
    # a scene's camera is its own, also beside another scene
    assert scene.camera.rays()[0].shape == (30, 40, 3) and scene.camera == scene.camera != changed.camera
    assert np.array_equal(scene.camera.rays()[0][0, 0], [0, 0, 4]) and np.array_equal(changed.camera.rays()[0][0, 0], [0, 0, 8])
    far = am.render(scene, changed.camera, channels=["Z"])
    assert np.isfinite(far["Z"]).sum() < np.isfinite(near["Z"]).sum()
    with pytest.raises(FileNotFoundError, match="none.toml"):
        am.Scene.load(tmp_path / "none.toml")
    with pytest.raises(ValueError, match="camera.vfov: expected a finite number"):
        am.Scene.load(path, {"camera.vfov": "wide"})


def test_arrays_of_any_kind_give_the_same_picture(pinhole):
    vertices = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], dtype=np.float64)
    faces = np.array([[0, 1, 2], [0, 2, 3]])

    def picture(vertices, faces):
        scene = am.Scene()
        scene.add(am.Mesh(vertices, faces))
        return am.render(scene, pinhole, size=SIZE, channels=["triangle.id"]).ids

    expected = picture(vertices, faces)
    assert len(np.unique(expected)) == 3
    wide = np.zeros((4, 6))
    wide[:, ::2] = vertices
    for same in (vertices.tolist(), vertices.astype(np.float32), np.asfortranarray(vertices), wide[:, ::2]):
        assert np.array_equal(picture(same, faces), expected)
    for same in (faces.tolist(), faces.astype(np.uint8), faces.astype(np.uint64), faces[::-1][::-1]):
        assert np.array_equal(picture(vertices, same), expected)


def test_keys_place_and_colour_meshes_of_arrays(square, pinhole):
    quad = am.Mesh([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]], uvs=[[0, 0], [1, 0], [1, 1], [0, 1]])
    scene = am.Scene()
    scene.add(quad, translate=[0, 0, 1], scale=0.5, color=[0, 1, 0], name="green")
    assert scene.objects == [("green", 2)]
    assert np.array_equal(scene.bounds, [[-0.5, -0.5, 1], [0.5, 0.5, 1]])
    frame = am.render(scene, pinhole, size=SIZE, channels=["Z", "albedo"])
    assert np.allclose(frame["albedo"][15, 20], [0, 1, 0]) and np.allclose(frame["Z"][15, 20], 3, atol=0.01)
    image = np.zeros((2, 2, 3), dtype=np.uint8)
    image[0, :, 0] = image[1, :, 2] = 255
    scene = am.Scene()
    scene.add(quad, texture=image)
    frame = am.render(scene, pinhole, size=SIZE, channels=["albedo"])
    # row 0 of an image is on top
    assert np.allclose(frame["albedo"][10, 20], [1, 0, 0], atol=0.1) and np.allclose(frame["albedo"][20, 20], [0, 0, 1], atol=0.1)


def test_meshes_of_other_packages(pinhole):
    faces = np.array([[0, 1, 2]])
    vertices = np.array([[-1, -1, 0], [1, -1, 0], [0, 1, 0]], dtype=np.float64)
    like_trimesh = types.SimpleNamespace(
        vertices=vertices,
        faces=faces,
        # both of these trimesh computes
        triangles=vertices[faces],
        vertex_normals=np.zeros((3, 3)),
        visual=types.SimpleNamespace(kind="vertex", vertex_colors=np.full((3, 4), [255, 0, 0, 255], dtype=np.uint8)),
    )
    like_open3d = types.SimpleNamespace(vertices=vertices, triangles=faces, vertex_normals=[], vertex_colors=[[0, 0.5, 0]] * 3)
    for mesh, color in ((like_trimesh, [1, 0, 0]), (like_open3d, [0, 0.214, 0])):
        scene = am.Scene()
        scene.add(mesh, name="of another")
        assert scene.objects == [("of another", 1)]
        frame = am.render(scene, pinhole, size=SIZE, channels=["albedo"])
        assert np.allclose(frame["albedo"][15, 20], color, atol=1e-3)


def test_mesh_files(tmp_path, pinhole):
    path = tmp_path / "a.ply"
    path.write_text(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n"
        "property list uchar int vertex_indices\nend_header\n-1 -1 0 0 0 255\n1 -1 0 0 0 255\n0 1 0 0 0 255\n3 0 1 2\n"
    )
    scene = am.Scene()
    scene.add(path, translate=(0, 0, 1))
    scene.add_builtin("icosphere", level=1, translate=[9, 9, 9])
    scene.add_builtin("box", name="crate", translate=[9, 9, 9])
    assert scene.objects == [("a", 1), ("icosphere", 80), ("crate", 12)]
    assert np.allclose(am.render(scene, pinhole, size=SIZE, channels=["albedo"])["albedo"][15, 20], [0, 0, 1])
    with pytest.raises(FileNotFoundError, match="none.ply"):
        scene.add(tmp_path / "none.ply")
    assert len(scene.objects) == 3


def test_what_is_wrong_is_said():
    good = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]

    def fails(kind, match, *arguments, **keys):
        scene = am.Scene()
        with pytest.raises(kind, match=match):
            scene.add(am.Mesh(*arguments, **keys))

    fails(ValueError, r"vertices: .*\(N, 3\) is needed, not \(3, 2\)", np.zeros((3, 2)), [[0, 1, 2]])
    fails(ValueError, r"faces: .*\(N, 3\)", good, [0, 1, 2])
    fails(TypeError, "faces: whole numbers", good, [[0.0, 1.0, 2.0]])
    fails(TypeError, "vertices: numbers", [["a", "b", "c"]], [[0, 0, 0]])
    fails(ValueError, "faces: indices are 0 and above, not -1 to 2", good, [[-1, 1, 2]])
    fails(ValueError, "triangle 0 is .*3 vertices", good, [[0, 1, 3]])
    fails(ValueError, "vertex 1 lies at .*finite", [[0, 0, 0], [np.nan, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    fails(ValueError, "2 normals for 3 vertices", good, [[0, 1, 2]], normals=[[0, 0, 1]] * 2)
    fails(ValueError, "from 0 to 1", good, [[0, 1, 2]], colors=[[0, 0, 2]] * 3)
    with pytest.raises(TypeError, match="dict is no mesh"):
        am.Scene().add({})
    with pytest.raises(ValueError, match="unknown key"):
        am.Scene().add(am.Mesh(good, [[0, 1, 2]]), colour=[1, 0, 0])
    with pytest.raises(ValueError, match="no texture coordinates"):
        am.Scene().add(am.Mesh(good, [[0, 1, 2]]), texture=np.zeros((2, 2, 3), dtype=np.uint8))
    with pytest.raises(TypeError, match="takes an image's file, not an array"):
        am.Scene().add("a.ply", texture=np.zeros((2, 2, 3), dtype=np.uint8))
    with pytest.raises(ValueError, match="type uint8"):
        am.Scene().add(am.Mesh(good, [[0, 1, 2]]), texture=np.zeros((2, 2, 3)))


def test_the_program_is_in_the_package():
    def run(*arguments):
        return subprocess.run([sys.executable, "-m", "anamorph", *arguments], capture_output=True, text=True)

    out = run("--version")
    assert out.returncode == 0 and out.stdout.startswith("anamorph "), out
    out = run("render", "none.toml", "-o", "a.png")
    assert out.returncode == 2 and out.stderr.startswith("error: none.toml") and out.stderr.count("\n") == 1, out


def test_arrays_of_other_libraries_by_dlpack() -> None:
    class OnlyDlpack:
        """An array as a library has it that knows nothing of NumPy."""

        def __init__(self, array: np.ndarray) -> None:
            self.own = array

        def __dlpack__(self, **options: object) -> object:
            return self.own.__dlpack__()

        def __dlpack_device__(self) -> tuple[int, int]:
            return self.own.__dlpack_device__()

    vertices = np.array([[-1.0, -1, 0], [1, -1, 0], [0, 1, 0]])
    mesh = am.Mesh(OnlyDlpack(vertices), OnlyDlpack(np.array([[0, 1, 2]])))
    assert (mesh.vertices == vertices).all() and np.shares_memory(mesh.vertices, vertices)
    scene = am.Scene()
    scene.add(mesh)
    assert am.cast(scene, OnlyDlpack(np.array([[0.0, 0, 1]])), [0, 0, -1]).triangle.tolist() == [0]
    # and frames are taken without a copy
    frame = am.render(scene, am.camera.pinhole(eye=[0, 0, 4], target=[0, 0, 0], vfov=40), (20, 10), ["Z"])
    assert np.shares_memory(np.from_dlpack(frame["Z"]), frame["Z"])


    scene.update("mesh", OnlyDlpack(vertices + 1))
    scene.move("mesh", OnlyDlpack(np.eye(4)))
    scene.animate("mesh", OnlyDlpack(np.array([0.0, 1.0])), OnlyDlpack(np.stack([vertices, vertices + 1])))
    rays = [OnlyDlpack(np.ones((2, 3, 3))) for _ in range(2)]
    assert am.camera.rays(*rays)._rays is not None


def test_fields_of_records_are_read_where_they_lie(pinhole) -> None:
    """Of records of 27 bytes the numbers of a field are no whole number of numbers apart."""
    vertices = np.array([[-1.0, -1, 0], [1, -1, 0], [0, 1, 0]])
    records = np.zeros(3, dtype=[("at", "<f8", 3), ("rgb", "u1", 3)])
    records["at"] = vertices
    normals = np.zeros(3, dtype=[("n", "<f4", 3), ("rgb", "u1", 3)])
    normals["n"] = [0, 0, 1]

    def seen(at, n):
        scene = am.Scene()
        scene.add(am.Mesh(at, [[0, 1, 2]], normals=n))
        return am.render(scene, pinhole, SIZE, ["Z", "N.X"])

    expected = seen(vertices, np.array([[0, 0, 1]] * 3, dtype=np.float32))
    found = seen(records["at"], normals["n"])
    assert all(np.array_equal(found[name], expected[name]) for name in ("Z", "N.X"))
    assert np.array_equal(am.splat(pinhole, records["at"], size=SIZE).point, am.splat(pinhole, vertices, size=SIZE).point)
    with pytest.raises(TypeError, match="numbers are needed, not complex128"):
        am.Mesh(vertices + 0j, [[0, 1, 2]])


def test_animations_follow_one_another() -> None:
    bar = np.array([[-0.1, -2, 0], [0.1, -2, 0], [0.1, 2, 0]], dtype=float)
    scene = am.Scene()
    scene.add(am.Mesh(bar, [[0, 1, 2]], name="bar"))
    for k in range(400):
        scene.animate("bar", [k, k + 1], [bar + k, bar + k + 1])


def test_what_moves_is_seen_at_the_time_of_its_row() -> None:
    bar = np.array([[-0.1, -2, 0], [0.1, -2, 0], [0.1, 2, 0], [-0.1, 2, 0]], dtype=float)
    scene = am.Scene()
    scene.add(am.Mesh(bar, [[0, 1, 2], [0, 2, 3]], name="bar"))
    camera = am.camera.orthographic(eye=[0, 0, 5], target=[0, 0, 0], height=3)
    still = am.render(scene, camera, size=(64, 48), channels=["Z"])["Z"]
    scene.animate("bar", [0, 1], [bar - [1, 0, 0], bar + [1, 0, 0]])
    scene.expose(line_time=1 / 48)
    seen = am.render(scene, camera, size=(64, 48), channels=["Z"])["Z"]
    width = 3 / 48
    for row in range(48):
        middle = -1 + 2 * row / 48
        x = (np.arange(64) + 0.5 - 32) * width
        # times are rounded to 2^-24 of the way of 2 units
        sure = np.abs(np.abs(x - middle) - 0.1) > 1e-6
        assert (np.isfinite(seen[row]) == (np.abs(x - middle) < 0.1))[sure].all(), row
    # read to the left all at its own time
    scene.expose(times=np.full((1, 64), 0.5))
    assert (am.render(scene, camera, size=(64, 48), channels=["Z"])["Z"] == still).all()
    # a move lets it stand still again
    scene.move("bar", np.eye(4))
    scene.expose(line_time=1 / 48)
    first = am.render(scene, camera, size=(64, 48), channels=["Z"])["Z"]
    assert (first == first[0]).all()


def test_wrong_motion_is_refused() -> None:
    scene = am.Scene()
    scene.add(am.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], name="a"))
    one = np.zeros((3, 3))
    for times, vertices, says in [
        ([0, 1], [one], "times of shape"),
        ([1, 0], [one, one], "ascend"),
        ([0], [one[:2]], "2 vertices at time 0 for an object of 3"),
        ([0], [one * np.nan], "use finite numbers"),
    ]:
        with pytest.raises(ValueError, match=says):
            scene.animate("a", times, np.array(vertices))
    with pytest.raises(ValueError, match="no object"):
        scene.animate("b", [0], one[None])
    with pytest.raises(ValueError, match="is no order"):
        scene.expose(line_time=1, line_order="sideways")
    with pytest.raises(ValueError, match="shutter"):
        scene.expose(shutter=-1)
    with pytest.raises(ValueError, match="leave line_time out"):
        scene.expose(line_time=1, times=np.zeros((2, 2)))


def test_pictures_are_thrown_onto_surfaces(tmp_path, pinhole) -> None:
    from_front = {"kind": "orthographic", "eye": [0, 0, 4], "target": [0, 0, 0], "height": 0.8}
    white = np.full((3, 4, 3), 255, np.uint8)
    scene = am.Scene()
    scene.add_builtin("box", color=[0.2, 0.2, 0.2])
    bare = am.render(scene, pinhole, size=SIZE, channels=["R", "G", "B"])
    bare.save(tmp_path / "take.png")
    assert scene.throw(tmp_path / "take.png", from_front, mode="show") == 0
    scene.show(0, white)
    shown = am.render(scene, pinhole, size=SIZE, channels=["R", "G"])
    assert bare["R"][15, 20] == pytest.approx(0.2, abs=1e-3) and shown["R"][15, 20] == pytest.approx(1, abs=1e-3)
    # the next frame of a video: red
    scene.show(0, white * np.array([1, 0, 0], np.uint8))
    red = am.render(scene, pinhole, size=SIZE, channels=["R", "G"])
    assert red["R"][15, 20] == pytest.approx(1, abs=1e-3) and red["G"][15, 20] == pytest.approx(0, abs=1e-3)
    with pytest.raises(ValueError, match="there is no projector light 1"):
        scene.show(1, white)
    with pytest.raises(ValueError, match="picture: an array of shape"):
        scene.show(0, white[0])
    with pytest.raises(ValueError, match="projector_light.*opacity: 2 is out of range"):
        scene.throw(tmp_path / "take.png", am.camera.pinhole(eye=[0, 0, 4], target=[0, 0, 0], vfov=20), opacity=2)


def test_spheres_of_arrays(pinhole) -> None:
    scene = am.Scene()
    scene.add_builtin("plane", translate=[0, -9, 0])
    centers = np.array([[0.0, 0.0, 0.0], [1.0, 0.5, 0.0]])
    scene.add_spheres(centers, radii=[0.5, 0.25], colors=[[1, 0, 0], [0, 0.5, 1]], name="atoms")
    assert scene.objects == [("plane", 2), ("atoms", 2)]
    frame = am.render(scene, pinhole, size=SIZE, channels=["triangle.id", "albedo", "N", "P"])
    seen = frame["triangle.id"]
    for k, (center, radius, color) in enumerate(zip(centers, [0.5, 0.25], [[1, 0, 0], [0, 0.5, 1]])):
        own = seen == 2 + k
        assert own.any()
        places = np.stack([frame[f"P.{axis}"][own] for axis in "XYZ"], axis=-1)
        normals = np.stack([frame[f"N.{axis}"][own] for axis in "XYZ"], axis=-1)
        assert np.allclose(np.linalg.norm(places - center, axis=-1), radius, atol=1e-5)
        assert np.allclose(normals, (places - center) / radius, atol=1e-4)
        assert np.allclose(np.stack([frame[f"albedo.{c}"][own] for c in "RGB"], axis=-1), color)
    scene.add_spheres(centers, radii=0.1, scale=2, translate=[0, 0, -3])
    assert scene.objects[-1] == ("spheres", 2)
    for wrong in [
        {"centers": [[0, 0]], "radii": 1},
        {"centers": centers, "radii": [1, 2, 3]},
        {"centers": centers, "radii": 0},
        {"centers": centers, "radii": np.nan},
        {"centers": centers, "radii": 1, "colors": [[0, 0, 2]] * 2},
        {"centers": centers, "radii": 1, "colors": [[0, 0, 1]]},
        {"centers": centers, "radii": 1, "scale": [1, 2, 1]},
    ]:
        with pytest.raises(ValueError):
            scene.add_spheres(**wrong)


def test_capsules_of_arrays(pinhole) -> None:
    scene = am.Scene()
    ends = np.array([[[-0.8, 0.0, 0.0], [0.6, 0.4, 0.3]], [[1.0, -0.5, 0.0], [1.0, -0.5, 0.0]]])
    scene.add_capsules(ends, radii=[0.3, 0.25], colors=[[1, 0, 0], [0, 0.5, 1]], name="bonds")
    assert scene.objects == [("bonds", 2)]
    frame = am.render(scene, pinhole, size=SIZE, channels=["triangle.id", "albedo", "N", "P"])
    for k, (radius, color) in enumerate(zip([0.3, 0.25], [[1, 0, 0], [0, 0.5, 1]])):
        own = frame["triangle.id"] == k
        assert own.any()
        places = np.stack([frame[f"P.{axis}"][own] for axis in "XYZ"], axis=-1)
        normals = np.stack([frame[f"N.{axis}"][own] for axis in "XYZ"], axis=-1)
        a, b = ends[k]
        share = np.clip((places - a) @ (b - a) / max((b - a) @ (b - a), 1e-300), 0, 1)
        offsets = places - (a + share[:, None] * (b - a))
        assert np.allclose(np.linalg.norm(offsets, axis=-1), radius, atol=1e-5)
        assert np.allclose(normals, offsets / radius, atol=1e-4)
        assert np.allclose(np.stack([frame[f"albedo.{c}"][own] for c in "RGB"], axis=-1), color)
    scene.add_capsules(ends, radii=0.1, scale=2, translate=[0, 0, -3])
    assert scene.objects[-1] == ("capsules", 2)
    for wrong in [
        {"ends": [[0, 0, 0]], "radii": 1},
        {"ends": ends, "radii": [1, 2, 3]},
        {"ends": ends, "radii": 0},
        {"ends": np.full((1, 2, 3), np.inf), "radii": 1},
        {"ends": ends, "radii": 1, "colors": [[0, 0, 1]]},
    ]:
        with pytest.raises(ValueError):
            scene.add_capsules(**wrong)


def test_a_volume_of_an_array() -> None:
    scene = am.Scene()
    look = {"min": [-1, -1, -1], "max": [1, 1, 1], "transfer": [[0, 1, 1, 1, 0], [1, 1, 0.5, 0, 0.7]]}
    scene.set_volume(np.ones((2, 3, 4)), **look)
    camera = am.camera.orthographic(eye=[0, 0, 5], target=[0, 0, 0], height=1)
    seen = am.render(scene, camera, size=(8, 8), channels=["R", "G", "B", "A"])
    hidden = 1 - np.exp(-1.4)
    assert np.allclose(seen["A"], hidden, atol=1 / 512) and np.allclose(seen["G"], hidden / 2, atol=1 / 512)
    scene.set_volume(None)
    assert not am.render(scene, camera, size=(8, 8), channels=["A"])["A"].any()
    for values, keys, says in [
        (np.ones((2, 2)), look, "an array of shape"),
        (np.ones((2, 2, 1)), look, "three sides of 2 to 4096"),
        (np.full((2, 2, 2), np.nan), look, "is NaN"),
        (np.ones((2, 2, 2)), {**look, "max": [1, -1, 1]}, "above that of min"),
        (np.ones((2, 2, 2)), {**look, "file": "a.npy"}, "unknown key"),
    ]:
        with pytest.raises(ValueError, match=says):
            scene.set_volume(values, **keys)


def test_a_scene_of_trimesh_goes_in_with_its_nodes(pinhole):
    vertices, faces = np.array([[-1.0, -1, 0], [1, -1, 0], [0, 1, 0]]), np.array([[0, 1, 2]])
    image = np.zeros((1, 1, 3), dtype=np.uint8)
    image[..., 1] = 255
    material = types.SimpleNamespace(image=image)
    textured = types.SimpleNamespace(kind="texture", uv=np.zeros((3, 2)), material=material)
    plain = types.SimpleNamespace(kind="texture", uv=None, material=types.SimpleNamespace(main_color=[255, 0, 0, 255]))
    near, far = np.eye(4), np.eye(4)
    far[:3, 3] = [0, 0, -3133805.225747891]

    class Graph(dict):
        nodes_geometry = ["wall", "door", "points"]

    like = types.SimpleNamespace(
        graph=Graph(wall=(near, "a"), door=(far, "b"), points=(near, "c")),
        geometry={
            "a": types.SimpleNamespace(vertices=vertices, faces=faces, visual=textured),
            "b": types.SimpleNamespace(vertices=vertices, faces=faces, visual=plain),
            "c": types.SimpleNamespace(vertices=vertices),
        },
    )
    scene = am.Scene()
    with pytest.warns(UserWarning, match="points of the scene is no mesh"):
        scene.add(like)
    assert [name for name, _ in scene.objects] == ["wall", "door"]
    assert scene.bounds[0][2] == -3133805.225747891
    frame = am.render(scene, pinhole, size=SIZE, channels=["albedo"])
    assert np.allclose(frame["albedo"][15, 20], [0, 1, 0])


def test_what_a_mesh_of_trimesh_loses_is_said(pinhole: am.Camera) -> None:
    vertices, faces = np.array([[-1.0, -1, 0], [1, -1, 0], [0, 1, 0]]), np.array([[0, 1, 2]])
    image = np.full((1, 1, 3), [0, 255, 0], dtype=np.uint8)

    def like(kind: str, uv: object = None, **material: object) -> types.SimpleNamespace:
        visual = types.SimpleNamespace(kind=kind, uv=uv, material=types.SimpleNamespace(**material))
        return types.SimpleNamespace(vertices=vertices, faces=faces, visual=visual)

    for mesh, says in [
        (like("face"), "left out: mesh: colours of faces"),
        (like("texture", np.zeros((3, 2)), image=image, normalTexture=image), "the material's normalTexture"),
        (like("texture", None, image=image), "as the mesh has no texture coordinates"),
    ]:
        with pytest.warns(UserWarning, match=says) as warned:
            am.Scene().add(mesh)
        assert warned[0].filename == __file__
        # rays see no colours
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            assert am.RayCaster(mesh).intersects_first([[0, 0, 1]], [[0, 0, -1]]) == [0]
    # a Mesh that is made of one first keeps its image
    scene = am.Scene()
    scene.add(am.Mesh.of(like("texture", np.zeros((3, 2)), image=image)))
    assert np.allclose(am.render(scene, pinhole, size=SIZE, channels=["albedo"])["albedo"][15, 20], [0, 1, 0])
