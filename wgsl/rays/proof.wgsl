// Proofs, in f32 and recheck arithmetic, about the first hit of a ray or curve.

#import arithmetic
#import rays/affine_bundle.wgsl

// Proven bounds on the first hit of a pixel's ray or curve with a triangle.
struct Proof {
    may: bool,              // it is not proven to miss
    sure: bool,             // it is proven to meet it, at a t in range and from a face that shows
    near: real,             // t lies between these, if it meets
    far: real,
}

const MISSED: Proof = Proof(false, false, 0.0, 0.0);

// Unbounded t.
const FARTHEST: real = 3.0e38;

// The normal of a triangle, a bound on its size, and its error bound. A difference of two stored vertices loses 2 units
// of the larger's size and 1 of itself, a cross product of rounded factors 8 units of the product of their sizes.
struct Normal {
    n: real3,
    size: real,
    error: real,
}

fn normal_of(v: array<real3, 3>) -> Normal {
    let e1 = v[1] - v[0];
    let e2 = v[2] - v[0];
    let n = cross(e1, e2);
    let error_e = 2.0 * REAL_UNIT * reach3(v);
    let error = error_e * (size3(e1) + size3(e2) + error_e) + PRODUCT_UNITS * REAL_UNIT * size3(e1) * size3(e2);
    return Normal(n, size3(n) + error, error);
}

// Units of REAL_UNIT that a cross or dot product of rounded vectors loses, of the product of their sizes: a rounding of each
// factor, three products, two sums, and the rounding of the bound itself.
const PRODUCT_UNITS: real = 8.0;
