"use strict";
// What is shown: a surface, the rows of its history, and its maps, as far as they have come.

const FREE = 0, KEPT = 1, NEW = 2, LOST = 3;

class Scene {
  constructor(buffer, { header, arrays }) {
    Object.assign(this, header);
    this.buffers = [buffer];
    this.heights = arrays.heights;
    [this.ny, this.nx] = header.shape;
    this.sites = this.ny * this.nx;
    this.nominal = this.ends ? this.heights.filter(Boolean).length : this.sites; // sites of the rough body
    this.rows = []; // one array a row, in the order of `columns`
    this.maps = [];
    this.lastTime = null;
    this.finished = null; // the message that says how it ended
    this.decoded = new Map();
  }

  add(buffer, { header, arrays }) {
    this.buffers.push(buffer);
    if (header.kind === "done") { this.finished = header; return; }
    const width = this.columns.length;
    const rows = arrays.rows || [];
    for (let at = 0; at < rows.length; at += width) this.rows.push(Array.from(rows.subarray(at, at + width)));
    for (const map of header.maps || []) {
      this.maps.push({ ...map, bits: arrays[`bits.${map.index}`], pressures: arrays[`pressure.${map.index}`], yielded: arrays[`yielded.${map.index}`] });
    }
    this.mapOfRow = new Map(this.maps.map((map, at) => [this.rowOf(at), map])); // rows that have a map
    this.lastTime = header.last_time ?? this.lastTime;
    this.timeNow = header.time_now ?? this.timeNow;
  }

  /** Take the rows for moments where no maps were kept. */
  doWithoutMaps() {
    this.mapless = true;
    this.maps = this.rows.map((_, row) => ({ index: row, time: this.value(row, "time"), leg: this.value(row, "leg"), area: this.value(row, "area"), pressure_scale: 0 }));
  }

  get isLine() { return this.ny === 1; }

  /** Whether a quantity is known at the times of the rows, or at those of the maps. */
  knows(name) { return this.columns.includes(name) || (!this.mapless && Boolean(this.map_columns?.includes(name))); }

  has(name) { return this.knows(name) && this.column(name).some(Number.isFinite); }

  value(row, name) {
    const at = this.columns.indexOf(name);
    if (this.map_columns?.includes(name)) return this.mapOfRow?.get(row)?.[name] ?? NaN;
    // With a shear strength it is the coefficient: strength times area (less rim) over load.
    if (name === "friction" && this.shear) {
      const area = this.columns.includes("contact_area_corrected") ? "contact_area_corrected" : "area";
      const strength = this.shear * (this.columns.includes("relative_strength") ? this.value(row, "relative_strength") : 1);
      const load = this.value(row, "load");
      return load > 0 ? strength * this.value(row, area) / load : NaN;
    }
    return at < 0 || !this.rows[row] ? NaN : this.rows[row][at];
  }

  column(name) { return this.rows.map((_, row) => this.value(row, name)); }

  /** The row of the same moment as a map: at a jump, of the same side. */
  rowOf(map) {
    const { time, leg } = this.maps[map];
    const same = [];
    this.rows.forEach((_, row) => { if (this.value(row, "time") === time) same.push(row); });
    const ofLeg = same.filter((row) => this.value(row, "leg") === leg);
    return (ofLeg.length ? ofLeg : same).at(-1) ?? -1;
  }

  /** Whether the rough body is there. */
  solid(site) { return !this.ends || this.heights[site] > 0; }

  height(site) {
    const [low, high] = this.height_range;
    return !this.solid(site) ? NaN : low + (high - low) * this.heights[site] / 65535;
  }

  /** Which sites touch in a map: one byte a site. The last few are kept. */
  contacts(map) {
    let found = this.decoded.get(map);
    if (!found) {
      const { bits } = this.maps[map];
      found = new Uint8Array(this.sites);
      if (bits) for (let at = 0; at < this.sites; at++) found[at] = (bits[at >> 3] >> (7 - (at & 7))) & 1;
      if (this.decoded.size > 6) this.decoded.delete([...this.decoded.keys()].find((key) => key !== 0));
      this.decoded.set(map, found);
    }
    return found;
  }

  touches(map, site) { return this.mapless ? 0 : (this.maps[map].bits[site >> 3] >> (7 - (site & 7))) & 1; }

  /** Whether the rough surface has yielded at a site by the time of a map. */
  yielded(map, site) { const bits = this.maps[map]?.yielded; return bits ? (bits[site >> 3] >> (7 - (site & 7))) & 1 : 0; }

  countYielded(map) { let found = 0; for (let at = 0; at < this.sites; at++) found += this.yielded(map, at); return found; }

  /** The map that states compare with: the first, or where that has no load the one up to which it rises. */
  get reference() {
    const load = this.maps.map((_, map) => this.value(this.rowOf(map), "load"));
    let at = 0;
    if (load[0] === 0) while (load[at + 1] > load[at] * (1 + 1e-9)) at++;
    return at;
  }

  /** When that was, in words. */
  get start() { return this.reference ? `t = ${quantity(this.maps[this.reference].time, this.units.time)}` : "first touch"; }

  /** Whether another scene is of the same surface, whatever it is called. */
  isOn(other) {
    return same([this.shape, this.height_range, this.units], [other.shape, other.height_range, other.units]) && this.heights.every((one, site) => one === other.heights[site]);
  }

  /** So many sites in words: their area, where that has a unit. */
  extent(sites, digits = 4) {
    return this.cell ? quantity(sites * this.cell, this.units.area, digits) : quantity(sites, "sites", 9);
  }

  /** Pressures between which colors tell apart in a map: all but the least 2 %, as in pictures. */
  pressureRange(map) {
    const { pressures, pressure_scale: top } = this.maps[map], rising = Uint16Array.from(pressures || []).sort();
    const low = Math.max(1, rising[Math.floor(0.02 * (rising.length - 1))] || 1) * top / 65535;
    return [low < top ? low : top / 2, top || 1];
  }

  state(map, site) { return this.states(map).states[site]; }

  /** State of each site in a map, compared with that of reference, and how many sites have each. */
  states(map) {
    const { reference } = this, lost = map < reference ? FREE : LOST;
    if (this.classified?.map === map && this.classified.reference === reference) return this.classified;
    const first = this.contacts(reference), now = this.contacts(map);
    const states = new Uint8Array(this.sites), counts = [0, 0, 0, 0];
    for (let at = 0; at < this.sites; at++) counts[states[at] = now[at] ? (first[at] ? KEPT : NEW) : first[at] ? lost : FREE]++;
    return (this.classified = { map, reference, states, counts });
  }

  /** Pressure of each site in a map, 0 where nothing touches. */
  pressures(map) {
    const { pressures, pressure_scale: scale } = this.maps[map];
    const now = this.contacts(map), found = new Float32Array(this.sites);
    for (let at = 0, next = 0; at < this.sites; at++) if (now[at]) found[at] = scale * pressures[next++] / 65535;
    return found;
  }

  pressure(map, site) {
    if (!this.touches(map, site)) return 0;
    const now = this.contacts(map);
    let rank = 0;
    for (let at = 0; at < site; at++) rank += now[at];
    return this.maps[map].pressure_scale * this.maps[map].pressures[rank] / 65535;
  }

  /** The first map of the present unbroken contact of a site, or of its present absence. */
  since(map, site) {
    const now = this.touches(map, site);
    let first = map;
    while (first > 0 && this.touches(first - 1, site) === now) first--;
    return first;
  }

  /** Time since which each site has been in contact, -1 where nothing touches. */
  beginnings(map) {
    const found = new Float32Array(this.sites).fill(-1), now = this.contacts(map);
    for (let at = 0; at < this.sites; at++) if (now[at]) found[at] = this.maps[this.since(map, at)].time;
    return found;
  }

  /** What a site does in a map, in words. */
  describe(map, site) {
    const [row, column] = [Math.floor(site / this.nx), site % this.nx];
    const time = (at) => quantity(this.maps[at].time, this.units.time);
    const parts = [this.isLine ? `site ${column}` : `row ${row}, column ${column}`];
    if (this.spacing && this.length_unit) {
      const [dy, dx] = this.spacing;
      const along = quantity(column * dx, this.length_unit);
      parts.push(this.isLine ? `x ${along}` : `x ${along}, y ${quantity(row * dy, this.length_unit)}`);
    }
    parts.push(`height ${quantity(this.height(site), this.units.height)}`);
    if (this.mapless) return parts.join(" · ");
    if (this.yielded(map, site)) parts.push("has yielded");
    const since = this.since(map, site);
    if (this.touches(map, site)) {
      parts.push(`pressure ${quantity(this.pressure(map, site), this.units.pressure)}`);
      if (since === 0) parts.push(map ? `in contact since first touch: age ${time(map)}` : "in contact at first touch");
      else parts.push(`new between t = ${time(since - 1)} and ${time(since)}: age ${quantity(this.maps[map].time - this.maps[since].time, this.units.time)}`);
    } else parts.push(since === 0 ? "never in contact so far" : `contact lost between t = ${time(since - 1)} and ${time(since)}`);
    return parts.join(" · ");
  }
}
