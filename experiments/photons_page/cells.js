// The field that paths have learned: its cells of space as boxes, and at a click the density with which one chooses directions.

const FACINGS = ["+x", "−x", "+y", "−y", "+z", "−z"];

class Cells {
  constructor() {
    this.lower = arrayOf("cell-lower", Float32Array);
    this.upper = arrayOf("cell-upper", Float32Array);
    this.facing = arrayOf("cell-facing", Uint8Array);
    this.selections = arrayOf("cell-selections", Float32Array);
    this.radiances = arrayOf("cell-radiances", Float32Array);
    this.peaks = arrayOf("cell-peaks", Float32Array);
    this.densities = arrayOf("cell-densities", Uint8Array);
    this.count = this.facing.length;
    const known = [...this.radiances].filter((v) => v > 0);
    this.range = [quantile(known, 0.02), quantile(known, 0.98)].map((v) => Math.log2(v || 1));
    this.group = new THREE.Group();
    this.picked = new THREE.Group();
    this.show(7);
  }

  /// Draws the cells of surfaces that face so, of media (6), or all (7). Those that know of no light are left out.
  show(facing) {
    const positions = [], colors = [];
    for (let i = 0; i < this.count; i++) {
      if (!(this.selections[i] > 0) || (facing < 7 && this.facing[i] !== facing)) continue;
      const share = (Math.log2(this.radiances[i]) - this.range[0]) / Math.max(this.range[1] - this.range[0], 1);
      const color = scaleColor(POWER_SCALE, clamped(share, 0, 1)).map((v) => v / 255);
      for (const corner of this.edges(i)) {
        positions.push(...corner);
        colors.push(...color);
      }
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.Float32BufferAttribute(positions, 3));
    geometry.setAttribute("color", new THREE.Float32BufferAttribute(colors, 3));
    const material = new THREE.LineBasicMaterial({ vertexColors: true, transparent: true, opacity: 0.35 });
    this.group.clear();
    this.group.add(new THREE.LineSegments(geometry, material), this.picked);
    this.visible = positions.length / 72;
  }

  /// The ends of the twelve edges of a box.
  edges(i) {
    const corner = (k) => [0, 1, 2].map((axis) => (k >> axis & 1 ? this.upper : this.lower)[3 * i + axis]);
    return [1, 2, 4].flatMap((axis) => [0, 1, 2, 3, 4, 5, 6, 7].filter((k) => !(k & axis))
      .flatMap((k) => [corner(k), corner(k | axis)]));
  }

  /// The cell of a place on a surface with this normal; -1: it is not on this page.
  at(p, n) {
    const sizes = [0, 1, 2].map((axis) => Math.abs(n.getComponent(axis))), axis = sizes.indexOf(Math.max(...sizes));
    const facing = 2 * axis + (n.getComponent(axis) < 0 ? 1 : 0);
    for (let i = 0; i < this.count; i++) {
      const inside = (k) => p.getComponent(k) >= this.lower[3 * i + k] && p.getComponent(k) < this.upper[3 * i + k];
      if (this.facing[i] === facing && inside(0) && inside(1) && inside(2)) return i;
    }
    return -1;
  }

  /// Draws a cell and, at p, its density as a lobe: the farther its surface in a direction, the more paths go there.
  pick(i, p) {
    this.picked.clear();
    if (i < 0) return;
    const box = new THREE.BufferGeometry();
    box.setAttribute("position", new THREE.Float32BufferAttribute(this.edges(i).flat(), 3));
    const edge = 2 ** facts.cells.depth, reach = 0.08 * facts.diagonal, positions = [], colors = [];
    const corner = (column, row, reached) => {
      const z = 2 * column / edge - 1, r = Math.sqrt(Math.max(1 - z * z, 0)), turn = 2 * Math.PI * row / edge;
      return [p.x + reached * r * Math.cos(turn), p.y + reached * r * Math.sin(turn), p.z + reached * z];
    };
    for (let row = 0; row < edge; row++)
      for (let column = 0; column < edge; column++) {
        const root = this.densities[(i * edge + row) * edge + column] / 255;  // square root of the density over its peak
        if (root === 0) continue;
        const [a, b, c, d] = [[0, 0], [1, 0], [1, 1], [0, 1]].map(([x, y]) => corner(column + x, row + y, reach * root));
        const o = p.toArray();
        positions.push(...[a, b, c, a, c, d, o, a, b, o, b, c, o, c, d, o, d, a].flat());
        const color = scaleColor(POWER_SCALE, root).map((v) => v / 255);
        for (let k = 0; k < 18; k++) colors.push(...color);
      }
    const lobe = new THREE.BufferGeometry();
    lobe.setAttribute("position", new THREE.Float32BufferAttribute(positions, 3));
    lobe.setAttribute("color", new THREE.Float32BufferAttribute(colors, 3));
    this.picked.add(new THREE.LineSegments(box, new THREE.LineBasicMaterial({ color: 0xffe27a, depthTest: false })),
      new THREE.Mesh(lobe, new THREE.MeshBasicMaterial({ vertexColors: true, side: THREE.DoubleSide })));
  }

  describe(i) {
    if (i < 0) return "The cell of this place is not on this page.";
    const sides = [0, 1, 2].map((k) => short(this.upper[3 * i + k] - this.lower[3 * i + k]));
    const name = this.facing[i] < 6 ? `Cell of surfaces that face ${FACINGS[this.facing[i]]}` : "Cell of media";
    if (!(this.selections[i] > 0)) return `${name}, ${sides.join(" × ")}\nit knows of no light yet`;
    return `${name}, ${sides.join(" × ")}\n${short(100 * this.selections[i])} % of the paths follow it\n` +
      `peak ${short(this.peaks[i])} / sr (evenly 0.0796)\nreflects ${short(this.radiances[i])} W/(sr m²) in the mean`;
  }
}
