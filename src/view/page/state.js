// The scene as this page knows it, and the connection to the server.

const $ = (id) => document.getElementById(id);

const state = {
  scene: null, // the last message about the scene
  values: {}, // its values, with the edits of this page that the server has not answered yet
  look: { shown: "color", samples: 4, beside: null, volume: true },
  seq: 0, // counts what this page has asked for
  lookSeq: 0, // the number of its last change of look
  tags: 0, // counts its questions about pixels
  gesture: null, // the number of the drag that is going on
  gestures: 0,
  socket: null,
  wires: null, // the scene's lines and bounds
  volume: null, // the camera's
  listeners: { scene: [], volume: [], picture: [], refused: [], pixel: [] },
};

const on = (what, listener) => state.listeners[what].push(listener);
const tell = (what, ...values) => state.listeners[what].forEach((listener) => listener(...values));

// The value that a dotted path leads to.
const get = (path, root = state.values) => path.split(".").reduce((at, step) => at?.[step], root);

// Puts a value where a path leads to, in this page's copy; null removes.
function put(path, value) {
  const steps = path.split(".");
  const last = steps.pop();
  // what is missing on the way: a list where an index follows, else a table
  const after = (k) => (/^\d+$/.test(steps[k + 1] ?? last) ? [] : {});
  const at = steps.reduce((at, step, k) => (at[step] ??= after(k)), state.values);
  if (value !== null) at[last] = value;
  else if (Array.isArray(at)) at.splice(Number(last), 1);
  else delete at[last];
}

function send(message) {
  if (state.socket?.readyState !== WebSocket.OPEN) return false;
  state.socket.send(JSON.stringify(message));
  return true;
}

// Sends what changes the picture; its number comes back with the picture.
function ask(what, more = {}) {
  const seq = ++state.seq;
  sentAt.set(seq, performance.now());
  sentAt.delete(seq - 1000);
  return send({ do: what, ...more, seq });
}

// Edits of a drag wait for the next animation frame: the newest of each path is sent.
const waiting = new Map();

// Changes values: [[path, value], ...]; null removes a key.
function edit(edits) {
  const isNumber = (value) => (Array.isArray(value) ? value.every(isNumber) : typeof value !== "number" || Number.isFinite(value));
  if (!edits.every(([, value]) => isNumber(value))) return;
  edits.forEach(([path, value]) => put(path, value));
  if (state.gesture === null) {
    ask("edit", { edits: edits.map(([path, value]) => ({ path, value })), gesture: null });
  } else {
    if (waiting.size === 0) requestAnimationFrame(flush);
    edits.forEach(([path, value]) => waiting.set(path, value));
  }
  tell("scene", true);
}

function flush() {
  if (waiting.size === 0) return;
  const edits = [...waiting].map(([path, value]) => ({ path, value }));
  waiting.clear();
  ask("edit", { edits, gesture: state.gesture ?? state.gestures });
}

// A gesture's number, by which it is ended: one that begins ends the last.
function beginGesture() {
  if (state.gesture !== null) endGesture(state.gesture);
  return (state.gesture = ++state.gestures);
}

function endGesture(number) {
  if (state.gesture === null || state.gesture !== number) return;
  flush();
  state.gesture = null;
  ask("rest");
}

// Tells the server how this page shows the scene.
function look(change) {
  Object.assign(state.look, change);
  ask("look", { look: state.look });
  state.lookSeq = state.seq;
}

function connect() {
  const token = new URLSearchParams(location.search).get("token") ?? "";
  const socket = new WebSocket(`ws://${location.host}/socket?token=${encodeURIComponent(token)}`);
  socket.binaryType = "arraybuffer";
  state.socket = socket;
  socket.onopen = () => {
    $("connection").textContent = "connected";
    waiting.clear();
    state.gesture = null;
    look({});
  };
  socket.onmessage = ({ data }) => (typeof data === "string" ? take(JSON.parse(data)) : takePicture(data));
  socket.onclose = () => {
    $("connection").textContent = state.refusal ?? "connection lost; trying again";
    state.refusal = null;
    setTimeout(connect, 1000);
  };
}

function take(message) {
  switch (message.is) {
    case "scene": {
      // the first message of a connection has more
      const known = message.name ? {} : state.scene;
      const lost = message.name && state.scene && state.scene.text !== message.text ? state.scene.text : null;
      state.scene = { ...known, ...message };
      // what this page has asked for since, and drags, is newer
      if (state.gesture === null && waiting.size === 0 && message.seq >= state.seq) state.values = message.values;
      tell("scene", false);
      if (lost !== null && message.saved) offerText(lost);
      break;
    }
    case "volume": state.volume = message; tell("volume"); break;
    case "wires": state.wires = message; tell("volume"); tell("scene", true); break;
    case "pixel": tell("pixel", message); break;
    case "command": takeCommand(message); break;
    case "refused": tell("refused", message.why); break;
    case "full": state.refusal = message.why; break;
  }
}

// The size of the scene: what lengths and steps are measured by.
function extent() {
  const bounds = state.wires?.bounds;
  return bounds ? Math.max(length(sub(bounds[1], bounds[0])), 1e-9) : 10;
}

// Asks about a pixel; the answer.
function pixel(x, y) {
  const tag = ++state.tags;
  return new Promise((resolve) => {
    const listen = (answer) => {
      if (answer.tag !== tag) return;
      state.listeners.pixel.splice(state.listeners.pixel.indexOf(listen), 1);
      resolve(answer);
    };
    on("pixel", listen);
    send({ do: "pixel", x, y, tag });
  });
}
