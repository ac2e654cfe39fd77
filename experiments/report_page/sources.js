// Chooses the image that a method has at a time, and fetches its pixels for the viewer.

/** The images of one scene. */
class Sources {
  constructor(scene) {
    this.pictures = data.pictures[scene];
    this.images = this.pictures.images;
    this.layers = this.pictures.layers;
    const times = this.images.slice(1).flatMap((image) => [...image.frames, image].map((frame) => frame.seconds));
    /** The seconds after which some method has a new image. */
    this.times = [...new Set(times)].sort((a, b) => a - b);
  }

  /**
   * The state of image `index` after times[time]: {none: why} or {passes, seconds, isFinal, image}. With
   * `wantsFinal` it is the final image at every time, because components and maps exist of that image alone.
   */
  at(index, time, wantsFinal) {
    const image = this.images[index];
    if (index === 0) return {isFinal: true};
    const final = {passes: image.passes, seconds: image.seconds, isFinal: true};
    if (wantsFinal) return final;
    const seconds = this.times[time];
    if (image.seconds <= seconds) return final;
    const frame = image.frames.filter((f) => f.seconds <= seconds).pop();
    if (frame) return {...frame, isFinal: false};
    return {none: `no image yet after ${number(seconds, 3)} s`};
  }

  /** The sum of a layer's parts in a final image; null if the image lacks all of them. */
  async layer(index, layer) {
    const {parts} = this.images[index];
    if (layer === 0 && parts.total) return imageOf(parts.total);
    const found = this.layers[layer].parts.filter((name) => parts[name]);
    if (found.length === 0) return null;
    return sumOf(await Promise.all(found.map((name) => imageOf(parts[name]))));
  }

  async radiance(index, layer, at) {
    if (at.none) return null;
    return at.isFinal ? this.layer(index, layer) : imageOf(at.image);
  }
}
