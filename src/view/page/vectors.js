// Vectors of three numbers, and rounding.

const add = (a, b) => a.map((x, k) => x + b[k]);
const sub = (a, b) => a.map((x, k) => x - b[k]);
const scale = (a, s) => a.map((x) => x * s);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const length = (a) => Math.hypot(...a);
const unit = (a) => { const l = length(a); return l > 0 ? scale(a, 1 / l) : [0, 0, 0]; };
const listOf = (value) => (Array.isArray(value) ? value : []);
const isVector = (v) => Array.isArray(v) && v.length === 3 && v.every((x) => typeof x === "number");

// a, turned about the unit vector axis by radians.
function turned(a, axis, radians) {
  const [c, s] = [Math.cos(radians), Math.sin(radians)];
  return add(add(scale(a, c), scale(cross(axis, a), s)), scale(axis, dot(axis, a) * (1 - c)));
}

// A number rounded to a part in a million of what else there is, so that the scene file stays readable.
function rounded(x, extent) {
  const digits = Math.min(12, Math.max(0, 6 - Math.ceil(Math.log10(Math.max(Math.abs(extent), 1e-9)))));
  return Number(x.toFixed(digits));
}
const roundedAll = (a, extent) => a.map((x) => rounded(x, extent));

// The frame of a view: forward, right and up, unit vectors; null where there is none.
function viewFrame(eye, target, up) {
  const forward = unit(sub(target, eye));
  const right = unit(cross(forward, up));
  return length(forward) > 0 && length(right) > 0 ? { forward, right, up: cross(right, forward) } : null;
}
