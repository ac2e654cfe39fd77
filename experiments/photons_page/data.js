// The data that the page holds: facts as JSON, arrays of numbers as base64.
import * as THREE from "three";
import { OrbitControls } from "three/orbit-controls";

const facts = JSON.parse(document.getElementById("facts").textContent);

/** The array of this name as numbers of a type. Its text is freed, since an array is read once. */
function arrayOf(name, Type) {
  const numbers = new Type(bytesOf(`array-${name}`).buffer);
  document.getElementById(`array-${name}`).remove();
  return numbers;
}

const part = (id) => document.getElementById(id);
const counted = (count) => count.toLocaleString("en");
/** A number with three significant digits. */
const short = (value) => Number(value.toPrecision(3)).toString();
const triple = (r, g, b) => `${short(r)}, ${short(g)}, ${short(b)}`;
const vector = (array, i = 0) => new THREE.Vector3().fromArray(array, 3 * i);

/** The value below which this share of the finite numbers lies; 0 if there are none. */
function quantile(numbers, share) {
  const sorted = Float64Array.from(numbers).filter(Number.isFinite).sort();
  return sorted.length ? sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))] : 0;
}
