// Shows the techniques that make paths as a pyramid: a row for each number of edges, in it the techniques by the number
// of vertices that they take from a light (Veach 1997, figure 10.3).
const techniquePattern = /^technique_k(\d+)_s(\d+)_t(\d+)(_alone)?$/;

/** The techniques among the parts of an image: {name, edges, fromLight, fromCamera, isAlone}. */
function techniquesOf(image) {
  return Object.keys(image.parts).map((name) => techniquePattern.exec(name)).filter((found) => found).map((found) =>
    ({name: found[0], edges: Number(found[1]), fromLight: Number(found[2]), fromCamera: Number(found[3]),
      isAlone: Boolean(found[4])}));
}

class Pyramid {
  /** `stops()` is the exposure; `choose(name)` is called with the technique whose picture has been clicked. */
  constructor(image, stops, choose) {
    this.image = image;
    this.stops = stops;
    this.choose = choose;
    this.techniques = techniquesOf(image);
    this.alone = 0;
    const kind = choice("Light", ["weighted", "each technique alone"], 0, (i) => {
      this.alone = i;
      this.fill();
    });
    this.rows = element("div", {className: "pyramid"});
    this.place = element("div", {}, element("h4", {textContent: `Techniques of ${image.label}`}),
      element("p", {className: "muted", textContent: "A row holds the paths of k edges, ordered by s, the number of vertices " +
        "from the light. Weighted pictures sum to the image. Pictures of techniques alone show the same light in a row. " +
        "A click shows a picture above."}),
      element("div", {className: "controls"}, kind.whole), this.rows);
    this.fill();
  }

  fill() {
    const shown = this.techniques.filter((t) => t.isAlone === (this.alone === 1));
    this.pictures = [];
    this.rows.replaceChildren(...[...new Set(shown.map((t) => t.edges))].sort((a, b) => a - b).map((edges) =>
      element("div", {className: "pyramid-row", attributes: {role: "group", "aria-label": `paths of ${edges} edges`}},
        ...shown.filter((t) => t.edges === edges).sort((a, b) => a.fromLight - b.fromLight).map((t) => this.cell(t)))));
    this.draw();
  }

  cell(technique) {
    const blob = this.image.parts[technique.name];
    const canvas = element("canvas", {width: blob.width, height: blob.height});
    this.pictures.push({canvas, blob});
    const text = `k ${technique.edges}, s ${technique.fromLight}, t ${technique.fromCamera}`;
    return element("button", {type: "button", className: "technique", onclick: () => this.choose(technique.name)}, canvas,
      element("span", {textContent: text}));
  }

  async draw() {
    for (const {canvas, blob} of this.pictures)
      paint(canvas, picture(await imageOf(blob), this.stops()));
  }
}

/** The pyramids of a scene's images; empty if no method has kept its techniques. */
function pyramidsOf(images, stops, choose) {
  return images.flatMap((image, index) =>
    techniquesOf(image).length > 0 ? [new Pyramid(image, stops, (name) => choose(index, name))] : []);
}
