// The camera's volume and the scene, drawn as lines in a view that can be turned, with handles.

const turntable = { yaw: 0.9, pitch: 0.45, scale: 30, middle: [0, 0, 0], isFitted: false };
const shapes = new Map(); // handles by their ids

function axes() {
  const [sy, cy, sp, cp] = [Math.sin(turntable.yaw), Math.cos(turntable.yaw), Math.sin(turntable.pitch), Math.cos(turntable.pitch)];
  // the viewer looks along -towards
  const towards = [cp * sy, sp, cp * cy];
  return { right: [cy, 0, -sy], up: cross(towards, [cy, 0, -sy]), towards };
}

// From the world to the page, px.
function placer() {
  const { right, up } = axes();
  const [w, h] = [$("volume").clientWidth / 2, $("volume").clientHeight / 2];
  const { middle, scale: s } = turntable;
  return (x, y, z) => {
    const p = [x - middle[0], y - middle[1], z - middle[2]];
    return [w + s * dot(p, right), h - s * dot(p, up)];
  };
}

// World units for a move on the page, px, across the line of sight.
function worldMove(dx, dy) {
  const { right, up } = axes();
  return add(scale(right, dx / turntable.scale), scale(up, -dy / turntable.scale));
}

// Places everything within the drawing.
function fitVolume() {
  const camera = state.volume?.camera ?? {};
  const points = (lines) => listOf(lines).flatMap((line) => Array.from({ length: line.length / 3 }, (_, k) => line.slice(3 * k, 3 * k + 3)));
  const all = [...cornersOf(state.wires?.bounds), ...handles().map((handle) => handle.at), ...points([...listOf(camera.near), ...listOf(camera.eyes)])];
  if (all.length === 0) return;
  if (!turntable.isFitted) standBeside(camera);
  // rays may go far beyond: as far as there is room for about as much again
  const least = (list, of) => list.reduce((least, p) => Math.min(least, of(p)), Infinity);
  const [lo, hi] = [0, 1, 2].map((k) => [least(all, (p) => p[k]), -least(all, (p) => -p[k])]).reduce(([l, h], [a, b]) => [[...l, a], [...h, b]], [[], []]);
  const room = length(sub(hi, lo)) / 4;
  all.push(...points(camera.rays).map((p) => p.map((x, k) => Math.min(hi[k] + room, Math.max(lo[k] - room, x)))));
  const { right, up } = axes();
  const [left, bottom] = [least(all, (p) => dot(p, right)), least(all, (p) => dot(p, up))];
  const [width, height] = [-least(all, (p) => -dot(p, right)) - left, -least(all, (p) => -dot(p, up)) - bottom];
  turntable.middle = add(scale(right, left + width / 2), scale(up, bottom + height / 2));
  turntable.scale = 0.92 * Math.min($("volume").clientWidth / Math.max(width, 1e-9), $("volume").clientHeight / Math.max(height, 1e-9));
  turntable.isFitted = true;
}

const cornersOf = (bounds) => (bounds ? [0, 1, 2, 3, 4, 5, 6, 7].map((k) => [0, 1, 2].map((axis) => bounds[(k >> axis) & 1][axis])) : []);

// Stands to the right of the camera and a little behind it, so that its rays go to the right.
function standBeside(camera) {
  const ways = (camera.rays ?? []).map((ray) => unit(sub(ray.slice(-3), ray.slice(0, 3))));
  const mean = ways.reduce(add, [0, 0, 0]);
  const level = length([mean[0], 0, mean[2]]) > 0.1 * ways.length ? unit([mean[0], 0, mean[2]]) : [0, 0, -1];
  const side = cross(level, [0, 1, 0]);
  const towards = sub(scale(side, Math.sin(1.08)), scale(level, Math.cos(1.08)));
  turntable.yaw = Math.atan2(towards[0], towards[2]);
  turntable.pitch = 0.42;
}

let drawing = null;
function drawVolume() {
  drawing ??= requestAnimationFrame(() => { drawing = null; drawLines(); drawHandles(); });
}

function drawLines() {
  const [canvas, box] = [$("lines"), $("volume")];
  const ratio = window.devicePixelRatio || 1;
  const [w, h] = [Math.round(box.clientWidth * ratio), Math.round(box.clientHeight * ratio)];
  if (w === 0) return;
  // once both are there
  if (!turntable.isFitted && state.wires && state.volume) fitVolume();
  if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, w, h);
  const place = placer();
  const colours = getComputedStyle(document.documentElement);
  const stroke = (lines, name, width, dash = []) => {
    context.beginPath();
    for (const line of lines ?? []) {
      for (let k = 0; k + 2 < line.length; k += 3) {
        const [x, y] = place(line[k], line[k + 1], line[k + 2]);
        k === 0 ? context.moveTo(x, y) : context.lineTo(x, y);
      }
    }
    context.strokeStyle = colours.getPropertyValue(name);
    context.lineWidth = width;
    context.setLineDash(dash);
    context.stroke();
  };
  if ($("show-scene").checked && state.wires) {
    stroke(state.wires.lines, "--wire", 0.7);
    context.fillStyle = colours.getPropertyValue("--wire");
    const points = state.wires.points ?? [];
    for (let k = 0; k + 2 < points.length; k += 3) context.fillRect(...place(points[k], points[k + 1], points[k + 2]), 1.3, 1.3);
  }
  const camera = state.volume?.camera ?? {};
  if ($("show-rays").checked) stroke(camera.rays, "--ray", 0.8);
  stroke(camera.far, "--far", 1, [5, 4]);
  stroke(camera.near, "--near", 1.2);
  stroke(camera.slits, "--slit", 2);
  context.fillStyle = colours.getPropertyValue("--slit");
  for (const eye of camera.eyes ?? []) {
    context.beginPath();
    context.arc(...place(...eye), 3.5, 0, 2 * Math.PI);
    context.fill();
  }
}

// A handle's circle follows its value; circles are kept, so that the one that is dragged or focused stays.
function drawHandles() {
  const place = placer();
  const svg = $("handles");
  const now = handles();
  const known = new Set(now.map((handle) => handle.id));
  for (const [id, shape] of shapes) if (!known.has(id)) { shape.remove(); shapes.delete(id); }
  for (const handle of now) {
    if (!shapes.has(handle.id)) shapes.set(handle.id, newHandle(svg, handle));
    const [x, y] = place(...handle.at);
    const shape = shapes.get(handle.id);
    shape.setAttribute("cx", x.toFixed(1));
    shape.setAttribute("cy", y.toFixed(1));
  }
}

function newHandle(svg, { id, label }) {
  const circle = handleElement(svg, id, label);
  const current = () => handles().find((handle) => handle.id === id);
  let start = null; // the handle and the pointer at the start of a drag
  circle.addEventListener("pointerdown", (event) => (start = { at: current()?.at, x: event.clientX, y: event.clientY }));
  dragged(circle, (event) => {
    const handle = current();
    if (handle && start?.at) edit(handle.move(add(start.at, worldMove(event.clientX - start.x, event.clientY - start.y))));
  }, (dx, dy) => {
    const handle = current();
    if (handle) edit(handle.move(add(handle.at, worldMove(dx, dy))));
  });
  const say = () => ($("handle-hint").textContent = `${label}: drag it, or move it by arrow keys`);
  circle.addEventListener("pointerenter", say);
  circle.addEventListener("focus", say);
  return circle;
}

// Turning, panning and zooming the drawing.
function turnVolumeBy(element) {
  const pointers = new Map();
  element.addEventListener("pointerdown", (event) => {
    if (event.target.closest?.(".handle")) return;
    event.preventDefault();
    element.focus();
    element.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
  });
  element.addEventListener("pointermove", (event) => {
    const last = pointers.get(event.pointerId);
    if (!last) return;
    const [dx, dy] = [event.clientX - last[0], event.clientY - last[1]];
    if (pointers.size === 2) {
      const other = [...pointers].find(([id]) => id !== event.pointerId)[1];
      const apart = (p) => Math.max(1, Math.hypot(p[0] - other[0], p[1] - other[1]));
      turntable.scale *= apart([event.clientX, event.clientY]) / apart(last);
    } else if (event.shiftKey || (event.buttons & 6) !== 0) turntable.middle = sub(turntable.middle, worldMove(dx, dy));
    else turn(-dx * 0.008, dy * 0.008);
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    drawVolume();
  });
  const done = (event) => pointers.delete(event.pointerId);
  element.addEventListener("pointerup", done);
  element.addEventListener("pointercancel", done);
  element.addEventListener("contextmenu", (event) => event.preventDefault());
  element.addEventListener("wheel", (event) => {
    event.preventDefault();
    turntable.scale *= Math.exp(-Math.max(-100, Math.min(100, event.deltaY)) * 0.002);
    drawVolume();
  }, { passive: false });
  element.addEventListener("keydown", (event) => {
    if (event.target !== element) return;
    const arrows = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] };
    if (arrows[event.key]) turn(...arrows[event.key]);
    else if (event.key === "+" || event.key === "=") turntable.scale *= 1.1;
    else if (event.key === "-") turntable.scale /= 1.1;
    else return;
    event.preventDefault();
    drawVolume();
  });
}

function turn(yaw, pitch) {
  turntable.yaw += yaw;
  turntable.pitch = Math.min(1.55, Math.max(-1.55, turntable.pitch + pitch));
}
