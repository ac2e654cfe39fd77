// The data that the page holds: facts as JSON, arrays of numbers as base64.
import * as THREE from "three";
import { OrbitControls } from "three/orbit-controls";

const facts = JSON.parse(document.getElementById("facts").textContent);

/// The array of this name as numbers of a type. Its text is freed, since an array is read once.
function arrayOf(name, Type) {
  const element = document.getElementById(`array-${name}`);
  const text = atob(element.textContent);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  element.remove();
  return new Type(bytes.buffer);
}

const counted = (number) => number.toLocaleString("en");
/// A number with three significant digits.
const short = (number) => (number === 0 ? "0" : Number(number.toPrecision(3)).toString());
const triple = (r, g, b) => `${short(r)}, ${short(g)}, ${short(b)}`;

/// The value below which this share of the finite numbers lies; 0 if there are none.
function quantile(numbers, share) {
  const sorted = Float64Array.from(numbers).filter(Number.isFinite).sort();
  return sorted.length ? sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))] : 0;
}
