// Pictures with a size on paper: PNG that states its density, PDF of one page.

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

// One page (PDF 1.4) as large as the canvas at `dpi`: the parts of the file.
export async function pdfOf(canvas, dpi) {
  const {width, height} = canvas, rgba = canvas.getContext("2d").getImageData(0, 0, width, height).data;
  const rgb = new Uint8Array(3 * width * height);
  for (let i = 0, k = 0; i < rgba.length; i += 4) { rgb[k++] = rgba[i]; rgb[k++] = rgba[i + 1]; rgb[k++] = rgba[i + 2]; }
  const packed = new Uint8Array(await new Response(new Blob([rgb]).stream().pipeThrough(new CompressionStream("deflate"))).arrayBuffer());
  const w = (72 * width / dpi).toFixed(2), h = (72 * height / dpi).toFixed(2), page = `q ${w} 0 0 ${h} 0 0 cm /Im Do Q`;
  const objects = [
    ["<< /Type /Catalog /Pages 2 0 R >>"], ["<< /Type /Pages /Kids [3 0 R] /Count 1 >>"],
    [`<< /Type /Page /Parent 2 0 R /MediaBox [0 0 ${w} ${h}] /Resources << /XObject << /Im 4 0 R >> >> /Contents 5 0 R >>`],
    [`<< /Type /XObject /Subtype /Image /Width ${width} /Height ${height} /ColorSpace /DeviceRGB /BitsPerComponent 8 /Filter /FlateDecode /Length ${packed.length} >>\nstream\n`, packed, "\nendstream"],
    [`<< /Length ${page.length} >>\nstream\n${page}\nendstream`]];
  const parts = [], places = [];
  let length = 0;
  const put = part => { const bytes = typeof part === "string" ? ascii(part) : part; parts.push(bytes); length += bytes.length; };
  put("%PDF-1.4\n");
  objects.forEach((object, k) => {
    places.push(length);
    put(`${k + 1} 0 obj\n`);
    object.forEach(put);
    put("\nendobj\n");
  });
  const table = length;
  put(`xref\n0 ${objects.length + 1}\n0000000000 65535 f \n${places.map(at => `${String(at).padStart(10, "0")} 00000 n \n`).join("")}`);
  put(`trailer\n<< /Size ${objects.length + 1} /Root 1 0 R >>\nstartxref\n${table}\n%%EOF\n`);
  return parts;
}
