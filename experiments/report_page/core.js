// This part is shared by all scripts of the page: the data, elements, colours of the scheme, numbers as text.
"use strict";
const report = (() => {
  const data = JSON.parse(document.getElementById("report-data").textContent);
  const methodMarks = ["circle", "rect", "triangle", "rectRot", "star", "crossRot"];

  /** An element with properties, attributes (the key `attributes`) and children. */
  function element(name, properties = {}, ...children) {
    const made = document.createElement(name);
    for (const [key, value] of Object.entries(properties)) {
      if (key === "attributes") {
        for (const [attribute, text] of Object.entries(value)) made.setAttribute(attribute, text);
      } else made[key] = value;
    }
    made.append(...children);
    return made;
  }

  /** The value of a CSS custom property in the present colour scheme. */
  function color(name) {
    return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  }

  /** A number as text with `digits` significant digits; powers of ten only if it is very large or small. */
  function number(value, digits = 4) {
    if (Number.isNaN(value)) return "not a number";
    if (!Number.isFinite(value)) return value > 0 ? "infinite" : "-infinite";
    if (value === 0) return "0";
    const size = Math.abs(value);
    if (size < 1e-3 || size >= 1e5) return value.toExponential(digits - 1);
    return value.toPrecision(digits);
  }

  return {
    data,
    element,
    color,
    number,
    methodColor: (index) => color(`--method-${index % 10}`),
    methodMark: (index) => methodMarks[index % methodMarks.length],
    /** Calls `listener` when the scheme changes between light and dark. */
    onScheme(listener) {
      matchMedia("(prefers-color-scheme: dark)").addEventListener("change", listener);
    },
  };
})();
