"""Lenses and their pictures by OpenCV, for tests/cameras/opencv.rs.

    lenses.py make FOLDER COUNT CALIBRATED   writes cam-N.yml, .xml or .json, points.f64 and lenses.json
    lenses.py check FOLDER                   reads rays.f64, and compares each ray with OpenCV's forward models

COUNT random lenses of each model, and CALIBRATED that calibrateCamera found, with every combination of its flags.
"""

import json
import sys
from itertools import product
from pathlib import Path

import cv2
import numpy as np

WIDTH, HEIGHT, POINTS = 16, 12, 16
FOCAL, CENTRE = (10.5, 9.75), (7.25, 5.875)
MATRIX = np.array([[FOCAL[0], 0, CENTRE[0]], [0, FOCAL[1], CENTRE[1]], [0, 0, 1]])
# largest error of a pixel
PIXEL = 1e-9


def random_lenses(count):
    """Name, coefficients: every other without tangential terms; rational ones with and without poles."""
    rng = np.random.default_rng(20)
    for name, size in [("plain", 5), ("rational", 8), ("prism", 12), ("tilted", 14), ("fisheye", 4)]:
        for n in range(count):
            k = np.zeros(size)
            if name == "fisheye":
                k[:] = rng.uniform(-1, 1, 4) * [0.2, 0.1, 0.05, 0.02]
                yield name, k
                continue
            k[[0, 1, 4]] = rng.uniform(-1, 1, 3) * [0.5, 0.3, 0.1]
            if n % 2:
                k[2:4] = rng.uniform(-1, 1, 2) * (0.05 if n % 10 == 1 else 0.005)
            if size >= 8:
                k[5:8] = rng.uniform(-1, 1, 3) * [0.3, 0.2, 0.1]
            if size >= 12 and n % 3:
                k[8:12] = rng.uniform(-1, 1, 4) * 0.02
            if size >= 14:
                k[12:14] = rng.uniform(-1, 1, 2) * 0.3
            yield name, k


def calibrated_lenses(count):
    """What calibrateCamera makes of pictures of a board with noise in them."""
    flags = [("rational", cv2.CALIB_RATIONAL_MODEL), ("prism", cv2.CALIB_THIN_PRISM_MODEL), ("tilted", cv2.CALIB_TILTED_MODEL)]
    combinations = list(product([0, 1], repeat=len(flags)))
    rng = np.random.default_rng(21)
    board = np.stack([*np.meshgrid(np.arange(7.0), np.arange(5.0)), np.zeros((5, 7))], -1).reshape(-1, 3) - [3, 2, 0]
    for n in range(count):
        chosen = combinations[n % len(combinations)]
        named = "+".join(name for (name, _), on in zip(flags, chosen) if on) or "plain"
        k = np.array([rng.uniform(-0.4, 0.1), rng.uniform(-0.1, 0.2), *rng.uniform(-0.002, 0.002, 2), 0])
        size = (640, 480)
        matrix = np.array([[520.0, 0, 310], [0, 515, 250], [0, 0, 1]])
        seen, boards = [], []
        for _ in range(6):
            turn, move = rng.uniform(-0.5, 0.5, 3), np.array([*rng.uniform(-1.5, 1.5, 2), rng.uniform(7, 12)])
            places = cv2.projectPoints(board, turn, move, matrix, k)[0]
            seen.append((places + rng.normal(0, 0.3, places.shape)).astype(np.float32))
            boards.append(board.astype(np.float32))
        used = sum(flag for (_, flag), on in zip(flags, chosen) if on)
        end = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 20, 1e-9)
        _, found, k, _, _ = cv2.calibrateCamera(boards, seen, size, None, None, flags=used, criteria=end)
        # the same picture in fewer pixels
        scale = np.array([WIDTH / size[0], HEIGHT / size[1]])
        matrix = np.diag([*scale, 1]) @ found
        matrix[:2, 2] += 0.5 * scale - 0.5
        yield "calibrated " + named, k.ravel(), matrix


def write(path, k, matrix):
    file = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
    file.write("calibration_time", "now & <then>")
    file.write("image_width", WIDTH)
    file.write("image_height", HEIGHT)
    file.write("camera_matrix", matrix)
    file.write("distortion_coefficients", k.reshape(1, -1))
    file.release()


def forward(fisheye, k, matrix, points):
    """OpenCV's pixels of points in its frame."""
    points, zero = np.ascontiguousarray(points).reshape(-1, 1, 3), np.zeros(3)
    if fisheye:
        return cv2.fisheye.projectPoints(points, zero, zero, matrix, k)[0].reshape(-1, 2)
    return cv2.projectPoints(points, zero, zero, matrix, k)[0].reshape(-1, 2)


def slopes(k, p):
    """dF/dp of the Brown model before the tilt, by central differences of OpenCV's own forward model."""
    k = np.concatenate([k, np.zeros(14 - len(k))])
    k[12:] = 0
    step, identity = 1e-6, np.eye(3)
    sides = [forward(False, k, identity, np.column_stack([p + s, np.ones(len(p))])) for s in (np.array([step, 0]), -np.array([step, 0]), np.array([0, step]), -np.array([0, step]))]
    return np.stack([(sides[0] - sides[1]) / (2 * step), (sides[2] - sides[3]) / (2 * step)], -1)


def branch_radius(k):
    """Radius of a disc without a pole on which the symmetric part of dF/dp is over 0.2 in all samples, so that F is one to one."""
    full = np.concatenate([k, np.zeros(14 - len(k))])
    # the radial part may fall steeply in a narrow range
    radii = np.linspace(0, 1, 20001)[1:]
    q = radii**2
    below = 1 + full[5] * q + full[6] * q**2 + full[7] * q**3
    radial = radii * (1 + full[0] * q + full[1] * q**2 + full[4] * q**3) / below
    good = (below > 0) & (np.diff(radial, prepend=0) > 0.2 * radii[0])
    end = 1.0 if good.all() else radii[np.argmin(good)]
    angles = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    radii = np.arange(0.05, 1.01, 0.05) * 0.95 * end
    j = slopes(k, np.concatenate([r * circle for r in radii]))
    least = np.linalg.eigvalsh(0.5 * (j + np.swapaxes(j, 1, 2)))[:, 0].reshape(len(radii), -1).min(1)
    good = least > 0.2
    return radii[: np.argmin(good)].max(initial=0.04) if not good.all() else radii[-1]


def make(folder, count, calibrated):
    rng = np.random.default_rng(22)
    lenses, points = [], []
    everything = [(name, k, MATRIX) for name, k in random_lenses(count)] + list(calibrated_lenses(calibrated))
    for n, (name, k, matrix) in enumerate(everything):
        if not (np.isfinite(k).all() and np.isfinite(matrix).all()):
            continue
        fisheye = name == "fisheye"
        file = f"cam-{n}.{['yml', 'xml', 'json'][n % 3]}"
        write(folder / file, k, matrix)
        lenses.append({"name": name, "file": file, "k": k.tolist(), "matrix": matrix.tolist(), "fisheye": fisheye})
        p = rng.uniform(-1, 1, (POINTS, 2)) * 0.6 * (0.5 if fisheye else branch_radius(k))
        pixels = forward(fisheye, k, matrix, np.column_stack([p, np.ones(POINTS)]))
        points.append(np.column_stack([p, pixels]))
    np.stack(points).astype("<f8").tofile(folder / "points.f64")
    (folder / "lenses.json").write_text(json.dumps(lenses))


def reach(k):
    """The distorted radius that a radial Brown lens reaches: at its first fold or pole."""
    k = np.concatenate([k, np.zeros(14 - len(k))])
    above, below = np.polynomial.Polynomial([1, k[0], k[1], k[4]]), np.polynomial.Polynomial([1, *k[5:8]])
    q = np.polynomial.Polynomial([0, 2])
    slope = (above + q * above.deriv()) * below - q * above * below.deriv()

    def first(polynomial):
        roots = polynomial.trim().roots()
        real = roots[(np.abs(roots.imag) < 1e-9 * np.abs(roots)) & (roots.real > 0)].real
        return real.min(initial=np.inf)

    fold, pole = first(slope), first(below)
    return np.sqrt(fold) * above(fold) / below(fold) if fold < pole else np.inf


def check(folder):
    lenses = json.loads((folder / "lenses.json").read_text())
    rays = np.fromfile(folder / "rays.f64", "<f8").reshape(len(lenses), HEIGHT, WIDTH, 3)
    pixels = np.stack(np.meshgrid(np.arange(float(WIDTH)), np.arange(float(HEIGHT))), -1)
    told, bad = {}, []
    for lens, own in zip(lenses, rays):
        k, matrix = np.array(lens["k"]), np.array(lens["matrix"])
        has = np.isfinite(own[..., 0])
        # OpenCV's fisheye stops before 90 degrees
        compared = has & (own[..., 2] > 0.02) if lens["fisheye"] else has
        off = np.linalg.norm(forward(lens["fisheye"], k, matrix, own[compared]) - pixels[compared], axis=-1) if compared.any() else np.zeros(0)
        n, without, worst = told.get(lens["name"], (0, 0, 0.0))
        told[lens["name"]] = (n + len(off), without + int((~has).sum()), max(worst, off.max(initial=0)))
        if not (off <= PIXEL).all():
            bad.append(f"{lens['file']} ({lens['name']}, {k.tolist()}): {off.max()} px off")
        if not lens["fisheye"] and not k[2:4].any() and not k[8:].any():
            radius = np.linalg.norm((pixels - matrix[:2, 2]) / [matrix[0, 0], matrix[1, 1]], axis=-1)
            end = reach(k)
            wrong = (has & (radius > end + 1e-9)) | (~has & (radius < end - 1e-9))
            if wrong.any():
                bad.append(f"{lens['file']} ({lens['name']}, {k.tolist()}): {wrong.sum()} pixels with or without a ray, reach {end}")
    for name, (n, without, worst) in told.items():
        print(f"{name}: {n} rays, at most {worst:.2g} px off; {without} pixels without one")
    if bad:
        sys.exit("\n".join([f"{len(bad)} lenses are wrong:", *bad[:5]]))


if __name__ == "__main__":
    if sys.argv[1] == "make":
        make(Path(sys.argv[2]), int(sys.argv[3]), int(sys.argv[4]))
    else:
        check(Path(sys.argv[2]))
