"use strict";
// The axis of times. It begins with 0 = first touch, and is logarithmic in the time since the last change: each leg
// of a protocol is a piece of its own, so that the aging after a step is seen as well as that before it.

const ZERO = 0.45; // decades that the stretch from 0 to the first recorded time takes
const LINEAR = 30; // a piece whose times span less than this ratio, such as a ramp, is linear

class TimeAxis {
  constructor(times, legs, end = null) {
    this.pieces = [];
    let start = 0, from = 0;
    for (let at = 1; at <= times.length; at++) {
      if (at < times.length && legs[at] === legs[from]) continue;
      const spans = times.slice(from, at).map((time) => time - start).filter((span) => span > 1e-9 * start);
      if (spans.length) this.grow(start, spans);
      start = times[at - 1];
      from = at;
    }
    const piece = this.pieces.at(-1);
    if (!piece) this.grow(0, [1e-3, end || 1]);
    else if (end !== null && this.pieces.length === 1 && end > piece.last) { piece.last = end; piece.linear = false; }
    const weights = this.pieces.map((one) => (one.linear ? 1.5 : ZERO + Math.max(0.5, Math.log10(one.last / one.first))));
    const total = weights.reduce((a, b) => a + b, 0);
    let left = 0;
    this.pieces.forEach((one, i) => {
      one.weight = weights[i];
      one.left = left / total;
      one.right = (left += weights[i]) / total;
    });
  }

  grow(start, spans) {
    const [first, last] = [spans[0], spans.at(-1)];
    this.pieces.push({ start, first, last, linear: spans.length > 1 && last / first < LINEAR });
  }

  /** Where a moment lies, from 0 to 1; at a jump `after` tells the two sides apart. */
  place(time, after = false) {
    let piece = this.pieces[0];
    for (const one of this.pieces) if (time > one.start * (1 + 1e-12) || (after && time >= one.start * (1 - 1e-12))) piece = one;
    return piece.left + (piece.right - piece.left) * Math.min(1, this.within(piece, time - piece.start));
  }

  within(piece, span) {
    if (piece.linear) return Math.max(0, span) / piece.last;
    if (span <= piece.first) return (ZERO * Math.max(0, span) / piece.first) / piece.weight;
    return (ZERO + Math.log10(span / piece.first) * Math.max(0.5, Math.log10(piece.last / piece.first))
      / (Math.log10(piece.last / piece.first) || 1)) / piece.weight;
  }

  /** Ticks of a piece: place and label. */
  ticks(piece, room) {
    const at = (span) => piece.left + (piece.right - piece.left) * this.within(piece, span);
    const ticks = [{ place: piece.left, label: "0" }];
    if (piece.linear) ticks.push({ place: piece.right, label: number(piece.last, 2), end: true });
    else {
      const [low, high] = [Math.ceil(Math.log10(piece.first) - 1e-9), Math.floor(Math.log10(piece.last) + 1e-9)];
      const stride = Math.max(1, Math.ceil((high - low + 1) * 38 / (room * (piece.right - piece.left))));
      for (let power = high; power >= low; power -= 1) {
        ticks.push({ place: at(10 ** power), label: (high - power) % stride ? "" : powerOfTen(power) });
      }
    }
    return ticks;
  }
}

/** Round numbers that divide a range: about so many. */
function roundTicks(low, high, wanted = 5) {
  const rough = (high - low) / wanted, power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 2.5, 5, 10].find((digit) => digit * power >= rough * 0.999);
  const ticks = [];
  for (let at = Math.ceil(low / step - 1e-9); at * step <= high + 1e-9 * step; at++) ticks.push(Number((at * step).toPrecision(12)));
  return ticks;
}
