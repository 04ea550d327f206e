"use strict";
// A change of load at a moment of the run shown: a configuration with a protocol.

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
  tellBranch(wrong);
  if (wrong.length) return;
  const config = branched(app.scene, app.changeRow, given);
  app.keep = true;
  ask({ kind: "run", config, changed: config.protocol.length - 2 });
  byId("curve-panel").scrollIntoView({ block: "nearest" });
}

/** Say what is wrong with a change, where it can be seen. */
function tellBranch(lines) {
  byId("branch-mistake").textContent = lines.join("\n");
  if (lines.length) byId("branch-mistake").scrollIntoView({ block: "nearest" });
}
