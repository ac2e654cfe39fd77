// The controls beside the stage. Each is found by its label.

let lastId = 0;

function element(name, parent, properties = {}) {
  const made = Object.assign(document.createElement(name), properties);
  parent?.append(made);
  return made;
}

/// A check box with a name and a line of detail.
function addCheck(parent, name, detail, checked, onChange) {
  const label = element("label", parent, { className: "check" });
  const box = element("input", label, { type: "checkbox", checked });
  element("span", label, { textContent: name });
  if (detail) element("span", label, { className: "detail", textContent: detail });
  box.addEventListener("change", () => onChange(box.checked));
  return box;
}

/// A slider. `text` writes its value.
function addSlider(parent, name, { min, max, step = 1, value, text = String }, onInput) {
  const id = `control-${(lastId += 1)}`;
  const label = element("label", parent, { className: "row", htmlFor: id });
  element("span", label, { textContent: name });
  const box = element("span", label, { className: "with-value" });
  const input = element("input", box, { type: "range", id, min, max, step, value });
  const output = element("output", box, { textContent: text(value) });
  output.htmlFor = id;
  input.update = () => { output.textContent = text(Number(input.value)); };
  input.addEventListener("input", () => {
    input.update();
    onInput(Number(input.value));
  });
  return input;
}

function addChoice(parent, name, choices, value, onChange) {
  const id = `control-${(lastId += 1)}`;
  const label = element("label", parent, { className: "row", htmlFor: id });
  element("span", label, { textContent: name });
  const select = element("select", label, { id });
  for (const [key, text] of choices) element("option", select, { value: key, textContent: text });
  select.value = value;
  select.addEventListener("change", () => onChange(select.value));
  return select;
}

/// The key of the colours in use.
function drawLegend(place, colorBy, photons) {
  place.replaceChildren();
  const bar = (colors, low, high) => {
    element("div", place, { className: "bar" }).style.background = `linear-gradient(to right, ${colors.join(", ")})`;
    const ends = element("div", place, { className: "ends" });
    element("span", ends, { textContent: low });
    element("span", ends, { textContent: high });
  };
  if (colorBy === "power") {
    const [low, high] = photons.powerRange.map((log) => `${short(2 ** log)} × mean`);
    bar(POWER_STOPS, low, high);
  } else if (colorBy === "bounces") {
    const list = element("div", place, { className: "swatches" });
    const last = BOUNCE_COLORS.length - 1;
    BOUNCE_COLORS.slice(0, photons.mostBounces + 1).forEach((color, i) => {
      const more = i === last && photons.mostBounces > last;
      element("i", element("span", list), {}).style.background = color;
      list.lastChild.append(`${i}${more ? " or more" : ""}`);
    });
  } else if (colorBy === "wavelength") {
    const ends = [facts.strata[0], facts.strata.at(-1)].map((s) => `${Math.round(s.wavelength)} nm`);
    bar(photons.strata.slice(1).map(cssColor), ...ends);
    element("div", place, { textContent: "Light that was not split is light grey." });
  } else {
    element("div", place, { textContent: "Each photon's power, relative to its map's mean; points add up." });
  }
}
