// Makes the viewer of a scene: its stage, the controls around it and the values under the cursor.
"use strict";
report.panel = (() => {
  const {data, element, number, controls, viewer} = report;
  const stopRange = {min: -10, max: 10, step: 0.25, value: 0};

  const stopsText = (v) => `${v > 0 ? "+" : ""}${v} stop${Math.abs(v) === 1 ? "" : "s"}`;
  const percent = (v, signed) => `${signed && v > 0 ? "+" : ""}${number(100 * v, 3)} %`;

  class Panel {
    constructor(place, scene) {
      this.scene = scene;
      this.sources = new report.sources.Sources(scene);
      const {images, times, pictures} = this.sources;
      this.baseStops = pictures.stops;
      this.state = {a: Math.min(1, images.length - 1), b: 0, mode: 0, side: 0, split: 0.5, quantity: 0, layer: 0,
        stops: this.baseStops, amplification: 0, time: times.length - 1};
      this.stage = new viewer.Stage(this.sources, this.state, (pixel) => this.showValues(pixel));
      this.makeControls();
      this.values = element("div", {className: "values", attributes: {role: "status", "aria-live": "polite"}});
      this.legend = element("div", {className: "map-legend", hidden: true});
      this.pyramids = report.pyramid.pyramidsOf(images, () => this.state.stops, (index, name) => this.choose(index, name));
      place.replaceChildren(this.top(), this.stage.heading, this.stage.place, this.bottom(),
        ...this.pyramids.map((pyramid) => pyramid.place));
      report.gestures.listen(this.stage, this.state, {
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
      this.a = controls.select("A", labels, this.state.a, change("a"));
      this.b = controls.select("B", labels, this.state.b, change("b"));
      // These two are wide, because labels of methods are long.
      for (const side of [this.a, this.b]) side.whole.classList.add("wide");
      this.quantity = controls.choice("Show", viewer.quantities.map((q) => q.name), 0, change("quantity"));
      this.layer = controls.select("Component", layers.map((l) => l.name), 0, change("layer"));
      this.mode = controls.choice("Compare", ["flip", "slide"], 0, (mode) => {
        this.state.mode = mode;
        this.showMode();
      });
      this.flipButton = controls.button("Flip to B", "space", () => this.flip());
      this.split = controls.slider("Split", {min: 0, max: 100, step: 1, value: 50}, (v) => `${v} %`,
        (v) => this.setSplit(v / 100));
      this.exposure = controls.slider("Exposure", stopRange, stopsText, (v) => this.setStops(v));
      this.reset = controls.button("Reset", "initial exposure", () => { this.exposure.set(0); this.setStops(0); });
      this.time = controls.slider("Time", {min: 0, max: Math.max(0, times.length - 1), step: 1,
        value: times.length - 1}, (i) => this.timeText(i), change("time"));
      this.zoom = element("div", {className: "control zoom", attributes: {role: "group", "aria-label": "zoom"}},
        controls.button("−", "zoom out", () => this.stage.zoomBy(1 / 1.5)),
        controls.button("+", "zoom in", () => this.stage.zoomBy(1.5)),
        controls.button("Fit", "the whole image", () => this.stage.fit()),
        controls.button("1:1", "actual pixels", () => { this.stage.setZoom(1, 0, 0); this.stage.center(); }));
      this.zoom.children[0].setAttribute("aria-label", "zoom out");
      this.zoom.children[1].setAttribute("aria-label", "zoom in");
    }

    timeText(i) {
      const {times} = this.sources;
      if (times.length === 0) return "";
      return i >= times.length - 1 ? `${number(times[i], 3)} s: final images` : `${number(times[i], 3)} s`;
    }

    top() {
      return element("div", {className: "controls"}, this.a.whole, this.b.whole, this.quantity.whole, this.layer.whole,
        this.mode.whole, element("div", {className: "control mode-detail"}, this.flipButton, this.split.whole));
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
          element("div", {className: "control exposure"}, this.exposure.whole, this.reset), this.zoom),
        element("p", {className: "muted notes", textContent: notes.join(" ")}));
    }

    get isMap() { return this.state.quantity !== 0; }

    changed() {
      const exposes = viewer.quantities[this.state.quantity].name;
      this.exposure.name.textContent = this.isMap ? "Amplification" : "Exposure";
      this.exposure.input.disabled = exposes === "FLIP";
      this.reset.disabled = exposes === "FLIP";
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

    /** Shows the layer `name` of an image as A. */
    choose(index, name) {
      this.state.a = index;
      this.state.layer = this.sources.layers.findIndex((layer) => layer.name === name);
      this.state.side = 0;
      this.a.set(index);
      this.layer.set(this.state.layer);
      this.showMode();
      this.changed();
      this.stage.place.scrollIntoView({block: "nearest"});
    }

    /** Shows image `index`, as it was after `seconds`, as A beside the reference, and brings the viewer into sight. */
    show(index, quantity, seconds) {
      const {times} = this.sources;
      const time = times.findLastIndex((t) => t <= (seconds ?? Infinity));
      Object.assign(this.state, {a: index, b: 0, quantity, layer: 0, side: 0, time: Math.max(0, time)});
      this.a.set(index);
      this.b.set(0);
      this.quantity.set(quantity);
      this.layer.set(0);
      this.time.set(this.state.time);
      this.showMode();
      this.changed();
      this.stage.heading.scrollIntoView({block: "start"});
      this.stage.place.focus({preventScroll: true});
    }

    exposeBy(stops) {
      if (this.exposure.input.disabled) return;
      this.exposure.set(Number(this.exposure.input.value) + stops);
      this.setStops(Number(this.exposure.input.value));
    }

    setSplit(split) {
      this.state.split = Math.min(1, Math.max(0, split));
      this.split.set(Math.round(100 * this.state.split));
      this.stage.draw();
    }

    flip() {
      if (this.state.mode === 1) return;
      this.state.side = 1 - this.state.side;
      this.showMode();
    }

    showMode() {
      const slides = this.state.mode === 1;
      this.flipButton.hidden = slides;
      this.split.whole.hidden = !slides;
      this.flipButton.textContent = `Flip to ${"BA"[this.state.side]}`;
      this.stage.draw();
      this.showValues(this.stage.cursor);
    }

    showLegend() {
      const {name} = viewer.quantities[this.state.quantity];
      this.legend.hidden = !this.isMap;
      if (!this.isMap) return;
      const end = percent(viewer.largestError / 2 ** this.state.amplification);
      const [low, high, words] = {
        error: ["0", `${end} and more`, "relative error of a pixel, |x − r| / √(r² + ε), mean of the channels"],
        bias: [`−${end}`, `+${end}`, "(mean of the seeds − r) / √(r² + ε), mean of the channels; grey: the seeds do not tell it from 0"],
        FLIP: ["0", "1", "FLIP: how much of a difference a viewer sees at 67 pixels per degree"],
      }[name];
      const colors = data.scales[name.toLowerCase()].map((c) => `rgb(${c.join(",")})`).join(",");
      const bar = element("div", {className: "scale"});
      bar.style.background = `linear-gradient(90deg, ${colors})`;
      this.legend.replaceChildren(element("div", {className: "scale-ends"}, element("span", {textContent: low}),
        element("span", {textContent: high})), bar, element("div", {className: "muted", textContent: words}));
    }

    valueText(side, pixel) {
      if (!side || side.none) return "–";
      const i = pixel.row * this.sources.pictures.width + pixel.column;
      if (side.map) {
        const v = side.map.values[i];
        return viewer.quantities[this.state.quantity].name === "FLIP" ? number(v, 3)
          : percent(v, viewer.quantities[this.state.quantity].name === "bias") +
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
      const what = this.isMap ? viewer.quantities[this.state.quantity].name : "R G B, linear";
      const row = (index) => {
        const active = this.state.mode === 1 || this.state.side === index;
        return element("span", {className: `value${active ? " active" : ""}`, attributes: {"data-side": "AB"[index]}},
          element("b", {textContent: "AB"[index]}), this.valueText(this.stage.sides[index], pixel));
      };
      this.values.replaceChildren(
        element("span", {className: "where", textContent: `x ${pixel.column}, y ${pixel.row}`}), row(0), row(1),
        element("span", {className: "muted", textContent: what}));
    }
  }

  return {Panel};
})();
