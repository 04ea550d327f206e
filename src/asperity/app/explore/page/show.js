"use strict";
// What is shown of a scene: numbers, legend, words, and the moment.

function show() {
  const { scene, map } = app;
  if (!scene?.maps.length) return;
  const earlier = byId("earlier").checked ? app.earlier : null;
  document.querySelector(".earlier").hidden = !app.earlier;
  document.querySelector(".earlier span").textContent = app.earlier ? earlierName(scene, app.earlier) : "";
  showQuantities();
  app.curveView.show(scene, { map, earlier, change: app.live ? app.change : null, runs: app.curveView.name === mainArea(scene) ? app.runs.map((run) => run.curve) : [] });
  app.mapView.show(scene, map);
  byId("map").setAttribute("aria-label", app.mapView.inWords());
  const place = app.curveView.placeOf(map), time = quantity(scene.maps[map].time, scene.units.time);
  const slider = byId("moment"), words = `t = ${time}${scene.maps[map].side === "after" ? ", just after the step" : ""}`;
  slider.value = 1000 * place;
  slider.setAttribute("aria-valuetext", `${words}, ${scene.extent(scene.maps[map].area)} in contact`);
  byId("shown").textContent = words;
  byId("curve").setAttribute("aria-label", curveInWords());
  showLegend();
  showNumbers();
  showBranch();
  showSummary();
  if (app.mapView.cursor !== null) readSite(app.mapView.cursor, map);
  if (app.busy) busy(true);
}

function curveInWords() {
  const { scene } = app, { name } = app.curveView, values = scene.column(name).filter(Number.isFinite);
  const said = (value) => quantity(value, scene.column_units[name]);
  return `${nameOf(scene, name)} against time: ${said(values[0])} at first touch, ${said(values.at(-1))} at t = ${quantity(scene.rows.at(-1)[scene.columns.indexOf("time")], scene.units.time)}.`;
}

function showQuantities() {
  const select = byId("quantity"), names = Object.keys(app.scene.labels).filter((name) => app.scene.has(name));
  const shown = [...select.options].map((one) => one.textContent);
  if (!same(shown, names.map((name) => nameOf(app.scene, name)))) {
    select.replaceChildren(...names.map((name) => element("option", { value: name }, nameOf(app.scene, name))));
  }
  if (!names.includes(app.curveView.name)) [app.curveView.name] = names;
  select.value = app.curveView.name;
}

function showLegend() {
  const { scene, map, mapView } = app, list = byId("legend");
  const size = `${mapView.side} × ${scene.isLine ? 1 : mapView.side} ${scene.cell ? "pixels" : "sites"}`, note = [];
  if (mapView.side > 1 && mapView.colored !== "heights") {
    const text = mapView.drawn.crowded ? `a mark is ${size}, and all marks together have the true area` : `a mark covers ${size}, so areas look larger`;
    note.push(element("li", { className: "hint" }, `${text}: zoom in to see each site`));
  }
  if (scene.isLine) note.push(element("li", { className: "hint" }, "position across, time downward"));
  if (scene.mapless) { list.replaceChildren(element("li", {}, `This run kept no maps of its contact: the heights are shown.${app.live && scene.config ? " “Press and age” makes them." : ""}`), ...note); return; }
  if (mapView.colored === "state") {
    const { counts } = scene.states(map);
    const items = [KEPT, NEW, LOST].map((state) => {
      const mark = element("i");
      mark.style.background = `var(--${STATES[state]})`;
      return element("li", { title: siteWords(scene)[state] }, mark, `${scene.extent(counts[state], 3)} ${["", `since ${scene.start}`, "new", "lost"][state]}`);
    });
    list.replaceChildren(...items, ...note);
    return;
  }
  const bar = element("canvas", { width: 90, height: 1 }), context = bar.getContext("2d"), { dark } = theme();
  const ranges = {
    pressure: [...scene.pressureRange(map), scene.units.pressure], age: [scene.maps[map].time, 0, scene.units.time],
    heights: [...scene.height_range, scene.units.height],
  };
  const [low, high, unit] = ranges[mapView.colored];
  for (let x = 0; x < 90; x++) {
    const part = x / 89;
    context.fillStyle = `rgb(${cividis(mapView.colored === "heights" ? part : dark ? 0.25 + 0.75 * part : 0.8 * (1 - part)).join()})`;
    context.fillRect(x, 0, 1, 1);
  }
  if (mapView.colored === "heights" && scene.maps[map].yielded) {
    const mark = element("i");
    mark.style.background = "var(--yielded)";
    note.unshift(element("li", { title: "the rough surface is lower there for good" }, mark, `${scene.extent(scene.countYielded(map))} yielded`));
  }
  list.replaceChildren(element("li", {}, `${{ age: "in contact since t =" }[mapView.colored] || mapView.colored} ${quantity(low, unit)} `, bar, ` ${quantity(high, unit)}${mapView.colored === "heights" ? "" : " (logarithmic)"}`), ...note);
}

function showNumbers() {
  const { scene, map } = app, row = scene.rowOf(map);
  const names = Object.keys(scene.labels).filter((name) => scene.knows(name));
  const items = names.map((name) => {
    const value = scene.value(row, name), unit = scene.column_units[name];
    const text = name === "contact_fraction" ? percent(value) : name === "area" ? `${count(value)} sites`
      : name === "decade_growth" && Number.isFinite(value) ? `${percent(value)} of ${scene.reference ? `that at ${scene.start}` : "first"}` : quantity(value, unit, name === "residual" ? 2 : 4);
    const label = nameOf(scene, name);
    return element("div", { title: scene.names[name] || "" }, element("dt", {}, label), element("dd", { id: `number-${name}` }, text));
  });
  byId("numbers").replaceChildren(...items);
  byId("shear-field").hidden = !scene.columns.includes("contact_area");
  byId("shear-field").querySelector("span").textContent = scene.column_units.mean_pressure === "Pa" ? "[Pa]" : "";
}

/** Units of the command line as the page writes them. */
const inSigns = (text) => text.replace(/\^2\b/g, "²").replace(/(?<=\d )u(?=[a-zA-Z])/g, "µ");

/** What the command line says at the end of a run: remarks, and a table of everything else. */
function showSummary() {
  const rows = app.scene.finished?.rows ?? [];
  const lines = [...new Set(rows.filter(([name]) => name === "remark").map(([, text]) => text))];
  byId("remarks").replaceChildren(...lines.map((text) => element("li", {}, text)));
  const table = rows.filter(([name]) => name !== "remark");
  byId("summary").hidden = !table.length;
  byId("summary").lastElementChild.replaceChildren(...table.map(([name, text]) => element("tr", {}, element("th", { scope: "row" }, name), element("td", {}, inSigns(text)))));
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
  app.following = false;
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
