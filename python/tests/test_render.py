"""Rendering to arrays."""

import json
import pickle
import pydoc
import re
import subprocess
import sys
import threading
import time

import anamorph as am
import numpy as np
import pytest

SIZE = (64, 48)


def test_depth_and_ids_of_a_square(square, pinhole):
    frame = am.render(square, pinhole, size=SIZE, channels=["Z", "t", "triangle.id", "object.id"])
    assert list(frame) == ["Z", "t", "triangle.id", "object.id"]
    assert (frame.shape, frame["Z"].shape, frame["Z"].dtype, frame.ids.dtype) == ((48, 64), (48, 64), np.float32, np.uint32)
    hit = frame.ids != am.NO_ID
    assert 0.1 < hit.mean() < 0.9
    assert np.array_equal(hit, np.isfinite(frame["Z"])) and set(frame.ids[hit]) == {0, 1}
    # t is the distance along the view's axis, as the pinhole's directions are not normalized
    assert np.abs(frame["t"][hit] - 4).max() < 1e-6
    assert frame["Z"][hit].min() >= 4 and not frame["object.id"][hit].any()
    # the lower right triangle is the first
    row, column = np.argwhere(frame.ids == 0).mean(axis=0)
    assert row > 24 and column > 32


def test_colour_and_vectors(square, pinhole):
    frame = am.render(square, pinhole, size=SIZE)
    assert frame.rgb.shape == (48, 64, 3) and frame.rgb.dtype == np.uint8
    left, right = frame.rgb[24, 22], frame.rgb[24, 42]
    assert left[0] > 150 > left[2] and right[2] > 150 > right[0]
    frame = am.render(square, pinhole, size=SIZE, channels=["N", "P", "albedo.R"])
    assert frame["N"].shape == (48, 64, 3)
    assert np.allclose(frame["N"][24, 32], [0, 0, 1]) and np.abs(frame["P"][24, 32]).max() < 0.1
    with pytest.raises(KeyError, match="rendered without colour"):
        frame.rgb
    with pytest.raises(KeyError, match="Z: not rendered; there are N.X"):
        frame["Z"]


def test_samples_and_report(square, pinhole):
    frame = am.render(square, pinhole, size=SIZE, channels=["A"], samples=16)
    edge = frame["A"][(frame["A"] > 0) & (frame["A"] < 1)]
    assert len(edge) > 20 and np.allclose(edge * 16 % 1, 0)
    assert frame.report["triangles"] == 2 and frame.report["frame_ms"]["runs"] == 1
    json.dumps(frame.report)
    assert "A" in frame and "foo" not in frame and frame.get("foo") is None and frame.get("Z") is None
    again = am.render(square, pinhole, size=SIZE, channels=["A"], samples=16)
    assert frame == again != am.render(square, pinhole, size=SIZE, channels=["A"])


def test_files_come_back(square, pinhole, tmp_path):
    frame = am.render(square, pinhole, size=SIZE, channels=["R", "G", "B", "Z", "triangle.id"])
    frame.save(tmp_path / "a.exr")
    frame.save(str(tmp_path / "a.png"))
    again = am.Frame.read(tmp_path / "a.exr")
    assert list(again) == list(frame)
    for name in frame:
        assert np.array_equal(again[name], frame[name])
    same = am.compare(frame, again)
    assert same["wrong_triangle"] == 0
    assert am.check(square, pinhole, frame)["wrong_safe"] == 0
    with pytest.raises(ValueError, match="written as .exr or .png"):
        frame.save(tmp_path / "a.jpg")
    with pytest.raises(OSError, match="nowhere"):
        frame.save(tmp_path / "nowhere" / "a.exr")


def test_a_renderer_keeps_its_scene(square, pinhole):
    with am.Renderer(square) as renderer:
        renderer.aim(pinhole)
        near = renderer.render(["Z"], SIZE)
        renderer.aim(pinhole.with_(eye=[0, 0, 8]))
        far = renderer.render(["Z"], SIZE)
    assert np.isfinite(near["Z"]).sum() > 3 * np.isfinite(far["Z"]).sum()
    reference = am.Renderer(reference=True)
    assert reference.adapter is None
    truth = reference.render(["Z"], SIZE, scene=square, camera=pinhole)
    assert np.allclose(truth["Z"], near["Z"])


def test_cameras_of_rays(square):
    y, x = np.mgrid[1:-1:5j, -1:1:7j]
    origins = np.stack([x, y, np.full_like(x, 3)], axis=-1)
    directions = np.broadcast_to([0.0, 0.0, -2.0], origins.shape).copy()
    directions[0, 0] = np.nan
    frame = am.render(square, am.camera.rays(origins, directions), channels=["t", "Z", "P"])
    assert frame.shape == (5, 7) and np.isinf(frame["t"][0, 0])
    assert np.allclose(frame["t"][1:-1, 1:-1], 1.5) and np.allclose(frame["Z"][2, 3], 3)
    assert np.allclose(frame["P"][1:-1, 1:-1, :2], origins[1:-1, 1:-1, :2])
    # float32, and strides of its own
    again = am.render(square, am.camera.rays(origins.astype(np.float32)[::-1][::-1], directions), channels=["t"])
    assert np.array_equal(again["t"], frame["t"])
    with pytest.raises(ValueError, match=r"directions: .*\(H, W, 3\)"):
        am.camera.rays(origins, directions[:3])
    with pytest.raises(ValueError, match="leave the size out"):
        am.render(square, am.camera.rays(origins, directions), size=(3, 3))


def test_rays_and_projection_agree(square):
    camera = am.camera.fisheye(eye=[0.2, 0.1, 3], target=[0, 0, 0], fov=190)
    origins, directions = camera.rays(SIZE)
    assert origins.shape == directions.shape == (48, 64, 3)
    inside = np.isfinite(directions[..., 0])
    assert 0.3 < inside.mean() < 0.9
    row, column = 30, 40
    point = origins[row, column] + 2.5 * directions[row, column]
    (found,) = am.project(None, camera, [point], SIZE)
    assert np.allclose(found.images, [[column + 0.5, row + 0.5]]) and np.allclose(found.t, 2.5)
    assert found.degenerate is None
    assert camera.piece_count(SIZE) == 0 and camera.with_(pieces=400).piece_count(SIZE) > 0


def test_what_is_wrong_is_said(square, pinhole):
    with pytest.raises(ValueError, match='^unknown key "fvo" in camera; nearest'):
        am.render(square, am.Camera("pinhole", {"eye": [0, 0, 4], "target": [0, 0, 0], "vfov": 40, "fvo": 1}), size=SIZE)
    with pytest.raises(ValueError, match="vfov"):
        am.render(square, pinhole.with_(vfov=181), size=SIZE)
    with pytest.raises(ValueError, match="no size"):
        am.render(square, pinhole)
    with pytest.raises(ValueError, match="no camera"):
        am.render(square, size=SIZE)
    with pytest.raises(ValueError, match='no channel "ZZ"'):
        am.render(square, pinhole, size=SIZE, channels=["ZZ"])
    with pytest.raises(ValueError, match="1 to 64"):
        am.render(square, pinhole, size=SIZE, samples=65)
    with pytest.raises(ValueError, match="no such adapter; there is"):
        am.Renderer(adapter="no such adapter")
    with pytest.raises(TypeError, match="eye.1: object is no value"):
        am.render(square, pinhole.with_(eye=[0, object(), 4]), size=SIZE)
    with pytest.raises(ValueError, match="eye.2: NaN"):
        am.render(square, pinhole.with_(eye=[0, 0, float("nan")]), size=SIZE)


def test_other_threads_run_while_it_renders(square, pinhole):
    renderer = am.Renderer(reference=True)
    counted = 0
    done = threading.Event()

    def count():
        nonlocal counted
        while not done.is_set():
            counted += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    start = time.monotonic()
    renderer.render(["Z"], (1600, 1200), scene=square, camera=pinhole)
    took = time.monotonic() - start
    done.set()
    thread.join()
    # a turn of its loop takes a millisecond and little more, on a busy machine up to ten
    assert counted > took / 0.01 > 1, (counted, took)


def test_ctrl_c_ends_a_long_call():
    text = """
import signal, threading, time, anamorph as am
# shells start what runs in the background with signals that are ignored
signal.signal(signal.SIGINT, signal.default_int_handler)
scene = am.Scene()
scene.add_builtin("teapot", level=20)
cam = am.camera.pinhole(eye=[0, 0, 9], target=[0, 0, 0], vfov=40)
renderer = am.Renderer(reference=True)
threading.Timer(1.0, lambda: signal.raise_signal(signal.SIGINT)).start()
start = time.time()
try:
    renderer.render(["Z"], (8000, 8000), scene=scene, camera=cam)
except KeyboardInterrupt:
    print("ended after", time.time() - start, flush=True)
    import os
    os._exit(0)
"""
    out = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, timeout=60)
    assert out.stdout.startswith("ended after"), out
    assert float(out.stdout.split()[-1]) < 5, out.stdout


def test_what_moves_is_rendered_where_it_is(square: am.Scene, pinhole: am.Camera) -> None:
    square.add(am.Mesh([[-1, -1, 1], [1, -1, 1], [0, 1, 1]], [[0, 1, 2]], name="sail"))
    with am.Renderer(square) as renderer:
        renderer.aim(pinhole)
        before = renderer.render(["triangle.id"], size=(64, 48))["triangle.id"]
        matrix = np.eye(4)
        matrix[:3, 3] = [0.5, 0, 1]
        renderer.move("sail", matrix)
        moved = renderer.render(["triangle.id"], size=(64, 48))["triangle.id"]
        fresh = am.Scene()
        fresh.add(am.Mesh([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]]))
        fresh.add(am.Mesh([[-0.5, -1, 2], [1.5, -1, 2], [0.5, 1, 2]], [[0, 1, 2]]))
        assert (moved == am.render(fresh, pinhole, (64, 48), ["triangle.id"])["triangle.id"]).all()
        assert (moved != before).any()
        renderer.update("sail", [[-0.5, -1, 2], [1.5, -1, 2], [0.5, 1, 2]])
        assert (renderer.render(["triangle.id"], size=(64, 48))["triangle.id"] == moved).all()
        # from the new vertices
        renderer.move("sail", np.hstack([np.eye(3), [[-0.5], [0], [-1]]]))
        assert (renderer.render(["triangle.id"], size=(64, 48))["triangle.id"] == before).all()
        for wrong, says in [
            (lambda: renderer.move("car", matrix), 'has no object "car"; it has square, sail'),
            (lambda: renderer.move("sail", np.eye(3)), "matrix: an affine matrix"),
            (lambda: renderer.move("sail", np.full((3, 4), np.nan)), "use finite numbers"),
            (lambda: renderer.update("sail", np.zeros((4, 3))), "4 vertices for an object of 3"),
            (lambda: renderer.update("sail", np.zeros(3)), "vertices: an array of shape"),
        ]:
            with pytest.raises(ValueError, match=re.escape(says)):
                wrong()
        assert (renderer.render(["triangle.id"], size=(64, 48))["triangle.id"] == before).all()
    with pytest.raises(ValueError, match="no scene"):
        am.Renderer().move("sail", matrix)


def test_many_images_are_those_of_one_each(square: am.Scene) -> None:
    cameras = [am.camera.pinhole(eye=[np.sin(k), 0.1 * k, 4], target=[0, 0, 0], vfov=40) for k in range(5)]
    with am.Renderer(square) as renderer:
        views = renderer.render_many(cameras, ["Z", "triangle.id", "N"], size=(50, 30))
        assert views.shape == views["Z"].shape == views.ids.shape == (5, 30, 50) and views["N"].shape == (5, 30, 50, 3)
        assert views.report["views"] == 5
        for k, camera in enumerate(cameras):
            alone = renderer.render(["Z", "triangle.id", "N"], size=(50, 30), camera=camera)
            assert (views.ids[k] == alone.ids).all() and (views.frame(k).ids == alone.ids).all()
            # the last bit of a depth may differ
            np.testing.assert_array_max_ulp(views["Z"][k], alone["Z"], maxulp=1)
        colored = renderer.render_many(cameras, size=(50, 30))
        assert colored.rgb.shape == (5, 30, 50, 3) and colored.frame(2).rgb.shape == (30, 50, 3)
        assert repr(views) == "<anamorph.Views 5 of 50x30: Z, triangle.id, N.X, N.Y, N.Z>"
        with pytest.raises(ValueError, match="there is no camera"):
            renderer.render_many([])
        rays = am.camera.rays(np.zeros((8, 9, 3)), np.ones((8, 9, 3)))
        with pytest.raises(ValueError, match="camera 1 is 9x8, camera 0 50x30; all images need one size"):
            renderer.render_many([cameras[0], rays], scene=sized())


def sized() -> am.Scene:
    """A scene without triangles, and its image's size."""
    return am.Scene.parse("image = { width = 50, height = 30 }\ncamera = { kind = 'pinhole', eye = [0, 0, 4], target = [0, 0, 0], vfov = 40 }")


@pytest.mark.parametrize("size", [(0, 8), (8, 0), (-1, 8), (2**32, 8), (70_000, 2), (8,), (8, 8, 8), "88", (8.5, 8)])
def test_a_wrong_size_is_a_value_error(size, square, pinhole):
    calls = [
        lambda: am.render(square, pinhole, size=size),
        lambda: am.Renderer().render_many([pinhole], size=size, scene=square),
        lambda: am.gradients(square, pinhole, ["depth"], ["vertices"], size=size),
        lambda: pinhole.rays(size),
    ]
    for call in calls:
        with pytest.raises(ValueError, match="size") as refused:
            call()
        assert "\n" not in str(refused.value)


def test_a_size_may_be_a_list_and_channels_may_not_be_a_text(square, pinhole):
    assert am.render(square, pinhole, size=[8, 6], channels=["Z"])["Z"].shape == (6, 8)
    with pytest.raises(ValueError, match=r'as in \["Zt"\]'):
        am.render(square, pinhole, size=(8, 6), channels="Zt")


@pytest.mark.parametrize("wrong, own", [("depth", "Z"), ("normals", "N"), ("trianlge.id", "triangle.id")])
def test_a_wrong_channel_tells_the_right_one(square, pinhole, wrong, own):
    with pytest.raises(ValueError, match=f'no channel "{wrong}"; did you mean {own}\\? known: R, '):
        am.render(square, pinhole, size=(8, 6), channels=[wrong])


def test_errors_speak_python(square, pinhole):
    with pytest.raises(ValueError, match=r"^(?!.*(--|\[image\])).*give size=\(width, height\)$"):
        am.render(square, pinhole)


def test_no_id_has_a_help_of_its_own():
    assert "the id where nothing is hit" in pydoc.render_doc(am.NO_ID)
    ids = np.array([0, 0xFFFFFFFF], dtype=np.uint32)
    assert (ids == am.NO_ID).tolist() == [False, True] and np.full(2, am.NO_ID, dtype=np.uint32)[1] == ids[1]
    assert repr(am.NO_ID) == "4294967295" and pickle.loads(pickle.dumps(am.NO_ID)) == am.NO_ID
