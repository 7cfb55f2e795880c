// Handles: the points of the scene file's camera that can be dragged, in the world.

// Keys whose vectors are places in the world.
const POSITIONS = /^(eye|target|at|origin|center|start|end|point|position|near|far|points|corners|control)$/;
const isPosition = (name) => POSITIONS.test(name);
const HANDLES_MAX = 200;

// All handles of the camera: { id, label, at, move(place) -> edits }.
function handles() {
  const camera = state.values.camera ?? {};
  const found = [];
  const pose = poseOf(camera);
  const size = pose ? Math.min(extent(), length(sub(pose.eye, pose.target))) : extent();
  const round = (place) => roundedAll(place, size);
  const walk = (value, path, name, inPlace) => {
    if (found.length >= HANDLES_MAX || value === null || typeof value !== "object") return;
    if (isVector(value)) {
      if (inPlace) found.push({ id: path, label: path.replace(/^camera\./, ""), at: value, move: (place) => [[path, round(place)]] });
      return;
    }
    const below = (key) => inPlace && Array.isArray(value) ? inPlace : isPosition(key);
    for (const [key, item] of Object.entries(value)) {
      walk(item, `${path}.${key}`, key, Array.isArray(value) ? inPlace || isPosition(name) : below(key));
    }
  };
  walk(camera, "camera", "camera", false);
  found.push(...tips(camera, round), ...special(camera, round));
  return found;
}

// The tips of vectors that start at a place of the same table: sides of a plane, an axis, a slit's direction.
function tips(camera, round) {
  const found = [];
  const walk = (table, path) => {
    if (table === null || typeof table !== "object") return;
    const base = table.origin ?? table.center ?? table.point ?? table.start;
    if (isVector(base)) {
      for (const key of ["u", "v", "axis", "normal", "direction", "velocity"]) {
        if (!isVector(table[key]) || (key === "direction" && table.extent !== undefined && !table.start)) continue;
        const vector = table[key];
        // sides of a plane and paths as long as they are; what is only a direction, long enough to be taken hold of
        const along = key === "velocity" ? table.time ?? 1 : key === "direction" && table.extent !== undefined ? table.extent / Math.max(length(vector), 1e-9) : 1;
        const isFree = ["axis", "normal"].includes(key) || (key === "direction" && table.extent === undefined);
        const stretch = isFree ? extent() / 8 / Math.max(length(vector), 1e-9) : along;
        const at = add(base, scale(vector, stretch));
        const move = (place) => {
          const now = sub(place, base);
          if (key === "direction" && table.extent !== undefined) return [[`${path}.direction`, round(now)], [`${path}.extent`, rounded(length(now), extent())]];
          const size = isFree ? length(vector) / Math.max(length(now), 1e-9) : 1 / stretch;
          return [[`${path}.${key}`, isFree ? roundedAll(scale(now, size), length(vector)) : round(scale(now, size))]];
        };
        found.push({ id: `${path}.${key}`, label: `${path.replace(/^camera\.?/, "")} ${key}`.trim(), at, move });
      }
    }
    if (!isVector(table)) for (const [key, item] of Object.entries(table)) walk(item, `${path}.${key}`);
  };
  walk(camera, "camera");
  return found;
}

// Handles of numbers: a hinge's angle, slits by distance and angle, a cylinder's and a sphere's radius.
function special(camera, round) {
  const found = [];
  const up = isVector(camera.up) ? camera.up : [0, 1, 0];
  const frame = isVector(camera.eye) && isVector(camera.target) ? viewFrame(camera.eye, camera.target, up) : null;
  if (camera.kind === "hinge" && frame && typeof camera.angle === "number" && typeof camera.path === "number") {
    // the end of the slit of eyes on the side that turns
    const c = 2 * (camera.column ?? 0.5) - 1;
    const side = camera.side === "left" ? -1 : 1;
    const [pivot, arm] = [add(camera.eye, scale(frame.right, (camera.path / 2) * c)), (camera.path / 2) * (1 - side * c)];
    const radians = (camera.angle * Math.PI) / 180;
    const outwards = scale(frame.right, side);
    const at = add(pivot, add(scale(outwards, arm * Math.cos(radians)), scale(frame.forward, arm * Math.sin(radians))));
    const move = (place) => {
      const v = sub(place, pivot);
      const degrees = (Math.atan2(dot(v, frame.forward), dot(v, outwards)) * 180) / Math.PI;
      return [["camera.angle", rounded(Math.min(89, Math.max(-89, degrees)), 100)]];
    };
    if (arm > 0) found.push({ id: "camera.angle", label: "angle", at, move });
  }
  if (camera.kind === "cross_slit" && frame && Array.isArray(camera.slits)) {
    const half = (camera.height ?? extent()) / 2;
    camera.slits.forEach((slit, k) => {
      if (typeof slit.distance !== "number") return;
      const middle = sub(camera.target, scale(frame.forward, slit.distance));
      const radians = ((slit.angle ?? 0) * Math.PI) / 180;
      const along = add(scale(frame.right, Math.cos(radians)), scale(frame.up, Math.sin(radians)));
      const path = `camera.slits.${k}`;
      found.push({
        id: `${path}.distance`, label: `slit ${k + 1} distance`, at: middle,
        move: (place) => [[`${path}.distance`, rounded(-dot(sub(place, camera.target), frame.forward), extent())]],
      });
      found.push({
        id: `${path}.angle`, label: `slit ${k + 1} angle`, at: add(middle, scale(along, half)),
        move: (place) => {
          const v = sub(place, middle);
          return [[`${path}.angle`, rounded((Math.atan2(dot(v, frame.up), dot(v, frame.right)) * 180) / Math.PI, 100)]];
        },
      });
    });
  }
  listOf(camera.surfaces).forEach((surface, k) => {
    if (!isVector(surface.center) || typeof surface.radius !== "number") return;
    const path = `camera.surfaces.${k}.radius`;
    const along = surface.kind === "sphere" ? [1, 0, 0] : radial(surface.axis ?? surface.normal ?? [0, 1, 0]);
    found.push({
      id: path, label: `surface ${k + 1} radius`, at: add(surface.center, scale(along, surface.radius)),
      move: (place) => [[path, rounded(Math.max(1e-6, dot(sub(place, surface.center), along)), extent())]],
    });
  });
  return found;
}

// A unit vector across an axis.
function radial(axis) {
  const w = unit(axis);
  const z = Math.abs(w[2]) > 0.999 ? [1, 0, 0] : [0, 0, 1];
  return unit(sub(z, scale(w, dot(z, w))));
}

// A circle that can be dragged and moved by arrow keys. `drag(event)` gets pointer events, `nudge(x, y)` steps of an arrow key.
function handleElement(svg, id, label) {
  const circle = document.createElementNS("http://www.w3.org/2000/svg", "circle");
  circle.setAttribute("class", "handle");
  circle.setAttribute("r", 6);
  circle.setAttribute("tabindex", "0");
  circle.setAttribute("role", "button");
  circle.setAttribute("aria-label", label);
  circle.dataset.id = id;
  const title = document.createElementNS("http://www.w3.org/2000/svg", "title");
  title.textContent = label;
  circle.append(title);
  svg.append(circle);
  return circle;
}

// Drags of an element: `moved(event)` for each move, within one gesture.
function dragged(shape, moved, nudge) {
  shape.addEventListener("pointerdown", (event) => {
    event.preventDefault();
    event.stopPropagation();
    if (event.button !== 0) return;
    shape.focus();
    shape.setPointerCapture(event.pointerId);
    const gesture = beginGesture();
    const move = (now) => moved(now);
    // also if the shape is gone by then
    const up = () => {
      shape.removeEventListener("pointermove", move);
      for (const name of ["pointerup", "pointercancel", "blur"]) removeEventListener(name, up, true);
      endGesture(gesture);
    };
    shape.addEventListener("pointermove", move);
    for (const name of ["pointerup", "pointercancel", "blur"]) addEventListener(name, up, true);
  });
  shape.addEventListener("keydown", (event) => {
    const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const way = arrows[event.key];
    if (!way) return;
    event.preventDefault();
    event.stopPropagation();
    nudge(way[0] * (event.shiftKey ? 10 : 2), way[1] * (event.shiftKey ? 10 : 2));
  });
}
