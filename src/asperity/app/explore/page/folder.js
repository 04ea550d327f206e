"use strict";
// What a folder holds, and the runs of a campaign.

function showFolder(entries) {
  byId("folder").hidden = !entries;
  if (!entries) return;
  byId("folder").querySelector("summary").textContent = entries.length ? `Results in this folder: ${entries.length}` : "This folder holds no results";
  byId("entries").replaceChildren(...entries.map(({ path, kind, title }) => {
    const button = element("button", { type: "button" }, `${title}${kind === "run" ? "" : ` (${kind})`}`);
    button.addEventListener("click", () => { forgetCampaign(); app.keep = false; ask({ kind: "open", path }); mark(button); });
    return button;
  }));
}

/** Show an answer without a contact that ages: its figure, its rows, and what one takes of it. */
function showAnswer({ title, config, toml, picture, table, rows }) {
  busy(false);
  app.scene = app.earlier = null;
  stopPlaying();
  address(app.wanted);
  if (app.form && app.wanted?.kind === "open") app.form.write(config);
  document.title = `${title} · Asperity`;
  byId("title").textContent = title;
  document.body.dataset.scene = "no";
  byId("failure").textContent = "";
  const image = new Blob([picture], { type: "image/svg+xml" }), button = (name, click) => {
    const made = element("button", { type: "button" }, name);
    made.addEventListener("click", click);
    return made;
  };
  byId("answer").replaceChildren(
    element("img", { src: URL.createObjectURL(image), alt: `Figure: ${title}` }),
    element("p", { className: "row" }, button("Picture (SVG)", () => save(image, "asperity.svg")),
      button("Table (CSV)", () => save(new Blob([table], { type: "text/csv" }), "asperity.csv")),
      button("Configuration (TOML)", () => save(new Blob([toml], { type: "text/plain" }), "config.toml"))),
    element("table", {}, ...rows.map(([name, text]) => element("tr", {}, element("th", { scope: "row" }, name), element("td", {}, text)))),
  );
  byId("answer").hidden = false;
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

function showCampaign({ path, parameters, units, runs }, arrays, buffer) {
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
    return element("tr", {}, element("td", {}, button, " ", fate), ...parameters.map((name) => element("td", {}, typeof run[name] === "number" ? quantity(run[name], units[name]) : String(run[name]))));
  }));
}
