// Colours of values. All are sRGB, and bright enough for the dark ground of the stage.

const POWER_STOPS = ["#6a5cf0", "#b04fd0", "#ea5a93", "#fb8d62", "#fbc85e", "#fdf7c0"];
const BOUNCE_COLORS = [
  "#ffe27a", "#ff9d4d", "#ff5f7e", "#d163e6", "#8b7bff", "#4fa8ff", "#3fd0c9", "#7fd66b", "#a9b2bd",
];

function bytesOfHex(hex) {
  return [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
}

/// The colour at t in [0, 1] between evenly spaced stops.
function between(stops, t) {
  const at = Math.min(Math.max(t, 0), 1) * (stops.length - 1);
  const i = Math.min(Math.floor(at), stops.length - 2);
  const from = bytesOfHex(stops[i]), to = bytesOfHex(stops[i + 1]);
  return from.map((v, k) => Math.round(v + (at - i) * (to[k] - v)));
}

/// A linear value in [0, 1] as sRGB in [0, 255] (IEC 61966-2-1).
function srgbByte(v) {
  const c = Math.min(Math.max(v, 0), 1);
  return Math.round(255 * (c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055));
}

const cssColor = (bytes) => `rgb(${bytes.join(" ")})`;

/// One row of colours as a texture without interpolation.
function rowTexture(colors) {
  const bytes = new Uint8Array(colors.length * 4);
  colors.forEach((color, i) => bytes.set([...color, 255], 4 * i));
  const texture = new THREE.DataTexture(bytes, colors.length, 1);
  texture.needsUpdate = true;
  return texture;
}
