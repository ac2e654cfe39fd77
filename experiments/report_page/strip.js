// Draws the strip of a scene: the reference and each method's image at equal time, with its error map below.

/** The image of a method after `passes`; the last one before these, or the first, if the page does not hold it. */
function stateOf(image, passes) {
  const final = {passes: image.passes, seconds: image.seconds, isFinal: true};
  if (passes >= image.passes) return final;
  const frame = image.frames.filter((f) => f.passes <= passes).pop() ?? image.frames[0];
  return frame ? {...frame, isFinal: false} : final;
}

/** Fills the tiles of one scene. `choose(index, quantity, seconds)` shows an image in the viewer. */
class Strip {
  constructor(section, scene, choose) {
    this.sources = new Sources(scene);
    this.tiles = [...section.querySelectorAll(".tile")].map((tile) => this.tileOf(tile)).filter((tile) => tile);
    for (const canvas of section.querySelectorAll(".strip canvas"))
      canvas.style.aspectRatio = `${this.sources.pictures.width} / ${this.sources.pictures.height}`;
    // The colours of the error maps are explained below the reference, which has none.
    const key = section.querySelector(".map-key");
    key.replaceChildren(element("div", {textContent: "relative error of a pixel"}),
      ...scaleBar(data.scales.error, "0", `${100 * largestError} % and more`));
    key.hidden = false;
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
      paint(place.querySelector("canvas.image"), picture(image, stops));
      if (index > 0)
        paint(place.querySelector("canvas.error"),
          colourMap(errorOf(image, reference, reference, epsilon), "error", 0, largestError));
      forgetImages();
    }
    this.drawn = true;
  }
}
