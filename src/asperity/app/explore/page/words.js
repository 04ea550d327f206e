"use strict";
// Numbers, units and elements in words.

const byId = (id) => document.getElementById(id);

const same = (a, b) => JSON.stringify(a ?? null) === JSON.stringify(b ?? null);

/** Make an element with properties and children. */
function element(tag, facts = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(facts)) {
    if (name in made) made[name] = value;
    else made.setAttribute(name, value);
  }
  made.append(...children);
  return made;
}

const SUPERSCRIPTS = "⁰¹²³⁴⁵⁶⁷⁸⁹";

/** Write 10 to a power; small powers as plain numbers. */
function powerOfTen(exponent) {
  if (exponent >= -2 && exponent <= 3) return String(Number(`1e${exponent}`));
  const digits = [...String(Math.abs(exponent))].map((digit) => SUPERSCRIPTS[digit]).join("");
  return `10${exponent < 0 ? "⁻" : ""}${digits}`;
}

/** Write a number with so many significant digits. */
function number(value, digits = 4) {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  if (!Number.isFinite(value)) return value > 0 ? "∞" : "−∞";
  if (value === 0) return "0";
  const exponent = Math.floor(Math.log10(Math.abs(value)) + 1e-12);
  if (exponent < -3 || exponent > 5) {
    let mantissa = Number((value / 10 ** exponent).toPrecision(digits));
    let power = exponent;
    if (Math.abs(mantissa) >= 10) { mantissa /= 10; power += 1; }
    const head = mantissa === 1 ? "" : mantissa === -1 ? "−" : `${String(mantissa).replace("-", "−")} × `;
    return head + powerOfTen(power);
  }
  return String(Number(value.toPrecision(digits))).replace("-", "−");
}

const count = (value) => String(Math.round(value)).replace(/\B(?=(\d{3})+$)/g, "\u202f");

const PREFIXES = [["G", 1e9], ["M", 1e6], ["k", 1e3], ["", 1], ["m", 1e-3], ["µ", 1e-6], ["n", 1e-9], ["p", 1e-12]];
const PREFIXED = { N: 1, "N/m": 1, Pa: 1, m: 1, "m^2": 2, s: 1, ohm: 1, "K/W": 1, "m/s": 1 };
const LENGTHS = { m: 1, mm: 1e-3, um: 1e-6, nm: 1e-9, pm: 1e-12 };

/** Choose a readable unit for a value: its name, and the factor to it. */
function readable(value, unit) {
  if (!unit || unit === "1") return ["", 1];
  const power = PREFIXED[unit] || (unit in LENGTHS ? 1 : 0);
  if (!power) return [/ unit|^unit/.test(unit) ? "" : unit, 1];
  const base = unit in LENGTHS ? LENGTHS[unit] : 1;
  const name = unit in LENGTHS ? "m" : unit;
  const known = PREFIXES.filter(([prefix]) => !(unit === "s" && "GMk".includes(prefix) && prefix)
    && !(name[0] === "m" && "GMk".includes(prefix) && prefix));
  const size = Math.abs(value) * base;
  const least = power === 2 ? 0.1 : 1; // 0.12 mm² rather than 120000 µm²
  const [prefix, factor] = known.find(([, f]) => size >= least * f ** power * (1 - 1e-9))
    || (size > 0 ? known.at(-1) : ["", 1]);
  return [prefix + name.replace("^2", "²"), base / factor ** power];
}

const PLURALS = [["site", "sites"], ["lattice spacing", "lattice spacings"]];

/** Write a quantity in a readable unit. */
function quantity(value, unit, digits = 4) {
  if (value === null || value === undefined || !Number.isFinite(value)) return number(value);
  const [name, factor] = readable(value, unit);
  const written = number(value * factor, digits), [one, several] = PLURALS.find((both) => both.includes(name)) || [name, name];
  return written + (name ? `\u00a0${written === "1" ? one : several}` : "");
}

const percent = (part) => `${number(100 * part, 3)}\u00a0%`;

const CIVIDIS = [[0, 34, 78], [26, 56, 111], [66, 78, 108], [98, 101, 112], [125, 124, 120],
  [156, 148, 119], [189, 175, 110], [223, 203, 94], [254, 232, 56]];

/** Color of a part from 0 to 1: luminance grows with it, for any color vision. */
function cividis(part) {
  const at = Math.min(1, Math.max(0, part)) * (CIVIDIS.length - 1);
  const low = Math.min(Math.floor(at), CIVIDIS.length - 2);
  return CIVIDIS[low].map((from, i) => Math.round(from + (at - low) * (CIVIDIS[low + 1][i] - from)));
}
