// Shared by the scripts of all pages: elements, colours, numbers as text, and what a page holds as base64.
"use strict";

/** An element with properties, attributes (the key `attributes`) and children. */
function element(name, {attributes = {}, ...properties} = {}, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  for (const [attribute, text] of Object.entries(attributes)) made.setAttribute(attribute, text);
  made.append(...children);
  return made;
}

/** The value of a CSS custom property in the present colour scheme. */
const color = (name, place = document.documentElement) => getComputedStyle(place).getPropertyValue(name).trim();

/** Calls `listener` when the scheme changes between light and dark. */
const onScheme = (listener) => matchMedia("(prefers-color-scheme: dark)").addEventListener("change", listener);

/** A number as text with `digits` significant digits; powers of ten only if it is very large or small. */
function number(value, digits = 4) {
  if (Number.isNaN(value)) return "not a number";
  if (!Number.isFinite(value)) return value > 0 ? "infinite" : "-infinite";
  if (value === 0) return "0";
  const size = Math.abs(value);
  return size < 1e-3 || size >= 1e5 ? value.toExponential(digits - 1) : value.toPrecision(digits);
}

const clamped = (v, low, high) => Math.min(high, Math.max(low, v));

/** A linear value in [0, 1] as sRGB in [0, 255] (IEC 61966-2-1). */
const srgbByte = (v) => Math.round(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055));

/** The colour at t in [0, 1] between evenly spaced colours, which are lists of bytes. */
function scaleColor(scale, t) {
  const position = clamped(t, 0, 1) * (scale.length - 1), i = Math.min(Math.floor(position), scale.length - 2);
  return scale[i].map((c, k) => c + (scale[i + 1][k] - c) * (position - i));
}

/** A bar with the colours of a scale and, below it, what its ends mean. */
function scaleBar(scale, low, high) {
  const bar = element("div", {className: "scale"});
  bar.style.background = `linear-gradient(90deg, ${scale.map((c) => `rgb(${c.join(",")})`).join(",")})`;
  return [bar, element("div", {className: "scale-ends"}, element("span", {textContent: low}),
    element("span", {textContent: high}))];
}

/** The bytes that the text of an element holds as base64. */
const bytesOf = (id) => Uint8Array.from(atob(document.getElementById(id).textContent), (c) => c.charCodeAt(0));
