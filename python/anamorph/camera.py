"""Kinds of cameras: one function each, with the keys of a scene file's ``[camera]``.

This file is made by generate_cameras.py from the texts of ``anamorph camera --help KIND``.
"""

from __future__ import annotations

import numpy as np

from ._camera import Camera, CompiledRays
from ._values import Numbers, Value, as_numbers

__all__ = [
    "Camera",
    "bottom_up",
    "calibrated",
    "camera_texture",
    "chain",
    "composite",
    "cross_slit",
    "curved_convergence",
    "cylinder",
    "display",
    "fisheye",
    "glc",
    "graph_camera",
    "hinge",
    "irregular_perspective",
    "lidar",
    "lightfield",
    "mcop",
    "mesh",
    "occlusion",
    "ods",
    "opencv",
    "ortho_to_perspective",
    "orthographic",
    "panini",
    "panorama",
    "pencil",
    "pinhole",
    "projector",
    "pushbroom",
    "raymap",
    "rays",
    "reflection",
    "refraction",
    "sphere",
    "street",
    "surround",
    "top_down",
    "track",
    "twist",
    "twisted",
]


def pinhole(
    *,
    eye: Value | None = None,
    target: Value | None = None,
    up: Value | None = None,
    vfov: Value | None = None,
    t_range: Value | None = None,
    matrix: Value | None = None,
    quaternion: Value | None = None,
    convention: Value | None = None,
    distance: Value | None = None,
) -> Camera:
    """All rays start in one point.

      eye      [x, y, z]  where the rays start; t = 0
      target   [x, y, z]  what the middle of the image looks at
      up       [x, y, z]  what points up in the image (default [0, 1, 0])
      vfov     degrees    angle between the image's upper and lower border, over 0 and under 180
      t_range  [t0, t1]   ends of t, inclusive (default [0, inf])

    A matrix replaces eye, target and up; a quaternion replaces target and up:
      matrix      [[..4], [..4], [..4]]  camera to world, 3 or 4 rows; the columns are the camera's x, y and z axes and its position
      quaternion  [w, x, y, z]           camera to world, of any length; needs eye; keyframes take the shortest rotation
      convention  "opengl"               x right, y up, view along -z: Blender, OpenGL, the transforms.json of NeRFs (default)
                  "opencv"               x right, y down, view along +z: OpenCV, COLMAP; both give world to camera: invert it first
      distance    length                 from the eye to the target (default 1)

    f = unit(target - eye), r = unit(f x up), u = r x f, k = tan(vfov / 2);
    P = eye, D = f + (2a - 1) k (W / H) r + (1 - 2b) k u
    """
    return Camera("pinhole", {"eye": eye, "target": target, "up": up, "vfov": vfov, "t_range": t_range, "matrix": matrix, "quaternion": quaternion, "convention": convention, "distance": distance})


def orthographic(
    *,
    eye: Value | None = None,
    target: Value | None = None,
    up: Value | None = None,
    height: Value | None = None,
    t_range: Value | None = None,
    matrix: Value | None = None,
    quaternion: Value | None = None,
    convention: Value | None = None,
    distance: Value | None = None,
) -> Camera:
    """All rays are parallel.

      eye      [x, y, z]  a point of the plane where the rays start, in the middle of the image
      target   [x, y, z]  what the middle of the image looks at
      up       [x, y, z]  what points up in the image (default [0, 1, 0])
      height   length     of the image, in world units
      t_range  [t0, t1]   ends of t, inclusive (default [0, inf])

    A matrix replaces eye, target and up; a quaternion replaces target and up:
      matrix      [[..4], [..4], [..4]]  camera to world, 3 or 4 rows; the columns are the camera's x, y and z axes and its position
      quaternion  [w, x, y, z]           camera to world, of any length; needs eye; keyframes take the shortest rotation
      convention  "opengl"               x right, y up, view along -z: Blender, OpenGL, the transforms.json of NeRFs (default)
                  "opencv"               x right, y down, view along +z: OpenCV, COLMAP; both give world to camera: invert it first
      distance    length                 from the eye to the target (default 1)

    f, r, u as for pinhole; P = eye + (2a - 1) (height / 2) (W / H) r + (1 - 2b) (height / 2) u, D = f
    """
    return Camera("orthographic", {"eye": eye, "target": target, "up": up, "height": height, "t_range": t_range, "matrix": matrix, "quaternion": quaternion, "convention": convention, "distance": distance})


def glc(
    *,
    near: Value | None = None,
    far: Value | None = None,
    t_range: Value | None = None,
) -> Camera:
    """A general linear camera, which three rays at corners of the image define.

      near     [n0, n1, n2]  where these rays have t = 0: top left, top right, bottom left corner of the image
      far      [f0, f1, f2]  where they have t = 1
      t_range  [t0, t1]      ends of t, inclusive (default [0, inf])

    P = n0 + a (n1 - n0) + b (n2 - n0), Q = f0 + a (f1 - f0) + b (f2 - f0), D = Q - P.
    With near and far on parallel planes it is a pinhole, orthographic, pushbroom, cross-slit, pencil, twisted
    orthographic or bilinear camera; `anamorph camera SCENE` says which, and where its slits are.
    """
    return Camera("glc", {"near": near, "far": far, "t_range": t_range})


def mesh(
    *,
    vertices: Value | None = None,
    triangles: Value | None = None,
    file: Value | None = None,
    normalize: Value | None = None,
    t_range: Value | None = None,
) -> Camera:
    """Image triangles, each a piece with rays at its corners.

      vertices   [{ image = [a, b], near = [x, y, z], far = [x, y, z], w = 1 }, ...]
                             image place ([0, 0] top left, [1, 1] bottom right), where t = 0, where t = 1, weight
      triangles  [[i, j, k]] indices into vertices; triangles must not overlap in the image
      file       "F.json"    a file with these two keys, instead of them
      normalize  true        interpolate unit directions instead of far points (default false)
      t_range    [t0, t1]    ends of t, inclusive (default [0, inf])

    The weights w_i L_i / sum(w_k L_k), L the barycentric coordinates in the image, interpolate near to P and far to Q;
    D = Q - P, or with normalize D = sum of the weights times unit(far_i - near_i). Pixels in no triangle are background.
    """
    return Camera("mesh", {"vertices": vertices, "triangles": triangles, "file": file, "normalize": normalize, "t_range": t_range})


def raymap(
    *,
    origins: Value | None = None,
    directions: Value | None = None,
    t_range: Value | None = None,
) -> Camera:
    """A ray read for every pixel.

      origins     "P.npy"   H x W x 3 of f32 or f64 in C order, or an EXR with R G B = x y z
      directions  "D.npy"   the same for the directions, of any length
      t_range     [t0, t1]  ends of t, inclusive (default [0, inf])

    The files' size is the image's. A pixel with a number that is not finite or with D = 0 has no ray.
    """
    return Camera("raymap", {"origins": origins, "directions": directions, "t_range": t_range})


def cross_slit(
    *,
    slits: Value | None = None,
    eye: Value | None = None,
    target: Value | None = None,
    up: Value | None = None,
    height: Value | None = None,
    center: Value | None = None,
    right: Value | None = None,
    pieces: Value | None = None,
    error: Value | None = None,
    t_range: Value | None = None,
    matrix: Value | None = None,
    quaternion: Value | None = None,
    convention: Value | None = None,
    distance: Value | None = None,
) -> Camera:
    """Every ray meets two slits.

      slits    [s1, s2]     rays start on s1 (t = 0), which lies before the image plane; each is one of
                 { distance = L, angle = D }           parallel to the image plane, L before it (negative: behind), passing the
                                                       axis at its middle; D degrees from the image's right towards its top
                 { point = [x, y, z], direction = [x, y, z] }   any line
      eye, target, up       the image plane goes through target, across the view from eye (up default [0, 1, 0])
      height   length       of the image on that plane, in world units
      center, right, up     instead of eye, target, up and height: the image's middle, and the vectors from there to the middles of
                            its right and upper border
      pieces   "exact"      of slits not parallel to the image plane: "exact" (default), N, or "auto": as many as the error needs
      error    px           of "auto": the largest image distance from the exact camera (default 0.25)
      t_range  [t0, t1]     ends of t, inclusive (default [0, inf])

    A matrix replaces eye, target and up; a quaternion replaces target and up:
      matrix      [[..4], [..4], [..4]]  camera to world, 3 or 4 rows; the columns are the camera's x, y and z axes and its position
      quaternion  [w, x, y, z]           camera to world, of any length; needs eye; keyframes take the shortest rotation
      convention  "opengl"               x right, y up, view along -z: Blender, OpenGL, the transforms.json of NeRFs (default)
                  "opencv"               x right, y down, view along +z: OpenCV, COLMAP; both give world to camera: invert it first
      distance    length                 from the eye to the target (default 1)

    X = center + (2a - 1) right + (1 - 2b) up (with eye: center = target, right = (height / 2) (W / H) r, up = (height / 2) u).
    n = (p2 - X) x d2, P = p1 + d1 ((X - p1) . n) / (d1 . n), D = X - P, so t = 1 on the image plane. With both slits parallel to
    that plane P and D are affine in (a, b): one general linear camera. Otherwise each pixel has this ray; there is none where
    the first slit is behind the plane.
    Sources: Zomet, Feldman, Peleg and Weinshall 2003; Yu, Yu and McMillan 2009, section 3.1.
    """
    return Camera("cross_slit", {"slits": slits, "eye": eye, "target": target, "up": up, "height": height, "center": center, "right": right, "pieces": pieces, "error": error, "t_range": t_range, "matrix": matrix, "quaternion": quaternion, "convention": convention, "distance": distance})


def pushbroom(
    *,
    start: Value | None = None,
    end: Value | None = None,
    velocity: Value | None = None,
    time: Value | None = None,
    direction: Value | None = None,
    extent: Value | None = None,
    look: Value | None = None,
    up: Value | None = None,
    vfov: Value | None = None,
    hfov: Value | None = None,
    t_range: Value | None = None,
) -> Camera:
    """A line camera that moves straight on, as on an aircraft.

      start      [x, y, z]  where its path begins
      end        [x, y, z]  where it ends; or
      velocity   [x, y, z]  world units a second, with
      time       seconds    that it moves; or
      direction  [x, y, z]  of any length, with
      extent     length     of the path
      look       [x, y, z]  the direction of the middle of the line
      up         [x, y, z]  what points up in the image (default [0, 1, 0])
      vfov       degrees    angle of the line across the track, which is a column of the image: the path goes to a side; or
      hfov       degrees    angle of the line, which is a row of the image: the path goes up or down in it
      t_range    [t0, t1]   ends of t, inclusive (default [0, inf])

    f = unit(look), r = unit(f x up), u = r x f, V = end - start = velocity time = unit(direction) extent, s the sign of V . r
    (hfov: of V . u), k = tan(fov / 2). P = start + V / 2 + (2a - 1) s V / 2, D = f + (1 - 2b) k u; with hfov P = start + V / 2 +
    (1 - 2b) s V / 2, D = f + (2a - 1) k r. A camera that moves left fills the image from right to left.
    Sources: Gupta and Hartley 1997; Yu, Yu and McMillan 2009, section 3.1.
    """
    return Camera("pushbroom", {"start": start, "end": end, "velocity": velocity, "time": time, "direction": direction, "extent": extent, "look": look, "up": up, "vfov": vfov, "hfov": hfov, "t_range": t_range})


def pencil(
    *,
    eye: Value | None = None,
    target: Value | None = None,
    up: Value | None = None,
    vfov: Value | None = None,
    slit: Value | None = None,
    angle: Value | None = None,
    t_range: Value | None = None,
    matrix: Value | None = None,
    quaternion: Value | None = None,
    convention: Value | None = None,
    distance: Value | None = None,
) -> Camera:
    """A pinhole whose eye moves along a slit, one eye position for each image line parallel to the slit.

      eye      [x, y, z]  the slit's middle; t = 0
      target   [x, y, z]  what the middle of the image looks at
      up       [x, y, z]  what points up in the image (default [0, 1, 0])
      vfov     degrees    angle between the image's upper and lower border, seen from the middle; over 0 and under 180
      slit     length     distance of the eyes of two lines one image height apart; negative reverses the direction
      angle    degrees    of the slit, from the image's right towards its top (default 0: one eye for each row)
      t_range  [t0, t1]   ends of t, inclusive (default [0, inf])

    A matrix replaces eye, target and up; a quaternion replaces target and up:
      matrix      [[..4], [..4], [..4]]  camera to world, 3 or 4 rows; the columns are the camera's x, y and z axes and its position
      quaternion  [w, x, y, z]           camera to world, of any length; needs eye; keyframes take the shortest rotation
      convention  "opengl"               x right, y up, view along -z: Blender, OpenGL, the transforms.json of NeRFs (default)
                  "opencv"               x right, y down, view along +z: OpenCV, COLMAP; both give world to camera: invert it first
      distance    length                 from the eye to the target (default 1)

    f, r, u and k as for pinhole, x = (2a - 1) W / H, y = 1 - 2b, s = cos(angle) r + sin(angle) u, q = y cos(angle) - x sin(angle):
    P = eye + q (slit / 2) s, D = f + x k r + y k u - (P - eye) / |target - eye|. The plane across the view through target looks
    as through a pinhole in eye; what lies before or behind it is sheared along the slit.
    Sources: Yu and McMillan 2004; Yu, Yu and McMillan 2009, section 3.1.
    """
    return Camera("pencil", {"eye": eye, "target": target, "up": up, "vfov": vfov, "slit": slit, "angle": angle, "t_range": t_range, "matrix": matrix, "quaternion": quaternion, "convention": convention, "distance": distance})


def twisted(
    *,
    eye: Value | None = None,
    target: Value | None = None,
    up: Value | None = None,
    height: Value | None = None,
    angle: Value | None = None,
    t_range: Value | None = None,
    matrix: Value | None = None,
    quaternion: Value | None = None,
    convention: Value | None = None,
    distance: Value | None = None,
) -> Camera:
    """Twisted orthographic; the rays of a row are parallel, and each row has its own direction.

      eye      [x, y, z]  a point of the plane where the rays start, in the middle of the image
      target   [x, y, z]  what the middle of the image looks at
      up       [x, y, z]  what points up in the image (default [0, 1, 0])
      height   length     of the image, in world units
      angle    degrees    by which the rays of the upper border turn to the right, those of the lower one to the left; between -90
                          and 90
      t_range  [t0, t1]   ends of t, inclusive (default [0, inf])

    A matrix replaces eye, target and up; a quaternion replaces target and up:
      matrix      [[..4], [..4], [..4]]  camera to world, 3 or 4 rows; the columns are the camera's x, y and z axes and its position
      quaternion  [w, x, y, z]           camera to world, of any length; needs eye; keyframes take the shortest rotation
      convention  "opengl"               x right, y up, view along -z: Blender, OpenGL, the transforms.json of NeRFs (default)
                  "opencv"               x right, y down, view along +z: OpenCV, COLMAP; both give world to camera: invert it first
      distance    length                 from the eye to the target (default 1)

    f, r, u as for pinhole, x = (2a - 1) W / H, y = 1 - 2b, g = tan(angle), l = |target - eye|:
    P = eye + x (height / 2) r + y ((height / 2) u - l g r), D = f + y g r. The plane across the view through target looks as through
    the orthographic camera; what lies before or behind it is sheared sideways.
    Sources: Yu and McMillan 2004; Yu, Yu and McMillan 2009, section 3.1.
    """
    return Camera("twisted", {"eye": eye, "target": target, "up": up, "height": height, "angle": angle, "t_range": t_range, "matrix": matrix, "quaternion": quaternion, "convention": convention, "distance": distance})


def panorama(
    *,
    center: Value | None = None,
    axis: Value | None = None,
    front: Value | None = None,
    radius: Value | None = None,
    elevation: Value | None = None,
    height: Value | None = None,
    sweep: Value | None = None,
    look: Value | None = None,
    pieces: Value | None = None,
    error: Value | None = None,
    t_range: Value | None = None,
) -> Camera:
    """An eye goes round an object and each column is what it sees straight ahead: a ring of cross-slit cameras.

      center     [x, y, z]  of the object
      axis       [x, y, z]  what points up in the image; through center, the slit that all columns share (default [0, 1, 0])
      front      [x, y, z]  the direction from the axis to the eye of the middle column (default [0, 0, 1])
      radius     length     of the eye's circle
      elevation  length     of that circle over center, along the axis (default 0)
      height     length     of the image, at the axis (outward: at the distance of a radius from the eye)
      sweep      degrees    that the eye goes round, over 0 and at most 360 (default 360)
      look       "inward"   at the axis, or "outward" (default "inward")
      pieces     "exact"    "exact" (default), N cross-slit cameras on chords of the circle, or "auto": as the error needs
      error      px         of "auto": the largest image distance from the exact camera (default 0.25)
      t_range    [t0, t1]   ends of t, inclusive (default [0, inf]); the axis is at t = 1, so [0, 1] ends the rays there

    w = axis, e = front made perpendicular to w, s = w x e, i = 1 inward and -1 outward, th = i sweep (a - 1/2),
    o = radius (cos(th) e + sin(th) s), all of unit length where directions: P = center + o + elevation w,
    D = -i o + (height (1/2 - b) - elevation) w. Behind the axis (t > 1) the inward picture is mirrored, as behind any slit.
    With pieces = N, P and D are affine between N + 1 columns: slits on the chords and on the axis; neighbours share their rays.
    Source: Yu, Yu and McMillan 2009, section 5.1.
    """
    return Camera("panorama", {"center": center, "axis": axis, "front": front, "radius": radius, "elevation": elevation, "height": height, "sweep": sweep, "look": look, "pieces": pieces, "error": error, "t_range": t_range})


def hinge(
    *,
    eye: Value | None = None,
    target: Value | None = None,
    up: Value | None = None,
    vfov: Value | None = None,
    path: Value | None = None,
    column: Value | None = None,
    angle: Value | None = None,
    side: Value | None = None,
    t_range: Value | None = None,
    matrix: Value | None = None,
    quaternion: Value | None = None,
    convention: Value | None = None,
    distance: Value | None = None,
) -> Camera:
    """Two cross-slit cameras that share an image column, the second rotated about it (faux animation).

      eye      [x, y, z]  the middle of the first camera's slit; t = 0
      target   [x, y, z]  what the middle of the image would look at without a hinge
      up       [x, y, z]  what points up in the image (default [0, 1, 0])
      vfov     degrees    angle between the image's upper and lower border; over 0 and under 180
      path     length     of the slit of eyes from the image's left to its right border
      column   a          the hinge, from 0 (left) to 1 (right) (default 0.5)
      angle    degrees    of the second camera: positive rotates its eyes towards the scene, 0 leaves one camera; between -90 and 90
      side     "right"    side of the hinge that rotates: "right" or "left" (default "right")
      t_range  [t0, t1]   ends of t, inclusive (default [0, inf])

    A matrix replaces eye, target and up; a quaternion replaces target and up:
      matrix      [[..4], [..4], [..4]]  camera to world, 3 or 4 rows; the columns are the camera's x, y and z axes and its position
      quaternion  [w, x, y, z]           camera to world, of any length; needs eye; keyframes take the shortest rotation
      convention  "opengl"               x right, y up, view along -z: Blender, OpenGL, the transforms.json of NeRFs (default)
                  "opencv"               x right, y down, view along +z: OpenCV, COLMAP; both give world to camera: invert it first
      distance    length                 from the eye to the target (default 1)

    f, r, u as for pinhole, l = |target - eye|, H2 = l tan(vfov / 2), W2 = H2 W / H, x = 2a - 1, y = 1 - 2b, c = 2 column - 1; on the
    first camera's side q = x r, on the other q = c r + (x - c) r', with r' = cos(angle) r + sin(angle) f (side = "left": minus).
    P = eye + (path / 2) q, D = f + ((W2 - path / 2) q + y H2 u) / l. Slits: the eyes at t = 0, which bend at the hinge, and at
    t = l path / (path - 2 W2) an upright one that both cameras share; with path = 2 W2 they are pushbrooms.
    Source: Yu, Yu and McMillan 2009, section 5.3.
    """
    return Camera("hinge", {"eye": eye, "target": target, "up": up, "vfov": vfov, "path": path, "column": column, "angle": angle, "side": side, "t_range": t_range, "matrix": matrix, "quaternion": quaternion, "convention": convention, "distance": distance})


def surround(
    *,
    radius: Value | None = None,
    level: Value | None = None,
    file: Value | None = None,
    scale: Value | None = None,
    center: Value | None = None,
    up: Value | None = None,
    columns: Value | None = None,
    t_range: Value | None = None,
) -> Camera:
    """A closed mesh of cameras around an object, each triangle unfolded to one of the image.

      radius   length     of a ball of cameras
      level    N          20 4^N cameras on the ball, 0 to 7 (default 2: 320)
      file     "F.obj"    instead of the two: a mesh of cameras, its triangles counter-clockwise seen from outside; at most
                          1,000,000
      scale    s          of the file's positions (default 1)
      center   [x, y, z]  of the ball, or where the file's origin goes (default [0, 0, 0])
      up       [x, y, z]  what points up in each camera's triangle as far as it can (default [0, 1, 0])
      columns  N          cells in a row of the image (default: as many as make cells near-square); a mesh listed row by row stays
                          connected at any image size if N is the number of cells in its rows
      t_range  [t0, t1]   ends of t, inclusive (default [0, inf])

    Vertex v of the mesh has the ray P = v, D = -n, n the unit normal there (the mean of the triangles' around it, by area); vertices
    at one position are one. P and D are affine over each triangle, so t is about the distance from the mesh.
    The image is a grid of c = ceil(cameras / 2) cells in N columns, ceil(sqrt(c W / H)) by default: camera 2k is cell k's upper left
    half, camera 2k + 1 its lower right half, row by row from the top left. Each is seen from outside, unmirrored, rotated so that its
    upright side points up most. On a ball all rays meet in the centre, at about t = radius: behind it the image is rotated by 180 degrees.
    Source: Hou, Wei, Shum and Guo 2006, sections 2 and 3.4.
    """
    return Camera("surround", {"radius": radius, "level": level, "file": file, "scale": scale, "center": center, "up": up, "columns": columns, "t_range": t_range})


def mcop(
    *,
    path: Value | None = None,
    circle: Value | None = None,
    vfov: Value | None = None,
    interpolation: Value | None = None,
    closed: Value | None = None,
    pieces: Value | None = None,
    error: Value | None = None,
    t_range: Value | None = None,
) -> Camera:
    """A multiple-center-of-projection image: a camera on a path takes one column after the other.

      path     [{ eye, target, up }, ...]   two or more places of the camera, equally far apart in a (up default [0, 1, 0]); or
      circle   { radius = R, center = [x, y, z], axis = [x, y, z], front = [x, y, z], elevation = L, sweep = D }
                              around center (default [0, 0, 0]), always facing it: axis (default [0, 1, 0]) points up in the
                              image, front (default [0, 0, 1]) to the middle column's eye, elevation (default 0) is the eye's over
                              center, sweep (default 360) degrees
      vfov     degrees        of a column; over 0 and under 180
      interpolation "linear"  of eye, target and up between the places, or "catmull-rom" (default "linear")
      closed   true           the path goes on from its last place to its first (default false)
      pieces   "exact"        "exact" (default): a ray for each pixel; N pieces; or "auto": as many as the error needs
      error    px             of "auto": the largest image distance from the exact camera (default 0.25)
      t_range  [t0, t1]       ends of t, inclusive (default [0, inf])

    A matrix replaces eye, target and up; a quaternion replaces target and up:
      matrix      [[..4], [..4], [..4]]  camera to world, 3 or 4 rows; the columns are the camera's x, y and z axes and its position
      quaternion  [w, x, y, z]           camera to world, of any length; needs eye; keyframes take the shortest rotation
      convention  "opengl"               x right, y up, view along -z: Blender, OpenGL, the transforms.json of NeRFs (default)
                  "opencv"               x right, y down, view along +z: OpenCV, COLMAP; both give world to camera: invert it first
      distance    length                 from the eye to the target (default 1)

    E(a), T(a), U(a) on the path, f = unit(T - E), r = unit(f x U), u = r x f: P = E, D = f + (1 - 2b) tan(vfov / 2) u. Columns go
    left to right: move or rotate the camera to its right, or the picture is mirrored. Where the path has no view (T = E) there is
    no ray. circle: E = center + elevation axis + radius (cos(th) e + sin(th) s), th = sweep (a - 1/2), e and s as for panorama.
    Source: Rademacher and Bishop 1998, section 3.
    """
    return Camera("mcop", {"path": path, "circle": circle, "vfov": vfov, "interpolation": interpolation, "closed": closed, "pieces": pieces, "error": error, "t_range": t_range})


def projector(
    *,
    surfaces: Value | None = None,
    reparam: Value | None = None,
    pieces: Value | None = None,
    error: Value | None = None,
) -> Camera:
    """A viewing volume between 2 to 4 surfaces, its rays straight or curved.

      surfaces  [S0, S1, ...]  control surfaces, world units; with 2 the rays are straight, with 3 or 4 Bezier curves of degree 2 or 3
      reparam   {...}          where on the surfaces an image place lies (default: (u, v) = (a, b), (0, 0) the top left corner)
      pieces    "exact"        of a straight projector that is no GLC: "exact" (default), N, or "auto": as the error needs
      error     px             of "auto": the largest image distance from the exact camera (default 0.25)

    X(a, b, t) = sum of Bernstein(i, m)(t) S_i(u, v), t in [0, 1], m + 1 surfaces. Surfaces, by kind:
      { kind = "plane", origin, u, v }                     origin + u U + v V
      { kind = "bilinear", corners = [c00, c10, c01, c11] } (1-u)(1-v) c00 + u (1-v) c10 + (1-u) v c01 + u v c11
      { kind = "point", at }
      { kind = "cylinder", center, axis, radius, height, from = 0, to = 360 }
          center + radius (cos th e1 + sin th e2) + height (v - 1/2) w, th = from + u (to - from), w = unit(axis),
          e1 the part of world z across w (of world x where w is along z), e2 = w x e1; a negative height flips the image
      { kind = "sphere", center, radius, lon = [l0, l1], lat = [p0, p1] }
          center + radius (cos p sin l, sin p, cos p cos l), l = l0 + u (l1 - l0), p = p0 + v (p1 - p0)
      { kind = "disc", center, normal, radius, up = [0, 1, 0] }
          center + v radius (cos 2 pi u e1 + sin 2 pi u e2), n = unit(normal), e1 the part of up across n, e2 = n x e1
      { kind = "bezier", points = [[...], ...] }           2 to 6 rows along v of 2 to 6 points along u
      { kind = "bspline", points, degree, knots_u, knots_v }  degree 1 to 5, or [along u, along v]; knots: points + degree + 1
          numbers each that do not descend (default: clamped and uniform); u and v from 0 to 1 go over the knots' inner extent
      { kind = "nurbs", points, degree, weights, knots_u, knots_v }  weights above 0, in rows as the points
      { kind = "pieces", vertices = [{ image = [u, v], at }, ...], triangles = [[i, j, k], ...] }
          linear on each triangle over (u, v), nothing outside; the lowest-numbered triangle wins
    Reparam, by kind:
      { kind = "affine", m = [[ua, ub, u0], [va, vb, v0]] }  u = ua a + ub b + u0, v alike
      { kind = "polar" }         x = 2a - 1, y = 1 - 2b, u = the angle of (x, y) over 360 degrees, v = |(x, y)|; no ray beyond 1
      { kind = "lens", power }   polar with v = |(x, y)|^power
      { kind = "magnify", center, radius, strength }  within the radius (u, v) = center + ((a, b) - center) s,
          s = 1/strength + (1 - 1/strength) q^2 (3 - 2q), q = the distance from the center over the radius
      { kind = "table", file }   H x W x 2 numbers of a .npy, or R and G of an EXR; bilinear
    Straight projectors over planes with an affine reparam are a GLC. A pixel whose control points are all the same has no ray.
    Brosz, Samavati, Carpendale and Costa Sousa 2007, Single Camera Flexible Projection, sections 3 and 4.1.
    """
    return Camera("projector", {"surfaces": surfaces, "reparam": reparam, "pieces": pieces, "error": error})


def irregular_perspective(
    *,
    eye: Value | None = None,
    target: Value | None = None,
    up: Value | None = None,
    vfov: Value | None = None,
    near: Value | None = None,
    far: Value | None = None,
    convergence: Value | None = None,
    pieces: Value | None = None,
    error: Value | None = None,
    matrix: Value | None = None,
    quaternion: Value | None = None,
    convention: Value | None = None,
    distance: Value | None = None,
) -> Camera:
    """Perspective, orthographic and inverse perspective, set per axis and per corner.

      eye          [x, y, z]   where the viewer stands (default [0, 0, 4])
      target       [x, y, z]   what the middle of the image looks at (default [0, 0, 0]); T is its distance
      up           [x, y, z]   what points up in the image (default [0, 1, 0])
      vfov         degrees     vertical angle of view at the target's plane, as of a pinhole (default 40)
      near, far    depths      where t is 0 and 1 (default T / 10 and 2 T)
      convergence  c           1 perspective, 0 orthographic, -1 inverse perspective (rays meet at 2 T); or [across, up]
                               (default [0.4, 1]); or four pairs, for the corners top left, top right, bottom left, bottom right
      pieces       "exact"     where the corners differ: "exact" (default): a ray for each pixel; N; or "auto": as the error needs
      error        px          of "auto": the largest image distance from the exact camera (default 0.25)

    A matrix replaces eye, target and up; a quaternion replaces target and up:
      matrix      [[..4], [..4], [..4]]  camera to world, 3 or 4 rows; the columns are the camera's x, y and z axes and its position
      quaternion  [w, x, y, z]           camera to world, of any length; needs eye; keyframes take the shortest rotation
      convention  "opengl"               x right, y up, view along -z: Blender, OpenGL, the transforms.json of NeRFs (default)
                  "opencv"               x right, y down, view along +z: OpenCV, COLMAP; both give world to camera: invert it first
      distance    length                 from the eye to the target (default 1)

    A point q of the target's plane, from its middle, goes to q (1 + c (z - T) / T) at the depth z. Without corners it is a GLC.
    Brosz et al. 2007, Figures 4 (c = 1, 0, -1) and 5 (columns that keep their shape: less convergence across than up).
    """
    return Camera("irregular_perspective", {"eye": eye, "target": target, "up": up, "vfov": vfov, "near": near, "far": far, "convergence": convergence, "pieces": pieces, "error": error, "matrix": matrix, "quaternion": quaternion, "convention": convention, "distance": distance})


def twist(
    *,
    eye: Value | None = None,
    target: Value | None = None,
    up: Value | None = None,
    vfov: Value | None = None,
    near: Value | None = None,
    far: Value | None = None,
    angle: Value | None = None,
    degree: Value | None = None,
    matrix: Value | None = None,
    quaternion: Value | None = None,
    convention: Value | None = None,
    distance: Value | None = None,
) -> Camera:
    """A pinhole's viewing volume whose far surface is rotated against the near one.

      eye        [x, y, z]   where the viewer stands (default [0, 0, 4])
      target     [x, y, z]   what the middle of the image looks at (default [0, 0, 0]); T is its distance
      up         [x, y, z]   what points up in the image at near (default [0, 1, 0])
      vfov       degrees     angle between the image's upper and lower border (default 40)
      near, far  depths      where t is 0 and 1 (default T / 2 and 3 T / 2)
      angle      degrees     rotation of the far surface, counter-clockwise as seen (default 60)
      degree     1, 2 or 3   straight projectors, or curves (default 1); |angle| < 180 for 2, < 360 for 3

    A matrix replaces eye, target and up; a quaternion replaces target and up:
      matrix      [[..4], [..4], [..4]]  camera to world, 3 or 4 rows; the columns are the camera's x, y and z axes and its position
      quaternion  [w, x, y, z]           camera to world, of any length; needs eye; keyframes take the shortest rotation
      convention  "opengl"               x right, y up, view along -z: Blender, OpenGL, the transforms.json of NeRFs (default)
                  "opencv"               x right, y down, view along +z: OpenCV, COLMAP; both give world to camera: invert it first
      distance    length                 from the eye to the target (default 1)

    Degree 1: straight lines, nearer to the axis by cos(angle / 2) half-way: a GLC. Degree 2: the middle surface turned by half
    the angle and larger by 1 / cos(angle / 2). Degree 3: legs of 4/3 tan(angle / 4) along the circles about the axis.
    Brosz et al. 2007, Figure 7, linear and non-linear.
    """
    return Camera("twist", {"eye": eye, "target": target, "up": up, "vfov": vfov, "near": near, "far": far, "angle": angle, "degree": degree, "matrix": matrix, "quaternion": quaternion, "convention": convention, "distance": distance})


def curved_convergence(
    *,
    eye: Value | None = None,
    target: Value | None = None,
    up: Value | None = None,
    vfov: Value | None = None,
    near: Value | None = None,
    far: Value | None = None,
    bend: Value | None = None,
    matrix: Value | None = None,
    quaternion: Value | None = None,
    convention: Value | None = None,
    distance: Value | None = None,
) -> Camera:
    """A pinhole's viewing volume that bows sideways: parallel lines converge along curves.

      eye        [x, y, z]   where the viewer stands (default [0, 0, 4])
      target     [x, y, z]   what the middle of the image looks at (default [0, 0, 0]); T is its distance
      up         [x, y, z]   what points up in the image (default [0, 1, 0])
      vfov       degrees     angle between the image's upper and lower border (default 40)
      near, far  depths      where t is 0 and 1 (default T / 10 and 3 T)
      bend       [x, y]      how far the control surface half-way is moved right and up, in its own height (default [0.5, 0])

    A matrix replaces eye, target and up; a quaternion replaces target and up:
      matrix      [[..4], [..4], [..4]]  camera to world, 3 or 4 rows; the columns are the camera's x, y and z axes and its position
      quaternion  [w, x, y, z]           camera to world, of any length; needs eye; keyframes take the shortest rotation
      convention  "opengl"               x right, y up, view along -z: Blender, OpenGL, the transforms.json of NeRFs (default)
                  "opencv"               x right, y down, view along +z: OpenCV, COLMAP; both give world to camera: invert it first
      distance    length                 from the eye to the target (default 1)

    Curves of degree 2 over the pinhole's planes at near, (near + far) / 2, there moved by bend, and far.
    Brosz et al. 2007, Figure 9.
    """
    return Camera("curved_convergence", {"eye": eye, "target": target, "up": up, "vfov": vfov, "near": near, "far": far, "bend": bend, "matrix": matrix, "quaternion": quaternion, "convention": convention, "distance": distance})


def ortho_to_perspective(
    *,
    eye: Value | None = None,
    target: Value | None = None,
    up: Value | None = None,
    vfov: Value | None = None,
    near: Value | None = None,
    far: Value | None = None,
    blend: Value | None = None,
    matrix: Value | None = None,
    quaternion: Value | None = None,
    convention: Value | None = None,
    distance: Value | None = None,
) -> Camera:
    """Parallel near the viewer, perspective far away.

      eye        [x, y, z]   where the viewer stands, and the pinhole's eye (default [0, 0, 4])
      target     [x, y, z]   what the middle of the image looks at (default [0, 0, 0]); T is its distance
      up         [x, y, z]   what points up in the image (default [0, 1, 0])
      vfov       degrees     angle between the pinhole's upper and lower border (default 40)
      near, far  depths      where t is 0 and 1, before and beyond T (default 0 and 3 T)
      blend      0 to 1      share of the pinhole in the far surface (default 1; 0: orthographic); or at the image's corners
                             [[top left, top right], [bottom left, bottom right]]

    A matrix replaces eye, target and up; a quaternion replaces target and up:
      matrix      [[..4], [..4], [..4]]  camera to world, 3 or 4 rows; the columns are the camera's x, y and z axes and its position
      quaternion  [w, x, y, z]           camera to world, of any length; needs eye; keyframes take the shortest rotation
      convention  "opengl"               x right, y up, view along -z: Blender, OpenGL, the transforms.json of NeRFs (default)
                  "opencv"               x right, y down, view along +z: OpenCV, COLMAP; both give world to camera: invert it first
      distance    length                 from the eye to the target (default 1)

    Curves of degree 2 over three planes: at near and at T of the height 2 T tan(vfov / 2), at far of the height
    2 (T + blend (far - T)) tan(vfov / 2). They start along the view and end, for blend = 1, along the pinhole's rays.
    Brosz et al. 2007, Figure 12.
    """
    return Camera("ortho_to_perspective", {"eye": eye, "target": target, "up": up, "vfov": vfov, "near": near, "far": far, "blend": blend, "matrix": matrix, "quaternion": quaternion, "convention": convention, "distance": distance})


def occlusion(
    *,
    eye: Value | None = None,
    target: Value | None = None,
    up: Value | None = None,
    vfov: Value | None = None,
    near: Value | None = None,
    far: Value | None = None,
    end: Value | None = None,
    pole: Value | None = None,
    distortion: Value | None = None,
    join: Value | None = None,
    matrix: Value | None = None,
    quaternion: Value | None = None,
    convention: Value | None = None,
    distance: Value | None = None,
) -> Camera:
    """A pinhole whose rays bend around an occluder, to see what its silhouette hides.

      eye         [x, y, z]   where the rays start (default [0, 0, 4])
      target      [x, y, z]   what the middle of the image looks at (default [0, 0, 0]); T is its distance
      up          [x, y, z]   what points up in the image (default [0, 1, 0])
      vfov        degrees     angle between the image's upper and lower border (default 40)
      near, far   depths      of the distortion planes: where bending starts and ends (default T and 3 T / 2)
      end         depth       where the rays end (default 2 far)
      pole        [a, b]      image place towards which they bend (default [0.5, 0.5])
      distortion  [dn, df]    how far, at near and at far, in heights of the image (default [0, 0.15])
      join        "linear"    a chain of straight segments (default), or "bezier": a curve of degree 3 over eye, near, far, end,
                              which bends less behind the occluder

    A matrix replaces eye, target and up; a quaternion replaces target and up:
      matrix      [[..4], [..4], [..4]]  camera to world, 3 or 4 rows; the columns are the camera's x, y and z axes and its position
      quaternion  [w, x, y, z]           camera to world, of any length; needs eye; keyframes take the shortest rotation
      convention  "opengl"               x right, y up, view along -z: Blender, OpenGL, the transforms.json of NeRFs (default)
                  "opencv"               x right, y down, view along +z: OpenCV, COLMAP; both give world to camera: invert it first
      distance    length                 from the eye to the target (default 1)

    At the depth z the ray of the image place q passes q - d unit(q - pole), or the pole where q is nearer to it than d; d is
    d_n at near and d_f from far on, and linear in 1/z between them. The segments are layers with t in [0, 1] each.
    Mei, Popescu and Sacks 2005, The Occlusion Camera; Brosz et al. 2007, section 5 and Figure 10.
    """
    return Camera("occlusion", {"eye": eye, "target": target, "up": up, "vfov": vfov, "near": near, "far": far, "end": end, "pole": pole, "distortion": distortion, "join": join, "matrix": matrix, "quaternion": quaternion, "convention": convention, "distance": distance})


def street(
    *,
    from_: Value | None = None,
    to: Value | None = None,
    up: Value | None = None,
    vfov: Value | None = None,
    facade: Value | None = None,
    far: Value | None = None,
    views: Value | None = None,
) -> Camera:
    """The houses along a street in one picture, with perspective views down its crossings.

      from    [x, y, z]   where the walk begins, at the image's left border (default [-2, 0, 4])
      to      [x, y, z]   where it ends, at the right border (default [2, 0, 4])
      up      [x, y, z]   what points up in the image (default [0, 1, 0]); the viewer looks along up x (to - from)
      vfov    degrees     angle between the upper and lower border (default: facades have the image's aspect)
      facade  distance    from the walk to the houses (default 3)
      far     distance    from the walk to where the rays end (default 3 facade)
      views   [{ at = 0.5, width = 0.3, angle = 60, turn = 0 }, ...]  perspective views: the middle as image coordinate a (needed),
                          share of the image's width, horizontal angle, turn to the right in degrees (default: none)

    Without views a pushbroom: straight rays from the line of the walk. With them curves of degree 2 over the walk, the plane of
    the facades, and a far surface moved along the street by (far - facade) tan(turn + q angle / 2) (1 - q^2)^2, q = -1 to 1
    across a view (a cubic B-spline with 16 control points for each width of the narrowest view).
    Brosz et al. 2007, Figure 11.
    """
    return Camera("street", {"from": from_, "to": to, "up": up, "vfov": vfov, "facade": facade, "far": far, "views": views})


def fisheye(
    *,
    eye: Value | None = None,
    target: Value | None = None,
    up: Value | None = None,
    fov: Value | None = None,
    mapping: Value | None = None,
    frame: Value | None = None,
    pieces: Value | None = None,
    error: Value | None = None,
    t_range: Value | None = None,
    matrix: Value | None = None,
    quaternion: Value | None = None,
    convention: Value | None = None,
    distance: Value | None = None,
) -> Camera:
    """The angle from the view direction becomes a distance from the middle of the image.

      eye      [x, y, z]   where the rays start; t = 0
      target   [x, y, z]   what the middle of the image looks at
      up       [x, y, z]   what points up in the image (default [0, 1, 0])
      fov      degrees     the angle across the circle or the image's diagonal, up to 360; orthographic up to 180
      mapping  "NAME"      "equidistant", "equisolid", "stereographic" (under 360) or "orthographic" (default "equidistant")
      frame    "circular"  the circle of the field of view touches the shorter sides, no ray outside (default)
               "full"      the field of view is the image's diagonal, every pixel has a ray
      pieces   "exact"     "exact" (default): a ray of its own for each pixel; N pieces; or "auto": as many as the error needs
      error    px          of "auto": the largest image distance from the exact camera (default 0.25)
      t_range  [t0, t1]    ends of t, inclusive (default [0, inf])

    A matrix replaces eye, target and up; a quaternion replaces target and up:
      matrix      [[..4], [..4], [..4]]  camera to world, 3 or 4 rows; the columns are the camera's x, y and z axes and its position
      quaternion  [w, x, y, z]           camera to world, of any length; needs eye; keyframes take the shortest rotation
      convention  "opengl"               x right, y up, view along -z: Blender, OpenGL, the transforms.json of NeRFs (default)
                  "opencv"               x right, y down, view along +z: OpenCV, COLMAP; both give world to camera: invert it first
      distance    length                 from the eye to the target (default 1)

    m(theta) = theta (equidistant), 2 sin(theta / 2) (equisolid), 2 tan(theta / 2) (stereographic), sin(theta)
    (orthographic). R = min(W, H) / 2 (circular) or sqrt(W^2 + H^2) / 2 (full) pixels,
    (x, y) = ((2a - 1) W / 2, (1 - 2b) H / 2) / R, rho = |(x, y)|, m(theta) = rho m(fov / 2). f, r, u as for pinhole;
    P = eye, D = cos(theta) f + sin(theta) (x r + y u) / rho, a unit vector.
    Source: Kannala and Brandt 2006, equations 2 to 5.
    """
    return Camera("fisheye", {"eye": eye, "target": target, "up": up, "fov": fov, "mapping": mapping, "frame": frame, "pieces": pieces, "error": error, "t_range": t_range, "matrix": matrix, "quaternion": quaternion, "convention": convention, "distance": distance})


def sphere(
    *,
    eye: Value | None = None,
    target: Value | None = None,
    up: Value | None = None,
    lon: Value | None = None,
    lat: Value | None = None,
    strips: Value | None = None,
    pieces: Value | None = None,
    error: Value | None = None,
    t_range: Value | None = None,
    matrix: Value | None = None,
    quaternion: Value | None = None,
    convention: Value | None = None,
    distance: Value | None = None,
) -> Camera:
    """Longitude and latitude become image coordinates (equirectangular).

      eye      [x, y, z]   where the rays start; t = 0
      target   [x, y, z]   what longitude 0, latitude 0 looks at
      up       [x, y, z]   latitude 90 (default [0, 1, 0]); made perpendicular to the view direction
      lon      [l0, l1]    degrees at the left and right border, growing to the right (default [-180, 180])
      lat      [p0, p1]    degrees at the lower and upper border (default [-90, 90])
      strips   N           N columns of perspective cells instead of exact rays (Lorenz and Doellner); not with pieces
      pieces   "exact"     "exact" (default): a ray of its own for each pixel; N pieces; or "auto": as many as the error needs
      error    px          of "auto": the largest image distance from the exact camera (default 0.25)
      t_range  [t0, t1]    ends of t, inclusive (default [0, inf])

    A matrix replaces eye, target and up; a quaternion replaces target and up:
      matrix      [[..4], [..4], [..4]]  camera to world, 3 or 4 rows; the columns are the camera's x, y and z axes and its position
      quaternion  [w, x, y, z]           camera to world, of any length; needs eye; keyframes take the shortest rotation
      convention  "opengl"               x right, y up, view along -z: Blender, OpenGL, the transforms.json of NeRFs (default)
                  "opencv"               x right, y down, view along +z: OpenCV, COLMAP; both give world to camera: invert it first
      distance    length                 from the eye to the target (default 1)

    l = l0 + a (l1 - l0), p = p1 + b (p0 - p1), f, r, u as for pinhole;
    P = eye, D = cos(p) (sin(l) r + cos(l) f) + sin(p) u, a unit vector.
    With strips: cells h = (l1 - l0) / N wide and k = (p1 - p0) / ceil(N (p1 - p0) / (l1 - l0)) high, cut from their lower
    left to their upper right corner; D is interpolated over each triangle from the exact D at its corners, so
    neighbours join without a seam, round the back too. A ray differs from the exact sphere's by at most
    asin((h + k)^2 / 8), h and k in radians.
    Source: Lorenz and Doellner 2009, section 3.1, with cells in place of strips.
    """
    return Camera("sphere", {"eye": eye, "target": target, "up": up, "lon": lon, "lat": lat, "strips": strips, "pieces": pieces, "error": error, "t_range": t_range, "matrix": matrix, "quaternion": quaternion, "convention": convention, "distance": distance})


def cylinder(
    *,
    eye: Value | None = None,
    target: Value | None = None,
    up: Value | None = None,
    fov: Value | None = None,
    vfov: Value | None = None,
    tan: Value | None = None,
    strips: Value | None = None,
    pieces: Value | None = None,
    error: Value | None = None,
    t_range: Value | None = None,
    matrix: Value | None = None,
    quaternion: Value | None = None,
    convention: Value | None = None,
    distance: Value | None = None,
) -> Camera:
    """The angle around the eye and the tangent of elevation become image coordinates.

      eye      [x, y, z]   where the rays start; t = 0
      target   [x, y, z]   what the middle column looks at
      up       [x, y, z]   the cylinder's axis (default [0, 1, 0]); made perpendicular to the view direction
      fov      degrees     around the axis, over 0 and at most 360 (default 360)
      vfov     degrees     between the image's lower and upper border, under 180 (default: pixels square on the horizon)
      tan      [v0, v1]    instead: tangents of elevation at the lower and upper border
      strips   N           N perspective strips instead of exact rays (Lorenz and Doellner); not with pieces
      pieces   "exact"     "exact" (default): a ray of its own for each pixel; N pieces; or "auto": as many as the error needs
      error    px          of "auto": the largest image distance from the exact camera (default 0.25)
      t_range  [t0, t1]    ends of t, inclusive (default [0, inf])

    A matrix replaces eye, target and up; a quaternion replaces target and up:
      matrix      [[..4], [..4], [..4]]  camera to world, 3 or 4 rows; the columns are the camera's x, y and z axes and its position
      quaternion  [w, x, y, z]           camera to world, of any length; needs eye; keyframes take the shortest rotation
      convention  "opengl"               x right, y up, view along -z: Blender, OpenGL, the transforms.json of NeRFs (default)
                  "opencv"               x right, y down, view along +z: OpenCV, COLMAP; both give world to camera: invert it first
      distance    length                 from the eye to the target (default 1)

    th = (a - 1/2) fov, v = v1 + b (v0 - v1), f, r, u as for pinhole; vfov: v1 = -v0 = tan(vfov / 2); neither: v1 = -v0 =
    fov H / (2 W), fov in radians. P = eye, D = cos(th) f + sin(th) r + v u, so t is the distance from the axis.
    With strips, 2 delta = fov / N: strip k around the angle th_k with f_k = cos(th_k) f + sin(th_k) r, r_k across it, s from
    -1 to 1 over its width: D = cos(delta) f_k + s sin(delta) r_k + v u, a planar perspective stretched over the strip. It is exact at
    the strips' borders, so they join without a seam, round the back too; between them the picture is off by
    |s delta - atan(s tan(delta))| of angle (W / fov pixels a radian) and at most |v| (1 / cos(delta) - 1) of v (H / (v1 - v0) pixels).
    Source: Lorenz and Doellner 2009, section 3.1, the planes through the strips' borders.
    """
    return Camera("cylinder", {"eye": eye, "target": target, "up": up, "fov": fov, "vfov": vfov, "tan": tan, "strips": strips, "pieces": pieces, "error": error, "t_range": t_range, "matrix": matrix, "quaternion": quaternion, "convention": convention, "distance": distance})


def chain(
    *,
    layers: Value | None = None,
) -> Camera:
    """Mesh cameras over one image, whose rays are run through one after the other.

      layers  [{ vertices = [...], triangles = [...] }, { file = "F.json" }, ...]
                        1 to 16 tables with the keys of a mesh camera (kind = "mesh" is optional), from the eye outwards

    It takes no t_range: each layer's rays have t in [0, 1]; a pixel's first hit in its lowest layer shows, with t = layer +
    t in the layer. Rays are continuous where the far points of a layer are the near points of the next, over the same image
    triangles with the same weights w; a gap is allowed, and noted. A pixel outside a layer's pieces has no ray there.
    (Popescu et al., 3.1)
    """
    return Camera("chain", {"layers": layers})


def bottom_up(
    *,
    views: Value | None = None,
    weights: Value | None = None,
    near: Value | None = None,
    far: Value | None = None,
    lateral: Value | None = None,
    foreground: Value | None = None,
    root: Value | None = None,
    cut: Value | None = None,
    longitudinal: Value | None = None,
    join: Value | None = None,
    morph: Value | None = None,
) -> Camera:
    """Two pinhole views side by side, and the scene between them, in one continuous picture.

      views         [{ eye, target, up, vfov }, { ... }]
                                 the left and the right view, keys as of pinhole; vfov spans the image's height
      weights       [l, m, r]    shares of the image's width: left view, between, right view (default [2, 1, 2])
      near, far     length       where the views' rays start and end, along their axes (default 0; beyond the scene)
      lateral       N            strips between the views, turning evenly (default: one for every 15 degrees)
      foreground    true         also render the root view and its connecting segments, in front of the views (default false)
      root          { eye, target, up, vfov }  what foreground and morph start from (default: before both views)
      cut           length       depth at which the root's segments end (default: halfway to the views)
      longitudinal  N            connecting segments have N parts that bend gradually (default 1)
      join          "bezier"     connecting segments are curves tangent to their neighbours (default "straight")
      morph         0..1         1 as built, 0 the root's plain view (default 1)

    A matrix replaces eye, target and up; a quaternion replaces target and up:
      matrix      [[..4], [..4], [..4]]  camera to world, 3 or 4 rows; the columns are the camera's x, y and z axes and its position
      quaternion  [w, x, y, z]           camera to world, of any length; needs eye; keyframes take the shortest rotation
      convention  "opengl"               x right, y up, view along -z: Blender, OpenGL, the transforms.json of NeRFs (default)
                  "opencv"               x right, y down, view along +z: OpenCV, COLMAP; both give world to camera: invert it first
      distance    length                 from the eye to the target (default 1)

    A view's part shows, pixel for pixel, the pinhole of that view in an image as large as the part. Between them near and
    far points are interpolated (CGLC segments). Views that intersect within the scene, or rays between them that cross there,
    are errors. (Popescu et al., 3.3, Fig. 4)
    """
    return Camera("bottom_up", {"views": views, "weights": weights, "near": near, "far": far, "lateral": lateral, "foreground": foreground, "root": root, "cut": cut, "longitudinal": longitudinal, "join": join, "morph": morph})


def graph_camera(
    *,
    views: Value | None = None,
    weights: Value | None = None,
    near: Value | None = None,
    far: Value | None = None,
    root: Value | None = None,
    morph: Value | None = None,
) -> Camera:
    """Two pinhole views and the root view between them, not joined; for comparison with bottom_up.

      views      [{ eye, target, up, vfov }, { ... }]
                              the left and the right view, keys as of pinhole; vfov spans the image's height
      weights    [l, m, r]    shares of the image's width: left view, between, right view (default [2, 1, 2])
      near, far  length       where the rays start and end, along the views' axes (default 0; beyond the scene)
      root       { eye, target, up, vfov }  the view in between (default: before both views)
      morph      0..1         1 as built, 0 the root's plain view (default 1)

    A matrix replaces eye, target and up; a quaternion replaces target and up:
      matrix      [[..4], [..4], [..4]]  camera to world, 3 or 4 rows; the columns are the camera's x, y and z axes and its position
      quaternion  [w, x, y, z]           camera to world, of any length; needs eye; keyframes take the shortest rotation
      convention  "opengl"               x right, y up, view along -z: Blender, OpenGL, the transforms.json of NeRFs (default)
                  "opencv"               x right, y down, view along +z: OpenCV, COLMAP; both give world to camera: invert it first
      distance    length                 from the eye to the target (default 1)

    Pinhole segments alone, as in the graph camera of 2009: the picture breaks at both sides of the middle part. (Popescu et al.,
    Fig. 9)
    """
    return Camera("graph_camera", {"views": views, "weights": weights, "near": near, "far": far, "root": root, "morph": morph})


def top_down(
    *,
    eye: Value | None = None,
    target: Value | None = None,
    up: Value | None = None,
    vfov: Value | None = None,
    regions: Value | None = None,
    band: Value | None = None,
    layout: Value | None = None,
    near: Value | None = None,
    far: Value | None = None,
    foreground: Value | None = None,
    cut: Value | None = None,
    longitudinal: Value | None = None,
    join: Value | None = None,
    morph: Value | None = None,
    matrix: Value | None = None,
    quaternion: Value | None = None,
    convention: Value | None = None,
    distance: Value | None = None,
) -> Camera:
    """A pinhole view, regions of which are seen from viewpoints of their own.

      eye, target, up, vfov      the root view, keys as of pinhole
      regions       [{ rect = [a0, b0, a1, b1], eye, target, up, vfov }, ...]
                                 any number of image rectangles, or polygon = [[a, b], ...] of up to 10000 corners; the region's middle
                                 looks at target (default: what the root sees there); up and vfov as the root's if absent
      band          0..          width of the transition around each region, in parts of the image's height (default 0.1)
      layout        "cross"      the root is a cube of six views of 90 degrees: "cross" (up, then left front right back, then
                                 down), "strip" (left front right back up down); leave vfov out (default "plain")
      near, far     length       where the regions' rays start, where all end, along the views' axes (default 0; beyond the scene)
      foreground    true         also render the root's segments in front of the regions (default false)
      cut           length       depth at which the root's segments end (default: halfway to the regions' near ends)
      longitudinal  N            connecting segments have N parts that bend gradually (default 1)
      join          "bezier"     connecting segments are curves tangent to their neighbours (default "straight")
      morph         0..1         1 as built, 0 the root's plain view (default 1)

    A matrix replaces eye, target and up; a quaternion replaces target and up:
      matrix      [[..4], [..4], [..4]]  camera to world, 3 or 4 rows; the columns are the camera's x, y and z axes and its position
      quaternion  [w, x, y, z]           camera to world, of any length; needs eye; keyframes take the shortest rotation
      convention  "opengl"               x right, y up, view along -z: Blender, OpenGL, the transforms.json of NeRFs (default)
                  "opencv"               x right, y down, view along +z: OpenCV, COLMAP; both give world to camera: invert it first
      distance    length                 from the eye to the target (default 1)

    A region shows, pixel for pixel, the pinhole of its viewpoint, moved by whole pixels; outside the bands the picture is the
    root's plain view; in a band near and far points are interpolated (CGLC segments). Where regions or their bands overlap, each has its share of what
    those before it in the list leave. Regions must not leave their face of a cube. If a band is too narrow for the distance between its region's eye and the root's, rays
    cross in it, and `anamorph camera` says so. (Popescu et al., 3.3, Fig. 1 and 6, 4.3)
    """
    return Camera("top_down", {"eye": eye, "target": target, "up": up, "vfov": vfov, "regions": regions, "band": band, "layout": layout, "near": near, "far": far, "foreground": foreground, "cut": cut, "longitudinal": longitudinal, "join": join, "morph": morph, "matrix": matrix, "quaternion": quaternion, "convention": convention, "distance": distance})


def track(
    *,
    eye: Value | None = None,
    target: Value | None = None,
    up: Value | None = None,
    vfov: Value | None = None,
    targets: Value | None = None,
    bend: Value | None = None,
    far: Value | None = None,
    segments: Value | None = None,
    smooth: Value | None = None,
    longitudinal: Value | None = None,
    join: Value | None = None,
    morph: Value | None = None,
    matrix: Value | None = None,
    quaternion: Value | None = None,
    convention: Value | None = None,
    distance: Value | None = None,
) -> Camera:
    """A pinhole view whose rays run around what hides targets in the scene.

      eye, target, up, vfov      the view, keys as of pinhole
      targets       [{ at = [x, y, z], radius = r }, ...]
                                 up to 32 balls, middle and outline, to be seen where they would be without occluders (default radius 0)
      bend          "up"         where rays go: "up", "down", "left", "right" in the picture; or "auto", the flattest of eight
                                 directions or a mean of some, one for all targets if possible (default "auto")
      far           length       where the rays end, along the view's axis (default: beyond the scene)
      segments      N            at most N segments of two triangles in each layer, as in the paper: 9 for a target, 17 for two
                                 apart; where bands of targets meet the shifts are coarser (default: as many as are of use)
      smooth        0..0.1       while a target moves by this part of the image's height, its rays pass from one detour to another, and
                                 may show what hides it for the moment; 0: they jump, and it stays in sight (default 0)
      longitudinal  N            the detours out and back have N parts that bend gradually (default 1)
      join          "bezier"     the detours out and back are curves (default "straight")
      morph         0..1         1 as built, 0 the plain view (default 1)

    A matrix replaces eye, target and up; a quaternion replaces target and up:
      matrix      [[..4], [..4], [..4]]  camera to world, 3 or 4 rows; the columns are the camera's x, y and z axes and its position
      quaternion  [w, x, y, z]           camera to world, of any length; needs eye; keyframes take the shortest rotation
      convention  "opengl"               x right, y up, view along -z: Blender, OpenGL, the transforms.json of NeRFs (default)
                  "opencv"               x right, y down, view along +z: OpenCV, COLMAP; both give world to camera: invert it first
      distance    length                 from the eye to the target (default 1)

    Rays about a hidden target's place are shifted parallel to the image, smoothly from the eye to before what hides it, and
    back from behind that to the target's front; there and beyond they are those of the plain view. The shift falls to 0
    around the target; where targets meet, shifts are blended, and the nearer target's counts where they overlap. A shift
    begins to grow when something is about to hide its target, 1/16 of the image's height away. Nothing hidden: the plain view. A
    target that no shift reaches, that is behind the eye, or for which there are no more layers, is shown as in the plain view; the
    summary line, the report and `anamorph camera` say so.
    (Popescu et al., 3.3, Fig. 8)
    """
    return Camera("track", {"eye": eye, "target": target, "up": up, "vfov": vfov, "targets": targets, "bend": bend, "far": far, "segments": segments, "smooth": smooth, "longitudinal": longitudinal, "join": join, "morph": morph, "matrix": matrix, "quaternion": quaternion, "convention": convention, "distance": distance})


def opencv(
    *,
    eye: Value | None = None,
    target: Value | None = None,
    up: Value | None = None,
    file: Value | None = None,
    model: Value | None = None,
    line_time: Value | None = None,
    velocity: Value | None = None,
    angular_velocity: Value | None = None,
    pieces: Value | None = None,
    error: Value | None = None,
    t_range: Value | None = None,
    matrix: Value | None = None,
    quaternion: Value | None = None,
    convention: Value | None = None,
    distance: Value | None = None,
) -> Camera:
    """A calibrated camera, from the file that OpenCV's FileStorage writes.

      eye        [x, y, z]   where the camera is while its row 0 is read; t = 0
      target     [x, y, z]   what its z axis (forward) looks at
      up         [x, y, z]   against its y axis (default [0, 1, 0])
      file       "CAM.yml"   FileStorage as YAML, XML or JSON, or ROS's camera_info, with image_width, image_height and the matrices
                             camera_matrix (no skew) and distortion_coefficients; other keys are ignored
      model      "brown"     0, 4, 5, 8, 12 or 14 coefficients k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4, tau_x, tau_y
                 "fisheye"   Kannala and Brandt: 4 coefficients k1, k2, k3, k4
                             (default: the file's distortion_model (plumb_bob and rational_polynomial are brown; equidistant and fisheye)
                             or fisheye_model (1, 0); else brown, which is told where 4 coefficients may be of either)
      line_time  seconds     from one row of the sensor to the next (default 0: all at once)
      velocity   [x, y, z]   of the camera, world units a second (default 0)
      angular_velocity  [x, y, z]  degrees a second about the world's axes through the eye, right-handed (default 0)
      pieces     "exact"     "exact" (default): a ray of its own for each pixel; N pieces; or "auto": as many as the error needs
      error      px          of "auto": the largest image distance from the exact camera (default 0.25)
      t_range    [t0, t1]    ends of t, inclusive (default [0, inf])

    A matrix replaces eye, target and up; a quaternion replaces target and up:
      matrix      [[..4], [..4], [..4]]  camera to world, 3 or 4 rows; the columns are the camera's x, y and z axes and its position
      quaternion  [w, x, y, z]           camera to world, of any length; needs eye; keyframes take the shortest rotation
      convention  "opengl"               x right, y up, view along -z: Blender, OpenGL, the transforms.json of NeRFs (default)
                  "opencv"               x right, y down, view along +z: OpenCV, COLMAP; both give world to camera: invert it first
      distance    length                 from the eye to the target (default 1)

    The image has the file's size; an [image] of another size shows the same view stretched to it, as fx and cx + 1/2 times
    W / image_width, fy and cy + 1/2 times H / image_height do. OpenCV's pixel (i, j) has its centre at (i, j), so image place
    (a, b) is u = a image_width - 1/2, v = b image_height - 1/2; x'' = (u - cx) / fx, y'' = (v - cy) / fy.
    brown: x'' = x' g + 2 p1 x'y' + p2 (r^2 + 2 x'^2) + s1 r^2 + s2 r^4, y'' = y' g + p1 (r^2 + 2 y'^2) + 2 p2 x'y' + s3 r^2 + s4 r^4,
    r^2 = x'^2 + y'^2, g = (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6), then the sensor's tilt by tau_x and tau_y
    as in OpenCV; solved for x', y' to f64. D = x' r - y' u + f, so t is OpenCV's z.
    fisheye: theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8) = |(x'', y'')|, theta up to 180 degrees;
    D = sin(theta) (x'' r - y'' u) / |(x'', y'')| + cos(theta) f. f, r, u as for pinhole.
    Beyond a fold (where the map's determinant is 0) or a pole a model shows more than one direction at the same pixel. A pixel has the
    ray on the branch of the middle: follow the straight line from (cx, cy) to the pixel. If it meets a fold or a pole before the
    pixel, the pixel has no ray. For a radial lens the branch ends at the first radius where the distorted radius stops growing or
    becomes infinite. Rays, the reference and `project` use this rule.
    P = eye + v line_time velocity; D is turned by v line_time angular_velocity.
    Source: OpenCV's calib3d and fisheye modules; Brown 1971; Kannala and Brandt 2006.
    """
    return Camera("opencv", {"eye": eye, "target": target, "up": up, "file": file, "model": model, "line_time": line_time, "velocity": velocity, "angular_velocity": angular_velocity, "pieces": pieces, "error": error, "t_range": t_range, "matrix": matrix, "quaternion": quaternion, "convention": convention, "distance": distance})


def calibrated(
    *,
    eye: Value | None = None,
    target: Value | None = None,
    up: Value | None = None,
    file: Value | None = None,
    image: Value | None = None,
    index: Value | None = None,
    line_time: Value | None = None,
    velocity: Value | None = None,
    angular_velocity: Value | None = None,
    pieces: Value | None = None,
    error: Value | None = None,
    t_range: Value | None = None,
    matrix: Value | None = None,
    quaternion: Value | None = None,
    convention: Value | None = None,
    distance: Value | None = None,
) -> Camera:
    """A calibrated camera, from the file of COLMAP, OpenCV, ROS, Kalibr or others; with an image of a project also its pose.

      eye        [x, y, z]   where the camera is while its row 0 is read; t = 0
      target     [x, y, z]   what its z axis (forward) looks at
      up         [x, y, z]   against its y axis (default [0, 1, 0])
      file       "sparse/0"  a folder of COLMAP's, with cameras and images as .bin or .txt, or its file of cameras; or
                 "CAM.yaml"  a file of OpenCV, ROS, Kalibr, EuRoC, camodocal, Basalt, ORB-SLAM, stella_vslam, SVO, vikit, gyroflow,
                             WoodScape, OCamCalib, NVIDIA's DRIVE and ncore, OpenSfM, ODM, AliceVision, Metashape or KITTI, or a
                             transforms.json: anamorph info CAM.yaml shows which cameras it has
      image      "NAME"      an image of COLMAP, transforms.json, OpenSfM, AliceVision or Metashape: its camera and its pose;
                             replaces eye, target, up, matrix and quaternion
      index      N           which camera of the file: COLMAP's id, N of camN, the place in the file's list from 0
                             (default: the only one)
      line_time  seconds     from one row of the sensor to the next (default 0: all at once)
      velocity   [x, y, z]   of the camera, world units a second (default 0)
      angular_velocity  [x, y, z]  degrees a second about the world's axes through the eye, right-handed (default 0)
      pieces     "exact"     "exact" (default): a ray of its own for each pixel; N pieces; or "auto": as many as the error needs
      error      px          of "auto": the largest image distance from the exact camera (default 0.25)
      t_range    [t0, t1]    ends of t, inclusive (default [0, inf])

    A matrix replaces eye, target and up; a quaternion replaces target and up:
      matrix      [[..4], [..4], [..4]]  camera to world, 3 or 4 rows; the columns are the camera's x, y and z axes and its position
      quaternion  [w, x, y, z]           camera to world, of any length; needs eye; keyframes take the shortest rotation
      convention  "opengl"               x right, y up, view along -z: Blender, OpenGL, the transforms.json of NeRFs (default)
                  "opencv"               x right, y down, view along +z: OpenCV, COLMAP; both give world to camera: invert it first
      distance    length                 from the eye to the target (default 1)

    The image has the file's size; an [image] of another size shows the same view stretched to it. Directions, at angle theta from the
    axis, are projected onto a plane at radius r, a distortion moves the plane's points, and focal lengths and principal point make
    pixels of them. The centre of the first pixel is where the writer of the file puts it: (0.5, 0.5) or (0, 0).
    COLMAP: all models up to EQUIRECTANGULAR. SIMPLE_PINHOLE to FULL_OPENCV and the fisheyes are opencv's brown and fisheye; FOV: r = atan(2 tan(theta)
    tan(omega / 2)) / omega; THIN_PRISM_FISHEYE: r = theta, then brown with k1..k4 of r^2..r^8, p1, p2, s1 = sx1, s3 = sy1;
    RAD_TAN_THIN_PRISM_FISHEYE: r = theta, then k0..k5 of r^2..r^12, then p and s of the moved point; DIVISION: tan(theta) =
    r / (1 + k r^2); EUCM; EQUIRECTANGULAR: longitude and latitude.
    ROS: plumb_bob, rational_polynomial, equidistant. Kalibr: pinhole, omni, eucm or ds, with radtan or none; pinhole with equidistant
    or fov. omni: r = sin(theta) / (cos(theta) + xi); eucm: r = sin(theta) / (alpha sqrt(beta sin^2(theta) + cos^2(theta)) +
    (1 - alpha) cos(theta)); ds: r = sin(theta) / (alpha d + (1 - alpha) (xi + cos(theta))), d^2 = sin^2(theta) + (xi + cos(theta))^2.
    DRIVE, ncore and WoodScape: a polynomial from the radius in pixels to theta or back, and [c d; e 1] or an aspect ratio. OCamCalib:
    D along (x, y, -(a0 + a1 r + a2 r^2 + ...)), r in pixels. The others have the same models under other names.
    The perspective and FOV projections have rays of D = x r - y u + f, so t is the depth along f; all others have D of unit length.
    A pixel has the ray on the branch of the middle, as for opencv: none beyond a fold or a pole; a line says how many have none.
    Extrinsics of chains and rigs, rectifications and time offsets of files are not read.
    Source: COLMAP's models.h; OpenCV; Kalibr's supported models; Scaramuzza et al. 2006; Devernay and Faugeras 2001; Fitzgibbon 2001; Mei and Rives 2007;
    Khomutenko et al. 2016; Usenko et al. 2018.
    """
    return Camera("calibrated", {"eye": eye, "target": target, "up": up, "file": file, "image": image, "index": index, "line_time": line_time, "velocity": velocity, "angular_velocity": angular_velocity, "pieces": pieces, "error": error, "t_range": t_range, "matrix": matrix, "quaternion": quaternion, "convention": convention, "distance": distance})


def ods(
    *,
    eye: Value | None = None,
    target: Value | None = None,
    up: Value | None = None,
    ipd: Value | None = None,
    pieces: Value | None = None,
    error: Value | None = None,
    t_range: Value | None = None,
    matrix: Value | None = None,
    quaternion: Value | None = None,
    convention: Value | None = None,
    distance: Value | None = None,
) -> Camera:
    """An omni-directional stereo pair, 360 x 180 degrees each, the left eye's picture above the right eye's.

      eye      [x, y, z]   the middle between the eyes
      target   [x, y, z]   what the middle of each picture looks at
      up       [x, y, z]   the axis about which the eyes rotate (default [0, 1, 0]); made perpendicular to the view direction
      ipd      length      between the eyes, world units (0.064 in metres)
      pieces   "exact"     "exact" (default): a ray of its own for each pixel; N pieces; or "auto": as many as the error needs
      error    px          of "auto": the largest image distance from the exact camera (default 0.25)
      t_range  [t0, t1]    ends of t, inclusive (default [0, inf])

    A matrix replaces eye, target and up; a quaternion replaces target and up:
      matrix      [[..4], [..4], [..4]]  camera to world, 3 or 4 rows; the columns are the camera's x, y and z axes and its position
      quaternion  [w, x, y, z]           camera to world, of any length; needs eye; keyframes take the shortest rotation
      convention  "opengl"               x right, y up, view along -z: Blender, OpenGL, the transforms.json of NeRFs (default)
                  "opencv"               x right, y down, view along +z: OpenCV, COLMAP; both give world to camera: invert it first
      distance    length                 from the eye to the target (default 1)

    The image's height is even. Upper half: s = -1, b' = 2b; lower half: s = 1, b' = 2b - 1. l = (a - 1/2) 360 degrees,
    p = (1/2 - b') 180 degrees, f, r, u as for pinhole; P = eye + s (ipd / 2) (cos(l) r - sin(l) f),
    D = cos(p) (sin(l) r + cos(l) f) + sin(p) u, a unit vector: every ray touches the circle of radius ipd / 2 or passes above it.
    Source: Google, Rendering Omni-directional Stereo Content; Peleg, Ben-Ezra and Pritch 2001.
    """
    return Camera("ods", {"eye": eye, "target": target, "up": up, "ipd": ipd, "pieces": pieces, "error": error, "t_range": t_range, "matrix": matrix, "quaternion": quaternion, "convention": convention, "distance": distance})


def camera_texture(
    *,
    eye: Value | None = None,
    target: Value | None = None,
    up: Value | None = None,
    vfov: Value | None = None,
    file: Value | None = None,
    offsets: Value | None = None,
    scale: Value | None = None,
    mode: Value | None = None,
    pieces: Value | None = None,
    error: Value | None = None,
    t_range: Value | None = None,
    matrix: Value | None = None,
    quaternion: Value | None = None,
    convention: Value | None = None,
    distance: Value | None = None,
) -> Camera:
    """A perspective view deformed by a grid of offsets.

      eye      [x, y, z]   where the rays start; t = 0
      target   [x, y, z]   what the middle of the undeformed image looks at
      up       [x, y, z]   what points up in it (default [0, 1, 0])
      vfov     degrees     between its upper and lower border, over 0 and under 180
      file     "O.npy"     rows x columns x 2 of f32 or f64 in C order, or an EXR with R G = right, down; at least 2 x 2
      offsets  [[[dx, dy]]]  instead: rows of offsets. Image coordinates: 1 is the image's width to the right, its height down
      scale    number      of all offsets (default 1)
      mode     "affine"    two affine pieces a cell (default)
               "bilinear"  each cell is a bilinear map, its exact inverse taken for each pixel
      pieces   "exact"     bilinear only: "exact" (default): a ray of its own for each pixel; N pieces; or "auto"
      error    px          of "auto": the largest image distance from the exact camera (default 0.25)
      t_range  [t0, t1]    ends of t, inclusive (default [0, inf])

    A matrix replaces eye, target and up; a quaternion replaces target and up:
      matrix      [[..4], [..4], [..4]]  camera to world, 3 or 4 rows; the columns are the camera's x, y and z axes and its position
      quaternion  [w, x, y, z]           camera to world, of any length; needs eye; keyframes take the shortest rotation
      convention  "opengl"               x right, y up, view along -z: Blender, OpenGL, the transforms.json of NeRFs (default)
                  "opencv"               x right, y down, view along +z: OpenCV, COLMAP; both give world to camera: invert it first
      distance    length                 from the eye to the target (default 1)

    Offset (i, j) of a grid of n x m belongs to the place p = (i / (n - 1), j / (m - 1)) and displaces it to p + scale o. The
    ray at a displaced place is the pinhole's ray of the undisplaced one: P = eye, D = the pinhole's D at p. Affine: p is linear over
    the displaced triangles of a cell, cut from its upper right to its lower left corner; bilinear: (u, v) with
    p + scale o = (1-u)(1-v) q00 + u(1-v) q10 + (1-u)v q01 + uv q11 over the displaced corners. Places that nothing is displaced to
    are background. Where cells fold over others the lowest-numbered shows; the camera's notes count the folded ones.
    Source: Lorenz and Doellner 2009, section 3.2; camera textures: Spindler et al. 2006.
    """
    return Camera("camera_texture", {"eye": eye, "target": target, "up": up, "vfov": vfov, "file": file, "offsets": offsets, "scale": scale, "mode": mode, "pieces": pieces, "error": error, "t_range": t_range, "matrix": matrix, "quaternion": quaternion, "convention": convention, "distance": distance})


def panini(
    *,
    eye: Value | None = None,
    target: Value | None = None,
    up: Value | None = None,
    fov: Value | None = None,
    d: Value | None = None,
    s: Value | None = None,
    pieces: Value | None = None,
    error: Value | None = None,
    t_range: Value | None = None,
    matrix: Value | None = None,
    quaternion: Value | None = None,
    convention: Value | None = None,
    distance: Value | None = None,
) -> Camera:
    """A cylinder around the eye, projected from a point behind its axis.

      eye      [x, y, z]   where the rays start; t = 0
      target   [x, y, z]   what the middle of the image looks at
      up       [x, y, z]   the cylinder's axis (default [0, 1, 0]); made perpendicular to the view direction
      fov      degrees     between the image's left and right border; under 360 with d = 1, under 180 with d = 0 or s > 0
      d        number      from the axis back to the centre of projection, radii: 0 rectilinear, 1 Pannini (default), large cylindrical
      s        0 to 1      vertical compression: 1 straightens horizontal lines that face the viewer (default 0)
      pieces   "exact"     "exact" (default): a ray of its own for each pixel; N pieces; or "auto": as many as the error needs
      error    px          of "auto": the largest image distance from the exact camera (default 0.25)
      t_range  [t0, t1]    ends of t, inclusive (default [0, inf])

    A matrix replaces eye, target and up; a quaternion replaces target and up:
      matrix      [[..4], [..4], [..4]]  camera to world, 3 or 4 rows; the columns are the camera's x, y and z axes and its position
      quaternion  [w, x, y, z]           camera to world, of any length; needs eye; keyframes take the shortest rotation
      convention  "opengl"               x right, y up, view along -z: Blender, OpenGL, the transforms.json of NeRFs (default)
                  "opencv"               x right, y down, view along +z: OpenCV, COLMAP; both give world to camera: invert it first
      distance    length                 from the eye to the target (default 1)

    S = (d + 1) / (d + cos(phi)), x = S sin(phi), y = tan(theta) ((1 - s) S + s / cos(phi)), phi the angle to the right of ahead,
    theta above the horizon; x = (2a - 1) x(fov / 2), y = (1 - 2b) (H / W) x(fov / 2), f, r, u as for pinhole;
    P = eye, D = sin(phi) r + cos(phi) f + tan(theta) u, so t is the distance from the axis.
    Source: Sharpless, Postle and German 2010, Pannini: A New Projection for Rendering Wide Angle Perspective Images.
    """
    return Camera("panini", {"eye": eye, "target": target, "up": up, "fov": fov, "d": d, "s": s, "pieces": pieces, "error": error, "t_range": t_range, "matrix": matrix, "quaternion": quaternion, "convention": convention, "distance": distance})


def display(
    *,
    eye: Value | None = None,
    mesh: Value | None = None,
    t_range: Value | None = None,
) -> Camera:
    """What a viewer sees through a curved screen, or a projector throws on it.

      eye      [x, y, z]     the viewer, of a projector's picture too; t = 0
      mesh     "SCREEN.obj"  the screen in world units; its texture coordinates are places in the image, (0, 0) the lower left corner and
                             (1, 1) the upper right one, as for any texture. Every face has them, and no two overlap there
      t_range  [t0, t1]      ends of t, inclusive (default [0, inf]); [1, inf]: only what lies behind the screen

    Each triangle of the mesh is a piece: at texture coordinates (u, v) = (a, 1 - b) it has the point S, linear in (u, v);
    P = eye, D = S - eye, so t = 1 on the screen. It is the mesh camera with near = eye and far = S: exact for a screen of flat
    triangles. Places in no triangle are background.
    """
    return Camera("display", {"eye": eye, "mesh": mesh, "t_range": t_range})


def lightfield(
    *,
    center: Value | None = None,
    normal: Value | None = None,
    up: Value | None = None,
    width: Value | None = None,
    height: Value | None = None,
    views: Value | None = None,
    fov: Value | None = None,
    pieces: Value | None = None,
    error: Value | None = None,
    t_range: Value | None = None,
) -> Camera:
    """A ray for each sub-pixel of a flat display under lenslets, which shows another view to each direction.

      center   [x, y, z]   the middle of the display; t = 0 on the display
      normal   [x, y, z]   from the display to its viewers
      up       [x, y, z]   what points up on the display (default [0, 1, 0])
      width    length      of the display, world units
      height   length      of the display, world units
      views    [nx, ny]    pixels under a lenslet; the image is a whole number of lenslets, W / nx x H / ny
      fov      degrees     the whole angle into which a lenslet shines, or [across, down]; under 180
      pieces   "exact"     "exact" (default): a ray of its own for each pixel; N pieces; or "auto": as many as the error needs
      error    px          of "auto": the largest image distance from the exact camera (default 0.25)
      t_range  [t0, t1]    ends of t, inclusive (default [0, inf]: what lies behind the display); [-1, inf]: in front of it too

    f = -unit(normal), r = unit(f x up), u = r x f. Lenslet (I, J) = (floor(a W / nx), floor(b H / ny)), of (X, Y) = (W / nx, H / ny),
    (x, y) = 2 (a X - I, b Y - J) - 1 within it; P = center + ((I + 1/2) / X - 1/2) width r - ((J + 1/2) / Y - 1/2) height u,
    D = f + x tan(fov_x / 2) r - y tan(fov_y / 2) u. A pixel to the right of its lenslet's middle shines to the left, where a viewer
    sees what lies to the right: each lenslet holds an upright picture. t is the depth behind the display.
    """
    return Camera("lightfield", {"center": center, "normal": normal, "up": up, "width": width, "height": height, "views": views, "fov": fov, "pieces": pieces, "error": error, "t_range": t_range})


def reflection(
    *,
    eye: Value | None = None,
    mirror: Value | None = None,
    facets: Value | None = None,
    facets_error: Value | None = None,
    depth: Value | None = None,
    roughness: Value | None = None,
    rays: Value | None = None,
    environment: Value | None = None,
    atlas: Value | None = None,
    color: Value | None = None,
    base: Value | None = None,
    t_range: Value | None = None,
) -> Camera:
    """A camera that looks at a mirror and at the scene in it.

      eye      {...}      the camera that looks: any kind but these two, its own keys in a table. Curved rays meet facets only
      mirror   {...}      the surface, see below
      facets   "exact"    the surface itself, where it is a shape (default there)
               "normals"  facets with normals interpolated between their corners (default for a mesh)
               "flat"     facets that are one GLC each: the reflected or refracted rays of their corners, interpolated; for a central eye
      facets_error  px    instead of a count of facets: the count is doubled, from 32, until after one bounce 95 % of the
                          pixels that see the surface show points within this many pixels of the exact surface's
      depth    N          how often a ray may be reflected, 1 to 16 (default 1). With 1 a reflected ray sees the scene without
                          the mirror; with more the mirror sees itself
      roughness  s        normals are tilted by up to this tangent (default 0), evenly over a disc
      rays     N          rays per pixel on a rough surface, 1 to 256 (default 16)
      environment  [x, y, z]   reflected or refracted rays start at this point instead of the surface, as in an environment map of
                          unlimited resolution, for comparison; with depth 1
      atlas    R          every facet is first rendered into a right-angled triangle of R x R / 2 texels, from which the picture
                          takes the nearest texel, as in the papers; for comparison
      color    [r, g, b]  factor of the colour at every reflection (default [1, 1, 1])
      base     [r, g, b]  colour of the mirror where rays end on it after the last reflection (default [0, 0, 0])
      t_range  [t0, t1]   ends of t of the rays from the eye, inclusive (default [0, inf])

    The mirror is a mesh ({ file = "F.obj", ... } or { builtin = "teapot", ... } with the keys of [[mesh]]) or a shape:
      { shape = "sphere", center, radius }
      { shape = "torus", center, axis, radius, tube }                 if tube > radius, the overlap counts as outside
      { shape = "quadric", vertex, axis, curvature, conic, radius }   a cap: at r <= radius from the axis it lies
          curvature r^2 / (1 + sqrt(1 - (1 + conic) curvature^2 r^2)) along the axis from the vertex
      { shape = "lens", center, axis, radius, thickness, curvatures = [c1, c2], conics = [k1, k2] }
      { shape = "wave", center, size, amplitude, wavelength }         y = amplitude sin(2 pi x / wavelength) sin(2 pi z / wavelength)
          for x and z within size / 2 of the center, at most 1024 wavelengths; outside is above
    and count = N: the approximate number of facets (default of a shape: 960; of a mesh: its own triangles). A mesh with more is simplified
    by collapsing edges; one with fewer is subdivided.
    With cameras = N these facets are still visible and occlude, but reflect or refract rays like a simplified copy with about N facets.
    Each corner's normal is intersected with the copy in both directions, and the copy's normal there replaces it (normal shooting: Hou
    et al., section 2.3); if the line misses the copy, its nearest point is used. "flat" facets reflect the corners' rays about these
    normals. Reflected rays start on the visible facet, not on the copy's as in the paper: this is nearer to the surface itself.
    Not with facets_error. With an atlas, its texels are those of the copy's facets, with rays that start on the copy, and the picture
    looks up the points of the copy found for the corners, all as in the paper.

    A ray P + t D of the eye whose first hit is the surface goes on from there, D' = d - 2 (d . n) n with d = D / |D| and the normal n;
    both faces reflect. A curve goes on as its tangent, D = X'(t); of several layers the one with the hit counts (Brosz et al., 6.1). n is the surface's own; or the sum of the corners' normals with the barycentric weights of the place on the
    facet (Hou et al., section 3.1). If this normal, or one tilted by roughness, sends D' through the surface, the surface's plane reflects
    it again. With flat facets D' is the weighted sum of the corners' reflected rays, scaled to one height over the facet (Yu et al.,
    section 5.2), or to unit length where one of them leaves it at less than 1/64.
    triangle.id and bary are of the last surface hit; a ray that ends on the mirror has an id behind the scene's triangles. t is of the
    last ray, Z the length of the whole path. mirror.id is the first facet met, and piece.id that facet behind the eye's own pieces;
    with cameras, piece.id is the copy's facet that the normal at the centre of mirror.id's facet meets.
    Source: Hou, Wei, Shum and Guo 2006, sections 2.3 and 3.1; Yu, Yu and McMillan 2009, section 5.2.
    """
    return Camera("reflection", {"eye": eye, "mirror": mirror, "facets": facets, "facets_error": facets_error, "depth": depth, "roughness": roughness, "rays": rays, "environment": environment, "atlas": atlas, "color": color, "base": base, "t_range": t_range})


def refraction(
    *,
    eye: Value | None = None,
    lens: Value | None = None,
    ior: Value | None = None,
    facets_error: Value | None = None,
    facets: Value | None = None,
    depth: Value | None = None,
    fresnel: Value | None = None,
    roughness: Value | None = None,
    rays: Value | None = None,
    environment: Value | None = None,
    color: Value | None = None,
    base: Value | None = None,
    t_range: Value | None = None,
    atlas: Value | None = None,
) -> Camera:
    """A camera that looks at a lens and at the scene through it.

      eye      {...}      the camera that looks: any kind but these two, its own keys in a table. Curved rays meet facets only
      lens     {...}      the surface, as the mirror of reflection: see anamorph camera --help reflection
      ior      n          index of refraction inside the surface; outside it is 1
      facets_error  px    as for reflection
      facets   "exact" | "normals" | "flat"   as for reflection
      depth    N          how often a ray may be refracted or reflected, 1 to 16 (default 1). 1: one interface, then the
                          scene. A solid lens needs 2, plus one for each total internal reflection
      fresnel  true       where a ray is refracted, a second ray is reflected with its share of the light by Fresnel's equations, up to
                          depth 8 (default false: all light is refracted). Ids and depths are those of the refracted ray
      roughness, rays, environment, color, base, t_range   as for reflection

    A ray P + t D whose first hit is the surface goes on by Snell's law: d' = e d + (e c - sqrt(1 - e^2 (1 - c^2))) n, with d = D / |D|,
    the normal n against d, c = -d . n, and e = 1 / ior where the ray meets the outside, ior where it meets the inside. Where the root
    is of a negative number it is reflected. The outside is where the surface's normals point, of a facet the side from which it is
    counter-clockwise: a ray from an eye inside the lens meets the inside first. If an interpolated or tilted normal sends
    a direction to the wrong side of the surface, the surface's plane reflects it.
    Channels are those of reflection.
    Source: Hou, Wei, Shum and Guo 2006, section 3.2, whose cameras refract once.
    """
    return Camera("refraction", {"eye": eye, "lens": lens, "ior": ior, "facets_error": facets_error, "facets": facets, "depth": depth, "fresnel": fresnel, "roughness": roughness, "rays": rays, "environment": environment, "color": color, "base": base, "t_range": t_range, "atlas": atlas})


def lidar(
    *,
    file: Value | None = None,
    eye: Value | None = None,
    target: Value | None = None,
    up: Value | None = None,
    beams: Value | None = None,
    columns: Value | None = None,
    start: Value | None = None,
    sweep: Value | None = None,
    velocity: Value | None = None,
    period: Value | None = None,
    t_range: Value | None = None,
    matrix: Value | None = None,
    quaternion: Value | None = None,
    convention: Value | None = None,
    distance: Value | None = None,
) -> Camera:
    """Any list of rays, or the rays of a spinning scanner.

      file      "R.npy"     N x 6 of f32 or f64 in C order: P and D of each ray; t = 0 at P; instead of all keys below
      eye       [x, y, z]   where the scanner is when its sweep begins; t = 0
      target    [x, y, z]   what azimuth 0, elevation 0 looks at
      up        [x, y, z]   the axis it rotates about (default [0, 1, 0]); made perpendicular to the view direction
      beams     [e0, ...]   elevations in degrees, a row of the image each, from the top
      columns   N           shots of each beam during the sweep
      start     degrees     azimuth where the sweep begins, to the right of target (default -180)
      sweep     degrees     how far it rotates to the right; negative: to the left (default 360)
      velocity  [x, y, z]   of the scanner, world units a second (default 0)
      period    seconds     of the sweep
      t_range   [t0, t1]    ends of t, inclusive (default [0, inf])

    A matrix replaces eye, target and up; a quaternion replaces target and up:
      matrix      [[..4], [..4], [..4]]  camera to world, 3 or 4 rows; the columns are the camera's x, y and z axes and its position
      quaternion  [w, x, y, z]           camera to world, of any length; needs eye; keyframes take the shortest rotation
      convention  "opengl"               x right, y up, view along -z: Blender, OpenGL, the transforms.json of NeRFs (default)
                  "opencv"               x right, y down, view along +z: OpenCV, COLMAP; both give world to camera: invert it first
      distance    length                 from the eye to the target (default 1)

    A list's image has any size that holds N pixels, filled row by row, without rays at the end; with no [image] it is
    ceil(sqrt(N)) wide. A scan's image is columns x beams. The whole pixel has that one ray: neighbours need not be alike.
    With s = (i + 1/2) / columns, th = start + s sweep, f, r, u as for pinhole: P = eye + s period velocity,
    D = cos(e) (sin(th) r + cos(th) f) + sin(e) u, a unit vector, so t is the range.
    `anamorph render SCENE --points OUT.ply` (or .npy) writes the points that are hit.
    """
    return Camera("lidar", {"file": file, "eye": eye, "target": target, "up": up, "beams": beams, "columns": columns, "start": start, "sweep": sweep, "velocity": velocity, "period": period, "t_range": t_range, "matrix": matrix, "quaternion": quaternion, "convention": convention, "distance": distance})


def composite(
    *,
    cameras: Value | None = None,
    master: Value | None = None,
) -> Camera:
    """Several cameras in one image, each in a region of its own or with objects of its own.

      cameras  [{ camera = { kind = "pinhole", ... }, region = { ... }, frame = "image", priority = 0 }, ...]
               1 to 256 tables; a pixel shows the first camera whose region holds it, background without one
      master   N  the number of a camera, from 0. All cameras whose regions hold a pixel are then seen there: those of the highest
               priority that hit something; of these, the hit that is nearest along this camera's ray

    Keys of each table:
        camera    {...}    a camera of any kind with one layer of rays, straight or curved, and no mirror or lens
        region    {...}    where it shows (default: the whole image):
                  { kind = "rectangle", from = [a0, b0], to = [a1, b1] }  from its upper left to its lower right corner
                  { kind = "polygon", points = [[a, b], ...] }            3 to 1024 corners; inside by the even-odd rule
                  { kind = "mask", file = "F.png" }                       white texels of an image of any size, over all of this one
        frame     "image"  the camera's own image is the whole image (default), or "region": the box around its region
        priority  N        a whole number; higher ones come first, equal ones in the order of the list (default 0)
        feather   PX       width of the strip along the region's border in which colours are blended, px (default 0)
        objects   [...]    names of the objects that it shows; "*" stands for any letters; needs master (default: all that no camera
                  names; if each camera names some, the master shows the others too). []: none, as for a master that is there for
                  its depth alone

    The border of a rectangle or polygon belongs to it. A texel is white where R + G + B >= 3/2 and opacity >= 1/2. Where the
    camera that shows has no ray, the background is seen. t is each camera's own if all rays are straight and all cameras have
    the same t_range, or with a master; else t from 0 to 1 is each camera's t_range, which must have two ends. Samples belong to
    the region of their own place. piece.id is the number of the camera. Agrawala, Zorin and Munzner 2000, Artistic
    Multiprojection Rendering; Brosz et al. 2007, section 6.1.
    """
    return Camera("composite", {"cameras": cameras, "master": master})


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
