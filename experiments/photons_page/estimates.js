// The method's estimate at a visible point, and the photons or records that it uses.

const ESTIMATE_COLORS = { global: 0x4fd0ff, caustic: 0xffc14f, record: 0x7fe08a };
const COMPONENTS_OF_MAPS = { global: "indirect", caustic: "caustic" };

class Estimates {
  constructor(view, layers) {
    this.facts = facts.estimate;
    this.view = view;
    this.layers = layers;
    this.points = arrayOf("pixel-points", Float32Array);
    this.normals = arrayOf("pixel-normals", Int8Array);
    this.reflections = arrayOf("pixel-reflections", Uint8Array);
    this.arrays = {};
    this.marks = new THREE.Group();
    view.scene.add(this.marks);
  }

  pointOf(i) { return vector(this.points, i); }
  normalOf(i) { return vector(this.normals, i).normalize(); }

  /// The pixel whose place lies nearest to p, unless p is farther away than its neighbours in the image are, or unless that
  /// place is seen from behind here; -1: none.
  pixelAt(p) {
    const [columns] = this.facts.grid;
    let found = -1, best = Infinity;
    for (let i = 0; i < this.reflections.length; i++) {
      const d = p.distanceToSquared(this.pointOf(i));
      if (d < best) [found, best] = [i, d];
    }
    const nearer = (step) => Math.min(...[found - step, found + step].filter((i) => this.points[3 * i] < Infinity)
      .map((i) => this.pointOf(i).distanceToSquared(this.pointOf(found))));
    const faces = found >= 0 && this.normalOf(found).dot(this.view.camera.position.clone().sub(p)) > 0;
    return faces && best <= Math.max(nearer(1), nearer(columns)) ? found : -1;
  }

  valueOf(name, i) {
    this.arrays[name] ??= arrayOf(name, Float32Array);
    return [...this.arrays[name].subarray(3 * i, 3 * i + 3)];
  }

  /// Shows the estimates at pixel i, or why there are none; undefined: none was asked for.
  show(i) {
    this.marks.clear();
    const { image, grid: [columns, rows, width, height] } = this.facts, lines = [];
    part("estimate-table").replaceChildren();
    if (i >= 0) {
      const at = [i % columns * width / columns, Math.floor(i / columns) * height / rows].map(Math.floor);
      lines.push(`pixel (${at.join(", ")}) [W/(sr m²)]`);
      const sum = [0, 0, 0];
      for (const name of ["emission", "direct", "caustic", "indirect", "volume", "total"]) {
        const values = name === "total" ? sum : image[name] ? this.valueOf(image[name], i) : [0, 0, 0];
        if (name !== "total") values.forEach((v, k) => { sum[k] += v; });
        if (values.some((v) => v !== 0)) this.addRow(name, values);
      }
      lines.push(...this.mark(i));
    } else if (i === -1) lines.push("The camera does not see this place: no pixel has an estimate of it.");
    part("estimate-words").textContent = lines.join("\n");
    this.view.redraw();
  }

  addRow(name, values) {
    part("estimate-table").append(element("tr", {}, element("th", { textContent: name }),
      ...values.map((v) => element("td", { textContent: number(v) }))));
  }

  /// Draws what the estimate at pixel i uses, and returns it in words.
  mark(i) {
    const p = this.pointOf(i), n = this.normalOf(i), words = [];
    this.line([vector(facts.camera.position), p], 0xffffff);
    if (this.reflections[i] === 0) return ["This surface reflects nothing: no photons are looked up here."];
    if (this.reflections[i] === 1) {
      return ["A specular surface: the path from the eye goes on, and no photons are looked up here."];
    }
    facts.maps.forEach((map, m) => {
      const radius = this.facts.radii[map.name], component = COMPONENTS_OF_MAPS[map.name];
      if (!radius) return;
      if (map.name === "global" && this.facts.gather) {
        words.push(`indirect: ${this.facts.gather} rays gather it, here or at records of the cache`);
        return;
      }
      const disc = this.discOf(p, n, m, map, radius);
      this.circle(p, n, disc.radius, ESTIMATE_COLORS[map.name]);
      words.push(`${component}: ${disc.words}, radius ${short(disc.radius)} (${map.name === "global" ? "blue" : "yellow"})`);
    });
    const { records } = this.layers;
    if (records) words.push(`irradiance records within reach: ${this.markRecords(records, p, n)} (green)`);
    return words;
  }

  /// The disc of an estimate: to the k-th photon of the map whose normal agrees and that lies at less than half the slope of the
  /// tangent plane, as methods/parts/density/surface_disc.h decides, or the largest one.
  discOf(p, n, m, map, radius) {
    const { photons } = this.layers, share = map.shown / map.stored, { k } = this.facts;
    const distances = [];
    for (let j = 0; j < photons.count; j++) {
      if (photons.infos[4 * j + 1] !== m) continue;
      const x = photons.positions[3 * j] - p.x, y = photons.positions[3 * j + 1] - p.y, z = photons.positions[3 * j + 2] - p.z;
      const d2 = x * x + y * y + z * z;
      if (d2 > radius * radius || (x * n.x + y * n.y + z * n.z) ** 2 > d2 / 4) continue;
      const [a, b, c] = photons.normals.subarray(3 * j, 3 * j + 3);
      if (a * n.x + b * n.y + c * n.z > 63.5) distances.push(Math.sqrt(d2));
    }
    const about = share < 1 ? "about " : "", inside = counted(Math.round(distances.length / share));
    const last = Math.max(1, Math.round(k * share));
    if (k === null || !(distances.length >= last)) return { radius, words: `${about}${inside} photons within the largest disc` };
    distances.sort((a, b) => a - b);
    return { radius: distances[last - 1], words: `disc to ${about}the ${counted(k)}th photon` };
  }

  markRecords(records, p, n) {
    let within = 0;
    for (let j = 0; j < records.count; j++) {
      const at = vector(records.positions, j), normal = vector(records.normals, j);
      if (at.distanceTo(p) > records.radii[j] || normal.dot(n) < 0.9) continue;
      this.circle(at, normal, records.radii[j], ESTIMATE_COLORS.record);
      within += 1;
    }
    return within;
  }

  /// A disc that shows through surfaces.
  circle(p, n, radius, color) {
    for (const [inner, opacity] of [[0.93, 1], [0, 0.3]]) {
      const material = new THREE.MeshBasicMaterial({
        color, opacity, transparent: true, depthTest: false, side: THREE.DoubleSide,
      });
      const mesh = new THREE.Mesh(new THREE.RingGeometry(inner * radius, radius, 96), material);
      mesh.position.copy(p);
      mesh.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), n);
      mesh.renderOrder = 4;
      this.marks.add(mesh);
    }
  }

  /// A line that shows through surfaces.
  line(points, color) {
    const geometry = new THREE.BufferGeometry().setFromPoints(points);
    const line = new THREE.Line(geometry, new THREE.LineBasicMaterial({ color, depthTest: false, transparent: true }));
    line.renderOrder = 4;
    this.marks.add(line);
  }
}

/// The purposes of the photons of the method's image.
function emission(emitted) {
  const all = [...facts.maps.map((map) => [map.emitted, `for the ${map.name} map`]), [facts.beams.emitted, "for the beams"]];
  const rest = emitted - all.reduce((sum, [count]) => sum + count, 0);
  all.push([rest, "to find radii and shadows or for maps that stay empty"]);
  const passes = facts.photons_of_passes && facts.passes > 1 ? ` in ${counted(facts.passes)} passes` : "";
  const parts = all.filter(([count]) => count > 0).map(([count, what]) => `${counted(count)} ${what}`);
  return `${counted(emitted)} photons emitted${passes}: ${parts.join(", ")}.`;
}

function addEstimates(view, layers) {
  const { passes, emitted } = facts.estimate, estimates = new Estimates(view, layers), place = part("estimate");
  place.hidden = false;
  const image = `Estimates are those of the method's image after ${counted(passes)} pass${passes === 1 ? "" : "es"}`;
  place.append(element("p", { className: "facts", textContent: `${image}.` }));
  if (emitted) part(layers.photons ? "maps" : "beams").append(element("p", { className: "facts", textContent: `${emission(emitted)} ` +
    "Powers are in watts if a scene unit is a metre; else they are to be multiplied by its square [m²]." }));
  return estimates;
}
