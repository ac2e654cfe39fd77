// Shows images of a scene at the same position and zoom: two of them, A and B, flipped or side by side, or all in a grid.
const quantities = [
  {name: "image", needsFinal: false},
  {name: "error", needsFinal: false},
  {name: "bias", needsFinal: true},
  {name: "FLIP", needsFinal: true},
];
const modes = ["flip", "slide", "grid"];
const largestError = 0.25; // error with the brightest colour in a map that is not amplified

/** The content of one side: its image and map, or in `none` the reason why there is nothing to show. */
async function sideOf(sources, state, index) {
  const quantity = quantities[state.quantity];
  const wantsFinal = quantity.needsFinal || state.layer !== 0;
  const at = sources.at(index, state.time, wantsFinal);
  const side = {label: sources.images[index].label, at, image: null, map: null};
  side.image = await sources.radiance(index, state.layer, at);
  if (at.none) side.none = at.none;
  else if (!side.image) side.none = `it does not simulate ${sources.layers[state.layer].name}`;
  else if (quantity.name === "error") {
    const [r, total] = await Promise.all([sources.layer(0, state.layer), sources.layer(0, 0)]);
    if (r) side.map = errorOf(side.image, r, total, sources.pictures.epsilon, errorNames[state.error]);
    else side.none = "the reference does not have this component";
  } else if (quantity.name !== "image") {
    const blob = sources.images[index][quantity.name.toLowerCase()];
    if (blob) side.map = await imageOf(blob);
    else side.none = index === 0 ? "the others are measured against the reference" : "it was not measured";
    if (blob && quantity.name === "bias") side.halfWidth = await imageOf(sources.images[index].bias_half_width);
  }
  return side;
}

/** The error with the brightest colour: squared where errors are; absolute errors are those of a radiance shown as 1. */
function brightest(state) {
  const amplified = largestError / 2 ** state.amplification;
  if (quantities[state.quantity].name !== "error") return amplified;
  return [amplified, amplified ** 2, amplified / 2 ** state.stops][state.error];
}

/** An off-screen canvas with what the side shows. */
function bitmapOf(side, state) {
  if (side.none) return null;
  const amplified = brightest(state);
  const {name} = quantities[state.quantity];
  const shown = name === "image" ? picture(side.image, state.stops, tones[state.tone])
    : name === "error" ? colourMap(side.map, "error", 0, amplified)
    : name === "bias" ? colourMap(side.map, "bias", -amplified, amplified, side.halfWidth)
    : colourMap(side.map, "flip", 0, 1);
  const canvas = element("canvas");
  paint(canvas, shown);
  return canvas;
}

function whenText(at) {
  if (at.none || at.passes === undefined) return "";
  const passes = `${at.passes} pass${at.passes === 1 ? "" : "es"}`;
  return `${at.isFinal ? "final image, " : ""}${passes}, ${number(at.seconds, 3)} s`;
}

/** The stage is a canvas with its zoom and position, and with the images that it shows. */
class Stage {
  constructor(sources, state, onCursor) {
    this.sources = sources;
    this.state = state;
    this.onCursor = onCursor;
    this.size = {width: sources.pictures.width, height: sources.pictures.height};
    this.canvas = element("canvas");
    this.labels = [element("div", {className: "stage-label left"}), element("div", {className: "stage-label right"})];
    this.place = element("div", {className: "stage", tabIndex: 0, attributes: {role: "application",
      "aria-label": "image viewer: arrow keys move the pixel cursor, space flips, plus and minus zoom"}},
      this.canvas);
    this.heading = element("div", {className: "stage-labels"}, ...this.labels);
    this.sides = [];
    this.bitmaps = [];
    this.turn = 0;
    new ResizeObserver(() => this.resize()).observe(this.place);
  }

  get isGrid() { return modes[this.state.mode] === "grid"; }

  /** The part of the stage that one image has: {width, height, columns}. The columns of a grid make its cells as large as can be. */
  get cell() {
    const {clientWidth, clientHeight} = this.place;
    const count = this.isGrid ? this.sources.images.length : 1;
    const cells = Array.from({length: count}, (_, i) =>
      ({columns: i + 1, width: clientWidth / (i + 1), height: clientHeight / Math.ceil(count / (i + 1))}));
    const zoom = ({width, height}) => Math.min(width / this.size.width, height / this.size.height);
    return cells.reduce((best, cell) => zoom(cell) > zoom(best) ? cell : best);
  }

  resize() {
    const {clientWidth: width, clientHeight: height} = this.place;
    const wasFit = !this.zoom || Math.abs(this.zoom - this.fitZoom) < 1e-6;
    this.ratio = devicePixelRatio || 1;
    this.canvas.width = Math.max(1, Math.round(width * this.ratio));
    this.canvas.height = Math.max(1, Math.round(height * this.ratio));
    this.fitZoom = Math.min(this.cell.width / this.size.width, this.cell.height / this.size.height);
    if (wasFit) this.fit();
    this.draw();
  }

  fit() { this.setZoom(this.fitZoom, 0, 0); this.center(); }

  center() {
    const {width, height} = this.cell;
    this.x = (width - this.zoom * this.size.width) / 2;
    this.y = (height - this.zoom * this.size.height) / 2;
    this.draw();
  }

  /** Zooms so that the point (x, y) of a cell stays where it is. */
  setZoom(zoom, x, y) {
    const next = Math.min(64, Math.max(Math.min(this.fitZoom, 1) / 2, zoom));
    this.x = x - (x - (this.x ?? 0)) * next / (this.zoom || next);
    this.y = y - (y - (this.y ?? 0)) * next / (this.zoom || next);
    this.zoom = next;
    this.place.style.touchAction = next > this.fitZoom * 1.01 ? "none" : "pan-y";
    this.draw();
  }

  zoomBy(factor) { this.setZoom(this.zoom * factor, this.cell.width / 2, this.cell.height / 2); }

  pan(dx, dy) { this.x += dx; this.y += dy; this.draw(); }

  /** The pixel at a point of a cell, or null. */
  pixelAt(x, y) {
    const column = Math.floor((x - this.x) / this.zoom);
    const row = Math.floor((y - this.y) / this.zoom);
    const inside = column >= 0 && row >= 0 && column < this.size.width && row < this.size.height;
    return inside ? {column, row} : null;
  }

  setCursor(pixel) { this.cursor = pixel; this.draw(); this.onCursor(pixel); }

  moveCursor(dx, dy) {
    const from = this.cursor ?? {column: Math.floor(this.size.width / 2), row: Math.floor(this.size.height / 2)};
    const within = (v, end) => Math.min(end - 1, Math.max(0, v));
    this.setCursor({column: within(from.column + dx, this.size.width), row: within(from.row + dy, this.size.height)});
  }

  /** Fetches what A and B show now, then draws. */
  async update() {
    const turn = ++this.turn;
    this.place.setAttribute("aria-busy", "true");
    const shown = this.isGrid ? [...this.sources.images.keys()] : [this.state.a, this.state.b];
    const sides = await Promise.all(shown.map((index) => sideOf(this.sources, this.state, index)));
    if (turn !== this.turn) return; // something newer was asked for
    this.sides = sides;
    forgetImages();
    this.expose();
    this.place.setAttribute("aria-busy", "false");
  }

  /** Converts the same images with the present exposure and draws them. */
  expose() {
    this.bitmaps = this.sides.map((side) => bitmapOf(side, this.state));
    this.draw();
    this.onCursor(this.cursor);
  }

  get splitX() { return this.state.split * this.place.clientWidth; }

  draw() {
    if (!this.zoom) return;
    const context = this.canvas.getContext("2d");
    context.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    context.imageSmoothingEnabled = false;
    context.clearRect(0, 0, this.place.clientWidth, this.place.clientHeight);
    const slides = this.state.mode === 1, {clientWidth} = this.place;
    if (this.isGrid) this.drawGrid(context);
    else if (slides) {
      this.drawSide(context, 0, 0, this.splitX);
      this.drawSide(context, 1, this.splitX, clientWidth);
      context.fillStyle = "#fff";
      context.fillRect(this.splitX - 1, 0, 2, this.place.clientHeight);
      context.strokeStyle = "#000";
      context.strokeRect(this.splitX - 1.5, -1, 3, this.place.clientHeight + 2);
    } else this.drawSide(context, this.state.side, 0, clientWidth);
    if (!this.isGrid) this.drawCursor(context);
    this.showLabels(slides);
    this.onDraw?.();
  }

  /** All images, each with its name. */
  drawGrid(context) {
    const {width, height, columns} = this.cell;
    context.font = "12px system-ui, sans-serif";
    for (const [index, side] of this.sides.entries()) {
      context.save();
      context.translate((index % columns) * width, Math.floor(index / columns) * height);
      context.beginPath();
      context.rect(0, 0, width - 1, height - 1);
      context.clip();
      this.drawSide(context, index, 0, width);
      this.drawCursor(context);
      const text = side.none ? `${side.label}: ${side.none}` : side.label;
      context.fillStyle = "rgb(0 0 0 / 65%)";
      context.fillRect(0, 0, context.measureText(text).width + 10, 18);
      context.fillStyle = "#fff";
      context.fillText(text, 5, 13);
      context.restore();
    }
  }

  drawSide(context, index, from, to) {
    const {width, height} = this.size;
    context.save();
    context.beginPath();
    context.rect(from, 0, to - from, this.place.clientHeight);
    context.clip();
    const bitmap = this.bitmaps[index];
    if (bitmap) context.drawImage(bitmap, this.x, this.y, this.zoom * width, this.zoom * height);
    else {
      context.fillStyle = "#888";
      context.fillRect(this.x, this.y, this.zoom * width, this.zoom * height);
    }
    context.restore();
  }

  drawCursor(context) {
    if (!this.cursor) return;
    const size = Math.max(this.zoom, 7);
    const middle = (v, offset) => offset + (v + 0.5) * this.zoom - size / 2;
    const x = middle(this.cursor.column, this.x), y = middle(this.cursor.row, this.y);
    context.lineWidth = 1;
    context.strokeStyle = "#000";
    context.strokeRect(x - 1.5, y - 1.5, size + 3, size + 3);
    context.strokeStyle = "#fff";
    context.strokeRect(x - 0.5, y - 0.5, size + 1, size + 1);
  }

  showLabels(slides) {
    const show = (place, index) => {
      const side = this.sides[index];
      const words = side ? [`${"AB"[index]}: ${side.label}`, side.none ?? whenText(side.at)] : ["", ""];
      if (place.textContent !== words.join(""))
        place.replaceChildren(element("b", {textContent: words[0]}), element("span", {textContent: words[1]}));
    };
    show(this.labels[0], slides ? 0 : this.state.side);
    show(this.labels[1], 1);
    this.labels[1].hidden = !slides;
  }
}
