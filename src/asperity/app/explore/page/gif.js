"use strict";
// Animated pictures: the GIF89a format, with a palette of the colors that occur most (CompuServe, 1990).

/** Choose at most 64 colors of some frames, and a function that gives each pixel its number. */
function paletteOf(frames) {
  const found = new Map();
  for (const { data } of frames) {
    for (let at = 0; at < data.length; at += 4) {
      const color = (data[at] << 16) | (data[at + 1] << 8) | data[at + 2];
      found.set(color, (found.get(color) || 0) + 1);
    }
  }
  const colors = [...found].sort((a, b) => b[1] - a[1]).slice(0, 64).map(([color]) => [color >> 16, (color >> 8) & 255, color & 255]);
  const known = new Map();
  const indexOf = (red, green, blue) => {
    const color = (red << 16) | (green << 8) | blue;
    let best = known.get(color);
    if (best === undefined) {
      let least = Infinity;
      colors.forEach(([r, g, b], index) => {
        const apart = (r - red) ** 2 + (g - green) ** 2 + (b - blue) ** 2;
        if (apart < least) [least, best] = [apart, index];
      });
      known.set(color, best);
    }
    return best;
  };
  return { colors, indexOf };
}

/** Compress the numbers of colors: LZW with codes that grow from `bits` + 1 to 12 bits, in blocks of 255 bytes. */
function compressed(indices, bits) {
  const bytes = [], clear = 1 << bits;
  let buffer = 0, filled = 0, size = bits + 1, next = clear + 2, table = new Map();
  const put = (code) => {
    buffer |= code << filled;
    for (filled += size; filled >= 8; filled -= 8) { bytes.push(buffer & 255); buffer >>>= 8; }
  };
  put(clear);
  let prefix = indices[0];
  for (let at = 1; at < indices.length; at++) {
    const key = (prefix << 8) | indices[at], longer = table.get(key);
    if (longer !== undefined) { prefix = longer; continue; }
    put(prefix);
    if (next < 4096) {
      if (next === 1 << size) size++;
      table.set(key, next++);
    } else {
      put(clear);
      [size, next, table] = [bits + 1, clear + 2, new Map()];
    }
    prefix = indices[at];
  }
  put(prefix);
  // The decoder has one entry more than the encoder by now, and may have grown its codes.
  if (next === 1 << size && size < 12) size++;
  put(clear + 1);
  if (filled) bytes.push(buffer & 255);
  const blocks = [bits];
  for (let at = 0; at < bytes.length; at += 255) {
    const block = bytes.slice(at, at + 255);
    blocks.push(block.length, ...block);
  }
  blocks.push(0);
  return blocks;
}

/**
 * Write an animation. `frame(number)` gives an ImageData, all of one size; `delays` are in seconds. The animation repeats.
 */
async function animation(frame, delays, told = () => {}) {
  const last = delays.length - 1;
  const first = frame(0), { width, height } = first;
  const { colors, indexOf } = paletteOf([first, frame(last >> 1), frame(last)]);
  const bits = 6, word = (value) => [value & 255, value >> 8];
  const table = Array.from({ length: 3 << bits }, (_, at) => colors[Math.floor(at / 3)]?.[at % 3] ?? 0);
  const parts = [new Uint8Array([...new TextEncoder().encode("GIF89a"), ...word(width), ...word(height), 0xf0 | (bits - 1), 0, 0, ...table,
    0x21, 0xff, 11, ...new TextEncoder().encode("NETSCAPE2.0"), 3, 1, 0, 0, 0])];
  for (const [at, delay] of delays.entries()) {
    const { data } = frame(at), indices = new Uint8Array(width * height);
    for (let i = 0; i < indices.length; i++) indices[i] = indexOf(data[4 * i], data[4 * i + 1], data[4 * i + 2]);
    parts.push(new Uint8Array([0x21, 0xf9, 4, 4, ...word(Math.round(100 * delay)), 0, 0,
      0x2c, 0, 0, 0, 0, ...word(width), ...word(height), 0, ...compressed(indices, bits)]));
    told((at + 1) / delays.length);
    await new Promise((done) => setTimeout(done));
  }
  parts.push(new Uint8Array([0x3b]));
  return new Blob(parts, { type: "image/gif" });
}
