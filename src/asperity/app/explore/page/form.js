"use strict";
// The form of a configuration, made of the description that the server sends, and examples to begin with.

const EVERYDAY = {
  surface: ["kind", "shape", "size", "rms", "hurst", "path", "seed"],
  solid: ["kind", "k0", "k1", "R", "modulus", "poisson", "thickness", "branches", "base_modulus", "base_poisson"],
  contact: ["load", "pressure", "separation"],
  aging: ["last", "per_decade", "times"],
  friction: ["shear_strength"],
  prediction: ["ramp"],
  law: ["pressures", "per_decade"],
  sliding: ["speeds", "per_decade", "direction"],
};
const TITLES = {
  surface: "Rough surface", solid: "Solid", contact: "What presses", aging: "Times", friction: "Friction",
  prediction: "Prediction", law: "Law", sliding: "Sliding",
};
const LEFT_OUT = { aging: ["times"] };
const POLYMER = {
  surface: { kind: "spectral", shape: [256, 256], hurst: 0.8, rms_height: 1e-6, spacing: [4e-6], cutoff: 4e-5, unit: "m", seed: 1 },
  solid: { kind: "half_space", modulus: 3e9, branches: [[0.3, 1], [0.3, 1000]] },
  contact: { pressure: 1e6 },
};
// Questions: what they are called, what their button says, and what they begin with.
const QUESTIONS = {
  "": ["A contact that ages", "Press and age", {}],
  prediction: ["Its growth with 95 % bands", "Predict", { contact: POLYMER.contact }],
  law: ["Stiffness against pressure", "Tabulate", { law: { pressures: [1e5, 1e7] }, aging: { times: [0, 1000] } }],
  sliding: ["Friction against speed", "Slide", { sliding: { speeds: [1e-6, 1] }, contact: POLYMER.contact }],
};

// What a solid that needs more begins with: a film of that polymer, on glass.
const FILM = { poisson: 0.35, thickness: 1e-4, base_modulus: 7e10, base_poisson: 0.2 };

const EXAMPLES = [
  ["Lattice of springs", "nine decades", {}],
  ["Polymer half-space", "in SI units", POLYMER],
  ["Unloading", "contacts are lost", {
    contact: { load: 800 }, protocol: [{ kind: "hold", duration: 100 }, { kind: "step", load: 300 }, { kind: "hold", duration: 1e5 }],
  }],
  ["Line contact", "4096 sites in a row", { surface: { shape: [4096] } }],
];

class Form {
  constructor(place, description, questions) {
    for (const [name, { keys }] of Object.entries(questions)) description[name] = { "": keys };
    this.description = description;
    this.questions = questions;
    this.question = "";
    this.place = place;
    this.values = {}; // section -> key -> text or switch, kept when the kind changes
    this.kinds = {};
    this.protocol = [];
    this.output = {};
    this.note = ""; // what was changed with the kind of the solid
    this.filled = {}; // what a kind of solid needed, and nobody typed
    this.chosen = null; // the configuration of the run shown, with nothing left open
    const choice = element("select", { id: "question" }, ...Object.entries(QUESTIONS).map(([value, [title]]) => element("option", { value }, title)));
    choice.addEventListener("change", () => this.ask(choice.value));
    place.append(element("div", { className: "field" }, element("label", { htmlFor: "question" }, "What to find"), choice));
    for (const [section, kinds] of Object.entries(description)) {
      if (!(section in EVERYDAY)) continue;
      this.kinds[section] = Object.keys(kinds)[0];
      this.values[section] = {};
      const box = element("fieldset", { id: `section-${section}` }, element("legend", {}, TITLES[section]));
      place.append(box);
      this.fill(section);
    }
  }

  /** The keys of a section that the question uses. */
  keys(section, kind = this.kinds[section]) {
    const { unused = {}, refused = [] } = this.questions[this.question] ?? {};
    if (section in this.questions && section !== this.question) return [];
    const left = this.question === "law" ? [] : LEFT_OUT[section];
    return Object.values(this.description[section][kind]).filter(({ name }) => !(left?.includes(name) || unused[section]?.includes(name) || refused.includes(`${section}.${name}`)));
  }

  /** Ask another question, of a solid and with numbers that it can have. */
  ask(question) {
    this.question = question;
    if (question && !this.hasModulus()) for (const section of ["surface", "solid", "contact"]) this.take(section, POLYMER[section]);
    for (const [section, given] of Object.entries(QUESTIONS[question][2])) {
      const held = this.values[section], typed = section === "contact" ? Object.keys(held) : Object.keys(given);
      if (!typed.some((name) => held[name])) this.give(section, given);
    }
    this.show(); // what this question does not use stays for another one
  }

  /** Show the question and the fields of all sections. */
  show() {
    byId("question").value = this.question;
    byId("press").textContent = QUESTIONS[this.question][1];
    for (const section of Object.keys(this.values)) this.fill(section);
    this.takeHistory(this.protocol);
    this.mistakes([]);
  }

  /** Whether the question takes a history. */
  get ages() { return !this.questions[this.question]?.refused.includes("protocol."); }

  /** Whether the numbers of a solid are in SI: springs between sites have no modulus. */
  hasModulus(kind = this.kinds.solid) {
    return "modulus" in this.description.solid[kind];
  }

  /** Make the fields of a section for its present kind. */
  fill(section) {
    const box = byId(`section-${section}`), opened = box.querySelector("details")?.open;
    while (box.children.length > 1) box.lastChild.remove();
    box.hidden = !this.keys(section).length;
    const kinds = Object.keys(this.description[section]);
    if (kinds.length > 1) {
      const chosen = element("select", { id: `${section}.kind` }, ...kinds.map((kind) => element("option", { value: kind }, kind.replaceAll("_", " "))));
      chosen.value = this.kinds[section];
      chosen.addEventListener("change", () => {
        const before = this.kinds[section];
        this.kinds[section] = chosen.value;
        if (section === "solid") this.suit(before);
        this.fill(section);
        byId(`${section}.kind`).focus();
      });
      box.append(this.field(section, { name: "kind", description: section === "solid" ? this.note : "" }, chosen));
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
    const unit = key.unit && this.hasModulus() ? ` [${key.unit}]` : "";
    children.push(element("label", { htmlFor: id }, key.name.replaceAll("_", " ") + unit), input);
    if (key.what === "path") {
      const browse = element("button", { type: "button" }, "Choose a file …");
      browse.addEventListener("click", () => { this.wanted = id; byId("file").click(); });
      children.push(browse);
    }
    children.push(element("small", { id: `help-${id}` }, key.description || ""), element("p", { id: `mistake-${id}`, className: "mistake" }));
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
      if (Object.keys(found).length || section === this.question) config[section] = found;
    }
    if (this.protocol.length && this.ages) config.protocol = this.protocol;
    if (Object.keys(this.output).length) config.output = this.output;
    return config;
  }

  /** Show a configuration, whole or as differences from the defaults. */
  write(config) {
    this.note = "";
    this.filled = {};
    this.question = Object.keys(this.questions).find((name) => name in config) ?? "";
    for (const section of Object.keys(this.values)) this.take(section, config[section] || {});
    const { maps_at: _maps, figures: _figures, measured: _measured, ...output } = config.output || {};
    this.output = output;
    this.protocol = config.protocol || [];
    this.show();
  }

  /** Take the kind and the values of a section, and no others. */
  take(section, given) {
    this.kinds[section] = given.kind ?? Object.keys(this.description[section])[0];
    this.values[section] = {};
    this.give(section, given);
  }

  /** Lay values over those of a section. */
  give(section, given) {
    for (const key of this.keys(section)) {
      if (given[key.name] !== undefined && given[key.name] !== null) this.values[section][key.name] = textOf(given[key.name], key);
    }
  }

  takeHistory(protocol) {
    this.protocol = protocol;
    const history = byId("history");
    history.hidden = !(this.protocol.length && this.ages);
    history.firstElementChild.textContent = `History: ${this.protocol.map(legInWords).join(", ")}.`;
  }

  /** Give a solid of another kind what it needs to be pressed, and a surface and a load that are in its units. */
  suit(before) {
    const held = this.values.solid, lattice = (kind) => !this.hasModulus(kind), blank = (name) => !held[name]?.trim();
    for (const [name, text] of Object.entries(this.filled)) if (held[name] === text) delete held[name];
    const needed = this.keys("solid").filter((key) => key.required && blank(key.name));
    this.give("solid", Object.fromEntries(needed.map(({ name }) => [name, FILM[name]])));
    this.filled = Object.fromEntries(needed.map(({ name }) => [name, held[name]]));
    if (["modulus", "young", "branches", "relaxation", "flow", "creep"].every(blank)) this.give("solid", POLYMER.solid);
    this.note = "";
    if (lattice(before) === lattice(this.kinds.solid)) return;
    const units = this.keys("surface").some(({ name, unit }) => unit === "m" || (name === "unit" && Boolean(this.values.surface.unit)));
    if (this.kinds.surface !== "file" && units === lattice(this.kinds.solid)) this.take("surface", units ? {} : POLYMER.surface);
    this.values.contact = {};
    this.takeHistory([]);
    this.note = lattice(this.kinds.solid) ? "It has no units: the surface and the load were set to fit." : "Its numbers are in SI: the surface and the load were set to fit.";
    for (const section of Object.keys(this.values)) if (section !== "solid") this.fill(section);
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

  /** A mistake in the words of the form: what its field is called, and what is wrong. */
  said({ where, text }) {
    const [section, key] = where.split(".");
    return [byId(where)?.labels?.[0]?.textContent || (key ? key.replaceAll("_", " ") : TITLES[section]) || "", text];
  }

  /** Show mistakes where they were made, and all of them by the button, which is in view. */
  mistakes(found) {
    for (const place of this.place.querySelectorAll(".mistake")) place.textContent = "";
    for (const input of this.place.querySelectorAll("[aria-invalid]")) input.removeAttribute("aria-invalid");
    const lines = [];
    let first = null;
    for (const one of found) {
      const input = byId(one.where), [name, told] = this.said(one);
      lines.push([name, told].filter(Boolean).join(": "));
      if (!input || !this.place.contains(input)) continue;
      input.setAttribute("aria-invalid", "true");
      for (const details of [input.closest("details"), byId("setup")]) if (details) details.open = true;
      const place = byId(`mistake-${one.where}`);
      place.textContent = [place.textContent, told].filter(Boolean).join("\n");
      first ||= input;
    }
    byId("form-mistakes").textContent = lines.slice(0, 3).concat(lines.length > 3 ? [`and ${lines.length - 3} more`] : []).join("\n");
    first?.focus({ preventScroll: true });
    if (found.length) (first?.closest(".field") ?? byId("form-mistakes")).scrollIntoView({ block: "nearest" });
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
  const words = (line) => withUnits(line.trim().split(/\s+/).map(one));
  if (written === "") return null;
  if (key.what === "pairs") return written.split(/[\n;]+/).filter((part) => part.trim()).map(words);
  if (["numbers", "wholes", "pair"].includes(key.what)) return words(written);
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

const LEG_UNITS = { duration: "s", load: "N", pressure: "Pa", separation: "m", approach: "m", distance: "m", velocity: "m/s", thickness: "m" };

/** A value of a leg or a key in words. */
const legValue = (name, value) => (typeof value === "number" ? quantity(value, app.form?.hasModulus() ? LEG_UNITS[name] : "") : typed(value));

/** A leg with what it was given and is not usual, whatever legs there are. */
function legInWords({ kind, legs, ...given }) {
  const told = Object.entries(given).filter(([name, value]) => (value ?? null) !== null && !(name === "mobility" && value === 1))
    .map(([name, value]) => `${name} ${legValue(name, value)}`);
  return [kind, ...told].join(" ") + (legs ? ` (${legs.map(legInWords).join(", ")})` : "");
}
