// Makes the viewer of a scene: its stage, the controls around it and the values under the cursor.
const stopsText = (v) => `${v > 0 ? "+" : ""}${v} stop${Math.abs(v) === 1 ? "" : "s"}`;
const percent = (v, signed) => `${signed && v > 0 ? "+" : ""}${number(100 * v, 3)} %`;

class ViewerPanel {
  /** `best`: the label of the method that is shown first; the first one if there is none. */
  constructor(place, scene, number, best) {
    this.scene = scene;
    this.number = number;
    this.sources = new Sources(scene);
    const {images, times, pictures} = this.sources;
    this.baseStops = pictures.stops;
    const shown = Math.max(1, images.findIndex((image) => image.label === best));
    this.state = {a: Math.min(shown, images.length - 1), b: 0, mode: 0, side: 0, split: 0.5, quantity: 0, error: 0, layer: 0,
      tone: 0, stops: this.baseStops, amplification: 0, time: times.length - 1};
    this.initial = {...this.state};
    this.stage = new Stage(this.sources, this.state, (pixel) => this.showValues(pixel));
    this.stage.onDraw = () => this.remember();
    this.makeControls();
    this.values = element("div", {className: "values", attributes: {role: "status", "aria-live": "polite"}});
    this.legend = element("div", {className: "map-legend", hidden: true});
    this.pyramids = pyramidsOf(images, () => this.state.stops, (index, name) => this.choose(index, name));
    place.replaceChildren(this.top(), this.stage.heading, this.stage.place, this.bottom(),
      ...this.pyramids.map((pyramid) => pyramid.place));
    listenToGestures(this.stage, this.state, {
      flip: () => this.flip(),
      setSplit: (split) => this.setSplit(split),
      exposeBy: (stops) => this.exposeBy(stops),
    });
    this.showMode();
    this.stage.update();
  }

  makeControls() {
    const {images, layers, times} = this.sources;
    const labels = images.map((image) => image.label);
    const change = (key) => (value) => { this.state[key] = value; this.changed(); };
    this.a = select("A", labels, this.state.a, change("a"));
    this.b = select("B", labels, this.state.b, change("b"));
    // These two are wide, because labels of methods are long.
    for (const side of [this.a, this.b]) side.whole.classList.add("wide");
    this.quantity = choice("Show", quantities.map((q) => q.name), 0, change("quantity"));
    this.layer = select("Component", layers.map((l) => l.name), 0, change("layer"));
    this.mode = choice("Compare", modes, 0, (mode) => this.apply({mode}));
    this.error = select("Error", errorNames, 0, change("error"));
    this.tone = select("Tone", tones, 0, change("tone"));
    this.save = button("Save PNG", "what the viewer shows", () =>
      element("a", {download: this.fileName, href: this.stage.canvas.toDataURL("image/png")}).click());
    this.flipButton = button("Flip to B", "space", () => this.flip());
    this.split = slider("Split", {min: 0, max: 100, value: 50}, (v) => `${v} %`, (v) => this.setSplit(v / 100));
    this.exposure = slider("Exposure", {min: -10, max: 10, step: 0.25, value: 0}, stopsText, (v) => this.setStops(v));
    this.reset = button("Reset", "initial exposure", () => { this.exposure.set(0); this.setStops(0); });
    const last = times.length - 1;
    this.time = slider("Time", {min: 0, max: Math.max(0, last), value: last},
      (i) => (last < 0 ? "" : `${number(times[i], 3)} s${i >= last ? ": final images" : ""}`), change("time"));
    this.zoom = element("div", {className: "control zoom", attributes: {role: "group", "aria-label": "zoom"}},
      button("−", "zoom out", () => this.stage.zoomBy(1 / 1.5)),
      button("+", "zoom in", () => this.stage.zoomBy(1.5)),
      button("Fit", "the whole image", () => this.stage.fit()),
      button("1:1", "actual pixels", () => { this.stage.setZoom(1, 0, 0); this.stage.center(); }));
  }

  top() {
    return element("div", {className: "controls"}, this.a.whole, this.b.whole, this.quantity.whole, this.error.whole,
      this.tone.whole, this.layer.whole, this.mode.whole, element("div", {className: "control mode-detail"}, this.flipButton, this.split.whole));
  }

  bottom() {
    const {pictures} = this.sources;
    const notes = ["All images are of seed 1; bias is the mean of all seeds against the reference."];
    if (pictures.reduction > 1)
      notes.push(`Each pixel here is the mean of ${pictures.reduction} × ${pictures.reduction} of the film's ` +
        `${pictures.film[0]} × ${pictures.film[1]}.`);
    if (data.pictures_note) notes.push(data.pictures_note);
    return element("div", {className: "under-stage"}, this.values, this.legend,
      element("div", {className: "controls"}, this.time.whole,
        element("div", {className: "control exposure"}, this.exposure.whole, this.reset), this.zoom, this.save),
      element("p", {className: "muted notes", textContent: notes.join(" ")}));
  }

  /** SCENE-METHOD.png, with both methods of a split, and without one of a grid. */
  get fileName() {
    const {a, b, side} = this.state, {images} = this.sources;
    const shown = {flip: [[a, b][side]], slide: [a, b], grid: []}[modes[this.state.mode]];
    return `${[this.scene, ...shown.map((index) => images[index].label)].join("-").replace(/[^\w.,=+-]+/g, "_")}.png`;
  }

  /** The present mode, unless it shows all images. */
  get pairMode() { return this.stage.isGrid ? 0 : this.state.mode; }

  get isMap() { return this.state.quantity !== 0; }

  changed() {
    const {name} = quantities[this.state.quantity];
    this.exposure.name.textContent = this.isMap ? "Amplification" : "Exposure";
    this.exposure.input.disabled = this.reset.disabled = name === "FLIP";
    this.error.whole.hidden = name !== "error";
    this.tone.whole.hidden = name !== "image";
    this.exposure.set(this.isMap ? this.state.amplification : this.state.stops - this.baseStops);
    this.showLegend();
    this.stage.update();
  }

  setStops(stops) {
    if (this.isMap) this.state.amplification = stops;
    else this.state.stops = this.baseStops + stops;
    this.showLegend();
    this.stage.expose();
    for (const pyramid of this.pyramids) pyramid.draw();
  }

  /** Changes the state, and the controls with it. */
  apply(changes) {
    Object.assign(this.state, changes);
    for (const key of ["a", "b", "mode", "quantity", "error", "layer", "tone", "time"]) this[key].set(this.state[key]);
    this.split.set(Math.round(100 * this.state.split));
    this.stage.resize();
    this.showMode();
    this.changed();
  }

  /** Writes the state into the address, once it has not changed for a while. */
  remember() {
    clearTimeout(this.waiting);
    this.waiting = setTimeout(() => {
      const {x, y, zoom, fitZoom} = this.stage;
      const view = Math.abs(zoom / fitZoom - 1) < 1e-6 ? {} : {x, y, zoom};
      const changed = Object.entries(this.state).filter(([key, value]) => value !== this.initial[key]);
      const state = new URLSearchParams([...changed, ...Object.entries(view)]).toString();
      if (state === (this.address ?? "")) return;
      this.address = state;
      history.replaceState(null, "", state ? `#viewer-${this.number}?${state}` : location.pathname);
    }, 300);
  }

  /** Takes the state from the address. */
  restore(state) {
    const numbers = Object.fromEntries([...new URLSearchParams(state)].map(([key, value]) => [key, Number(value)]));
    const {images, layers, times} = this.sources;
    const counts = {a: images.length, b: images.length, side: 2, mode: modes.length, layer: layers.length,
      quantity: quantities.length, error: errorNames.length, tone: tones.length, time: times.length};
    const known = Object.entries(numbers).filter(([key, value]) => key in this.state && Number.isFinite(value) &&
      (!(key in counts) || (Number.isInteger(value) && value >= 0 && value < counts[key])));
    this.apply(Object.fromEntries(known));
    if (numbers.zoom > 0) Object.assign(this.stage, {x: numbers.x, y: numbers.y, zoom: numbers.zoom});
    this.stage.place.scrollIntoView({block: "center"});
  }

  /** Shows the layer `name` of an image as A. */
  choose(index, name) {
    this.apply({a: index, layer: this.sources.layers.findIndex((layer) => layer.name === name), side: 0, mode: this.pairMode});
    this.stage.place.scrollIntoView({block: "nearest"});
  }

  /** Shows image `index`, as it was after `seconds`, as A beside the reference, and brings the viewer into sight. */
  show(index, quantity, seconds) {
    const {times} = this.sources;
    const time = times.findLastIndex((t) => t <= (seconds ?? Infinity));
    this.apply({a: index, b: 0, quantity, layer: 0, side: 0, time: Math.max(0, time), mode: this.pairMode});
    this.stage.heading.scrollIntoView({block: "start"});
    this.stage.place.focus({preventScroll: true});
  }

  exposeBy(stops) {
    if (this.exposure.input.disabled) return;
    this.exposure.set(Number(this.exposure.input.value) + stops);
    this.setStops(Number(this.exposure.input.value));
  }

  setSplit(split) {
    this.state.split = clamped(split, 0, 1);
    this.split.set(Math.round(100 * this.state.split));
    this.stage.draw();
  }

  flip() {
    if (this.state.mode !== 0) return;
    this.state.side = 1 - this.state.side;
    this.showMode();
  }

  showMode() {
    for (const part of [this.a.whole, this.b.whole, this.stage.heading]) part.hidden = this.stage.isGrid;
    this.flipButton.hidden = this.state.mode !== 0;
    this.split.whole.hidden = this.state.mode !== 1;
    this.flipButton.textContent = `Flip to ${"BA"[this.state.side]}`;
    this.stage.draw();
    this.showValues(this.stage.cursor);
  }

  showLegend() {
    const {name} = quantities[this.state.quantity];
    this.legend.hidden = !this.isMap && tones[this.state.tone] !== "false colour";
    if (this.legend.hidden) return;
    const most = brightest(this.state), end = percent(most);
    const luminance = (log) => number(2 ** (log - this.state.stops), 3);
    const [low, high, words] = {
      image: [luminance(falseColours.low), luminance(falseColours.high), "luminance [W/(sr m²)], logarithmic"],
      error: [
        ["0", `${end} and more`, "relative error of a pixel, |x − r| / √(r² + ε), mean of the channels"],
        ["0", `${number(most, 3)} and more`, "what the squared relative RMSE is the mean of, (x − r)² / (r² + ε)"],
        ["0", `${number(most, 3)} and more`, "|x − r| [W/(sr m²)], mean of the channels"]][this.state.error],
      bias: [`−${end}`, `+${end}`, "(mean of the seeds − r) / √(r² + ε), mean of the channels; grey: not significantly different from 0"],
      FLIP: ["0", "1", "FLIP: how much of a difference a viewer sees at 67 pixels per degree"],
    }[name];
    const [bar, ends] = scaleBar(data.scales[this.isMap ? name.toLowerCase() : "error"], low, high);
    this.legend.replaceChildren(ends, bar, element("div", {className: "muted", textContent: words}));
  }

  valueText(side, pixel) {
    if (!side || side.none) return "–";
    const i = pixel.row * this.sources.pictures.width + pixel.column;
    if (side.map) {
      const v = side.map.values[i], {name} = quantities[this.state.quantity];
      return name === "FLIP" || (name === "error" && this.state.error > 0) ? number(v, 3)
        : percent(v, name === "bias") +
          (side.halfWidth ? ` ± ${number(100 * side.halfWidth.values[i], 3)}` : "");
    }
    return [0, 1, 2].map((k) => number(side.image.values[3 * i + k])).join("  ");
  }

  showValues(pixel) {
    if (!this.values) return;
    if (!pixel) {
      this.values.replaceChildren(element("span", {className: "muted",
        textContent: "Point at a pixel to read its values; click the image and scroll to zoom."}));
      return;
    }
    const what = this.isMap ? quantities[this.state.quantity].name : "R G B, linear";
    const row = (side, index) => {
      const active = this.state.mode !== 0 || this.state.side === index;
      const name = this.stage.isGrid ? side.label : "AB"[index];
      return element("span", {className: `value${active ? " active" : ""}`, attributes: {"data-side": name}},
        element("b", {textContent: name}), this.valueText(side, pixel));
    };
    this.values.replaceChildren(
      element("span", {className: "where", textContent: `x ${pixel.column}, y ${pixel.row}`}), ...this.stage.sides.map(row),
      element("span", {className: "muted", textContent: what}));
  }
}
