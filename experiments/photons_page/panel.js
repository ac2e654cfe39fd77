// The parts of the panel beside the stage that no other page has.

/** A check box with a name and a line of detail. */
function check(name, detail, onChange) {
  const box = element("input", {type: "checkbox", checked: true, onchange: () => onChange(box.checked)});
  const label = element("label", {className: "check"}, box, element("span", {textContent: name}));
  if (detail) label.append(element("span", {className: "detail", textContent: detail}));
  return {whole: label, box};
}

/** A slider of exposures [stops]. */
const exposureSlider = (max, onInput) => slider("Exposure", {min: -4, max, step: 0.5, value: 0}, (v) => `${v} EV`, onInput);

/** The key of the colours in use. */
function legendOf(colorBy, photons) {
  if (colorBy === "power") return scaleBar(POWER_SCALE, ...photons.powerRange.map((log) => `${short(2 ** log)} × mean`));
  if (colorBy === "bounces") {
    const last = BOUNCE_COLORS.length - 1;
    return [element("div", {className: "swatches"}, ...BOUNCE_COLORS.slice(0, photons.mostBounces + 1).map((color, i) =>
      element("span", {}, element("i", {style: `background: rgb(${color})`}),
        `${i}${i === last && photons.mostBounces > last ? " or more" : ""}`)))];
  }
  if (colorBy === "wavelength")
    return [...scaleBar(photons.strata.slice(1),
      ...[facts.strata[0], facts.strata.at(-1)].map((s) => `${Math.round(s.wavelength)} nm`)),
    element("div", {textContent: "Light that was not split is light grey."})];
  return [element("div", {textContent: "Each photon's power, relative to its map's mean; points add up."})];
}
