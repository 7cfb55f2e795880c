// Puts the parts together.

let refusal = null;
function showProblem() {
  const problem = refusal ?? state.scene?.problem ?? null;
  const box = $("problem");
  if (box.dataset.said === (problem ?? "")) return;
  box.dataset.said = problem ?? "";
  box.hidden = problem === null;
  box.replaceChildren(problem ?? "");
  // "x is missing; add e.g. x = 1"
  const advice = /camera: (\w+) is missing; add e\.g\. \w+ = (.*)$/.exec(problem ?? "");
  const value = advice && initial({ shape: "", default: advice[2] });
  if (value !== null && value !== undefined) {
    const button = element("button", {}, `Add ${advice[1]} = ${advice[2]}`);
    button.onclick = () => edit([[`camera.${advice[1]}`, value]]);
    box.append(" ", button);
  }
}

on("refused", (why) => { refusal = why; showProblem(); setTimeout(() => { refusal = null; showProblem(); }, 8000); });

on("scene", (isOwn) => {
  const { scene } = state;
  if (!scene) return;
  if (!isOwn) {
    $("name").textContent = scene.name;
    document.title = `${fileName("")} - anamorph`;
    $("saved").textContent = !scene.has_file ? "" : scene.saved ? "saved" : "not saved";
    $("undo").disabled = !scene.undo;
    $("redo").disabled = !scene.redo;
    $("save").disabled = scene.saved || !scene.has_file;
    $("copy-command").disabled = !scene.has_file;
    if ($("beside").options.length === 1) scene.engines.forEach((name) => $("beside").append(element("option", { value: name }, name)));
    $("timeline").hidden = !scene.frames;
    if (scene.frames) {
      [$("frame").min, $("frame").max] = scene.frames;
      if (document.activeElement !== $("frame") || playing !== null) $("frame").value = scene.frame;
      $("frame-number").textContent = Number(scene.frame.toPrecision(6));
    }
    showText();
    showProblem();
  }
  showControls();
  showTools();
  drawVolume();
});

on("volume", drawVolume);
on("picture", (header) => {
  if (header.beside) return;
  showStatus(header);
  showLegend(header.legend);
  showTimes(header);
  drawOverlay();
});

$("undo").onclick = () => ask("undo");
$("redo").onclick = () => ask("redo");
$("save").onclick = () => send({ do: "save" });
$("copy-command").onclick = () => send({ do: "command" });
$("download-scene").onclick = () => download(fileName(".toml"), state.scene.text, "application/toml");
$("download-picture").onclick = () => picture.bytes && download(fileName(picture.header.mime === "image/png" ? ".png" : ".jpg"), picture.bytes, picture.header.mime);
$("shown").onchange = () => look({ shown: $("shown").value });
$("samples").onchange = () => look({ samples: Number($("samples").value) });
$("beside").onchange = () => { picture.beside = null; look({ beside: $("beside").value || null }); wipe(); };
$("wiper").oninput = wipe;
$("tool").onchange = showTools;
$("pose").onchange = () => { aimRegion($("pose").value); drawOverlay(); };
$("fit").onclick = () => { fitVolume(); drawVolume(); };
$("show-rays").onchange = $("show-scene").onchange = drawVolume;
$("save-view").onclick = saveView;
$("join-views").onclick = joinViews;
$("pixel-form").onsubmit = (event) => { event.preventDefault(); inspect(Number($("pixel-x").value), Number($("pixel-y").value)); };
$("scene-text").oninput = () => { isTyped = true; showText(); };
function applyText() {
  if (ask("text", { text: $("scene-text").value })) isTyped = false;
  else tell("refused", "not connected: the text is kept here; apply it when the connection is back");
}
$("apply-text").onclick = applyText;
$("revert-text").onclick = () => { isTyped = false; showText(); };

let playing = null;
function showFrame(frame, isPlaying) {
  ask("frame", { frame, playing: isPlaying });
}
$("frame").oninput = () => showFrame(Number($("frame").value), true);
$("frame").onchange = () => ask("rest");
$("play").onclick = () => {
  if (playing !== null) {
    clearInterval(playing);
    playing = null;
    ask("rest");
  } else {
    const FRAMES_A_SECOND = 24;
    const begin = performance.now();
    const [first, last] = state.scene.frames;
    const from = state.scene.frame >= last ? first : Math.max(first, state.scene.frame);
    playing = setInterval(() => {
      const frame = from + Math.floor(((performance.now() - begin) / 1000) * FRAMES_A_SECOND);
      // a frame that is not drawn in time is left out
      if (frame > last) { $("play").click(); showFrame(last, false); } else if (frame !== state.scene.frame) showFrame(frame, true);
    }, 1000 / FRAMES_A_SECOND);
  }
  $("play").textContent = playing === null ? "Play" : "Stop";
};

document.addEventListener("keydown", (event) => {
  if (!(event.ctrlKey || event.metaKey)) return;
  const isText = event.target.matches?.("textarea, input[type=text], input[type=number]");
  const key = event.key.toLowerCase();
  if (key === "s") {
    if (isTyped) applyText();
    document.activeElement?.blur?.();
    send({ do: "save" });
  }
  else if (key === "z" && !isText) ask(event.shiftKey ? "redo" : "undo");
  else if (key === "y" && !isText) ask("redo");
  else return;
  event.preventDefault();
});
new ResizeObserver(drawVolume).observe($("volume"));
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", drawVolume);
tabsByKeys();
navigateBy($("view"));
turnVolumeBy($("volume"));
connect();
