// Photons as points. One geometry holds all of them; the vertex shader hides those that the filters leave out, so
// that a filter costs no upload.

const POINT_VERTEX = `
attribute vec4 power;  // mantissas and exponent of Ward's RGBE, as bytes over 255
attribute vec4 info;   // bounces, map, stratum + 1, pass, as bytes over 255
uniform vec4 shownMaps;
uniform vec2 bounces, passes, powerRange;
uniform float size, exposure;
uniform int colorBy;
uniform sampler2D powerColors, bounceColors, strataColors;
varying vec3 color;

void main() {
  vec4 i = floor(255.0 * info + 0.5), p = floor(255.0 * power + 0.5);
  bool inside = i.x >= bounces.x && i.x <= bounces.y && i.w >= passes.x && i.w <= passes.y && shownMaps[int(i.y)] > 0.5;
  if (!inside) {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    gl_PointSize = 0.0;
    color = vec3(0.0);
    return;
  }
  if (colorBy == 0) {
    color = exposure * min(p.xyz * exp2(p.w - 136.0), 4.0);  // points add up, as light does
  } else if (colorBy == 1) {
    float mean = (p.x + p.y + p.z) / 3.0;
    float value = (log2(max(mean, 1e-3)) + p.w - 136.0 - powerRange.x) / (powerRange.y - powerRange.x);
    color = texture2D(powerColors, vec2(clamp(value, 0.002, 0.998), 0.5)).rgb;
  } else if (colorBy == 2) {
    color = texture2D(bounceColors, vec2((min(i.x, BOUNCE_COUNT - 1.0) + 0.5) / BOUNCE_COUNT, 0.5)).rgb;
  } else {
    color = texture2D(strataColors, vec2((i.z + 0.5) / STRATA_COUNT, 0.5)).rgb;
  }
  vec4 seen = modelViewMatrix * vec4(position, 1.0);
  seen.xyz *= 0.998;  // towards the eye, in front of the surface that the photon lies on
  gl_Position = projectionMatrix * seen;
  gl_PointSize = size;
}`;

const POINT_FRAGMENT = `
varying vec3 color;
void main() {
  vec2 at = gl_PointCoord - 0.5;
  if (dot(at, at) > 0.25) discard;
  gl_FragColor = vec4(color, 1.0);
}`;

const COLOR_BY = { light: 0, power: 1, bounces: 2, wavelength: 3 };
// Colours in sRGB, bright enough for the dark ground of the stage.
const POWER_SCALE = [[106, 92, 240], [176, 79, 208], [234, 90, 147], [251, 141, 98], [251, 200, 94], [253, 247, 192]];
const BOUNCE_COLORS = [[255, 226, 122], [255, 157, 77], [255, 95, 126], [209, 99, 230], [139, 123, 255], [79, 168, 255],
  [63, 208, 201], [127, 214, 107], [169, 178, 189]];

/** One row of colours as a texture without interpolation. */
function rowTexture(colors) {
  const texture = new THREE.DataTexture(Uint8Array.from(colors.flatMap((c) => [...c.map(Math.round), 255])), colors.length, 1);
  texture.needsUpdate = true;
  return texture;
}

class Photons {
  constructor() {
    this.positions = arrayOf("photon-positions", Float32Array);
    this.normals = arrayOf("photon-normals", Int8Array);
    this.powers = arrayOf("photon-powers", Uint8Array);
    this.infos = arrayOf("photon-infos", Uint8Array);
    this.count = this.infos.length / 4;
    this.mostBounces = 0;
    for (let i = 0; i < this.infos.length; i += 4) this.mostBounces = Math.max(this.mostBounces, this.infos[i]);
    this.filter = {
      maps: facts.maps.map(() => true), bounces: [0, this.mostBounces], passes: [0, Math.max(facts.passes - 1, 0)],
    };
    this.powerRange = this.rangeOfPowers();
    this.strata = [[235, 235, 235], ...facts.strata.map((s) => s.color.map((v) => srgbByte(clamped(v, 0, 1))))];
    this.points = new THREE.Points(this.geometry(), this.material());
    this.points.frustumCulled = false;
    this.points.renderOrder = 3;
    this.apply();
  }

  geometry() {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(this.positions, 3));
    geometry.setAttribute("power", new THREE.BufferAttribute(this.powers, 4, true));
    geometry.setAttribute("info", new THREE.BufferAttribute(this.infos, 4, true));
    return geometry;
  }

  material() {
    return new THREE.ShaderMaterial({
      vertexShader: POINT_VERTEX, fragmentShader: POINT_FRAGMENT,
      defines: { BOUNCE_COUNT: `${BOUNCE_COLORS.length}.0`, STRATA_COUNT: `${this.strata.length}.0` },
      uniforms: {
        shownMaps: { value: new THREE.Vector4() }, bounces: { value: new THREE.Vector2() },
        passes: { value: new THREE.Vector2() }, powerRange: { value: new THREE.Vector2(...this.powerRange) },
        size: { value: 1 }, exposure: { value: 1 }, colorBy: { value: 0 },
        powerColors: { value: rowTexture(Array.from({ length: 256 }, (_, i) => scaleColor(POWER_SCALE, i / 255))) },
        bounceColors: { value: rowTexture(BOUNCE_COLORS) },
        strataColors: { value: rowTexture(this.strata) },
      },
    });
  }

  /// Power of photon i relative to the mean of its map, by channel.
  powerOf(i) {
    const unit = 2 ** (this.powers[4 * i + 3] - 136);
    return [0, 1, 2].map((c) => this.powers[4 * i + c] * unit);
  }

  /// The logarithms to base 2 of the powers that most photons have. Powers that hardly differ get a range around them.
  rangeOfPowers() {
    const logs = [], step = Math.max(1, Math.floor(this.count / 20000));
    for (let i = 0; i < this.count; i += step) {
      const [r, g, b] = this.powerOf(i);
      if (r + g + b > 0) logs.push(Math.log2((r + g + b) / 3));
    }
    const low = quantile(logs, 0.02), high = quantile(logs, 0.98);
    return high - low > 0.5 ? [low, high] : [(low + high) / 2 - 1, (low + high) / 2 + 1];
  }

  /// Colours the points. Those with their own light add up and hide nothing; others hide what lies behind them.
  colorBy(name) {
    const material = this.points.material, glows = name === "light";
    material.uniforms.colorBy.value = COLOR_BY[name];
    material.transparent = glows;
    material.depthWrite = !glows;
    material.blending = glows ? THREE.AdditiveBlending : THREE.NormalBlending;
    material.needsUpdate = true;
  }

  passes(i) {
    const { maps, bounces, passes } = this.filter, at = 4 * i, info = this.infos;
    return maps[info[at + 1]] && info[at] >= bounces[0] && info[at] <= bounces[1] &&
      info[at + 3] >= passes[0] && info[at + 3] <= passes[1];
  }

  /// Hands the filter to the shader and counts what passes.
  apply() {
    const { maps, bounces, passes } = this.filter, uniforms = this.points.material.uniforms;
    uniforms.shownMaps.value.set(...[0, 1, 2, 3].map((i) => (maps[i] ? 1 : 0)));
    uniforms.bounces.value.set(...bounces);
    uniforms.passes.value.set(...passes);
    this.visible = 0;
    for (let i = 0; i < this.count; i++) if (this.passes(i)) this.visible++;
    this.points.visible = this.visible > 0;
  }

  /// The nearest photon within a few pixels of a place on the stage, in normalised device coordinates; -1: none.
  nearest(place, camera, width, height) {
    const m = new THREE.Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse).elements;
    let found = -1, best = Infinity;
    for (let i = 0; i < this.count; i++) {
      if (!this.passes(i)) continue;
      const x = this.positions[3 * i], y = this.positions[3 * i + 1], z = this.positions[3 * i + 2];
      const w = m[3] * x + m[7] * y + m[11] * z + m[15];
      if (!(w > 0)) continue;
      const dx = ((m[0] * x + m[4] * y + m[8] * z + m[12]) / w - place.x) * width / 2;
      const dy = ((m[1] * x + m[5] * y + m[9] * z + m[13]) / w - place.y) * height / 2;
      if (dx * dx + dy * dy < 25 && w < best) [found, best] = [i, w];
    }
    return found;
  }

  describe(i) {
    const map = facts.maps[this.infos[4 * i + 1]], stratum = this.infos[4 * i + 2];
    const lines = [`Photon of the ${map.name} map, ${this.infos[4 * i]} bounces`,
      `power (${triple(...this.powerOf(i))}) × ${short(map.mean_power)} ${map.power_unit}`];
    if (facts.photons_of_passes) lines.push(`pass ${this.infos[4 * i + 3] + 1}`);
    if (stratum > 0) lines.push(`wavelength ${Math.round(facts.strata[stratum - 1].wavelength)} nm`);
    return lines.join("\n");
  }
}
