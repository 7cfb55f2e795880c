// Tools in the picture: inspecting pixels, regions of top_down, targets of track, a grid of offsets, a path of a pushbroom.

// The tools of each kind of camera: a name, and what to do.
const TOOLS = {
  navigate: { hint: "Drag to orbit, with shift to pan, with alt to turn the head; wheel to move closer." },
  inspect: { hint: "Click on a pixel to see its ray, its hit and its near candidates." },
  region: { kinds: ["top_down", "pinhole"], hint: "Drag a rectangle. It becomes a region with a viewpoint of its own, which you then move by dragging in the picture." },
  target: { kinds: ["track", "pinhole"], hint: "Click to place a target; drag a target to move it." },
  grid: { kinds: ["camera_texture"], hint: "Drag the crossings of the grid." },
  path: { kinds: ["pushbroom"], hint: "Drag from the start of the flight to its end." },
};

function showTools() {
  const kind = state.values.camera?.kind;
  const names = Object.keys(TOOLS).filter((name) => TOOLS[name].kinds?.includes(kind) ?? true);
  const select = $("tool");
  if (select.dataset.names !== names.join()) {
    const last = select.value;
    select.replaceChildren(...names.map((name) => element("option", { value: name }, name)));
    select.dataset.names = names.join();
    select.value = names.includes(last) ? last : "navigate";
  }
  const paths = poses();
  if ($("pose").dataset.paths !== paths.join()) {
    const last = $("pose").value;
    $("pose").replaceChildren(...paths.map((path) => element("option", { value: path }, path === "camera" ? "camera" : path.replace(/^camera\./, ""))));
    $("pose").dataset.paths = paths.join();
    if (paths.includes(last)) $("pose").value = last;
    $("pose").disabled = paths.length === 0;
  }
  const isGridInFile = kind === "camera_texture" && typeof state.values.camera.file === "string" && select.value === "grid";
  const isFixed = select.value === "navigate" && paths.length === 0;
  const fixed = state.scene.has_poses
    ? "The poses of this camera are in a file: they cannot be changed here."
    : "This camera has no eye and target: use the handles of its volume, and the controls.";
  const hint = isFixed ? fixed : TOOLS[select.value]?.hint ?? "";
  const said = isGridInFile ? "The grid is in a file. " : hint;
  if ($("hint").dataset.said !== said) $("hint").replaceChildren(said);
  if (isGridInFile && $("hint").dataset.said !== said) {
    const button = element("button", {}, "Write it into the scene");
    button.onclick = () => ask("offsets");
    $("hint").append(button);
  }
  $("hint").dataset.said = said;
  drawOverlay();
}

// Whether the chosen tool takes this press, instead of moving the camera.
function toolTakes(event) {
  if (event.button !== 0 || !picture.header) return false;
  const tool = $("tool").value;
  const place = placeOf(event);
  if (tool === "inspect") { inspect(...pixelAt(place)); return true; }
  if (tool === "target") { addTarget(place); return true; }
  if (tool === "region") { rubber(event, "rect", (a, b) => addRegion(a, b)); return true; }
  if (tool === "path") { rubber(event, "line", (a, b) => flyOver(a, b)); return true; }
  return false;
}

// Draws a rectangle or a line while the pointer is held; then calls `done` with both places.
function rubber(press, shape, done) {
  const [view, svg, from] = [$("view"), $("overlay"), placeOf(press)];
  const [width, height] = picture.header.whole;
  const drawn = document.createElementNS("http://www.w3.org/2000/svg", shape);
  drawn.setAttribute("class", "rubber");
  drawn.setAttribute("vector-effect", "non-scaling-stroke");
  svg.append(drawn);
  view.setPointerCapture(press.pointerId);
  const show = (event) => {
    const to = placeOf(event);
    const set = (attributes) => Object.entries(attributes).forEach(([key, value]) => drawn.setAttribute(key, value));
    if (shape === "rect") {
      set({ x: Math.min(from[0], to[0]) * width, y: Math.min(from[1], to[1]) * height,
        width: Math.abs(from[0] - to[0]) * width, height: Math.abs(from[1] - to[1]) * height });
    } else set({ x1: from[0] * width, y1: from[1] * height, x2: to[0] * width, y2: to[1] * height });
  };
  view.addEventListener("pointermove", show);
  const end = (event) => {
    view.removeEventListener("pointermove", show);
    drawn.remove();
    if (event.type === "pointerup") done(from, placeOf(event));
  };
  view.addEventListener("pointerup", end, { once: true });
  view.addEventListener("pointercancel", end, { once: true });
}

// Edits that make a pinhole camera one of another kind that has its keys.
function ofKind(kind) {
  const camera = state.values.camera;
  if (camera.kind === kind) return [];
  return [["camera.kind", kind], ...("t_range" in camera ? [["camera.t_range", null]] : [])];
}

// A region of top_down, seen for now from where the root is; its middle looks at what is there.
async function addRegion(a, b) {
  const within = (x) => rounded(Math.min(1, Math.max(0, x)), 1);
  const rect = [Math.min(a[0], b[0]), Math.min(a[1], b[1]), Math.max(a[0], b[0]), Math.max(a[1], b[1])].map(within);
  if (rect[2] - rect[0] < 0.01 || rect[3] - rect[1] < 0.01) return;
  const middle = await pixel(...pixelAt([(rect[0] + rect[2]) / 2, (rect[1] + rect[3]) / 2]));
  const camera = state.values.camera;
  const [eye, target] = [camera.eye, middle.point ? roundedAll(middle.point, extent()) : camera.target];
  if (!isVector(eye) || !isVector(target)) return tell("refused", "regions need a camera with an eye and a target");
  const count = listOf(camera.regions).length;
  edit([...ofKind("top_down"), [`camera.regions.${count}`, { rect, eye: [...eye], target: [...target] }]]);
  showTools();
  $("pose").value = `camera.regions.${count}`;
  $("tool").value = "navigate";
  showTools();
}

// A target of track at what the picture shows there.
async function addTarget(place) {
  const found = await pixel(...pixelAt(place));
  if (!found.point) return tell("refused", "nothing is hit here; click on a surface");
  const count = listOf(state.values.camera.targets).length;
  edit([...ofKind("track"), [`camera.targets.${count}`, { at: roundedAll(found.point, extent()), radius: rounded(extent() / 40, extent()) }]]);
}

// A pushbroom whose middle line goes from one place to the other.
async function flyOver(a, b) {
  const [from, to] = await Promise.all([pixel(...pixelAt(a)), pixel(...pixelAt(b))]);
  if (!from.point || !to.point) return tell("refused", "the path must begin and end on a surface");
  const camera = state.values.camera;
  const [look, start] = [unit(camera.look), camera.start];
  // as high as now, measured along the look
  const over = (point) => roundedAll(sub(point, scale(look, dot(sub(point, start), look))), extent());
  const gone = ["direction", "extent", "velocity", "time"].filter((key) => key in camera).map((key) => [`camera.${key}`, null]);
  edit([...gone, ["camera.start", over(from.point)], ["camera.end", over(to.point)]]);
}

// Handles in the picture.
const marks = new Map();
function drawOverlay() {
  if (!picture.header || !state.scene) return;
  const now = overlayShapes();
  const known = new Set(now.map((shape) => shape.id));
  for (const [id, shape] of marks) if (!known.has(id)) { shape.remove(); marks.delete(id); }
  for (const shape of now) {
    if (!marks.has(shape.id)) marks.set(shape.id, shape.make($("overlay")));
    const own = marks.get(shape.id);
    for (const [key, value] of Object.entries(shape.at)) own.setAttribute(key, value);
  }
}

function overlayShapes() {
  const camera = state.values.camera ?? {};
  const [width, height] = picture.header.whole;
  const radius = (7 * width) / Math.max(1, $("view").clientWidth);
  const shapes = [];
  const point = (id, label, [a, b], moved, nudged) => shapes.push({
    id, at: { cx: a * width, cy: b * height, r: radius },
    make: (svg) => {
      const circle = handleElement(svg, id, label);
      circle.setAttribute("vector-effect", "non-scaling-stroke");
      dragged(circle, (event) => moved(placeOf(event)), nudged);
      return circle;
    },
  });
  if (camera.kind === "top_down" && $("tool").value === "region") {
    listOf(camera.regions).forEach((region, k) => {
      if (!Array.isArray(region.rect)) return;
      const [path, rect] = [`camera.regions.${k}.rect`, region.rect];
      shapes.push({ id: path, at: { x: rect[0] * width, y: rect[1] * height, width: (rect[2] - rect[0]) * width, height: (rect[3] - rect[1]) * height },
        make: (svg) => area(svg, path, `region ${k + 1}`) });
      [[0, 1], [2, 1], [0, 3], [2, 3]].forEach(([i, j]) => {
        const moveTo = ([a, b]) => {
          const now = [...get(path)];
          [now[i], now[j]] = [a, b].map((x) => rounded(Math.min(1, Math.max(0, x)), 1));
          if (now[0] < now[2] && now[1] < now[3]) edit([[path, now]]);
        };
        point(`${path}.${i}${j}`, `corner of region ${k + 1}`, [rect[i], rect[j]], moveTo,
          (dx, dy) => moveTo([get(path)[i] + dx / width, get(path)[j] + dy / height]));
      });
    });
  }
  if (camera.kind === "track" && $("tool").value === "target") {
    listOf(camera.targets).forEach((target, k) => {
      const place = viewPlace(target.at);
      const path = `camera.targets.${k}.at`;
      if (place) point(path, `target ${k + 1}`, place, (to) => moveTarget(path, to), (dx, dy) => {
        const now = viewPlace(get(path));
        moveTarget(path, [now[0] + dx / width, now[1] + dy / height]);
      });
    });
  }
  if (camera.kind === "camera_texture" && $("tool").value === "grid" && Array.isArray(camera.offsets)) shapes.push(...gridShapes(camera, width, height, point));
  return shapes;
}

// The outline of a region: it is dragged as a whole.
function area(svg, path, label) {
  const rect = document.createElementNS("http://www.w3.org/2000/svg", "rect");
  rect.setAttribute("class", "area");
  rect.setAttribute("tabindex", "0");
  rect.setAttribute("role", "button");
  rect.setAttribute("aria-label", label);
  rect.setAttribute("vector-effect", "non-scaling-stroke");
  let start = null;
  const by = (from, dx, dy) => {
    const fit = (d, lo, hi) => Math.min(1 - hi, Math.max(-lo, d));
    const [x, y] = [fit(dx, from[0], from[2]), fit(dy, from[1], from[3])];
    edit([[path, [from[0] + x, from[1] + y, from[2] + x, from[3] + y].map((v) => rounded(v, 1))]]);
  };
  rect.addEventListener("pointerdown", (event) => (start = { rect: [...get(path)], place: placeOf(event) }));
  dragged(rect, (event) => {
    const place = placeOf(event);
    by(start.rect, place[0] - start.place[0], place[1] - start.place[1]);
  }, (dx, dy) => by(get(path), dx / picture.header.whole[0], dy / picture.header.whole[1]));
  svg.prepend(rect);
  return rect;
}

// Where the camera's plain view shows a point, and the point of that view at a place, as far away as another one.
function plainView() {
  const camera = state.values.camera;
  const pose = poseOf(camera);
  const frame = pose && viewFrame(pose.eye, pose.target, pose.up);
  if (!frame) return null;
  const [width, height] = picture.header.whole;
  const tan = Math.tan(((camera.vfov ?? 40) * Math.PI) / 360);
  return { pose, frame, tall: tan, wide: (tan * width) / height };
}

function viewPlace(at) {
  const view = plainView();
  if (!view || !isVector(at)) return null;
  const v = sub(at, view.pose.eye);
  const depth = dot(v, view.frame.forward);
  if (depth <= 0) return null;
  return [0.5 + dot(v, view.frame.right) / depth / view.wide / 2, 0.5 - dot(v, view.frame.up) / depth / view.tall / 2];
}

function moveTarget(path, [a, b]) {
  const view = plainView();
  const depth = dot(sub(get(path), view.pose.eye), view.frame.forward);
  const across = scale(view.frame.right, (2 * a - 1) * view.wide * depth);
  const upwards = scale(view.frame.up, (1 - 2 * b) * view.tall * depth);
  const at = add(add(view.pose.eye, scale(view.frame.forward, depth)), add(across, upwards));
  edit([[path, roundedAll(at, extent())]]);
}

// The displaced crossings of a camera texture's grid, and the lines between them.
function gridShapes(camera, width, height, point) {
  const offsets = camera.offsets;
  const [rows, columns] = [offsets.length, offsets[0]?.length ?? 0];
  if (rows < 2 || columns < 2 || rows * columns > 1100 || !offsets.every((row) => row?.length === columns)) return [];
  // as they are when they are asked for: handles outlive changes of the scene
  const factor = () => state.values.camera.scale ?? 1;
  const rest = (i, j) => [j / (get("camera.offsets.0").length - 1), i / (get("camera.offsets").length - 1)];
  const at = (i, j) => add(rest(i, j), scale(get(`camera.offsets.${i}.${j}`), factor()));
  offsets.forEach((row, i) => row.forEach((_, j) => {
    const path = `camera.offsets.${i}.${j}`;
    const moveTo = (place) => factor() !== 0 && edit([[path, roundedAll(scale(sub(place, rest(i, j)), 1 / factor()), 1)]]);
    point(path, `offset of row ${i + 1}, column ${j + 1}`, at(i, j), moveTo,
      (dx, dy) => moveTo(add(at(i, j), [dx / picture.header.whole[0], dy / picture.header.whole[1]])));
  }));
  const line = (places) => places.map(([a, b], k) => `${k === 0 ? "M" : "L"}${(a * width).toFixed(1)} ${(b * height).toFixed(1)}`).join("");
  const across = offsets.map((row, i) => line(row.map((_, j) => at(i, j))));
  const down = offsets[0].map((_, j) => line(offsets.map((_, i) => at(i, j))));
  return [{ id: "grid", at: { d: [...across, ...down].join("") }, make: (svg) => {
    const path = document.createElementNS("http://www.w3.org/2000/svg", "path");
    path.setAttribute("class", "mesh-line");
    path.setAttribute("vector-effect", "non-scaling-stroke");
    svg.prepend(path);
    return path;
  } }];
}
