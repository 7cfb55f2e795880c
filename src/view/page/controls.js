// Controls for the values of the camera, the picture, lights and style, made from the tables of their keys.

let shape = ""; // what the controls were made for: they are made anew when the keys or kinds change
const controls = []; // [path, show(value)]
const open = new Set(["camera"]); // paths of the groups that are unfolded

// What the controls depend on: every key, and the number of items of lists.
function shapeOf(value) {
  if (Array.isArray(value)) return `[${value.length <= 40 ? value.map(shapeOf).join() : value.length}]`;
  if (value && typeof value === "object") return `{${Object.entries(value).map(([key, item]) => `${key}:${shapeOf(item)}`).join()}}`;
  // ends of t may be "inf"
  return value === "inf" || value === "-inf" ? "number" : typeof value;
}

function showControls() {
  const shown = Object.fromEntries(["camera", ...Object.keys(state.scene.sections)].map((key) => [key, state.values[key]]));
  const now = JSON.stringify([shapeOf(shown), shown.camera?.kind, state.scene.keyframed, state.wires?.bounds]);
  // a slider that is dragged stays
  if (now !== shape && state.gesture === null) {
    shape = now;
    makeControls();
  }
  for (const [path, show] of controls) {
    const value = get(path);
    if (value !== undefined) show(value);
  }
}

function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key in made && key !== "list") made[key] = value;
    else made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

function makeControls() {
  controls.length = 0;
  const focused = document.activeElement?.dataset?.path;
  const pressed = document.activeElement?.closest?.("#controls") ? document.activeElement.getAttribute("aria-label") : null;
  const panel = $("controls");
  const groups = [group("camera", "camera", state.values.camera, state.scene.cameras[state.values.camera?.kind] ?? [])];
  for (const [section, keys] of Object.entries(state.scene.sections)) {
    const value = state.values[section];
    if (section === "light") groups.push(lights(listOf(value), keys));
    else if (section === "projector_light") groups.push(...pictures(listOf(value), keys));
    else groups.push(group(section, section.replace("_", " "), value ?? {}, keys));
  }
  panel.replaceChildren(...groups);
  const again = focused ? `[data-path="${CSS.escape(focused)}"]` : pressed ? `[aria-label="${CSS.escape(pressed)}"]` : null;
  if (again) panel.querySelector(again)?.focus();
}

function folded(path, name, content) {
  const details = element("details", { open: open.has(path) }, element("summary", {}, name), content);
  details.addEventListener("toggle", () => (details.open ? open.add(path) : open.delete(path)));
  return details;
}

function lights(list, keys) {
  const items = list.map((light, k) => {
    const own = group(`light.${k}`, `light ${k + 1}`, light, keys);
    own.append(remover(`light.${k}`, `Remove light ${k + 1}`));
    return own;
  });
  const more = element("button", { ariaLabel: "Add a light" }, "Add a light");
  more.onclick = () => edit([[`light.${list.length}`, { direction: [-1, -2, -1] }]]);
  return folded("light", "light", element("fieldset", {}, ...items, more));
}

// Of pictures that are thrown onto surfaces: they come with their files, and are added in the scene's text.
function pictures(list, keys) {
  return list.map((picture, k) => group(`projector_light.${k}`, `projector light ${k + 1}`, picture, keys));
}

function remover(path, label) {
  const button = element("button", { className: "remove", title: label, ariaLabel: label }, "remove");
  button.onclick = () => edit([[path, null]]);
  return button;
}

// The controls of a table: its keys, and a choice of those that can be added.
function group(path, name, table, keys) {
  const fields = element("fieldset");
  const order = ["kind", ...keys.map((key) => key.name)];
  const rank = (key) => (order.includes(key) ? order.indexOf(key) : order.length);
  const known = table && typeof table === "object" && !Array.isArray(table) ? table : {};
  for (const key of Object.keys(known).sort((a, b) => rank(a) - rank(b))) {
    fields.append(control(`${path}.${key}`, key, table[key], keys.find((k) => k.name === key)));
  }
  const absent = keys.filter((key) => !(key.name in known) && initial(key) !== undefined);
  if (absent.length > 0) {
    const choice = element("select", { ariaLabel: `Key to add to ${name}` });
    absent.forEach((key) => choice.append(element("option", { value: key.name, title: key.about }, key.name)));
    const button = element("button", { ariaLabel: `Add the key to ${name}` }, "Add");
    button.onclick = () => edit([[`${path}.${choice.value}`, initial(keys.find((key) => key.name === choice.value))]]);
    fields.append(element("div", { className: "add" }, choice, button));
  }
  return folded(path, name, fields);
}

// A first value of a key that is added: its default, or an example by its shape.
function initial(key) {
  const read = (text) => {
    if (text === undefined) return undefined;
    const json = text.replace(/([{,]\s*)([a-z_]+)\s*=/g, '$1"$2":').replace(/\binf\b/g, '"inf"');
    try { return JSON.parse(json); } catch { return undefined; }
  };
  const known = read(key.default) ?? read(key.shape);
  if (known !== undefined && known !== null) return known;
  if (key.shape === "length") return rounded(extent() / 4, extent());
  if (key.shape === "degrees") return 40;
  if (key.shape === "N") return 2;
  if (key.shape === "number" || key.shape === "px") return 1;
  if (key.shape === "[r, g, b]") return [1, 1, 1];
  if (key.shape === "[x, y, z]") return [0, 1, 0];
  const range = /^(-?[\d.]+)\.\.(-?[\d.]*)$/.exec(key.shape);
  return range ? Number(range[1]) : undefined;
}

// One value: a number, numbers, a choice, a text, a switch, or a table or a list of such.
function control(path, name, value, key) {
  const label = element("span", { className: "label", title: key?.about ?? "" }, name);
  if (state.scene.keyframed.includes(path)) label.classList.add("keyed");
  const row = (...content) => element("div", { className: "control" }, label, element("div", {}, ...content));
  if (path === "camera.kind") return row(choice(path, name, Object.keys(state.scene.cameras)));
  if (typeof value === "boolean") {
    const box = element("input", { type: "checkbox", ariaLabel: name });
    box.dataset.path = path;
    box.onchange = () => edit([[path, box.checked]]);
    controls.push([path, (now) => (box.checked = now === true)]);
    return row(box);
  }
  if (typeof value === "number") return row(number(path, name, rangeOf(path, name, key, value)));
  if (typeof value === "string" && value !== "inf" && value !== "-inf") {
    if (key?.choices?.length > 1) return row(choice(path, name, key.choices));
    const text = element("input", { type: "text", ariaLabel: name });
    text.dataset.path = path;
    text.onchange = () => edit([[path, text.value]]);
    controls.push([path, (now) => document.activeElement !== text && (text.value = now)]);
    return row(text);
  }
  if (typeof value === "string") return row(number(path, name, rangeOf(path, name, key, 0)));
  if (Array.isArray(value) && value.length <= 4 && value.every((x) => typeof x === "number" || x === "inf" || x === "-inf")) {
    const axes = ["x", "y", "z", "w"];
    return row(...value.map((x, k) => number(`${path}.${k}`, `${name} ${value.length === 3 ? axes[k] : k + 1}`, rangeOf(path, name, key, x, k))));
  }
  return nested(path, name, value);
}

// Tables and lists.
function nested(path, name, value) {
  const ITEMS_MAX = 40;
  const entries = Object.entries(value ?? {});
  const fields = element("fieldset");
  const fill = () => {
    if (fields.childElementCount > 0) return;
    for (const [key, item] of entries.slice(0, ITEMS_MAX)) {
      const title = Array.isArray(value) ? `${name} ${Number(key) + 1}` : key;
      const own = control(`${path}.${key}`, title, item);
      if (Array.isArray(value) && item && typeof item === "object" && !Array.isArray(item)) {
        own.append(remover(`${path}.${key}`, `Remove ${title}`));
      }
      fields.append(own);
    }
    if (entries.length > ITEMS_MAX) fields.append(`${entries.length - ITEMS_MAX} more: see the scene file`);
  };
  const details = folded(path, entries.length > 3 || Array.isArray(value) ? `${name} (${entries.length})` : name, fields);
  if (details.open) fill();
  details.addEventListener("toggle", () => details.open && (fill(), controls.forEach(([p, show]) => get(p) !== undefined && show(get(p)))));
  return details;
}

function choice(path, name, choices) {
  const select = element("select", { ariaLabel: name }, ...choices.map((word) => element("option", { value: word }, word)));
  select.dataset.path = path;
  select.onchange = () => edit([[path, select.value]]);
  controls.push([path, (now) => {
    if (![...select.options].some((option) => option.value === now)) select.append(element("option", { value: now }, now));
    select.value = now;
  }]);
  return select;
}

// A slider and a field.
function number(path, label, [least, most, step]) {
  const slider = element("input", { type: "range", min: least, max: most, step, ariaLabel: label });
  const field = element("input", { type: "number", step: "any", ariaLabel: `${label}, exact` });
  field.dataset.path = `${path} exact`;
  slider.dataset.path = path;
  let gesture = null;
  slider.onpointerdown = (event) => { if (event.button === 0) gesture = beginGesture(); };
  slider.onpointerup = slider.onpointercancel = slider.onblur = slider.onlostpointercapture = () => endGesture(gesture);
  slider.oninput = () => {
    const value = Number(slider.value);
    field.value = value;
    edit([[path, value]]);
  };
  field.onchange = () => field.value !== "" && edit([[path, Number(field.value)]]);
  controls.push([path, (now) => {
    const value = now === "inf" ? Infinity : now === "-inf" ? -Infinity : now;
    if (document.activeElement !== field) field.value = Number.isFinite(value) ? value : "";
    field.placeholder = Number.isFinite(value) ? "" : String(now);
    if (Number.isFinite(value)) {
      if (value < Number(slider.min)) slider.min = value;
      if (value > Number(slider.max)) slider.max = value;
      slider.value = value;
    } else slider.value = value > 0 ? slider.max : slider.min;
  }]);
  return element("div", { className: "number" }, slider, field);
}

// The least and the greatest value of a slider, and its step, by what a key says of its values.
function rangeOf(path, name, key, value, axis = 0) {
  const size = extent();
  const fine = (least, most) => [least, most, 10 ** Math.floor(Math.log10(Math.max((most - least) / 200, 1e-6)))];
  const said = /(-?[\d.]+)\.\.(-?[\d.]+)/.exec(key?.shape ?? "");
  if (said) return fine(Number(said[1]), Number(said[2]));
  if (/^(width|height)$/.test(name) && path.startsWith("image.")) return [16, 2048, 1];
  if (name === "t_range") return fine(axis === 0 ? -size : 0, 4 * size);
  if (/color|background|albedo|ink|paper/.test(name) || key?.shape === "[r, g, b]") return [0, 1, 0.01];
  if (/^(rect|image|center_px|radius_ab)$/.test(name)) return [0, 1, 0.005];
  if (/fov$/.test(name)) {
    const most = /up to (\d+)/.exec(key?.about ?? "");
    return [1, most ? Number(most[1]) : 179, 0.5];
  }
  if (key?.shape === "degrees" || /angle|rotate|lon|lat|from|to$|sweep|twist/.test(name)) return [-180, 180, 0.5];
  if (key?.shape === "N") return [1, 32, 1];
  if (key?.shape === "px") return [0.05, 8, 0.05];
  if (/^(up|normal|axis|direction|look|u|v)$/.test(name)) return fine(-Math.max(2, 2 * Math.abs(value)), Math.max(2, 2 * Math.abs(value)));
  if (isPosition(name) || key?.shape === "[x, y, z]") {
    const bounds = state.wires?.bounds ?? [[-5, -5, -5], [5, 5, 5]];
    const middle = (bounds[0][axis % 3] + bounds[1][axis % 3]) / 2;
    return fine(Math.min(middle - 1.5 * size, value), Math.max(middle + 1.5 * size, value));
  }
  if (key?.shape === "length" || /height|width|radius|distance|near|far|depth|path/.test(name)) return fine(0, Math.max(2 * size, 2 * value));
  const reach = Math.max(1, 2 * Math.abs(value));
  return fine(value < 0 ? -reach : 0, reach);
}
