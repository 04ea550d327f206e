"use strict";
// Messages between server and page, and the same messages within an exported page.

const ARRAYS = { f8: Float64Array, f4: Float32Array, u2: Uint16Array, u1: Uint8Array, i4: Int32Array };

const padded = (length) => Math.ceil(length / 8) * 8;

/** Read a message: uint32 length of the header, the header in JSON, and the arrays, each at a multiple of 8. */
function readMessage(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  const start = padded(4 + length);
  const arrays = {};
  for (const { name, dtype, shape, offset } of header.arrays || []) {
    const count = shape.reduce((a, b) => a * b, 1);
    arrays[name] = new ARRAYS[dtype](buffer, start + offset, count);
  }
  return { header, arrays };
}

/** Put messages one after the other, each behind its length (uint64), compressed, as text for an exported page. */
async function packMessages(buffers) {
  const parts = buffers.flatMap((buffer) => [new BigUint64Array([BigInt(buffer.byteLength)]), buffer]);
  const stream = new Blob(parts).stream().pipeThrough(new CompressionStream("gzip"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  const pieces = [];
  for (let at = 0; at < bytes.length; at += 0x6000) {
    pieces.push(btoa(String.fromCharCode(...bytes.subarray(at, at + 0x6000))));
  }
  return pieces.join("");
}

/** Take apart what `packMessages`, or the command line, made. */
async function unpackMessages(text) {
  const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  const all = await new Response(stream).arrayBuffer();
  const buffers = [];
  for (let at = 0; at < all.byteLength;) {
    const length = Number(new DataView(all).getBigUint64(at, true));
    buffers.push(all.slice(at + 8, at + 8 + length));
    at += 8 + length;
  }
  return buffers;
}
