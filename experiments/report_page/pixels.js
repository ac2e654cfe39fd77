// Converts values to what a screen shows: exposure and sRGB's curve, colour scales, sums of components, errors.
const curveSteps = 16384;
const srgbCurve = Uint8Array.from({length: curveSteps + 1}, (_, i) => srgbByte(i / curveSteps));

/** The sRGB byte of a linear value. NaN is black here and magenta in maps. */
const shownByte = (v) => (v > 0 ? srgbCurve[Math.min(curveSteps, Math.round(v * curveSteps))] : 0);

const scaleTables = Object.fromEntries(Object.entries(data.scales).map(([name, scale]) =>
  [name, Array.from({length: 256}, (_, i) => scaleColor(scale, i / 255))]));

// False colours show luminances from 2^-8 to 2^4, once multiplied.
const falseColours = {low: -8, high: 4};
const tones = ["linear", "filmic", "false colour"];

/** ImageData of an image of radiance, whose values are multiplied by 2^stops, by one of the `tones`. */
function picture(image, stops, tone = "linear") {
  const factor = 2 ** stops;
  if (tone === "false colour") {
    const logs = new Float32Array(image.values.length / 3);
    for (let i = 0; i < logs.length; ++i) {
      const [r, g, b] = image.values.subarray(3 * i, 3 * i + 3);
      logs[i] = Math.log2(Math.max(factor * (0.212671 * r + 0.71516 * g + 0.072169 * b), 1e-30));
    }
    return colourMap({...image, values: logs}, "error", falseColours.low, falseColours.high);
  }
  // Narkowicz 2015, "ACES Filmic Tone Mapping Curve".
  const filmic = (v) => v * (2.51 * v + 0.03) / (v * (2.43 * v + 0.59) + 0.14);
  const out = new ImageData(image.width, image.height);
  for (let i = 0, o = 0; i < image.values.length; i += 3, o += 4) {
    for (let k = 0; k < 3; ++k) {
      const v = image.values[i + k] * factor;
      out.data[o + k] = shownByte(tone === "filmic" ? filmic(Math.max(v, 0)) : v);
    }
    out.data[o + 3] = 255;
  }
  return out;
}

/**
 * ImageData of an image with one value a pixel, in the colour scale `name` from `low` to `high`; grey where a value is
 * not larger than that of `halfWidth`, the half width of its interval.
 */
function colourMap(image, name, low, high, halfWidth = null) {
  const out = new ImageData(image.width, image.height);
  for (let i = 0, o = 0; i < image.values.length; ++i, o += 4) {
    const t = (image.values[i] - low) / (high - low);
    const isUnknown = halfWidth && Math.abs(image.values[i]) <= halfWidth.values[i];
    const color = isUnknown ? [128, 128, 128] : Number.isNaN(t) ? [255, 0, 255] : scaleTables[name][Math.round(255 * clamped(t, 0, 1))];
    for (let k = 0; k < 3; ++k) out.data[o + k] = color[k];
    out.data[o + 3] = 255;
  }
  return out;
}

/** Draws ImageData into a canvas of the page. */
function paint(canvas, shown) {
  canvas.width = shown.width;
  canvas.height = shown.height;
  canvas.getContext("2d").putImageData(shown, 0, 0);
}

/** The sum of images of one size. */
function sumOf(images) {
  const values = new Float32Array(images[0].values);
  for (const image of images.slice(1)) for (let i = 0; i < values.length; ++i) values[i] += image.values[i];
  return {...images[0], values};
}

/** The errors of pixels: the mean over the channels of the difference d, t being the reference's total. */
const errorKinds = {
  "relative": (d, t, epsilon) => Math.abs(d) / Math.sqrt(t ** 2 + epsilon),
  "relative, squared": (d, t, epsilon) => d ** 2 / (t ** 2 + epsilon),
  "absolute": (d) => Math.abs(d),
};
const errorNames = Object.keys(errorKinds);

function errorOf(x, r, total, epsilon, kind = "relative") {
  const values = new Float32Array(x.width * x.height);
  for (let i = 0; i < x.values.length; ++i)
    values[Math.floor(i / 3)] += errorKinds[kind](x.values[i] - r.values[i], total.values[i], epsilon) / 3;
  return {width: x.width, height: x.height, channels: 1, values};
}
