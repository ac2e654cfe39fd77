// Draws the strip of a scene: the reference and each method's image at equal time, with its error map below.
"use strict";
report.strip = (() => {
  const {data, element, number, pixels, viewer} = report;
  const keptImages = 64; // number of unpacked images that are kept

  /** Draws ImageData into a canvas of the page. */
  function paint(canvas, shown) {
    canvas.width = shown.width;
    canvas.height = shown.height;
    canvas.getContext("2d").putImageData(shown, 0, 0);
  }

  /** The image of a method after `passes`; the last one before these, or the first, if the page does not hold it. */
  function stateOf(image, passes) {
    const final = {passes: image.passes, seconds: image.seconds, isFinal: true};
    if (passes >= image.passes) return final;
    const frame = image.frames.filter((f) => f.passes <= passes).pop() ?? image.frames[0];
    return frame ? {...frame, isFinal: false} : final;
  }

  /** What the colours of the error maps mean; it stands below the reference, which has no error map. */
  function colourKey(place) {
    const bar = element("div", {className: "scale"});
    bar.style.background = `linear-gradient(90deg, ${data.scales.error.map((c) => `rgb(${c.join(",")})`).join(",")})`;
    place.replaceChildren(element("div", {textContent: "relative error of a pixel"}), bar,
      element("div", {className: "scale-ends"}, element("span", {textContent: "0"}),
        element("span", {textContent: `${100 * viewer.largestError} % and more`})));
    place.hidden = false;
  }

  /** Fills the tiles of one scene. `choose(index, quantity, seconds)` shows an image in the viewer. */
  class Strip {
    constructor(section, scene, choose) {
      this.sources = new report.sources.Sources(scene);
      this.tiles = [...section.querySelectorAll(".tile")].map((tile) => this.tileOf(tile)).filter((tile) => tile);
      for (const canvas of section.querySelectorAll(".strip canvas"))
        canvas.style.aspectRatio = `${this.sources.pictures.width} / ${this.sources.pictures.height}`;
      colourKey(section.querySelector(".map-key"));
      for (const {place, index, at} of this.tiles)
        place.querySelectorAll("a.picture").forEach((link, quantity) => link.addEventListener("click", (event) => {
          event.preventDefault();
          choose(index, quantity, at.seconds);
        }));
    }

    tileOf(place) {
      const {method, passes} = place.dataset;
      if (method === undefined) return {place, index: 0, at: {isFinal: true}};
      const index = this.sources.images.findIndex((image) => image.label === method);
      if (index < 0) return null;
      const at = stateOf(this.sources.images[index], Number(passes));
      if (at.passes !== Number(passes))
        place.querySelector(".shown").textContent = `shown: ${at.passes} passes, ${number(at.seconds, 3)} s`;
      return {place, index, at};
    }

    async draw() {
      const {stops, epsilon} = this.sources.pictures;
      const reference = await this.sources.layer(0, 0);
      for (const {place, index, at} of this.tiles) {
        const image = await this.sources.radiance(index, 0, at);
        if (!image) continue;
        paint(place.querySelector("canvas.image"), pixels.picture(image, stops));
        if (index > 0)
          paint(place.querySelector("canvas.error"),
            pixels.map(pixels.errorOf(image, reference, reference, epsilon), "error", 0, viewer.largestError));
        report.blobs.trim(keptImages);
      }
      this.drawn = true;
    }
  }

  return {Strip};
})();
