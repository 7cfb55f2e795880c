//! The keys of every kind of camera, as `anamorph camera --help KIND` prints them.

use crate::error::{Error, Result};

const PINHOLE: &str = "\
pinhole: all rays start in one point

  eye      [x, y, z]  where the rays start; t = 0
  target   [x, y, z]  what the middle of the image looks at
  up       [x, y, z]  what points up in the image (default [0, 1, 0])
  vfov     degrees    angle between the image's upper and lower border, over 0 and under 180
  t_range  [t0, t1]   ends of t, inclusive (default [0, inf])

f = unit(target - eye), r = unit(f x up), u = r x f, k = tan(vfov / 2);
P = eye, D = f + (2a - 1) k (W / H) r + (1 - 2b) k u
";

const ORTHOGRAPHIC: &str = "\
orthographic: all rays are parallel

  eye      [x, y, z]  a point of the plane where the rays start, in the middle of the image
  target   [x, y, z]  what the middle of the image looks at
  up       [x, y, z]  what points up in the image (default [0, 1, 0])
  height   length     of the image, in world units
  t_range  [t0, t1]   ends of t, inclusive (default [0, inf])

f, r, u as for pinhole; P = eye + (2a - 1) (height / 2) (W / H) r + (1 - 2b) (height / 2) u, D = f
";

const GLC: &str = "\
glc: a general linear camera, which three rays at corners of the image define

  near     [n0, n1, n2]  where these rays have t = 0: top left, top right, bottom left corner of the image
  far      [f0, f1, f2]  where they have t = 1
  t_range  [t0, t1]      ends of t, inclusive (default [0, inf])

P = n0 + a (n1 - n0) + b (n2 - n0), Q = f0 + a (f1 - f0) + b (f2 - f0), D = Q - P.
With near and far on parallel planes it is a pinhole, orthographic, pushbroom, cross-slit, pencil, twisted
orthographic or bilinear camera; `anamorph camera SCENE` says which, and where its slits are.
";

const MESH: &str = "\
mesh: image triangles, each a piece with rays at its corners

  vertices   [{ image = [a, b], near = [x, y, z], far = [x, y, z], w = 1 }, ...]
                         image place ([0, 0] top left, [1, 1] bottom right), where t = 0, where t = 1, weight
  triangles  [[i, j, k]] indices into vertices; triangles must not overlap in the image
  file       \"F.json\"    a file with these two keys, instead of them
  normalize  true        interpolate unit directions instead of far points (default false)
  t_range    [t0, t1]    ends of t, inclusive (default [0, inf])

The weights w_i L_i / sum(w_k L_k), L the barycentric coordinates in the image, interpolate near to P and far to Q;
D = Q - P, or with normalize D = sum of the weights times unit(far_i - near_i). Pixels in no triangle are background.
";

const RAYMAP: &str = "\
raymap: a ray read for every pixel

  origins     \"P.npy\"   H x W x 3 of f32 or f64 in C order, or an EXR with R G B = x y z
  directions  \"D.npy\"   the same for the directions, of any length
  t_range     [t0, t1]  ends of t, inclusive (default [0, inf])

The files' size is the image's. A pixel with a number that is not finite or with D = 0 has no ray.
";

/// A kind and its text.
const KINDS: [(&str, &str); 5] =
    [("pinhole", PINHOLE), ("orthographic", ORTHOGRAPHIC), ("glc", GLC), ("mesh", MESH), ("raymap", RAYMAP)];

pub fn names() -> Vec<&'static str> {
    KINDS.iter().map(|k| k.0).collect()
}

/// # Errors
/// [`Error::Input`] that lists the known kinds.
pub fn keys(kind: &str) -> Result<&'static str> {
    let found = KINDS.iter().find(|k| k.0 == kind);
    found.map(|k| k.1).ok_or_else(|| {
        Error::input(format!("--help {kind}: no such kind of camera in this version; known: {}", names().join(", ")))
    })
}
