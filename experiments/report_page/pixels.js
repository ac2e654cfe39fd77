// Converts values to what a screen shows: exposure and sRGB's curve, colour scales, sums of components, errors.
"use strict";
report.pixels = (() => {
  const {data} = report;
  const steps = 16384;
  const curve = new Uint8ClampedArray(steps + 1);
  for (let i = 0; i <= steps; ++i) {
    const v = i / steps;
    curve[i] = Math.round(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055));
  }

  /** The sRGB byte of a linear value. NaN is black here and magenta in maps. */
  const shown = (v) => (v > 0 ? curve[Math.min(steps, Math.round(v * steps))] : 0);

  function scaleColor(scale, t) {
    const position = Math.min(1, Math.max(0, t)) * (scale.length - 1);
    const i = Math.min(Math.floor(position), scale.length - 2);
    return scale[i].map((c, k) => c + (scale[i + 1][k] - c) * (position - i));
  }

  function table(scale) {
    return Array.from({length: 256}, (_, i) => scaleColor(scale, i / 255));
  }
  const tables = Object.fromEntries(Object.entries(data.scales).map(([name, scale]) => [name, table(scale)]));

  // False colours show luminances from 2^-8 to 2^4, once multiplied.
  const falseColours = {low: -8, high: 4};

  /** ImageData of an image of radiance, whose values are multiplied by 2^stops, by one of the `tones`. */
  function picture(image, stops, tone = "linear") {
    const factor = 2 ** stops;
    if (tone === "false colour") {
      const logs = new Float32Array(image.values.length / 3);
      for (let i = 0; i < logs.length; ++i) {
        const [r, g, b] = image.values.subarray(3 * i, 3 * i + 3);
        logs[i] = Math.log2(Math.max(factor * (0.212671 * r + 0.71516 * g + 0.072169 * b), 1e-30));
      }
      return map({...image, values: logs}, "error", falseColours.low, falseColours.high);
    }
    // Narkowicz 2015, "ACES Filmic Tone Mapping Curve".
    const filmic = (v) => v * (2.51 * v + 0.03) / (v * (2.43 * v + 0.59) + 0.14);
    const out = new ImageData(image.width, image.height);
    for (let i = 0, o = 0; i < image.values.length; i += 3, o += 4) {
      for (let k = 0; k < 3; ++k) {
        const v = image.values[i + k] * factor;
        out.data[o + k] = shown(tone === "filmic" ? filmic(Math.max(v, 0)) : v);
      }
      out.data[o + 3] = 255;
    }
    return out;
  }

  /**
   * ImageData of an image with one value a pixel, in the colour scale `name` from `low` to `high`; grey where a value is
   * not larger than that of `halfWidth`, the half width of its interval.
   */
  function map(image, name, low, high, halfWidth = null) {
    const out = new ImageData(image.width, image.height);
    for (let i = 0, o = 0; i < image.values.length; ++i, o += 4) {
      const t = (image.values[i] - low) / (high - low);
      const isUnknown = halfWidth && Math.abs(image.values[i]) <= halfWidth.values[i];
      const color = isUnknown ? [128, 128, 128] : Number.isNaN(t) ? [255, 0, 255] : tables[name][Math.round(255 * Math.min(1, Math.max(0, t)))];
      for (let k = 0; k < 3; ++k) out.data[o + k] = color[k];
      out.data[o + 3] = 255;
    }
    return out;
  }

  /** The sum of images of one size. */
  function sum(images) {
    const values = new Float32Array(images[0].values);
    for (const image of images.slice(1)) for (let i = 0; i < values.length; ++i) values[i] += image.values[i];
    return {...images[0], values};
  }

  /** The errors of pixels: the mean over the channels of the difference d, t being the reference's total. */
  const errors = {
    "relative": (d, t, epsilon) => Math.abs(d) / Math.sqrt(t ** 2 + epsilon),
    "relative, squared": (d, t, epsilon) => d ** 2 / (t ** 2 + epsilon),
    "absolute": (d) => Math.abs(d),
  };
  function errorOf(x, r, total, epsilon, kind = "relative") {
    const values = new Float32Array(x.width * x.height);
    for (let i = 0; i < x.values.length; ++i)
      values[Math.floor(i / 3)] += errors[kind](x.values[i] - r.values[i], total.values[i], epsilon) / 3;
    return {width: x.width, height: x.height, channels: 1, values};
  }

  return {picture, map, sum, errorOf, scaleColor, falseColours, tones: ["linear", "filmic", "false colour"],
    errors: Object.keys(errors)};
})();
