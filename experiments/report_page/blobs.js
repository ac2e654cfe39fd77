// The data of the report. Unpacks images from the page's text: base64, zlib, half floats (experiments/report/report_pictures.h packs them).
const data = JSON.parse(document.getElementById("report-data").textContent);
const unpacked = new Map();

// The value of each of the 65536 half floats.
const halves = new Float32Array(65536);
for (let bits = 0; bits < 65536; ++bits) {
  const sign = bits & 0x8000 ? -1 : 1;
  const exponent = (bits >> 10) & 31;
  const mantissa = bits & 1023;
  if (exponent === 31) halves[bits] = mantissa ? NaN : sign * Infinity;
  else if (exponent === 0) halves[bits] = sign * mantissa * 2 ** -24;
  else halves[bits] = sign * (1 + mantissa / 1024) * 2 ** (exponent - 15);
}

async function inflate(id) {
  const stream = new Blob([bytesOf(id)]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Undoes the differences to the left neighbour, in place. */
function undoDifferences(bytes, width) {
  for (let i = 0; i < bytes.length; ++i) if (i % width > 0) bytes[i] += bytes[i - 1];
}

async function unpack(blob) {
  const {width, height, channels} = blob;
  const count = width * height;
  const bytes = await inflate(blob.id);
  if (blob.bytes) {
    undoDifferences(bytes, width);
    return {width, height, channels, values: Float32Array.from(bytes, (byte) => byte / 255)};
  }
  const values = new Float32Array(count * channels);
  const scale = 2 ** -blob.exponent;
  for (let c = 0; c < channels; ++c) {
    const high = bytes.subarray(c * count, (c + 1) * count);
    const low = bytes.subarray((channels + c) * count, (channels + c + 1) * count);
    undoDifferences(high, width);
    for (let i = 0; i < count; ++i) values[channels * i + c] = halves[(high[i] << 8) | low[i]] * scale;
  }
  return {width, height, channels, values};
}

/** A promise of {width, height, channels, values}: height x width x channels, row 0 on top. */
function imageOf(blob) {
  const key = `${blob.id} ${blob.exponent}`;
  if (!unpacked.has(key)) unpacked.set(key, unpack(blob));
  return unpacked.get(key);
}

/** Forgets all unpacked images but the newest 64. */
function forgetImages() {
  for (const key of [...unpacked.keys()].slice(0, -64)) unpacked.delete(key);
}
