// Pictures with a size on paper: PNG that states its density.

const ascii = text => new TextEncoder().encode(text);

// ISO 3309, as PNG has it.
function crc(bytes) {
  let sum = ~0;
  for (const byte of bytes) {
    sum ^= byte;
    for (let bit = 0; bit < 8; ++bit) sum = sum & 1 ? (sum >>> 1) ^ 0xEDB88320 : sum >>> 1;
  }
  return ~sum >>> 0;
}

// With a pHYs chunk behind the header: `dpi` pixels an inch.
export function withDensity(png, dpi) {
  const chunk = new DataView(new ArrayBuffer(21)), perMetre = Math.round(dpi / 0.0254), header = 33;
  chunk.setUint32(0, 9);
  ascii("pHYs").forEach((c, k) => chunk.setUint8(4 + k, c));
  chunk.setUint32(8, perMetre);
  chunk.setUint32(12, perMetre);
  chunk.setUint8(16, 1);  // to the metre
  chunk.setUint32(17, crc(new Uint8Array(chunk.buffer, 4, 13)));
  const out = new Uint8Array(png.length + 21);
  out.set(png.subarray(0, header));
  out.set(new Uint8Array(chunk.buffer), header);
  out.set(png.subarray(header), header + 21);
  return out;
}
