"use strict";
// What one can take along: picture, table, animation, the page as a file, and the configuration as text.

/** Draw map and curve side by side, with what they show in words. */
function picture(app, map, scale = 2) {
  const { scene } = app, [width, height] = [1040, 590], colors = theme();
  const canvas = element("canvas", { width: width * scale, height: height * scale });
  const context = canvas.getContext("2d", { willReadFrequently: true });
  context.scale(scale, scale);
  context.fillStyle = colors.of("page");
  context.fillRect(0, 0, width, height);
  context.fillStyle = colors.of("ink");
  context.textBaseline = "alphabetic";
  context.font = "600 15px system-ui, sans-serif";
  context.fillText(scene.title, 16, 28, width - 32);
  const at = (left, top, paint) => { context.save(); context.translate(left, top); paint(); context.restore(); };
  at(16, 48, () => app.mapView.paint(context, 470, 470, map));
  at(520, 48, () => app.curveView.paint(context, 504, 470, map, false));
  context.font = "13px system-ui, sans-serif";
  context.textAlign = "left";
  context.textBaseline = "alphabetic";
  context.fillStyle = colors.of("ink");
  context.fillText(`t = ${quantity(scene.maps[map].time, scene.units.time)}: ${scene.extent(scene.maps[map].area)} in contact, `
    + `${percent(scene.maps[map].area / scene.nominal)}; load ${quantity(scene.value(scene.rowOf(map), "load"), scene.units.load)}`, 16, 542);
  let left = 16;
  if (app.mapView.colored === "state") {
    for (const state of [KEPT, NEW, LOST]) {
      const text = ["", `since ${scene.start}`, "new", `lost since ${scene.start}`][state];
      context.fillStyle = colors.of(STATES[state]);
      context.fillRect(left, 558, 12, 12);
      context.strokeStyle = colors.of("line");
      context.strokeRect(left + 0.5, 558.5, 11, 11);
      context.fillStyle = colors.of("ink");
      context.fillText(text, left + 18, 569);
      left += 42 + context.measureText(text).width;
    }
  } else context.fillText(byId("legend").textContent.trim(), left, 569);
  return canvas;
}

/** The time series as a table: names with their units in brackets. */
function table(scene) {
  const columns = [...scene.columns, ...(scene.map_columns || []).filter((name) => scene.has(name))];
  const named = columns.map((name) => {
    if (name === "friction" && scene.shear) return `friction coefficient (shear strength ${typed(scene.shear)})`;
    const unit = scene.column_units[name];
    const text = unit && unit !== "1" ? `${name} [${unit}]` : name;
    return /[",]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
  });
  const written = (value) => (Number.isNaN(value) ? "" : String(value));
  return [named.join(","), ...scene.rows.map((_, row) => columns.map((name) => written(scene.value(row, name))).join(","))].join("\n") + "\n";
}

/** This page as one file: the server gives the page without data, and the messages are put into it. */
async function wholePage({ scene, campaign }) {
  const answer = await fetch("shell.html");
  if (!answer.ok) throw new Error(`the server did not give the page: ${answer.status}`);
  const shell = await answer.text(), packed = await packMessages(campaign ? [campaign, ...scene.buffers] : scene.buffers);
  const title = element("i", {}, scene.title).innerHTML;
  return new Blob([shell.replace(/(<script type="application\/octet-stream" id="recording">)[^<]*/, (_, tag) => tag + packed)
    .replace(/<title>[^<]*/, () => `<title>${title}`)], { type: "text/html" });
}

function save(blob, name) {
  const link = element("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}

const SAVES = {
  page: async (app) => save(await wholePage(app), "asperity.html"),
  png: async (app) => save(await new Promise((done) => picture(app, app.map).toBlob(done, "image/png")), "asperity.png"),
  csv: async ({ scene }) => save(new Blob([table(scene)], { type: "text/csv" }), "asperity.csv"),
  gif: async (app, told) => {
    const frame = (map) => { const made = picture(app, map, 1); return made.getContext("2d").getImageData(0, 0, made.width, made.height); };
    const delays = app.scene.maps.map((_, map, all) => (map === all.length - 1 ? 2 : map ? 0.12 : 0.8));
    save(await animation(frame, delays, (part) => told(`Making the animation: ${Math.round(100 * part)} %`)), "asperity.gif");
  },
};

/** Put text on the clipboard; where that is not allowed, the text stays selected. */
async function copy(text) {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    return false;
  }
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
