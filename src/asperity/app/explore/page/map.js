"use strict";
// The map of the contact on a canvas: colors, zoom, and a cursor that reads a site. A line contact is drawn as position
// across and time downward, one row a map.

const STATES = ["free", "kept", "new", "lost"];
const siteWords = ({ start }) => [null, `in contact now and at ${start}`, `new: not in contact at ${start}`, `lost: in contact only at ${start}`];

const BELOW = 22; // pixels below a map, for its scale bar

/** The colors of the page, as they are now: light or dark. */
function theme() {
  const style = getComputedStyle(document.documentElement);
  const of = (name) => style.getPropertyValue(`--${name}`).trim();
  const rgb = (name) => of(name).match(/[0-9a-f]{2}/gi).map((pair) => parseInt(pair, 16));
  return { of, rgb, dark: of("scheme") === "dark", states: STATES.map(rgb), yielded: rgb("yielded") };
}

const CROWDED = 0.12; // part of a map up to which marks may be larger than their sites

/**
 * Which cells are marked, given how many of their `size` sites are. Where few are, all cells with any: no contact is lost.
 * Where cells of this kind would fill more than `CROWDED`, so many that the marked area is the true one: those with more
 * sites than an even pattern of thresholds, the same in all maps. A cell full of contact is always marked.
 */
function markedCells(counts, wide, size) {
  let sites = 0, covered = 0;
  for (const one of counts) { sites += one; covered += one > 0; }
  const wanted = Math.round(Math.max(sites / size, Math.min(covered, CROWDED * counts.length)));
  if (wanted >= covered) return { marked: counts, crowded: false };
  // The pattern: multiples of the powers of the plastic number, which fill the unit interval evenly.
  const parts = counts.map((one, cell) => one / size / (1 - (0.7548776662466927 * (cell % wide) + 0.5698402909980532 * Math.floor(cell / wide)) % 1));
  const least = Math.min(1, parts.filter((part) => part > 0).sort().at(-Math.max(1, wanted)));
  return { marked: parts.map((part) => part >= least), crowded: true };
}

/** Colors of cells of `side` x `side` sites, RGBA, and whether there are fewer marks than cells with contact. */
function cellsOf(scene, map, wanted, side, colors) {
  const colored = scene.mapless ? "heights" : wanted;
  const rows = scene.isLine ? scene.maps.length : scene.ny;
  const down = scene.isLine ? 1 : side;
  const [wide, high] = [Math.ceil(scene.nx / side), Math.ceil(rows / down)];
  const cells = new ImageData(wide, high), pixels = cells.data;
  const paint = (cell, [red, green, blue]) => {
    pixels[4 * cell] = red; pixels[4 * cell + 1] = green; pixels[4 * cell + 2] = blue; pixels[4 * cell + 3] = 255;
  };
  const shade = (part) => cividis(colors.dark ? 0.25 + 0.75 * part : 0.8 * (1 - part));
  const solid = new Uint8Array(wide * high), sums = new Float64Array(3 * wide * high), counts = new Float64Array(wide * high);
  let values, low, top; // of the map that is being gathered
  for (let row = 0; row < rows; row++) {
    const shown = scene.isLine ? row : map;
    if (row === 0 || scene.isLine) prepare(shown);
    const from = scene.isLine ? 0 : row * scene.nx, to = Math.floor(row / down) * wide;
    for (let column = 0; column < scene.nx; column++) gather(from + column, to + Math.floor(column / side), shown);
  }
  function prepare(which) {
    if (colored === "state") values = scene.states(which).states;
    else if (colored === "pressure") { values = scene.pressures(which); [low, top] = scene.pressureRange(which); }
    else if (colored === "age") { values = scene.beginnings(which); top = Math.log1p(scene.maps[which].time / oldest(scene)) || 1; }
    else values = scene.heights;
  }
  function gather(site, cell, shown) {
    if (!scene.solid(scene.isLine ? site % scene.nx : site)) return;
    const value = values[site], at = 3 * cell;
    solid[cell] = 1;
    if (colored !== "heights") counts[cell] += colored === "age" ? value >= 0 : value > 0;
    if (colored === "state") { if (value) sums[at + value - 1] += 1; }
    else if (colored === "pressure") sums[at] = Math.max(sums[at], value > low ? Math.log(value / low) / Math.log(top / low) : 0);
    else if (colored === "age") sums[at] = Math.max(sums[at], value < 0 ? 0 : 1 + 1e-9 - Math.log1p(value / oldest(scene)) / top);
    else { sums[at] += value / 65535; sums[at + 1] += 1; sums[at + 2] += scene.yielded(shown, site); }
  }
  const { marked, crowded } = markedCells(counts, wide, side * down);
  for (let cell = 0; cell < wide * high; cell++) {
    const [a, b, c] = [sums[3 * cell], sums[3 * cell + 1], sums[3 * cell + 2]];
    if (!solid[cell]) continue;
    if (colored === "heights") paint(cell, c ? colors.yielded : cividis(a / b));
    else if (!marked[cell]) paint(cell, colors.states[FREE]);
    else if (colored === "state") paint(cell, colors.states[c && c >= b && c >= a ? LOST : b && b >= a ? NEW : KEPT]);
    else paint(cell, shade(a));
  }
  return { cells, crowded };
}

/** The time from which beginnings are told apart by color: the first that was recorded. */
const oldest = (scene) => scene.maps.find((map) => map.time > 0)?.time || 1;

class MapView {
  constructor(canvas) {
    this.canvas = canvas;
    this.scene = null;
    this.map = 0;
    this.colored = "state";
    this.zoom = 1; // 1: the whole map
    this.center = [0.5, 0.5]; // parts of the map
    this.cursor = null; // a site
    this.cells = { key: "", canvas: document.createElement("canvas") };
    this.pointers = new Map();
    this.onread = () => {};
    this.listen();
  }

  show(scene, map) {
    const other = !same(scene.shape, this.scene?.shape);
    Object.assign(this, { scene, map });
    if (other) { this.cursor = null; this.whole(); } else this.draw();
  }

  whole() { this.zoom = 1; this.center = [0.5, 0.5]; this.draw(); }

  /** Sites across and down, and how much taller than wide one is drawn. */
  get extent() {
    const { nx, ny, maps, spacing, isLine } = this.scene;
    return isLine ? [nx, maps.length, 1] : [nx, ny, spacing ? spacing[0] / spacing[1] : 1];
  }

  /** Where the map lies in a box: left, top, and width and height of a site. */
  frame(width, height) {
    const [nx, ny, aspect] = this.extent;
    let across = width / nx, down = height / ny;
    if (!this.scene.isLine) down = (across = Math.min(across, height / (ny * aspect))) * aspect;
    across *= this.zoom;
    if (!this.scene.isLine) down *= this.zoom;
    const held = (center, size, room) => size <= room ? (room - size) / 2 : Math.min(0, Math.max(room - size, room / 2 - center * size));
    return { left: held(this.center[0], across * nx, width), top: held(this.center[1], down * ny, height), across, down };
  }

  /** Paint the map and a scale bar below it into a box of another canvas, or of the own one. */
  paint(context, width, whole, map = this.map) {
    const height = whole - BELOW;
    const { left, top, across, down } = this.frame(width, height);
    const [nx, ny] = this.extent, colors = theme();
    const side = Math.max(1, Math.ceil(1 / across - 1e-9));
    const key = [this.scene.job, this.scene.rows.length, this.scene.isLine ? "" : map, this.colored, side, colors.dark].join();
    if (this.cells.key !== key || this.cells.scene !== this.scene) {
      const { cells, crowded } = cellsOf(this.scene, map, this.colored, side, colors);
      this.cells.canvas.width = cells.width;
      this.cells.canvas.height = cells.height;
      this.cells.canvas.getContext("2d").putImageData(cells, 0, 0);
      Object.assign(this.cells, { key, scene: this.scene, crowded });
    }
    const high = this.scene.isLine ? 1 : side;
    context.save();
    context.beginPath();
    context.rect(0, 0, width, whole);
    context.clip();
    context.fillStyle = colors.of("page");
    context.fillRect(0, 0, width, whole);
    context.fillStyle = colors.of("free");
    context.fillRect(left, top, across * nx, down * ny);
    context.imageSmoothingEnabled = false;
    context.beginPath();
    context.rect(Math.max(left, 0), Math.max(top, 0), Math.min(across * nx, width), Math.min(down * ny, height));
    context.clip();
    context.drawImage(this.cells.canvas, left, top, this.cells.canvas.width * across * side, this.cells.canvas.height * down * high);
    context.restore();
    context.strokeStyle = colors.of("line");
    context.strokeRect(Math.max(left, 0) + 0.5, Math.max(top, 0) + 0.5, Math.min(across * nx, width) - 1, Math.min(down * ny, height) - 1);
    if (this.scene.isLine) this.markRow(context, { left, top, across, down }, width, map, colors);
    this.scaleBar(context, width, height, across, Math.max(left, 0), colors);
    return { left, top, across, down, side, crowded: this.cells.crowded };
  }

  markRow(context, { top, down }, width, map, colors) {
    context.strokeStyle = colors.of("accent");
    context.lineWidth = 2;
    context.strokeRect(1, top + map * down, width - 2, Math.max(down, 2));
    context.lineWidth = 1;
  }

  scaleBar(context, width, height, across, left, colors) {
    const { spacing, length_unit: unit } = this.scene;
    const inUnits = spacing && unit;
    const pixel = inUnits ? spacing.at(-1) : 1;
    const [name, factor] = inUnits ? readable(0.3 * width / across * pixel, unit) : ["sites", 1];
    const longest = 0.3 * width / across * pixel * factor;
    const power = 10 ** Math.floor(Math.log10(longest));
    const length = Math.max(...[1, 2, 5].map((digit) => digit * power).filter((one) => one <= longest * 1.0001));
    const wide = length / factor / pixel * across, text = `${number(length)} ${name}`;
    if (!(wide > 0)) return;
    context.font = "12px system-ui, sans-serif";
    context.fillStyle = colors.of("ink");
    context.fillRect(left, height + 10, wide, 3);
    context.textAlign = "left";
    context.textBaseline = "middle";
    context.fillText(text, left + wide + 8, height + 12);
  }

  draw() {
    const { canvas } = this;
    const width = canvas.clientWidth;
    if (!this.scene || !this.scene.maps.length || !width) return;
    const [nx, ny, aspect] = this.extent;
    const seen = Math.max(280, 0.75 * innerHeight); // no more than fits on the screen
    const height = this.scene.isLine ? 340 : Math.round(Math.min(seen, width * Math.min(1.3, Math.max(0.4, aspect * ny / nx))));
    const scale = window.devicePixelRatio || 1;
    if (canvas.width !== Math.round(width * scale) || canvas.height !== Math.round((height + BELOW) * scale)) {
      canvas.width = Math.round(width * scale);
      canvas.height = Math.round((height + BELOW) * scale);
      canvas.style.height = `${height + BELOW}px`;
    }
    const context = canvas.getContext("2d");
    context.setTransform(scale, 0, 0, scale, 0, 0);
    this.box = { width, height };
    this.drawn = this.paint(context, width, height + BELOW);
    this.side = this.drawn.side;
    canvas.classList.toggle("zoomed", this.zoom > 1);
    if (this.cursor !== null) this.drawCursor(context);
  }

  drawCursor(context) {
    const { left, top, across, down } = this.drawn;
    const row = this.scene.isLine ? this.map : Math.floor(this.cursor / this.scene.nx);
    const side = Math.max(across, 9), high = this.scene.isLine ? down : Math.max(down, 9);
    const x = left + (this.cursor % this.scene.nx + 0.5) * across, y = top + (row + 0.5) * down;
    for (const [width, color] of [[4, "page"], [2, "accent"]]) {
      context.lineWidth = width;
      context.strokeStyle = theme().of(color);
      context.strokeRect(x - side / 2 - 1, y - high / 2 - 1, side + 2, high + 2);
    }
    context.lineWidth = 1;
  }

  /** The site at a point of the canvas, and for a line contact the map; null outside. */
  at(x, y) {
    const { left, top, across, down } = this.drawn, [nx, ny] = this.extent;
    const [column, row] = [Math.floor((x - left) / across), Math.floor((y - top) / down)];
    if (column < 0 || row < 0 || column >= nx || row >= ny) return null;
    return this.scene.isLine ? { site: column, map: row } : { site: row * nx + column, map: this.map };
  }

  /** Zoom by a factor about a point of the canvas, which stays where it is. */
  magnify(factor, x = this.box.width / 2, y = this.box.height / 2) {
    if (!this.drawn) return;
    const before = this.drawn, [nx, ny] = this.extent;
    const part = [(x - before.left) / (before.across * nx), (y - before.top) / (before.down * ny)];
    const most = Math.max(1, 48 / (before.across / this.zoom));
    this.zoom = Math.min(most, Math.max(1, this.zoom * factor));
    const after = this.frame(this.box.width, this.box.height);
    this.center = [part[0] + (this.box.width / 2 - x) / (after.across * nx), part[1] + (this.box.height / 2 - y) / (after.down * ny)];
    this.settle();
  }

  move(dx, dy) {
    const { across, down } = this.drawn, [nx, ny] = this.extent;
    this.center = [this.center[0] - dx / (across * nx), this.center[1] - dy / (down * ny)];
    this.settle();
  }

  /** Keep the center where the map fills the box. */
  settle() {
    const { across, down } = this.frame(this.box.width, this.box.height), [nx, ny] = this.extent;
    const held = (center, size, room) => size <= room ? 0.5 : Math.min(1 - room / 2 / size, Math.max(room / 2 / size, center));
    this.center = [held(this.center[0], across * nx, this.box.width), held(this.center[1], down * ny, this.box.height)];
    this.draw();
  }

  read(site, map = this.map) {
    this.cursor = site;
    this.draw();
    this.onread(site, map);
  }

  step(columns, rows) {
    const { nx, ny, isLine } = this.scene, at = this.cursor ?? Math.floor(ny / 2) * nx + Math.floor(nx / 2);
    const column = Math.min(nx - 1, Math.max(0, at % nx + columns));
    const row = isLine ? 0 : Math.min(ny - 1, Math.max(0, Math.floor(at / nx) + rows));
    this.goTo(row * nx + column);
  }

  jump(direction) {
    const now = this.scene.contacts(this.map), { sites } = this.scene;
    let at = this.cursor ?? (direction > 0 ? -1 : sites);
    for (let tries = 0; tries < sites; tries++) {
      at = (at + direction + sites) % sites;
      if (now[at]) { this.goTo(at); return; }
    }
  }

  /** Put the cursor on a site, and bring it into view. */
  goTo(site) {
    const { nx, ny, isLine } = this.scene;
    if (this.zoom > 1) {
      const { left, top, across, down } = this.drawn;
      const x = left + (site % nx) * across, y = top + (isLine ? 0 : Math.floor(site / nx)) * down;
      if (x < 0 || x > this.box.width - across) this.center[0] = (site % nx + 0.5) / nx;
      if (!isLine && (y < 0 || y > this.box.height - down)) this.center[1] = (Math.floor(site / nx) + 0.5) / ny;
      this.settle();
    }
    this.read(site);
  }

  listen() {
    const { canvas, pointers } = this;
    const point = (event) => { const box = canvas.getBoundingClientRect(); return [event.clientX - box.left, event.clientY - box.top]; };
    canvas.addEventListener("wheel", (event) => {
      if (!this.drawn) return;
      event.preventDefault();
      this.magnify(2 ** (-event.deltaY / 300), ...point(event));
    }, { passive: false });
    canvas.addEventListener("pointerdown", (event) => {
      pointers.set(event.pointerId, point(event));
      if (this.zoom > 1 || pointers.size > 1) canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (!this.drawn) return;
      const now = point(event), before = pointers.get(event.pointerId);
      if (before && pointers.size === 2) {
        const other = [...pointers].find(([id]) => id !== event.pointerId)[1];
        const apart = (a) => Math.hypot(a[0] - other[0], a[1] - other[1]);
        this.magnify(apart(now) / Math.max(1, apart(before)), (now[0] + other[0]) / 2, (now[1] + other[1]) / 2);
      } else if (before && this.zoom > 1) this.move(now[0] - before[0], now[1] - before[1]);
      if (before) pointers.set(event.pointerId, now);
      const found = this.at(...now);
      if (found && pointers.size < 2) this.read(found.site, found.map);
    });
    for (const name of ["pointerup", "pointercancel", "pointerleave"]) canvas.addEventListener(name, (event) => pointers.delete(event.pointerId));
    canvas.addEventListener("dblclick", (event) => this.drawn && this.magnify(2, ...point(event)));
    canvas.addEventListener("keydown", (event) => {
      if (!this.drawn || event.ctrlKey || event.metaKey || event.altKey) return;
      const by = event.shiftKey ? 10 : 1;
      const keys = {
        ArrowLeft: () => this.step(-by, 0), ArrowRight: () => this.step(by, 0),
        ArrowUp: () => this.step(0, -by), ArrowDown: () => this.step(0, by),
        "+": () => this.closer(), "=": () => this.closer(), "-": () => this.magnify(1 / 1.5), 0: () => this.whole(),
        n: () => this.jump(1), p: () => this.jump(-1),
      };
      const found = keys[event.key] || keys[event.key.toLowerCase()];
      if (found) { event.preventDefault(); found(); }
    });
  }

  /** Zoom in, about the cursor where there is one in view. */
  closer() {
    if (this.cursor === null || this.scene.isLine) { this.magnify(1.5); return; }
    const { left, top, across, down } = this.drawn;
    const x = left + (this.cursor % this.scene.nx + 0.5) * across, y = top + (Math.floor(this.cursor / this.scene.nx) + 0.5) * down;
    const seen = x >= 0 && y >= 0 && x <= this.box.width && y <= this.box.height;
    this.magnify(1.5, ...(seen ? [x, y] : []));
  }

  /** The map in words, for those who do not see it. */
  inWords() {
    if (this.scene.mapless) return "No maps of the contact were kept; the heights are shown.";
    const { counts } = this.scene.states(this.map), touching = counts[KEPT] + counts[NEW];
    const size = this.scene.isLine ? `a line of ${count(this.scene.nx)} sites` : `${this.scene.ny} × ${this.scene.nx} sites`;
    return `Contact map: ${size}, ${this.scene.extent(touching)} in contact, ${percent(touching / this.scene.nominal)}, at t = `
      + `${quantity(this.scene.maps[this.map].time, this.scene.units.time)}: ${this.scene.extent(counts[KEPT])} since ${this.scene.start}, `
      + `${this.scene.extent(counts[NEW])} new, ${this.scene.extent(counts[LOST])} lost`
      + `${this.scene.maps[this.map].yielded ? `; the rough surface has yielded at ${this.scene.extent(this.scene.countYielded(this.map))}` : ""}.`;
  }
}
