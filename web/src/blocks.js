// The inverse of cli/report_blocks.c: base64, inflate, planes of bytes, differences.

function fromBase64(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const binary = atob(text), bytes = new Uint8Array(binary.length);
  for (let i = 0; i < bytes.length; i++) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

async function inflate(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Reads the arrays of a block in the order in which they were written.
class Reader {
  constructor(bytes) {
    this.bytes = bytes;
    this.at = 0;
  }

  take(count) {
    if (this.at + count > this.bytes.length) throw new Error("a block of the page is too short");
    this.at += count;
    return this.bytes.subarray(this.at - count, this.at);
  }

  done() {
    if (this.at !== this.bytes.length) throw new Error("a block of the page is too long");
  }

  bytesOf(count) {
    return this.take(count).slice();
  }

  shorts(count) {
    const b = this.take(2 * count), out = new Uint16Array(count);
    for (let i = 0; i < count; i++) out[i] = b[i] | (b[count + i] << 8);
    return out;
  }

  words(count) {
    const b = this.take(4 * count), out = new Uint32Array(count), c2 = 2 * count, c3 = 3 * count;
    for (let i = 0; i < count; i++) out[i] = b[i] | (b[count + i] << 8) | (b[c2 + i] << 16) | (b[c3 + i] << 24);
    return out;
  }

  floats(count) {
    return new Float32Array(this.words(count).buffer);
  }

  indices(count) {
    const out = this.words(count);
    let before = 0;
    for (let i = 0; i < count; i++) {
      const word = out[i];
      before = (before + ((word >>> 1) ^ -(word & 1))) >>> 0;
      out[i] = before;
    }
    return out;
  }
}

export function hasBlock(id) {
  return document.getElementById(id) !== null;
}

// Reads a block, waiting for the page where it is not there yet; its text is let go of where it is not needed again.
export async function readBlock(id, forget = true) {
  if (!document.getElementById(id) && document.readyState === "loading")
    await new Promise((parsed) => document.addEventListener("DOMContentLoaded", parsed, { once: true }));
  const element = document.getElementById(id);
  if (!element) throw new Error(`the page has no block ${id}`);
  const bytes = fromBase64(element.textContent);
  if (forget) element.textContent = "";
  return new Reader(await inflate(bytes));
}

export function readFacts() {
  return JSON.parse(document.getElementById("facts").textContent);
}
