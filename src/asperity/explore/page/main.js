"use strict";
// The page: what is shown, what the user does, and the connection to the server, where there is one.

const app = {
  scene: null, earlier: null, runs: [], map: 0, following: false, playing: 0, change: null,
  socket: null, live: false, connected: false, wanted: null, busy: false, form: null, found: [], replay: false,
};
app.mapView = new MapView(byId("map"));
app.curveView = new CurveView(byId("curve"));

const calm = matchMedia("(prefers-reduced-motion: reduce)");

// ---- what comes --------------------------------------------------------------------------------------------------

const ARRIVALS = {
  hello(header) {
    document.body.dataset.live = "yes";
    if (!app.form) {
      app.form = new Form(byId("sections"), header.form);
      showFolder(header.folder);
      begin(header.folder);
    } else if (app.wanted && (app.busy || !app.scene)) ask(app.wanted);
  },
  stage({ text }) { busy(true, text); },
  mistakes({ mistakes }) { fail(mistakes); },
  failed({ mistakes }) { fail(mistakes); },
  scene(header, message, buffer) {
    app.earlier = app.scene && app.keep && same(app.scene.column_units, header.column_units) ? app.scene : null;
    app.scene = new Scene(buffer, message);
    app.scene.shear = app.shear;
    if (!app.picked) app.curveView.name = app.runs.length ? "area" : "";
    Object.assign(app, { map: 0, following: true, change: null });
    stopPlaying();
    if (app.form && header.config) {
      if (app.wanted?.kind === "open") app.form.write(header.config);
      app.form.chosen = header.config;
      app.form.showChosen();
    }
    document.title = `${header.title} · Asperity`;
    byId("title").textContent = header.title;
    document.body.dataset.scene = "yes";
    byId("failure").textContent = "";
    showText();
  },
  rows(header, message, buffer) {
    if (!app.scene || header.job !== app.scene.job) return;
    app.scene.add(buffer, message);
    if (app.following && app.scene.maps.length) app.map = app.scene.maps.length - 1;
    show();
  },
  done(header, message, buffer) {
    if (app.scene && header.job === app.scene.job) app.scene.add(buffer, message);
    if (!app.scene.maps.length) app.scene.doWithoutMaps();
    if (app.following) app.map = app.scene.maps.length - 1;
    busy(false);
    suggestBranch();
    show();
    if (app.replay && app.following && !calm.matches) play();
    app.replay = app.following = false;
  },
  campaign(header, message, buffer) { showCampaign(header, message.arrays, buffer); },
};

function receive(buffer) {
  const message = readMessage(buffer), { kind, sequence } = message.header;
  send({ kind: "ack", sequence });
  ARRIVALS[kind]?.(message.header, message, buffer);
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

// ---- what is asked for -------------------------------------------------------------------------------------------

const encoded = (value) => btoa(String.fromCharCode(...new TextEncoder().encode(JSON.stringify(value)))).replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "");
const decoded = (text) => JSON.parse(new TextDecoder().decode(Uint8Array.from(atob(text.replaceAll("-", "+").replaceAll("_", "/")), (letter) => letter.charCodeAt(0))));

function send(message) {
  if (app.socket?.readyState === WebSocket.OPEN) app.socket.send(JSON.stringify(message));
}

/** Ask for a run or a folder, and put that into the address, so that a reload asks again. */
function ask(request) {
  app.wanted = request;
  app.replay = request.kind === "run";
  const hash = request.kind === "run" ? `#config=${encoded(request.config)}` : `#open=${encodeURIComponent(request.path)}`;
  if (location.hash !== hash) history.replaceState(null, "", hash);
  app.form.mistakes([]);
  app.found = [];
  byId("branch-mistake").textContent = byId("failure").textContent = "";
  busy(true, "waiting for the server");
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
  app.found = mistakes;
  const ofBranch = (one) => one.where.startsWith("protocol");
  if (app.form) app.form.mistakes(mistakes.filter((one) => !ofBranch(one)));
  byId("branch-mistake").textContent = mistakes.filter(ofBranch).map((one) => one.text).join("\n");
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
      delete config.contact;
      config.protocol = [];
    } else config[section] = { ...config[section], [key]: told.path };
    forgetCampaign();
    app.form.write(config);
    ask({ kind: "run", config: app.form.read() });
  } catch {
    fail([{ where: field, text: `${file.name}: the file did not reach the server; try again` }]);
  }
}

// ---- what is shown -----------------------------------------------------------------------------------------------

function show() {
  const { scene, map } = app;
  if (!scene?.maps.length) return;
  const earlier = byId("earlier").checked ? app.earlier : null;
  document.querySelector(".earlier").hidden = !app.earlier;
  showQuantities();
  app.curveView.show(scene, { map, earlier, change: app.live ? app.change : null, runs: app.curveView.name === "area" ? app.runs.map((run) => run.curve) : [] });
  app.mapView.show(scene, map);
  byId("map").setAttribute("aria-label", app.mapView.inWords());
  const place = app.curveView.placeOf(map), time = quantity(scene.maps[map].time, scene.units.time);
  const slider = byId("moment"), words = `t = ${time}${scene.maps[map].side === "after" ? ", just after the step" : ""}`;
  slider.value = 1000 * place;
  slider.setAttribute("aria-valuetext", `${words}, ${count(scene.maps[map].area)} sites in contact`);
  byId("shown").textContent = words;
  byId("curve").setAttribute("aria-label", curveInWords());
  showLegend();
  showNumbers();
  showBranch();
  showRemarks();
  if (app.mapView.cursor !== null) readSite(app.mapView.cursor, map);
  if (app.busy) busy(true);
}

function curveInWords() {
  const { scene } = app, { name } = app.curveView, values = scene.column(name).filter(Number.isFinite);
  const said = (value) => quantity(value, scene.column_units[name]);
  return `${nameOf(scene, name)} against time: ${said(values[0])} at first touch, ${said(values.at(-1))} at t = ${quantity(scene.rows.at(-1)[scene.columns.indexOf("time")], scene.units.time)}.`;
}

function showQuantities() {
  const select = byId("quantity"), names = Object.keys(QUANTITIES).filter((name) => app.scene.has(name));
  const shown = [...select.options].map((one) => one.textContent);
  if (!same(shown, names.map((name) => nameOf(app.scene, name)))) {
    select.replaceChildren(...names.map((name) => element("option", { value: name }, nameOf(app.scene, name))));
  }
  if (!names.includes(app.curveView.name)) [app.curveView.name] = names;
  select.value = app.curveView.name;
}

function showLegend() {
  const { scene, map, mapView } = app, list = byId("legend");
  const note = mapView.side > 1 ? [element("li", { className: "hint" }, `one mark covers ${mapView.side} × ${scene.isLine ? 1 : mapView.side} sites, so areas look larger: zoom in`)] : [];
  if (scene.isLine) note.push(element("li", { className: "hint" }, "position across, time downward"));
  if (scene.mapless) { list.replaceChildren(element("li", {}, `This run kept no maps of its contact: the heights are shown.${app.live && scene.config ? " “Press and age” makes them." : ""}`), ...note); return; }
  if (mapView.colored === "state") {
    const { counts } = scene.states(map);
    const items = [KEPT, NEW, LOST].map((state) => {
      const mark = element("i");
      mark.style.background = `var(--${STATES[state]})`;
      return element("li", { title: SITE_WORDS[state] }, mark, `${count(counts[state])} ${["", "since first touch", "new", "lost"][state]}`);
    });
    list.replaceChildren(...items, ...note);
    return;
  }
  const bar = element("canvas", { width: 90, height: 1 }), context = bar.getContext("2d"), { dark } = theme();
  const ranges = {
    pressure: [0, scene.maps[map].pressure_scale, scene.units.pressure], age: [scene.maps[map].time, 0, scene.units.time],
    heights: [...scene.height_range, scene.units.height],
  };
  const [low, high, unit] = ranges[mapView.colored];
  for (let x = 0; x < 90; x++) {
    const part = x / 89;
    context.fillStyle = `rgb(${cividis(mapView.colored === "heights" ? part : dark ? 0.25 + 0.75 * part : 0.8 * (1 - part)).join()})`;
    context.fillRect(x, 0, 1, 1);
  }
  list.replaceChildren(element("li", {}, `${{ age: "in contact since t =" }[mapView.colored] || mapView.colored} ${quantity(low, unit)} `, bar, ` ${quantity(high, unit)}${mapView.colored === "age" ? " (logarithmic)" : ""}`), ...note);
}

function showNumbers() {
  const { scene, map } = app, row = scene.rowOf(map);
  const names = Object.keys(QUANTITIES).filter((name) => scene.columns.includes(name));
  const items = names.map((name) => {
    const value = scene.value(row, name), unit = scene.column_units[name];
    const text = name === "contact_fraction" ? percent(value) : name === "area" ? `${count(value)} sites`
      : name === "decade_growth" && Number.isFinite(value) ? `${percent(value)} of first` : quantity(value, unit, name === "residual" ? 2 : 4);
    const label = nameOf(scene, name);
    return element("div", { title: scene.names[name] || "" }, element("dt", {}, label), element("dd", { id: `number-${name}` }, text));
  });
  byId("numbers").replaceChildren(...items);
  byId("shear-field").hidden = !scene.columns.includes("contact_area");
  byId("shear-field").querySelector("span").textContent = scene.column_units.mean_pressure === "Pa" ? "[Pa]" : "";
  const growth = scene.finished?.fit?.growth;
  byId("fit").textContent = growth
    ? `Growth per decade from t = ${quantity(growth.first, scene.units.time, 3)} to ${quantity(growth.last, scene.units.time, 3)}: ${percent(growth.per_decade)} `
      + `(${percent(growth.low)} to ${percent(growth.high)}, 95 %) of the area at first`
      + `${growth.straight === false ? "; the curve bends, so that this is a mean" : ""}.`
    : "";
}

function showRemarks() {
  const { scene } = app, { remarks = [], effort } = scene.finished || {};
  const lines = [...new Set([...(scene.remarks || []), ...remarks])];
  if (effort?.seconds) lines.push(`${count(effort.steps)} time steps in ${number(effort.seconds, 2)} s`);
  const list = byId("remarks");
  if (list.textContent !== lines.join("")) list.replaceChildren(...lines.map((text) => element("li", {}, text)));
}

function readSite(site, map) {
  byId("site").textContent = app.scene.describe(map, site);
}

function showText() {
  byId("text").value = app.scene?.[byId("language").value] || "";
}

/** Show the moment of one map; the user decides, so nothing follows the computing any more. */
function choose(map) {
  app.map = Math.min(app.scene.maps.length - 1, Math.max(0, map));
  app.following = app.replay = false;
  show();
}

function play() {
  stopPlaying();
  const { maps } = app.scene;
  if (maps.length < 2) return;
  byId("play").textContent = "Pause";
  byId("shown").setAttribute("aria-live", "off");
  app.map = app.map >= maps.length - 1 ? 0 : app.map;
  show();
  app.playing = setInterval(() => {
    if (app.map >= app.scene.maps.length - 1) stopPlaying();
    else { app.map += 1; show(); }
  }, Math.max(60, 4000 / maps.length));
}

function stopPlaying() {
  clearInterval(app.playing);
  app.playing = 0;
  byId("play").textContent = "Play";
  byId("shown").setAttribute("aria-live", "polite");
}

// ---- a change of load --------------------------------------------------------------------------------------------

const flattened = (legs) => (legs || []).flatMap((leg) => (leg.kind === "repeat" ? Array(Math.min(leg.count, 200)).fill(flattened(leg.legs)).flat() : [leg]));

/** Rows at which the load may be changed: not within a ramp, and not at first touch. */
function changeable(scene) {
  const legs = flattened(scene.config?.protocol);
  return scene.rows.map((_, row) => row).filter((row) => {
    const leg = legs[scene.value(row, "leg")];
    return scene.value(row, "time") > 0 && (!legs.length || leg?.kind === "hold");
  });
}

function suggestBranch() {
  const { scene } = app;
  if (!app.live || !scene) return;
  byId("branch").hidden = !scene.config || !changeable(scene).length;
  if (byId("branch").hidden) return;
  const rows = changeable(scene), last = scene.value(scene.rows.length - 1, "time");
  app.changeRow = rows[Math.floor(0.6 * (rows.length - 1))];
  for (const option of byId("target").options) {
    const unit = readable(1, scene.column_units[option.value])[0];
    option.textContent = unit ? `${option.value} [${unit}]` : option.value;
  }
  byId("target").value = scene.config.contact?.separation === undefined ? "load" : "separation";
  suggestValue();
  byId("after").value = typed(Number(last.toPrecision(3)));
  byId("ramp").value = typed(Number((last / 100).toPrecision(3)));
}

function suggestValue() {
  const value = app.scene.value(app.changeRow, byId("target").value);
  const scale = byId("target").value === "load" ? 2 * value : value - 0.1 * (app.scene.height_range[1] - app.scene.height_range[0]);
  byId("new-value").value = typed(Number(scale.toPrecision(3)));
}

function showBranch() {
  if (!app.live || app.changeRow === undefined || !app.scene.finished) return;
  const { scene } = app, time = scene.value(app.changeRow, "time");
  const words = `t = ${quantity(time, scene.units.time)}`;
  app.change = time;
  byId("when").value = 1000 * app.curveView.axis.place(time);
  byId("when").setAttribute("aria-valuetext", words);
  byId("when-text").textContent = words;
}

/** The configuration of the run shown, with a change of load or separation at one of its rows. */
function branched(scene, row, { how, target, value, ramp, after }) {
  const time = scene.value(row, "time"), leg = scene.value(row, "leg"), legs = flattened(scene.config.protocol);
  const before = legs.slice(0, leg), begun = before.reduce((sum, one) => sum + (one.duration || 0), 0);
  const { hold, last: _last, times: _times, ...aging } = scene.config.aging || {};
  const pressed = scene.config.contact?.separation === undefined ? "load" : "separation";
  const held = legs.length ? legs[leg] : { kind: "hold", ...(hold && hold !== pressed ? { hold } : {}) };
  const change = how === "ramp" ? { kind: "ramp", duration: ramp, [target]: value } : { kind: "step", [target]: value };
  const { maps_at: _maps, ...output } = scene.config.output || {};
  return { ...scene.config, aging, output, protocol: [...before, { ...held, duration: time - begun }, change, { kind: "hold", duration: after }] };
}

// ---- folders and campaigns ---------------------------------------------------------------------------------------

function showFolder(entries) {
  byId("folder").hidden = !entries;
  if (!entries) return;
  byId("folder").querySelector("summary").textContent = entries.length ? `Results in this folder: ${entries.length}` : "This folder holds no results";
  byId("entries").replaceChildren(...entries.map(({ path, kind, title }) => {
    const button = element("button", { type: "button" }, `${path}${kind === "run" ? "" : ` (${kind})`}`);
    button.title = title || "";
    button.addEventListener("click", () => { forgetCampaign(); app.keep = false; ask({ kind: "open", path }); mark(button); });
    return button;
  }));
}

function forgetCampaign() {
  app.runs = [];
  app.campaign = null;
  byId("campaign").hidden = true;
}

function mark(button) {
  for (const other of button.closest("section").querySelectorAll("[aria-current]")) other.removeAttribute("aria-current");
  button.setAttribute("aria-current", "true");
}

function showCampaign({ path, parameters, runs }, arrays, buffer) {
  app.campaign = buffer;
  byId("campaign").hidden = false;
  byId("campaign").querySelector("summary").textContent = `Campaign of ${runs.length} runs: ${parameters.join(", ")}`;
  app.runs = runs.map((run) => {
    const times = arrays[`time.${run.id}`] || [], areas = arrays[`area.${run.id}`] || [];
    return { ...run, curve: Array.from(times, (time, at) => [time, areas[at]]) };
  }).filter((run) => run.curve.length);
  const head = element("tr", {}, ...["run", ...parameters].map((name) => element("th", { scope: "col" }, name)));
  byId("campaign").querySelector("table").replaceChildren(head, ...runs.map((run) => {
    const button = app.live && run.state === "done" ? element("button", { type: "button" }, run.id.slice(0, 8)) : element("span", {}, run.id.slice(0, 8));
    button.addEventListener("click", () => { app.keep = false; ask({ kind: "open", path: `${path}/${run.id}` }); mark(button); });
    const fate = run.state === "done" ? "" : [run.state, run.reason].filter(Boolean).join(": ");
    return element("tr", {}, element("td", {}, button, " ", fate), ...parameters.map((name) => element("td", {}, typeof run[name] === "number" ? number(run[name]) : String(run[name]))));
  }));
}

// ---- what the user does ------------------------------------------------------------------------------------------

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
  on("play", "click", () => { app.following = app.replay = false; if (app.playing) stopPlaying(); else play(); });
  on("quantity", "change", ({ target }) => { app.picked = app.curveView.name = target.value; show(); });
  on("colored", "change", ({ target }) => { app.mapView.colored = target.value; show(); });
  on("earlier", "change", show);
  on("shear", "input", ({ target }) => {
    const value = valueOf(target.value, { what: "number" });
    app.shear = app.scene.shear = value > 0 ? value : null;
    if (app.earlier) app.earlier.shear = app.shear;
    target.toggleAttribute("aria-invalid", value !== null && !(value > 0));
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
  if (matchMedia("(max-width: 46rem)").matches) byId("setup").open = false;
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

function branch() {
  if (app.busy) return; // the run from which it branches has not ended
  const wrong = [];
  const read = (id, name) => {
    const key = { what: "number" }, value = valueOf(byId(id).value, key);
    byId(id).removeAttribute("aria-invalid");
    if (typeof value === "number") return value;
    if (value && /^[\d.]/.test(value)) return value; // with a unit, which the server reads
    byId(id).setAttribute("aria-invalid", "true");
    wrong.push(`${name}: expected a number, got ${value === null ? "none" : JSON.stringify(value)}`);
    return value;
  };
  const target = byId("target").value, how = byId("how").value;
  const given = { how, target, value: read("new-value", target), ramp: how === "ramp" ? read("ramp", "lasting") : 0, after: read("after", "then hold for") };
  byId("branch-mistake").textContent = wrong.join("\n");
  if (wrong.length) return;
  const config = branched(app.scene, app.changeRow, given);
  app.keep = true;
  app.form.write(config);
  ask({ kind: "run", config: app.form.read() });
}

/** Save or copy what a button says, and tell how it went. */
async function take(button) {
  const told = (text) => { byId("taken").textContent = text; };
  told("");
  try {
    if (button.dataset.save) {
      await SAVES[button.dataset.save](app, told);
      told("Saved.");
      return;
    }
    const kind = button.dataset.copy;
    const text = kind === "link" ? linkOf(app.scene) : app.scene[kind] || "";
    if (await copy(text)) told("Copied.");
    else {
      if (kind !== "link") byId("language").value = kind;
      byId("text").value = text;
      byId("text").closest("details").open = true;
      byId("text").select();
      told("The browser did not let the page copy: the text is selected below.");
    }
  } catch (error) {
    told(`This did not work: ${error.message}`);
  }
}

/** The address of this page with the configuration of the run that is shown. */
function linkOf(scene) {
  const shown = new URL(location.href);
  shown.hash = app.form && scene.config && app.wanted?.kind !== "run" ? `config=${encoded(scene.config)}` : location.hash.slice(1);
  return shown.href;
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
  row(at) { return Object.fromEntries(app.scene.columns.map((name) => [name, app.scene.value(at, name)])); },
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
    choose(app.scene.maps.length - 1);
  } else {
    app.live = true;
    connect();
  }
}

start();
