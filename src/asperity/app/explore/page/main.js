"use strict";
// The page: what is shown, what the user does, and the connection to the server, where there is one.

const app = {
  scene: null, earlier: null, runs: [], map: 0, following: false, playing: 0, change: null,
  socket: null, live: false, connected: false, wanted: null, busy: false, form: null, found: [], changed: null,
};
app.mapView = new MapView(byId("map"));
app.curveView = new CurveView(byId("curve"));

const narrow = matchMedia("(max-width: 46rem)");

// ---- what comes --------------------------------------------------------------------------------------------------------

const ARRIVALS = {
  hello(header) {
    document.body.dataset.live = "yes";
    if (!app.form) {
      app.form = new Form(byId("sections"), header.form, header.questions);
      showFolder(header.folder);
      begin(header.folder);
    } else if (app.wanted && (app.busy || !app.scene)) ask(app.wanted);
  },
  stage({ text }) { busy(true, text); },
  mistakes({ mistakes }) { fail(mistakes); },
  failed({ mistakes }) { fail(mistakes); },
  scene(header, message, buffer) {
    const before = app.scene;
    app.scene = new Scene(buffer, message);
    app.earlier = before && app.keep && app.scene.isOn(before) && same(before.column_units, header.column_units) ? before : null;
    if (header.shear_strength) app.shear = null; // what was tried ends with a strength of the run
    app.scene.shear = app.shear ?? header.shear_strength;
    byId("shear").value = app.scene.shear ? typed(app.scene.shear) : "";
    if (!app.picked) app.curveView.name = "";
    Object.assign(app, { map: 0, following: true, change: null });
    byId("site").textContent = "Point at a site to read its height, pressure and age.";
    app.mapView.cursor = null;
    for (const button of document.querySelectorAll('[data-copy="toml"], [data-copy="python"]')) button.hidden = !header[button.dataset.copy];
    byId("text").closest("details").hidden = !header.toml;
    stopPlaying();
    address(app.wanted);
    if (app.form && header.config) {
      if (app.wanted?.kind === "open") app.form.write(header.config);
      app.form.chosen = header.config;
      app.form.showChosen();
    }
    if (app.form && !header.config) byId("setup").open = false; // it says nothing of what is shown
    document.title = `${header.title} · Asperity`;
    byId("title").textContent = header.title;
    document.body.dataset.scene = "yes";
    byId("answer").hidden = true;
    byId("failure").textContent = "";
    showText();
  },
  answer(header) { showAnswer(header); },
  rows(header, message, buffer) {
    if (!app.scene || header.job !== app.scene.job) return;
    app.scene.add(buffer, message);
    if (app.following && app.scene.maps.length) app.map = newest();
    show();
  },
  done(header, message, buffer) {
    if (app.scene && header.job === app.scene.job) app.scene.add(buffer, message);
    if (!app.scene.maps.length) app.scene.doWithoutMaps();
    if (app.following) app.map = newest();
    app.following = false;
    busy(false);
    if (app.form && app.wanted?.changed) app.form.write(app.wanted.config); // a change that has run
    suggestBranch();
    show();
  },
  campaign(header, message, buffer) { showCampaign(header, message.arrays, buffer); },
};

function receive(buffer) {
  const message = readMessage(buffer), { kind, sequence } = message.header;
  send({ kind: "ack", sequence });
  ARRIVALS[kind]?.(message.header, message, buffer);
}

/** The map to show while the user has chosen none: the newest, or after a change of load that at its end. */
function newest() {
  const { maps } = app.scene, after = maps.findLastIndex((map) => map.leg === app.changed);
  return after < 0 ? maps.length - 1 : after;
}

function connect(wait = 500) {
  const socket = new WebSocket(`ws://${location.host}/socket`);
  socket.binaryType = "arraybuffer";
  app.socket = socket;
  socket.onopen = () => { app.connected = true; wait = 500; said("", false); };
  socket.onmessage = ({ data }) => receive(data);
  socket.onclose = () => {
    app.connected = false;
    said("The connection to the server is lost; trying again …", true);
    setTimeout(() => connect(Math.min(5000, 1.6 * wait)), wait);
  };
}

function said(text, lost) {
  byId("connection").textContent = text;
  byId("connection").classList.toggle("lost", lost);
}

// ---- what is asked for -------------------------------------------------------------------------------------------------

const encoded = (value) => btoa(String.fromCharCode(...new TextEncoder().encode(JSON.stringify(value)))).replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "");
const decoded = (text) => JSON.parse(new TextDecoder().decode(Uint8Array.from(atob(text.replaceAll("-", "+").replaceAll("_", "/")), (letter) => letter.charCodeAt(0))));

function send(message) {
  if (app.socket?.readyState === WebSocket.OPEN) app.socket.send(JSON.stringify(message));
}

/** Put what is asked for into the address, so that a reload asks again. */
function address(request) {
  if (!request) return;
  const hash = request.kind === "run" ? `#config=${encoded(request.config)}` : `#open=${encodeURIComponent(request.path.toWellFormed?.() ?? request.path)}`;
  if (location.hash !== hash) history.replaceState(null, "", hash);
}

/** Ask for a run or a folder; `changed` is the leg of a change, which the form takes up when it has run. */
function ask(request) {
  app.before = request.changed ? app.wanted : null;
  app.wanted = request;
  app.changed = request.changed ?? null;
  if (!request.changed) address(request);
  app.form.mistakes([]);
  app.found = [];
  byId("branch-mistake").textContent = byId("failure").textContent = "";
  busy(true, "waiting for the server");
  if (narrow.matches && byId("setup").open) { // the results come first, not the form
    byId("setup").open = false;
    byId("results").focus({ preventScroll: true });
    byId("results").scrollIntoView();
  }
  send(request);
}

/** Begin with what the address says, or with what the folder holds, or with the usual run. */
function begin(folder) {
  const [, kind, text] = location.hash.match(/^#(config|open)=(.*)$/) || [];
  try {
    if (kind === "open") return ask({ kind: "open", path: decodeURIComponent(text) });
    if (kind === "config") {
      const config = decoded(text);
      app.form.write(config);
      return ask({ kind: "run", config });
    }
  } catch {
    byId("failure").textContent = "The link is damaged: expected a configuration behind #config=, got something else. Try to copy it again.";
    return undefined;
  }
  if (!folder) return ask({ kind: "run", config: {} });
  return folder.length ? byId("entries").querySelector("button").click() : undefined;
}

function busy(now, text = "") {
  app.busy = now;
  if (!now && document.activeElement === byId("stop")) byId("press").focus();
  document.querySelector("#branch button").setAttribute("aria-disabled", now);
  byId("progress").firstElementChild.hidden = byId("stop").hidden = !now;
  if (!now) { byId("stage").textContent = ""; return; }
  if (text) byId("stage").textContent = text;
  const bar = byId("progress").firstElementChild, { scene } = app;
  if (!scene?.rows.length || scene.finished) bar.removeAttribute("value");
  else bar.value = app.scene.config?.protocol?.length ? scene.timeNow / scene.lastTime : app.curveView.axis?.place(scene.timeNow) ?? 0;
}

function fail(mistakes) {
  busy(false);
  if (app.before && !(app.scene && same(app.scene.config?.protocol, app.wanted.config.protocol))) app.wanted = app.before;
  app.found = mistakes;
  const ofBranch = (one) => one.where.startsWith("protocol");
  if (app.form) app.form.mistakes(mistakes.filter((one) => !ofBranch(one)));
  tellBranch(mistakes.filter(ofBranch).map(({ text }) => text));
}

async function upload(file, field = "surface.path") {
  busy(true, `reading ${file.name}`);
  try {
    const answer = await fetch(`files/${encodeURIComponent(file.name)}`, { method: "POST", body: file });
    const told = await answer.json().catch(() => ({}));
    if (!answer.ok) { fail(told.mistakes || [{ where: field, text: told.text || `the server refused the file: ${answer.status}` }]); return; }
    const config = app.form.read(), [section, key] = field.split(".");
    if (section === "surface") {
      config.surface = { ...(config.surface?.kind === "file" ? config.surface : {}), kind: "file", path: told.path };
      if (config.contact?.load !== undefined) delete config.contact; // a pressure means the same on any area
      if (/"(load|separation|approach|distance)":[^n]/.test(JSON.stringify(config.protocol ?? []))) config.protocol = []; // and so do its legs
    } else config[section] = { ...config[section], [key]: told.path };
    if (key === "relaxation") for (const known of ["branches", "flow", "creep", "modulus", "young"]) delete config.solid[known]; // the table gives them
    forgetCampaign();
    app.form.write(config);
    ask({ kind: "run", config: app.form.read() });
  } catch {
    fail([{ where: field, text: `${file.name}: the file did not reach the server; try again` }]);
  }
}

// ---- what the user does ------------------------------------------------------------------------------------------------

function listen() {
  const on = (id, event, done) => byId(id).addEventListener(event, done);
  on("form", "submit", (event) => { event.preventDefault(); app.keep = true; ask({ kind: "run", config: app.form.read() }); });
  on("stop", "click", () => send({ kind: "stop" }));
  on("no-history", "click", () => { app.form.write({ ...app.form.read(), protocol: [] }); ask({ kind: "run", config: app.form.read() }); byId("press").focus(); });
  on("file", "change", ({ target }) => { if (target.files[0]) upload(target.files[0], app.form.wanted); target.value = ""; });
  byId("presets").append(...EXAMPLES.map(([title, text, config]) => {
    const button = element("button", { type: "button" }, title, element("small", {}, text));
    button.addEventListener("click", () => { forgetCampaign(); app.keep = false; app.form.write(config); ask({ kind: "run", config: app.form.read() }); });
    return button;
  }));
  const own = element("button", { type: "button" }, "Your own scan …", element("small", {}, "or drop a file here"));
  own.addEventListener("click", () => { app.form.wanted = "surface.path"; byId("file").click(); });
  byId("presets").append(own);

  on("moment", "input", ({ target }) => { stopPlaying(); choose(app.curveView.nearest(target.value / 1000)); });
  steps("moment", () => app.map, () => app.scene.maps.length, (map) => { stopPlaying(); choose(map); });
  on("when", "input", ({ target }) => {
    const place = (row) => Math.abs(app.curveView.axis.place(app.scene.value(row, "time")) - target.value / 1000);
    app.changeRow = changeable(app.scene).reduce((best, row) => (place(row) < place(best) ? row : best));
    show();
  });
  steps("when", () => changeable(app.scene).indexOf(app.changeRow), () => changeable(app.scene).length,
    (at) => { app.changeRow = changeable(app.scene)[Math.min(changeable(app.scene).length - 1, Math.max(0, at))]; show(); });
  app.curveView.onpick = (place) => { stopPlaying(); choose(app.curveView.nearest(place)); };
  app.mapView.onread = (site, map) => { if (app.scene.isLine && map !== app.map) { stopPlaying(); choose(map); } readSite(site, map); };
  on("play", "click", () => { app.following = false; if (app.playing) stopPlaying(); else play(); });
  on("quantity", "change", ({ target }) => { app.picked = app.curveView.name = target.value; show(); });
  on("colored", "change", ({ target }) => { app.mapView.colored = target.value; show(); });
  on("earlier", "change", show);
  on("shear", "input", ({ target }) => {
    const value = valueOf(target.value, { what: "number" });
    app.shear = app.scene.shear = value > 0 ? value : null;
    if (app.earlier) app.earlier.shear = app.shear;
    const wrong = value !== null && !(value > 0);
    target.toggleAttribute("aria-invalid", wrong);
    target.setCustomValidity(wrong ? "expected a number above 0, such as 40e6" : "");
    if (wrong) target.reportValidity();
    show();
  });
  on("closer", "click", () => { app.mapView.closer(); showLegend(); });
  on("farther", "click", () => { app.mapView.magnify(1 / 1.5); showLegend(); });
  on("whole", "click", () => { app.mapView.whole(); showLegend(); });
  for (const event of ["wheel", "keyup", "pointerup"]) on("map", event, () => app.scene?.maps.length && showLegend());
  on("how", "change", ({ target }) => { byId("ramp-field").hidden = target.value !== "ramp"; });
  on("target", "change", suggestValue);
  on("branch", "submit", (event) => { event.preventDefault(); branch(); });
  on("language", "change", showText);
  for (const button of document.querySelectorAll("[data-save]")) button.addEventListener("click", () => take(button));
  for (const button of document.querySelectorAll("[data-copy]")) button.addEventListener("click", () => take(button));

  addEventListener("hashchange", () => app.form && begin(null));
  addEventListener("resize", () => app.scene && show());
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => app.scene && show());
  addEventListener("dragover", (event) => { if (app.live) { event.preventDefault(); document.body.classList.add("dropping"); } });
  addEventListener("dragleave", (event) => { if (!event.relatedTarget) document.body.classList.remove("dropping"); });
  addEventListener("drop", (event) => {
    if (!app.live) return;
    event.preventDefault();
    document.body.classList.remove("dropping");
    if (event.dataTransfer.files[0]) upload(event.dataTransfer.files[0]);
  });
  if (narrow.matches) byId("setup").open = false;
}

/** Let arrows, Home and End of a slider go from one stop to the next. */
function steps(id, now, length, go) {
  byId(id).addEventListener("keydown", (event) => {
    const moves = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageDown: -5, PageUp: 5, Home: -Infinity, End: Infinity };
    if (!(event.key in moves) || !app.scene) return;
    event.preventDefault();
    go(Math.min(length() - 1, Math.max(0, now() + moves[event.key])));
  });
}

/** What the tests look at. */
Object.defineProperty(window, "asperity", { value: Object.freeze({
  get state() {
    const { scene, map, mapView, curveView } = app;
    return {
      live: app.live, connected: app.connected, busy: app.busy, playing: Boolean(app.playing), mistakes: app.found, runs: app.runs.length,
      job: scene?.job ?? null, shape: scene?.shape ?? null, rows: scene?.rows.length ?? 0, maps: scene?.maps.map(({ time, area, leg }) => ({ time, area, leg })) ?? [],
      finished: Boolean(scene?.finished), map, cursor: mapView.cursor, zoom: mapView.zoom, side: mapView.side ?? null, drawn: mapView.drawn ?? null,
      quantity: curveView.name, earlier: app.earlier?.job ?? null, change: app.change, config: scene?.config ?? null,
      counts: scene?.maps.length ? scene.states(map).counts : null,
    };
  },
  row(at) { return Object.fromEntries([...app.scene.columns, ...(app.scene.map_columns || [])].map((name) => [name, app.scene.value(at, name)])); },
  site(site, map = app.map) {
    const { scene } = app;
    return { height: scene.height(site), pressure: scene.pressure(map, site), state: scene.state(map, site), since: scene.maps[scene.since(map, site)].time };
  },
}) });

async function start() {
  listen();
  const recording = byId("recording");
  if (recording) {
    for (const buffer of await unpackMessages(recording.textContent.trim())) receive(buffer);
    document.querySelector('[data-save="page"]').hidden = true;
    if (app.scene) choose(app.scene.maps.length - 1);
  } else {
    app.live = true;
    connect();
  }
}

start();
