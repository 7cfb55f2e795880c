"""Scenes, cameras and renderers in other processes: pickled, and after a fork."""

from __future__ import annotations

import copy
import os
import pickle
import subprocess
import sys
from pathlib import Path

import anamorph as am
import numpy as np
import pytest

# As torch's DataLoader takes items from a data set in worker processes.
WORKERS = """
import multiprocessing, sys
import anamorph as am
import numpy as np

class Views:
    def __init__(self, scene):
        self.renderer = am.Renderer(scene)

    def __getitem__(self, number):
        self.renderer.move("teapot", np.eye(4) + 0.1 * number * np.eye(4, k=3))
        camera = am.camera.fisheye(eye=[0.3, -4, number], target=[0, 0, 0.1], fov=120)
        return self.renderer.render(["Z", "triangle.id"], size=(24, 16), camera=camera)

def take(views, numbers, queue):
    queue.put([(number, views[number]) for number in numbers])

if __name__ == "__main__":
    scene = am.Scene()
    scene.add_builtin("teapot")
    scene.add_spheres([[2, 0, 0]], 0.5)
    views = Views(scene)
    expected = {number: views[number] for number in range(4)}
    # loops on all cores ran in this process
    am.cast(scene, np.random.default_rng(1).uniform(-9, 9, (100_000, 3)), [0.0, 0.0, 1.0])
    context = multiprocessing.get_context(sys.argv[1])
    queue = context.Queue()
    workers = [context.Process(target=take, args=(views, numbers, queue)) for numbers in ([0, 1], [2, 3])]
    for worker in workers:
        worker.start()
    found = dict(pair for _ in workers for pair in queue.get(timeout=120))
    for worker in workers:
        worker.join(60)
    assert [worker.exitcode for worker in workers] == [0, 0]
    assert found == expected and len({frame["Z"].tobytes() for frame in found.values()}) == 4
    print("same")
"""


CAN_FORK = pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")


@pytest.mark.parametrize("start", ["spawn", pytest.param("fork", marks=CAN_FORK)])
def test_worker_processes_render_what_the_first_one_does(start: str, tmp_path: Path) -> None:
    (tmp_path / "workers.py").write_text(WORKERS)
    out = subprocess.run([sys.executable, "workers.py", start], cwd=tmp_path, capture_output=True, text=True, timeout=240)
    assert out.stdout == "same\n", out


@CAN_FORK
def test_a_forked_process_makes_all_calls_that_its_parent_made(tmp_path: Path) -> None:
    text = """
import os, sys, warnings, anamorph as am, numpy as np
warnings.simplefilter("ignore")
scene, renderer = am.Scene(), am.Renderer()
scene.add_builtin("icosphere", level=5)
camera = am.camera.pinhole(eye=[0, 0, 4], target=[0, 0, 0], vfov=40)
points = np.random.default_rng(1).uniform(-1, 1, (10_000, 3))

def everything():
    again = am.Scene()
    again.add(am.Mesh(points, np.arange(9_999).reshape(-1, 3)))
    frame = renderer.render(["Z", "triangle.id"], size=(32, 24), scene=scene, camera=camera)
    frame.save(sys.argv[1])
    read = am.Frame.read(sys.argv[1])
    return [
        scene.bounds.tolist(), again.bounds.tolist(), am.cast(scene, points, [0.0, 0.0, 1.0], all=True).t.sum(),
        am.project_many(camera, points, size=(32, 24)).images.sum(), am.check(scene, camera, frame)["wrong_safe"],
        am.render(scene, camera, size=(32, 24), channels=["Z"])["Z"].tobytes(), read["Z"].tobytes(),
        renderer.render_many([camera, camera], ["Z"], size=(8, 8), scene=scene)["Z"].tobytes(),
    ]

expected = everything()
child = os.fork()
if child == 0:
    assert everything() == expected
    # as the processes of multiprocessing end
    os._exit(7)
print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)
assert everything() == expected
"""
    command = [sys.executable, "-c", text, str(tmp_path / "frame.exr")]
    out = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert (out.stdout, out.returncode) == ("7\n", 0), out


def pictures(scene: am.Scene) -> list[bytes]:
    with am.Renderer(scene) as renderer:
        camera = am.camera.pinhole(eye=[0, 0.3, 4], target=[0, 0, 0], vfov=60)
        frame = renderer.render(["Z", "triangle.id", "R", "N.X"], size=(40, 30), camera=camera)
        return [frame[name].tobytes() for name in frame]


def shifted(x: float) -> np.ndarray:
    return np.eye(4) + x * np.eye(4, k=3)


def everything(folder: Path) -> am.Scene:
    """A scene that most methods have changed."""
    (folder / "mesh.obj").write_text("v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n")
    (folder / "scene.toml").write_text(
        "image = { width = 8, height = 6 }\ncamera = { kind = 'pinhole', eye = [0, 0, 4], target = [0, 0, 0], vfov = 40 }\n"
        "mesh = [{ file = 'mesh.obj', name = 'first' }]\n"
    )
    scene = am.Scene.load(folder / "scene.toml", {"mesh.0.color": [0.2, 0.5, 0.1]})
    vertices = np.array([[-1.0, -1, -1], [1, -1, -1], [0, 1, -1]])
    texture = np.arange(48, dtype=np.uint8).reshape(4, 4, 3)
    scene.add(am.Mesh(vertices, [[0, 1, 2]], uvs=[[0, 0], [1, 0], [0, 1]], name="second"), texture=texture)
    scene.add_spheres([[1, 1, 0]], [0.3], colors=[[1, 0, 0]])
    scene.move("second", shifted(0.3))
    scene.add_builtin("box", scale=0.2)
    scene.update("first", vertices + [0.5, 0.0, 0.2])
    scene.move("spheres", shifted(0.25))
    scene.expose(line_time=0.01)
    scene.set_volume(np.ones((2, 2, 2)), min=[-1, -1, -1], max=[0, 0, 0], transfer=[[0, 0, 0, 0, 0], [1, 1, 1, 1, 0.5]])
    vertices[:] = 99.0
    texture[:] = 0
    return scene


def test_a_pickled_scene_is_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    scene = everything(Path())
    monkeypatch.chdir("/")
    again = pickle.loads(pickle.dumps(scene))
    assert again.objects == scene.objects and pictures(again) == pictures(scene)
    # either goes its own way
    copied = copy.copy(scene)
    scene.move("second", np.eye(4))
    assert pictures(pickle.loads(pickle.dumps(copied))) == pictures(again) != pictures(scene)
    # the camera of a scene's file goes with it
    assert np.array_equal(pickle.loads(pickle.dumps(scene.camera)).rays()[1], scene.camera.rays()[1])
    (tmp_path / "mesh.obj").unlink()
    with pytest.raises(FileNotFoundError, match=r"mesh\.obj"):
        pickle.loads(pickle.dumps(scene))


def test_what_a_scene_keeps_does_not_grow_with_moves(square: am.Scene) -> None:
    vertices = np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    sizes = []
    for k in range(50):
        square.update("square", vertices + 1e-3 * k)
        square.animate("square", [0, 1], np.stack([vertices, vertices + 1e-3 * k]))
        square.move("square", shifted(1e-3 * k))
        square.expose(line_time=1e-3 * k)
        sizes.append(len(pickle.dumps(square)))
    # numbers take eight bytes, whatever their value; small ones before the first step do not
    assert len(set(sizes[1:])) == 1
    assert pictures(pickle.loads(pickle.dumps(square))) == pictures(square)


@pytest.mark.parametrize(
    "calls",
    [["animate", "move"], ["move", "animate"], ["update", "move", "animate", "move"], ["move", "update"], ["animate", "update", "animate"]],
)
def test_calls_that_are_left_out_change_nothing(calls: list[str]) -> None:
    scene = am.Scene()
    scene.add_builtin("icosphere", level=1, smooth=True)
    [(ball, _)] = scene.objects
    vertices = np.random.default_rng(1).uniform(-1, 1, (42, 3))
    for round_ in range(3):
        for k, call in enumerate(calls):
            shift = 0.1 * k + 0.3 * round_
            if call == "move":
                scene.move(ball, shifted(shift))
            elif call == "update":
                scene.update(ball, vertices + shift)
            else:
                scene.animate(ball, [0, 1], np.stack([vertices, vertices + shift]))
    scene.expose(line_time=0.02)
    assert pictures(pickle.loads(pickle.dumps(scene))) == pictures(scene)


def test_a_renderer_pickles_with_its_scene_and_camera(square: am.Scene, pinhole: am.Camera) -> None:
    renderer = am.Renderer(square, reference=True)
    renderer.aim(pinhole)
    again = pickle.loads(pickle.dumps(renderer))
    assert again.adapter is None and again.camera == pinhole
    assert again.render(["Z"], size=(8, 6)) == renderer.render(["Z"], size=(8, 6))
    with pytest.raises(ValueError, match="no such adapter"):
        am.Renderer(adapter="no such adapter")
