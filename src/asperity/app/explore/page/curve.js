"use strict";
// A quantity against time, with the moment shown, the limit, an earlier curve, and the moment of a change of load.

/** What a quantity is called, which the server says. */
const nameOf = (scene, name) => (name === "friction" && scene.shear ? "friction coefficient" : scene.labels[name]);

const mainArea = (scene) => (scene.has("contact_area") ? "contact_area" : "area");

const MARGIN = { left: 74, right: 14, top: 12, bottom: 44 };

class CurveView {
  constructor(canvas) {
    this.canvas = canvas;
    this.name = "";
    this.onpick = () => {};
    const pick = (event) => {
      if (!this.axis) return;
      const box = canvas.getBoundingClientRect();
      this.onpick((event.clientX - box.left - MARGIN.left) / (box.width - MARGIN.left - MARGIN.right));
    };
    canvas.addEventListener("pointerdown", (event) => { canvas.setPointerCapture(event.pointerId); pick(event); });
    canvas.addEventListener("pointermove", (event) => event.buttons && pick(event));
  }

  /** Show a scene: `extras` holds map, earlier (a scene), runs (other curves), and change (a time). */
  show(scene, extras) {
    this.scene = scene;
    this.extras = extras;
    this.axis = axisOf(scene);
    this.draw();
  }

  draw() {
    const { canvas } = this, width = canvas.clientWidth, height = canvas.clientHeight;
    if (!this.scene || !this.scene.rows.length || !width) return;
    const scale = window.devicePixelRatio || 1;
    canvas.width = Math.round(width * scale);
    canvas.height = Math.round(height * scale);
    const context = canvas.getContext("2d");
    context.setTransform(scale, 0, 0, scale, 0, 0);
    this.paint(context, width, height);
  }

  /** Places of the rows of a scene on the axis of the one shown. */
  points(scene, name) {
    const legs = scene.column("leg"), times = scene.column("time");
    return scene.column(name).map((value, row) => [this.axis.place(times[row], row > 0 && legs[row] !== legs[row - 1]), value]);
  }

  /**
   * Places of an earlier run on the axis of the one shown. Between its rows it goes straight on its own axis, so on this
   * one, which begins anew at a change of load, it is bent: points are put in at the times of the run shown.
   */
  pointsOf(earlier, name) {
    const { scene } = this, own = axisOf(earlier), last = scene.lastTime * (1 + 1e-9), found = [];
    const times = scene.column("time"), after = (row) => row > 0 && earlier.value(row, "leg") !== earlier.value(row - 1, "leg");
    earlier.rows.forEach((_, row) => {
      const [begin, end] = [row - 1, row].map((one) => earlier.value(one, "time")), [low, high] = [row - 1, row].map((one) => earlier.value(one, name));
      const between = row && !after(row) ? times.filter((time) => begin < time && time < end) : [];
      const [left, right] = [own.place(begin, row && after(row - 1)), own.place(end, after(row))];
      for (const time of between) found.push([time, low + (high - low) * (own.place(time) - left) / (right - left), false]);
      found.push([end, high, after(row)]);
    });
    return found.filter(([time, value]) => time <= last && Number.isFinite(value)).map(([time, value, jumped]) => [this.axis.place(time, jumped), value]);
  }

  paint(context, width, height, map = this.extras.map, handles = true) {
    const { scene, name, extras } = this, colors = theme();
    const [wide, high] = [width - MARGIN.left - MARGIN.right, height - MARGIN.top - MARGIN.bottom];
    const own = this.points(scene, name).filter(([, value]) => Number.isFinite(value));
    const others = (extras.runs || []).map((run) => run.map(([time, value]) => [this.axis.place(time), value]));
    const earlier = extras.earlier ? this.pointsOf(extras.earlier, name) : [];
    const limit = scene.finished?.limit?.[name] ?? NaN;
    const log = name === "residual";
    const [lower, upper] = ["_low", "_high"].map((end) => scene.columns.includes(name + end)
      ? this.points(scene, name + end).filter(([, value]) => Number.isFinite(value)) : []); // of the 95 % band
    let values = [...own, ...lower, ...upper, ...earlier, ...others.flat()].map(([, value]) => value);
    if (Number.isFinite(limit)) values.push(limit);
    if (log) values = values.filter((value) => value > 0);
    const [unit, factor] = readable(Math.max(...values.map(Math.abs)), scene.column_units[name]);
    const bend = log ? Math.log10 : (value) => value * factor;
    let low = Math.min(...values.map(bend)), top = Math.max(...values.map(bend));
    if (!values.length) [low, top] = [0, 1];
    const room = (top - low) * 0.06 || Math.abs(top) * 0.05 || 1;
    [low, top] = [low >= 0 && low - room < 0 && !log ? 0 : low - room, top + room];
    const x = (place) => MARGIN.left + place * wide;
    const y = (value) => MARGIN.top + high * (1 - (bend(log ? Math.max(value, 1e-300) : value) - low) / (top - low));
    Object.assign(this, { x, y });

    context.fillStyle = colors.of("page");
    context.fillRect(0, 0, width, height);
    context.font = "12px system-ui, sans-serif";
    context.textBaseline = "middle";
    context.lineWidth = 1;
    context.textAlign = "right";
    const marks = log ? roundTicks(low, top).filter(Number.isInteger) : roundTicks(low, top);
    for (const tick of marks) {
      const level = MARGIN.top + high * (1 - (tick - low) / (top - low));
      context.strokeStyle = colors.of("grid");
      line(context, [[MARGIN.left, level], [width - MARGIN.right, level]]);
      context.fillStyle = colors.of("ink");
      context.fillText(log ? powerOfTen(tick) : number(tick), MARGIN.left - 6, level);
    }
    this.times(context, colors, x, wide, high);
    context.save();
    context.translate(9, MARGIN.top + high / 2);
    context.rotate(-Math.PI / 2);
    context.textAlign = "center";
    const told = name === "area" ? "sites" : name === "decade_growth" ? `area at ${scene.start}` : unit;
    context.fillText(nameOf(scene, name) + (told ? ` [${told}]` : ""), 0, 0);
    context.restore();

    context.save();
    context.beginPath();
    context.rect(MARGIN.left, 0, wide + MARGIN.right, height);
    context.clip();
    context.strokeStyle = colors.of("muted");
    for (const run of others) line(context, run.map(([place, value]) => [x(place), y(value)]));
    context.setLineDash([2, 3]);
    line(context, earlier.map(([place, value]) => [x(place), y(value)]));
    if (Number.isFinite(limit)) {
      context.strokeStyle = colors.of("ink");
      context.setLineDash([7, 4]);
      line(context, [[MARGIN.left, y(limit)], [width - MARGIN.right, y(limit)]]);
      context.textAlign = "left";
      context.fillText("limit t → ∞", MARGIN.left + 6, y(limit) + (y(limit) < MARGIN.top + 20 ? 11 : -9));
    }
    context.setLineDash([]);
    context.strokeStyle = context.fillStyle = colors.of("curve");
    context.globalAlpha = 0.2;
    area(context, [...lower, ...upper.reverse()].map(([place, value]) => [x(place), y(value)]));
    context.globalAlpha = 1;
    context.lineWidth = 2;
    line(context, own.map(([place, value]) => [x(place), y(value)]));
    for (const [place, value] of own) disc(context, x(place), y(value), 2.2);
    context.lineWidth = 1;
    const entries = [["curve", lower.length ? "with its 95 % band" : "this run", []]];
    if (earlier.length) entries.push(["muted", earlierName(scene, extras.earlier), [2, 3]]);
    if (earlier.length || lower.length) this.legend(context, colors, entries, wide);
    if (handles && extras.change !== null) {
      context.strokeStyle = context.fillStyle = colors.of("ink");
      context.setLineDash([3, 3]);
      const at = x(this.axis.place(extras.change));
      line(context, [[at, MARGIN.top], [at, MARGIN.top + high]]);
      context.setLineDash([]);
      context.textAlign = at > width / 2 ? "right" : "left";
      context.fillText("change here", at + (at > width / 2 ? -5 : 5), MARGIN.top + high - 10);
    }
    const row = scene.maps[map] ? scene.rowOf(map) : -1;
    if (row >= 0) {
      const at = x(this.placeOf(map)), value = scene.value(row, name);
      context.strokeStyle = context.fillStyle = colors.of("accent");
      line(context, [[at, MARGIN.top], [at, MARGIN.top + high]]);
      if (Number.isFinite(value)) disc(context, at, y(value), 5);
    }
    context.restore();
  }

  /** Say which curve is which, in the upper left corner. */
  legend(context, colors, entries, wide) {
    const width = 34 + Math.max(...entries.map(([, text]) => context.measureText(text).width));
    context.fillStyle = colors.of("page");
    context.globalAlpha = 0.8;
    context.fillRect(MARGIN.left + 4, MARGIN.top, Math.min(width + 8, wide), 16 * entries.length + 6);
    context.globalAlpha = 1;
    context.textAlign = "left";
    entries.forEach(([color, text, dash], at) => {
      context.strokeStyle = context.fillStyle = colors.of(color);
      context.setLineDash(dash);
      line(context, [[MARGIN.left + 8, MARGIN.top + 11 + 16 * at], [MARGIN.left + 30, MARGIN.top + 11 + 16 * at]]);
      context.setLineDash([]);
      context.fillText(text, MARGIN.left + 36, MARGIN.top + 11 + 16 * at);
    });
  }

  times(context, colors, x, wide, high) {
    const floor = MARGIN.top + high, unit = readable(1, this.scene.units.time)[0];
    context.textAlign = "center";
    let free = -Infinity;
    for (const [index, piece] of this.axis.pieces.entries()) {
      context.strokeStyle = colors.of(index ? "muted" : "grid");
      if (index) line(context, [[x(piece.left), MARGIN.top], [x(piece.left), floor]]);
      context.fillStyle = colors.of("ink");
      for (const { place, label, end } of this.axis.ticks(piece, wide).sort((a, b) => a.place - b.place)) {
        context.strokeStyle = colors.of("muted");
        line(context, [[x(place), floor], [x(place), floor + (label ? 5 : 3)]]);
        const half = context.measureText(label).width / 2;
        if (label && x(place) - half > free && !(end && index < this.axis.pieces.length - 1)) {
          context.fillText(label, x(place), floor + 14);
          free = x(place) + half + 4;
        }
      }
      const said = index ? `time since t = ${quantity(piece.start, this.scene.units.time, 3)}` : `time since first touch${unit ? ` [${unit}]` : ""}`;
      const short = index ? "" : `time${unit ? ` [${unit}]` : ""}`;
      const room = (piece.right - piece.left) * wide - 8;
      const text = [said, short].find((one) => context.measureText(one).width <= room);
      if (text) context.fillText(text, x((piece.left + piece.right) / 2), floor + 32);
    }
    context.strokeStyle = colors.of("muted");
    line(context, [[MARGIN.left, MARGIN.top], [MARGIN.left, floor], [x(1), floor]]);
  }

  /** Where the moment of a map lies on the axis. */
  placeOf(map) {
    const { time, leg } = this.scene.maps[map];
    const row = this.scene.rowOf(map), before = row > 0 ? this.scene.value(row - 1, "leg") : leg;
    return this.axis.place(time, row > 0 && this.scene.value(row, "leg") !== before);
  }

  /** The map whose moment is nearest to a place of the axis. */
  nearest(place) {
    let best = 0;
    this.scene.maps.forEach((_, map) => { if (Math.abs(this.placeOf(map) - place) < Math.abs(this.placeOf(best) - place)) best = map; });
    return best;
  }
}

function axisOf(scene) {
  return new TimeAxis(scene.column("time"), scene.column("leg"), scene.finished || scene.config?.protocol?.length ? null : scene.lastTime);
}

/** What an earlier run is to the one shown: the same without its last change of load, or with other keys. */
function earlierName(scene, earlier) {
  const legs = (one) => one.config?.protocol?.length ?? 0;
  if (legs(scene) !== legs(earlier)) return `${legs(scene) > legs(earlier) ? "without" : "with"} the change`;
  const found = ["contact", "solid", "aging", "friction"].flatMap((section) => Object.entries(earlier.config?.[section] ?? {})
    .filter(([key, value]) => !same(value, scene.config?.[section]?.[key])).map(([key, value]) => `${key.replaceAll("_", " ")} ${legValue(key, value)}`));
  return found.length === 1 ? `with ${found[0]}` : "the run before";
}

function line(context, points) {
  context.beginPath();
  points.forEach(([x, y], at) => (at ? context.lineTo(x, y) : context.moveTo(x, y)));
  context.stroke();
}

function area(context, points) {
  context.beginPath();
  points.forEach(([x, y], at) => (at ? context.lineTo(x, y) : context.moveTo(x, y)));
  context.fill();
}

function disc(context, x, y, radius) {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.fill();
}
