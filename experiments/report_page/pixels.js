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

  /** ImageData of an image of radiance, whose values are multiplied by 2^stops. */
  function picture(image, stops) {
    const out = new ImageData(image.width, image.height);
    const factor = 2 ** stops;
    for (let i = 0, o = 0; i < image.values.length; i += 3, o += 4) {
      for (let k = 0; k < 3; ++k) out.data[o + k] = shown(image.values[i + k] * factor);
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

  /** The tables' relative error for each pixel: the mean over channels of |x - r| / sqrt(r_total^2 + epsilon). */
  function errorOf(x, r, total, epsilon) {
    const values = new Float32Array(x.width * x.height);
    for (let i = 0; i < x.values.length; ++i)
      values[Math.floor(i / 3)] +=
        Math.abs(x.values[i] - r.values[i]) / Math.sqrt(total.values[i] ** 2 + epsilon) / 3;
    return {width: x.width, height: x.height, channels: 1, values};
  }

  return {picture, map, sum, errorOf, scaleColor};
})();
