"use strict";
// The form of a configuration, made of the description that the server sends, and examples to begin with.

const EVERYDAY = {
  surface: ["kind", "shape", "size", "rms", "hurst", "path", "seed"],
  solid: ["kind", "k0", "k1", "R", "modulus", "poisson", "thickness", "branches", "base_modulus", "base_poisson"],
  contact: ["load", "pressure", "separation"],
  aging: ["last", "per_decade"],
  friction: ["shear_strength"],
};
const TITLES = { surface: "Rough surface", solid: "Solid", contact: "What presses", aging: "Times", friction: "Friction" };
const LEFT_OUT = { aging: ["times"] };

const EXAMPLES = [
  ["Lattice of springs", "nine decades", {}],
  ["Polymer half-space", "in SI units", {
    surface: { kind: "spectral", shape: [256, 256], hurst: 0.8, rms_height: 1e-6, spacing: [4e-6], cutoff: 4e-5, unit: "m", seed: 1 },
    solid: { kind: "half_space", modulus: 3e9, branches: [[0.3, 1], [0.3, 1000]] },
    contact: { pressure: 1e6 },
  }],
  ["Unloading", "contacts are lost", {
    contact: { load: 800 }, protocol: [{ kind: "hold", duration: 100 }, { kind: "step", load: 300 }, { kind: "hold", duration: 1e5 }],
  }],
  ["Line contact", "4096 sites in a row", { surface: { shape: [4096] } }],
];

class Form {
  constructor(place, description) {
    this.description = description;
    this.place = place;
    this.values = {}; // section -> key -> text or switch, kept when the kind changes
    this.kinds = {};
    this.protocol = [];
    this.output = {};
    this.chosen = null; // the configuration of the run shown, with nothing left open
    for (const [section, kinds] of Object.entries(description)) {
      if (!(section in EVERYDAY)) continue;
      this.kinds[section] = Object.keys(kinds)[0];
      this.values[section] = {};
      const box = element("fieldset", { id: `section-${section}` }, element("legend", {}, TITLES[section]));
      place.append(box);
      this.fill(section);
    }
  }

  keys(section, kind = this.kinds[section]) {
    return Object.values(this.description[section][kind]).filter((key) => !LEFT_OUT[section]?.includes(key.name));
  }

  /** Make the fields of a section for its present kind. */
  fill(section) {
    const box = byId(`section-${section}`), opened = box.querySelector("details")?.open;
    while (box.children.length > 1) box.lastChild.remove();
    const kinds = Object.keys(this.description[section]);
    if (kinds.length > 1) {
      const chosen = element("select", { id: `${section}.kind` }, ...kinds.map((kind) => element("option", { value: kind }, kind.replaceAll("_", " "))));
      chosen.value = this.kinds[section];
      chosen.addEventListener("change", () => { this.kinds[section] = chosen.value; this.fill(section); byId(`${section}.kind`).focus(); });
      box.append(this.field(section, { name: "kind", description: "" }, chosen));
    }
    const rest = element("details", { open: Boolean(opened) }, element("summary", {}, "more"));
    for (const key of this.keys(section)) {
      const everyday = key.required || EVERYDAY[section].includes(key.name);
      (everyday ? box : rest).append(this.field(section, key, this.input(section, key)));
    }
    if (rest.children.length > 1) box.append(rest);
  }

  field(section, key, input) {
    const id = `${section}.${key.name}`, children = [];
    input.id = id;
    input.setAttribute("aria-describedby", `help-${id} mistake-${id}`);
    const unit = key.unit && this.kinds.solid !== "spring_lattice" ? ` [${key.unit}]` : "";
    children.push(element("label", { htmlFor: id }, key.name.replaceAll("_", " ") + unit), input);
    if (key.what === "path") {
      const browse = element("button", { type: "button" }, "Choose a file …");
      browse.addEventListener("click", () => { this.wanted = id; byId("file").click(); });
      children.push(browse);
    }
    children.push(element("small", { id: `help-${id}` }, key.description || ""), element("p", { id: `mistake-${id}`, className: "mistake", role: "alert" }));
    return element("div", { className: "field" }, ...children);
  }

  input(section, key) {
    const held = this.values[section], shown = held[key.name] ?? textOf(key.default, key);
    let input;
    if (key.what === "switch") input = element("input", { type: "checkbox", checked: shown === true });
    else if (key.what === "choice") {
      const options = (key.default === null || key.default === undefined ? [""] : []).concat(key.choices);
      input = element("select", {}, ...options.map((one) => element("option", { value: one }, one || "by default")));
      input.value = shown;
    } else if (key.what === "pairs") input = element("textarea", { rows: 2, value: shown });
    else {
      input = element("input", { type: "text", value: shown, autocomplete: "off", spellcheck: false });
      if (key.what === "number" || key.what === "whole") input.inputMode = "decimal";
    }
    input.addEventListener("input", () => { held[key.name] = key.what === "switch" ? input.checked : input.value; });
    return input;
  }

  /** The configuration as it stands in the form, without what is left at its default. */
  read() {
    const config = {};
    for (const [section, held] of Object.entries(this.values)) {
      const found = {};
      const kinds = Object.keys(this.description[section]);
      if (kinds.length > 1 && this.kinds[section] !== kinds[0]) found.kind = this.kinds[section];
      for (const key of this.keys(section)) {
        const value = valueOf(held[key.name] ?? textOf(key.default, key), key);
        if (value !== null && !same(value, key.default)) found[key.name] = value;
      }
      if (this.protocol.length && section === "aging") for (const name of ["last", "hold", "times"]) delete found[name];
      if (Object.keys(found).length) config[section] = found;
    }
    if (this.protocol.length) config.protocol = this.protocol;
    if (Object.keys(this.output).length) config.output = this.output;
    return config;
  }

  /** Show a configuration, whole or as differences from the defaults. */
  write(config) {
    for (const section of Object.keys(this.values)) {
      const kinds = Object.keys(this.description[section]), given = config[section] || {};
      this.kinds[section] = given.kind ?? kinds[0];
      this.values[section] = {};
      for (const key of this.keys(section)) {
        if (given[key.name] !== undefined && given[key.name] !== null) this.values[section][key.name] = textOf(given[key.name], key);
      }
    }
    for (const section of Object.keys(this.values)) this.fill(section);
    this.protocol = config.protocol || [];
    const { maps_at: _maps, figures: _figures, ...output } = config.output || {};
    this.output = output;
    const history = byId("history");
    history.hidden = !this.protocol.length;
    history.firstElementChild.textContent = `History: ${this.protocol.map(legInWords).join(", ")}.`;
    this.mistakes([]);
  }

  /** Show in empty fields what was taken for them. */
  showChosen() {
    for (const section of Object.keys(this.values)) {
      for (const key of this.keys(section)) {
        const value = this.chosen?.[section]?.[key.name];
        byId(`${section}.${key.name}`).placeholder = value === undefined ? "" : textOf(value, key);
      }
    }
  }

  /** Show mistakes where they were made; those of no field stand above the form. */
  mistakes(found) {
    for (const place of this.place.querySelectorAll(".mistake")) place.textContent = "";
    for (const input of this.place.querySelectorAll("[aria-invalid]")) input.removeAttribute("aria-invalid");
    const general = [];
    let first = null;
    for (const { where, text } of found) {
      const input = byId(where);
      if (!input || !this.place.contains(input)) { general.push(text); continue; }
      input.setAttribute("aria-invalid", "true");
      const details = input.closest("details");
      if (details) details.open = true;
      const place = byId(`mistake-${where}`);
      place.textContent = [place.textContent, text].filter(Boolean).join("\n");
      first ||= input;
    }
    byId("form-mistakes").textContent = general.join("\n");
    if (found.length) byId("setup").open = true;
    first?.focus();
  }
}

/** A value as it is typed. */
function textOf(value, key) {
  if (key.what === "switch") return value === true;
  if (value === null || value === undefined) return "";
  if (key.what === "pairs") return value.map((pair) => pair.map(typed).join(" ")).join("\n");
  return Array.isArray(value) ? value.map(typed).join(" ") : typed(value);
}

/** A number as one types it: 1e6 rather than 1000000. */
function typed(value) {
  const size = Math.abs(value);
  return typeof value === "number" && (size >= 1e5 || (size > 0 && size < 1e-3)) ? value.toExponential().replace("e+", "e") : String(value);
}

/** What was typed, as a value; a text that is no number stays one, and the server says what is wrong with it. */
function valueOf(text, key) {
  if (key.what === "switch") return text;
  const written = text.trim();
  const one = (word) => (/^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(word) ? Number(word) : word);
  const words = (line) => line.trim().split(/\s+/).map(one);
  if (written === "") return null;
  if (key.what === "pairs") return written.split(/[\n;]+/).filter((part) => part.trim()).map(words);
  if (["numbers", "wholes", "pair"].includes(key.what)) return key.unit ? withUnits(words(written)) : words(written);
  if (key.what === "number" || key.what === "whole") return one(written);
  return key.what === "text or whole" && /^\d+$/.test(written) ? Number(written) : written;
}

/** Put numbers and the units behind them together: "3 GPa" is one quantity. */
function withUnits(words) {
  return words.reduce((all, word) => {
    if (typeof word === "string" && typeof all.at(-1) === "number" && /^[^\d+-]/.test(word)) all.push(`${all.pop()} ${word}`);
    else all.push(word);
    return all;
  }, []);
}

function legInWords(leg) {
  const to = ["load", "pressure", "separation", "approach"].filter((name) => leg[name] !== undefined && leg[name] !== null).map((name) => `to ${name} ${number(leg[name])}`).join(" ");
  if (leg.kind === "hold") return `hold for ${number(leg.duration)}`;
  if (leg.kind === "step") return `step ${to}`;
  if (leg.kind === "ramp") return `ramp ${to} in ${number(leg.duration)}`;
  if (leg.kind === "slide") return `slide ${number(leg.distance)} ${leg.velocity === "inf" ? "at once" : `at ${number(leg.velocity)}`}`;
  return `${leg.count} times (${leg.legs.map(legInWords).join(", ")})`;
}
