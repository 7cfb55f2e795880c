// The panels beside the picture: pixel, scene file, times, saved views; and what is said below the picture.

async function inspect(x, y) {
  [$("pixel-x").value, $("pixel-y").value] = [x, y];
  showTab("pixel");
  const answer = await pixel(x, y);
  $("pixel-text").textContent = answer.text ?? answer.why;
  const names = [["object", answer.object], ["material", answer.material], ["point", answer.point?.map((v) => Number(v.toPrecision(7))).join(", ")]];
  $("pixel-names").replaceChildren(...names.filter(([, value]) => value).map(([name, value]) => element("div", {}, `${name}: ${value}`)));
}

function showTab(name) {
  for (const tab of document.querySelectorAll("[role=tab]")) {
    const isShown = tab.getAttribute("aria-controls") === name;
    tab.setAttribute("aria-selected", isShown);
    tab.tabIndex = isShown ? 0 : -1;
    $(tab.getAttribute("aria-controls")).hidden = !isShown;
  }
}

function tabsByKeys() {
  const tabs = [...document.querySelectorAll("[role=tab]")];
  tabs.forEach((tab, k) => {
    tab.onclick = () => showTab(tab.getAttribute("aria-controls"));
    tab.onkeydown = (event) => {
      const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (!step) return;
      const next = tabs[(k + step + tabs.length) % tabs.length];
      next.click();
      next.focus();
    };
  });
}

// The scene file's text. What is typed waits for Apply; what the server sends does not overwrite it.
let isTyped = false;
function showText() {
  if (!isTyped) $("scene-text").value = state.scene.text;
  $("apply-text").disabled = $("revert-text").disabled = !isTyped;
}

function offerText(text) {
  if (isTyped) return;
  $("scene-text").value = text;
  isTyped = true;
  showText();
  showTab("text");
  tell("refused", "the server has restarted; Scene file shows the text that this page had: apply it or discard it");
}

// Bars of the stages' times, and of the rest.
function showTimes({ times, quality, width, height, seq }) {
  const latency = sentAt.get(seq);
  const rows = [["read", times.read], ["render", times.render],
    ...times.parts.map(([name, ms]) => [`- ${name.replace("_", " ")}`, ms]), ["encode", times.encode]];
  if (latency !== undefined) rows.push(["input to picture", performance.now() - latency]);
  const most = Math.max(...rows.map(([, ms]) => ms), ...times.stages.map(([, ms]) => ms), 1e-6);
  const bar = ([name, ms]) => {
    const fill = element("div");
    fill.style.width = `${(100 * ms) / most}%`;
    return element("div", { className: "stage-time" }, element("span", {}, name), element("div", { className: "track" }, fill),
      element("span", { className: "value" }, `${ms.toFixed(2)} ms`));
  };
  $("times").replaceChildren(
    element("p", { className: "about" }, `${quality === "moving" ? "moving" : "at rest"}, ${width} x ${height}`),
    ...rows.map(bar),
    element("p", { className: "about" }, times.stages.length > 0 ? "stages on the device" : "the device gives no times of its stages"),
    ...times.stages.map(bar));
}

function showLegend(legend) {
  const box = $("legend");
  box.replaceChildren();
  if (!legend) return;
  if (legend.scale === "range") {
    const scale = element("span", { className: "scale" });
    const stops = ["#440154", "#3b518b", "#21908d", "#5cc863", "#fde725"];
    const isDepth = legend.unit === "world units";
    scale.style.background = `linear-gradient(to right, ${(isDepth ? stops.reverse() : stops).join()})`;
    const text = (x) => Number(x.toPrecision(4)).toString();
    box.append(text(legend.from), scale, `${text(legend.to)} ${legend.unit}`);
  } else {
    for (const [name, colour] of legend.names) {
      const swatch = element("span", { className: "swatch" });
      swatch.style.background = `rgb(${colour.join()})`;
      box.append(element("span", {}, swatch, name));
    }
  }
}

function showStatus(header) {
  const { width, height, whole, quality, times, notes } = header;
  const size = quality === "moving" && width !== whole[0] ? `${width} x ${height} of ${whole.join(" x ")}` : `${width} x ${height}`;
  const samples = quality === "rest" ? `, ${state.look.samples} samples` : "";
  const ms = times.read + times.render + times.encode;
  $("status").textContent = [`${size}${samples}, ${ms.toFixed(0)} ms on ${state.scene?.adapter ?? "?"}`, ...notes].join(" | ");
}

// Views that are kept while the page is open.
const views = [];
function saveView() {
  const own = moved();
  if (!own) return tell("refused", "this camera has no eye and target to keep");
  const { eye, target, up } = own.pose;
  views.push({ eye: [...eye], target: [...target], up: [...up], vfov: get(own.path).vfov ?? get("camera.vfov") ?? 40 });
  showViews();
}

function showViews() {
  const items = views.map((view, k) => {
    const box = element("input", { type: "checkbox", ariaLabel: `Choose view ${k + 1}` });
    box.dataset.view = k;
    box.onchange = () => ($("join-views").disabled = chosenViews().length !== 2);
    const go = element("button", {}, "Go there");
    go.onclick = () => {
      const own = moved();
      if (!own) return;
      const hasAngle = typeof get(own.path).vfov === "number";
      edit([...posed(own.path, view), ...(hasAngle ? [[`${own.path}.vfov`, view.vfov]] : [])]);
    };
    const remove = element("button", { className: "remove", ariaLabel: `Remove view ${k + 1}` }, "remove");
    remove.onclick = () => { views.splice(k, 1); showViews(); };
    return element("li", {}, box, ` from ${view.eye.map((v) => Number(v.toPrecision(3))).join(", ")} `, go, remove);
  });
  $("view-list").replaceChildren(...items);
  $("join-views").disabled = true;
}

const chosenViews = () => [...$("view-list").querySelectorAll("input:checked")].map((box) => views[Number(box.dataset.view)]);

// bottom_up of the two chosen views; a camera of another kind is replaced.
function joinViews() {
  const [left, right] = chosenViews();
  if (!right) return;
  const pair = [left, right].map(({ eye, target, up, vfov }) => ({ eye, target, up, vfov }));
  if (state.values.camera.kind === "bottom_up") edit([["camera.views", pair]]);
  else edit([["camera", { kind: "bottom_up", views: pair }]]);
}

function takeCommand(message) {
  if (message.why) return tell("refused", message.why);
  $("command-line").hidden = false;
  $("command-text").value = message.text;
  navigator.clipboard?.writeText(message.text).then(
    () => ($("saved").textContent = "command copied"),
    () => { $("command-text").focus(); $("command-text").select(); });
}

function download(name, data, type) {
  const link = element("a", { href: URL.createObjectURL(new Blob([data], { type })), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

const fileName = (ending) => (state.scene.name.split(/[/\\]/).pop() ?? "scene").replace(/\.[^.]*$/, "") + ending;
