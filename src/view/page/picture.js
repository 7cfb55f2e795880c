// The picture: what comes from the server, and moving the camera by it.

const picture = { header: null, bytes: null, beside: null, count: 0 };
const sentAt = new Map(); // when each input was sent, for what it took until its picture

// A picture: 4 bytes of the header's length, the header, the file.
async function takePicture(buffer) {
  const size = new DataView(buffer).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, size)));
  const bytes = new Uint8Array(buffer, 4 + size);
  try {
    const bitmap = await createImageBitmap(new Blob([bytes], { type: header.mime }));
    const canvas = header.beside ? $("other") : $("picture");
    if (canvas.width !== bitmap.width || canvas.height !== bitmap.height) {
      [canvas.width, canvas.height] = [bitmap.width, bitmap.height];
    }
    canvas.getContext("2d").drawImage(bitmap, 0, 0);
    bitmap.close();
  } finally {
    send({ do: "drawn", id: header.id });
  }
  if (header.beside) {
    picture.beside = header.revision === picture.header?.revision ? header : null;
    wipe();
  } else {
    Object.assign(picture, { header, bytes, count: picture.count + 1 });
    if (picture.beside && picture.beside.revision !== header.revision) picture.beside = null;
    const [width, height] = header.whole;
    $("view").style.aspectRatio = `${width} / ${height}`;
    $("view").style.maxWidth = `calc((100vh - 250px) * ${width / height})`;
    $("overlay").setAttribute("viewBox", `0 0 ${width} ${height}`);
    wipe();
  }
  tell("picture", header);
}

// Shows the second picture right of the wiper.
function wipe() {
  const shown = state.look.beside !== null && picture.beside !== null;
  $("other").hidden = !shown;
  $("wiper").hidden = state.look.beside === null;
  $("other").style.clipPath = `inset(0 0 0 ${$("wiper").value}%)`;
  $("border").hidden = !shown;
  $("border").style.left = `${$("wiper").value}%`;
}

// The place of a pointer in the picture: a and b, 0 to 1.
function placeOf(event) {
  const box = $("view").getBoundingClientRect();
  return [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
}

// The pixel at a place.
function pixelAt([a, b]) {
  const [width, height] = picture.header.whole;
  const within = (share, count) => Math.min(count - 1, Math.max(0, Math.floor(share * count)));
  return [within(a, width), within(b, height)];
}

// Tables of the scene that have an eye and a target, by their paths.
function poses() {
  const found = [];
  // keyframes of a file: there is nothing to change in the scene's text
  if (state.scene.has_poses) return found;
  const look = (at, path) => {
    if (Array.isArray(at)) at.forEach((item, k) => look(item, `${path}.${k}`));
    else if (at && typeof at === "object") {
      if (poseOf(at) || lacksTarget(at)) found.push(path);
      for (const [key, value] of Object.entries(at)) if (value && typeof value === "object" && !isVector(value)) look(value, `${path}.${key}`);
    }
  };
  look(state.values.camera, "camera");
  return found;
}

// A region of top_down may lack a target: it looks at what the root sees in its middle.
const lacksTarget = (table) => isVector(table.eye) && !table.target && (table.rect || table.polygon);

// Gives such a region its target, before it is moved.
async function aimRegion(path) {
  const region = get(path);
  if (!region || !lacksTarget(region) || !picture.header) return;
  const corners = region.polygon ?? [region.rect.slice(0, 2), region.rect.slice(2)];
  const middle = scale(corners.reduce(add), 1 / corners.length);
  const found = await pixel(...pixelAt(middle));
  if (found.point) edit([[`${path}.target`, roundedAll(found.point, extent())]]);
}

// Eye, target and up of a table; null where it has none.
function poseOf(table) {
  const up = isVector(table.up) ? table.up : get("camera.up") ?? [0, 1, 0];
  if (isVector(table.eye) && isVector(table.target)) return { eye: table.eye, target: table.target, up };
  const isOpencv = table.convention === "opencv";
  const of = (eye, x, y, z) => {
    const forward = isOpencv ? z : scale(z, -1);
    return { eye, target: add(eye, scale(forward, table.distance ?? extent() / 2)), up: isOpencv ? scale(y, -1) : y };
  };
  if (isVector(table.eye) && Array.isArray(table.quaternion)) {
    const [w, x, y, z] = scale(table.quaternion, 1 / Math.hypot(...table.quaternion));
    const turn = (v) => { const q = [x, y, z]; const c = add(cross(q, v), scale(v, w)); return add(v, scale(cross(q, c), 2)); };
    return of(table.eye, turn([1, 0, 0]), turn([0, 1, 0]), turn([0, 0, 1]));
  }
  if (Array.isArray(table.matrix) && table.matrix.length >= 3) {
    const column = (k) => table.matrix.slice(0, 3).map((row) => row[k]);
    return of(column(3), unit(column(0)), unit(column(1)), unit(column(2)));
  }
  return null;
}

// Edits that give a table another pose.
function posed(path, { eye, target, up }) {
  const table = get(path);
  // fine enough for the scene, and for views of a small part of it
  const size = Math.min(extent(), length(sub(eye, target)));
  const gone = ["quaternion", "matrix", "convention", "distance"].filter((key) => key in table);
  const edits = gone.map((key) => [`${path}.${key}`, null]);
  edits.push([`${path}.eye`, roundedAll(eye, size)]);
  edits.push([`${path}.target`, roundedAll(target, size)]);
  const before = isVector(table.up) ? table.up : [0, 1, 0];
  if (gone.length > 0 || length(sub(unit(before), unit(up))) > 1e-6) edits.push([`${path}.up`, roundedAll(up, 1)]);
  return edits;
}

// The table that is moved, and its pose.
function moved() {
  const path = $("pose").value;
  const table = path && get(path);
  const pose = table && poseOf(table);
  return pose ? { path, pose } : null;
}

// Turns the eye about the target; right and up in radians.
function orbit(right, up) {
  const own = moved();
  if (!own) return;
  const { eye, target } = own.pose;
  const axis = unit(own.pose.up);
  let arm = sub(eye, target);
  arm = turned(arm, axis, right);
  const side = unit(cross(axis, arm));
  // not over the pole
  const height = Math.asin(Math.min(1, Math.max(-1, dot(unit(arm), axis))));
  const most = (89 / 180) * Math.PI;
  const rise = Math.min(most, Math.max(-most, height + up)) - height;
  edit(posed(own.path, { eye: add(target, turned(arm, side, -rise)), target, up: own.pose.up }));
}

// Moves eye and target along the view's axes, in world units.
function shift(right, up, forward) {
  const own = moved();
  const frame = own && viewFrame(own.pose.eye, own.pose.target, own.pose.up);
  if (!frame) return;
  const by = add(add(scale(frame.right, right), scale(frame.up, up)), scale(frame.forward, forward));
  edit(posed(own.path, { eye: add(own.pose.eye, by), target: add(own.pose.target, by), up: own.pose.up }));
}

// Moves the eye towards the target: by a factor of their distance.
function dolly(factor) {
  const own = moved();
  if (!own) return;
  const { eye, target, up } = own.pose;
  // parallel rays and slits: the size of what is seen
  const height = get(own.path).height;
  if (typeof height === "number") edit([[`${own.path}.height`, rounded(height * factor, height)]]);
  else edit(posed(own.path, { eye: add(target, scale(sub(eye, target), factor)), target, up }));
}

// Turns the view about the eye.
function turnAbout(right, up) {
  const own = moved();
  const frame = own && viewFrame(own.pose.eye, own.pose.target, own.pose.up);
  if (!frame) return;
  const arm = turned(turned(sub(own.pose.target, own.pose.eye), unit(own.pose.up), -right), frame.right, up);
  if (length(cross(unit(arm), unit(own.pose.up))) < 0.02) return;
  edit(posed(own.path, { eye: own.pose.eye, target: add(own.pose.eye, arm), up: own.pose.up }));
}

// World units that a pixel of the page is at the target.
function unitsAPixel() {
  const own = moved();
  if (!own) return 0;
  const table = get(own.path);
  const height = $("view").clientHeight || 1;
  const span = typeof table.height === "number" ? table.height
    : 2 * length(sub(own.pose.target, own.pose.eye)) * Math.tan(((Math.min(table.vfov ?? get("camera.vfov") ?? 60, 150) / 2) * Math.PI) / 180);
  return span / height;
}

const RADIANS_A_PIXEL = 0.008;

// Pointers on the picture: one orbits, or pans with shift or another button; two pan and pinch.
function navigateBy(element) {
  const pointers = new Map();
  let gesture = null;
  element.addEventListener("pointerdown", (event) => {
    if (event.target.closest?.(".handle, .area") || toolTakes(event)) return;
    element.focus();
    element.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    if (pointers.size === 1) gesture = beginGesture();
    event.preventDefault();
  });
  element.addEventListener("pointermove", (event) => {
    const last = pointers.get(event.pointerId);
    if (!last) return;
    const now = [event.clientX, event.clientY];
    const [dx, dy] = [now[0] - last[0], now[1] - last[1]];
    if (pointers.size === 2) {
      const other = [...pointers].find(([id]) => id !== event.pointerId)[1];
      const apart = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]);
      if (apart(now) > 1) dolly(apart(last) / apart(now));
      shift((-dx / 2) * unitsAPixel(), (dy / 2) * unitsAPixel(), 0);
    } else if (event.shiftKey || (event.buttons & 6) !== 0) shift(-dx * unitsAPixel(), dy * unitsAPixel(), 0);
    else if (event.altKey) turnAbout(dx * RADIANS_A_PIXEL / 2, -dy * RADIANS_A_PIXEL / 2);
    else orbit(-dx * RADIANS_A_PIXEL, dy * RADIANS_A_PIXEL);
    pointers.set(event.pointerId, now);
  });
  const done = (event) => {
    if (pointers.delete(event.pointerId) && pointers.size === 0) endGesture(gesture);
  };
  element.addEventListener("pointerup", done);
  element.addEventListener("pointercancel", done);
  element.addEventListener("contextmenu", (event) => event.preventDefault());
  let wheel = null; // the gesture of turning the wheel, until it rests
  let wheelEnd = null;
  element.addEventListener("wheel", (event) => {
    event.preventDefault();
    if (state.gesture === null) wheel = beginGesture();
    clearTimeout(wheelEnd);
    wheelEnd = setTimeout(() => endGesture(wheel), 200);
    dolly(Math.exp(Math.max(-100, Math.min(100, event.deltaY)) * 0.002));
  }, { passive: false });
  moveByKeys(element);
}

// Arrow keys orbit, with shift pan; plus and minus go closer and away; W A S D Q E fly while they are held.
function moveByKeys(element) {
  const held = new Set();
  const fly = { w: [0, 0, 1], s: [0, 0, -1], a: [-1, 0, 0], d: [1, 0, 0], q: [0, -1, 0], e: [0, 1, 0] };
  let [flying, gesture] = [null, null];
  const step = (last) => (now) => {
    if (held.size === 0) { flying = null; endGesture(gesture); return; }
    const way = [...held].map((key) => fly[key]).reduce(add, [0, 0, 0]);
    const by = scale(way, (extent() / 4) * Math.min(0.1, (now - last) / 1000));
    shift(...by);
    flying = requestAnimationFrame(step(now));
  };
  element.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.target !== element) return;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    if (fly[key]) {
      held.add(key);
      if (flying === null) { gesture = beginGesture(); flying = requestAnimationFrame(step(performance.now())); }
    } else if (arrows[key]) {
      const [x, y] = arrows[key];
      if (event.shiftKey) shift(x * 20 * unitsAPixel(), y * 20 * unitsAPixel(), 0);
      else orbit(x * 0.06, y * 0.06);
    } else if (key === "+" || key === "=") dolly(0.92);
    else if (key === "-") dolly(1 / 0.92);
    else return;
    event.preventDefault();
  });
  const released = (event) => held.delete(event.key?.toLowerCase());
  element.addEventListener("keyup", released);
  element.addEventListener("blur", () => held.clear());
}
