// Everything that has an extent: the scene's surfaces, photon beams, records of an irradiance cache as discs, patches of radiosity.

const colorsOf = (numbers, factor) => numbers.map((v) => clamped(v * factor, 0, 1));

/// The surfaces: diffuse reflectors and emitters first, transparent ones last.
class Surfaces {
  constructor() {
    const geometry = new THREE.BufferGeometry();
    const attribute = (name, Type, normalized) =>
      new THREE.BufferAttribute(arrayOf(`surface-${name}`, Type), Type === Float32Array ? 3 : 4, normalized);
    geometry.setAttribute("position", attribute("positions", Float32Array, false));
    geometry.setAttribute("normal", attribute("normals", Int8Array, true));
    geometry.setAttribute("color", attribute("colors", Uint8Array, true));
    const { opaque, shown } = facts.surfaces;
    geometry.addGroup(0, 3 * opaque, 0);
    geometry.addGroup(3 * opaque, 3 * (shown - opaque), 1);
    const material = () => new THREE.MeshLambertMaterial({
      vertexColors: true, side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
    });
    this.materials = [material(), material()];
    this.mesh = new THREE.Mesh(geometry, this.materials);
    this.mesh.renderOrder = 1;
  }

  /// Solid surfaces are dim, so that stored light is visible on them.
  show(how) {
    this.mesh.visible = how !== "hidden";
    this.materials.forEach((material, i) => {
      const solid = how === "solid" && i === 0;
      material.color.setScalar(solid ? 0.1 : 1);
      material.wireframe = how === "wire";
      material.transparent = !solid;
      material.depthWrite = solid;
      material.opacity = solid ? 1 : how === "wire" ? 0.3 : [0.2, 0.3][i];
      material.needsUpdate = true;
    });
  }
}

/// Photon beams as lines, which add up as light does.
class Beams {
  constructor() {
    this.powers = arrayOf("beam-powers", Float32Array);
    this.count = this.powers.length / 3;
    this.white = quantile(this.powers, 0.98) || 1;
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(arrayOf("beam-ends", Float32Array), 3));
    geometry.setAttribute("color", new THREE.BufferAttribute(new Float32Array(6 * this.count), 3));
    this.group = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({
      vertexColors: true, transparent: true, depthWrite: false, blending: THREE.AdditiveBlending,
    }));
    this.group.frustumCulled = false;
    this.group.renderOrder = 3;
    this.expose(0);
  }

  /// A beam is the brighter, the fewer there are.
  expose(stops) {
    const { color } = this.group.geometry.attributes, factor = (Math.min(1, 200 / this.count) * 2 ** stops) / this.white;
    for (let i = 0; i < this.count; i++) {
      const shown = colorsOf(this.powers.subarray(3 * i, 3 * i + 3), factor);
      color.array.set(shown, 6 * i);
      color.array.set(shown, 6 * i + 3);
    }
    color.needsUpdate = true;
  }
}

/// Records of an irradiance cache: a faint disc and its rim each, one draw call for all discs and one for all rims.
class Records {
  constructor() {
    this.positions = arrayOf("record-positions", Float32Array);
    this.normals = arrayOf("record-normals", Float32Array);
    this.irradiances = arrayOf("record-irradiances", Float32Array);
    this.radii = arrayOf("record-radii", Float32Array);
    this.count = this.radii.length;
    this.white = quantile(this.irradiances, 0.98) || 1;
    const instanced = (geometry, opacity) => {
      const material = new THREE.MeshBasicMaterial({
        transparent: true, opacity, side: THREE.DoubleSide, depthWrite: false,
      });
      const mesh = new THREE.InstancedMesh(geometry, material, this.count);
      mesh.frustumCulled = false;
      mesh.renderOrder = 2;
      return mesh;
    };
    this.discs = instanced(new THREE.CircleGeometry(1, 32), 0.16);
    this.rims = instanced(new THREE.RingGeometry(0.95, 1, 32), 0.8);
    this.group = new THREE.Group();
    this.group.add(this.discs, this.rims);
    this.scale(1);
    const color = new THREE.Color();
    for (let i = 0; i < this.count; i++) {
      color.setRGB(...colorsOf(this.irradianceOf(i), 1 / this.white));
      this.discs.setColorAt(i, color);
      this.rims.setColorAt(i, color);
    }
  }

  irradianceOf(i) { return [...this.irradiances.subarray(3 * i, 3 * i + 3)]; }

  /// Draws each disc with this share of its radius.
  scale(share) {
    const matrix = new THREE.Matrix4(), turn = new THREE.Quaternion(), z = new THREE.Vector3(0, 0, 1);
    const p = new THREE.Vector3(), n = new THREE.Vector3(), size = new THREE.Vector3();
    for (let i = 0; i < this.count; i++) {
      n.fromArray(this.normals, 3 * i);
      p.fromArray(this.positions, 3 * i).addScaledVector(n, 2e-4 * facts.diagonal);
      matrix.compose(p, turn.setFromUnitVectors(z, n), size.setScalar(share * this.radii[i]));
      this.discs.setMatrixAt(i, matrix);
      this.rims.setMatrixAt(i, matrix);
    }
    this.discs.instanceMatrix.needsUpdate = this.rims.instanceMatrix.needsUpdate = true;
    this.discs.computeBoundingSphere();  // picking reads it
  }

  describe(i) {
    return `Irradiance record\nradius ${short(this.radii[i])}\nE (${triple(...this.irradianceOf(i))}) W/m²`;
  }
}

/// Patches with radiosity, linear between their corners.
class Patches {
  constructor() {
    this.radiosities = arrayOf("patch-radiosities", Float32Array);
    this.indices = arrayOf("patch-indices", Uint32Array);
    this.count = this.indices.length / 4;
    this.white = quantile(this.radiosities, 0.98) || 1;
    const position = new THREE.BufferAttribute(arrayOf("patch-corners", Float32Array), 3);
    const triangles = [], edges = [];
    for (let i = 0; i < this.indices.length; i += 4) {
      const [a, b, c, d] = this.indices.subarray(i, i + 4);
      triangles.push(a, b, c, a, c, d);
      edges.push(a, b, b, c, c, d, d, a);
    }
    const geometry = (index) => {
      const made = new THREE.BufferGeometry();
      made.setAttribute("position", position);
      made.setIndex(index);
      return made;
    };
    const faces = geometry(triangles);
    this.colors = new THREE.BufferAttribute(new Float32Array(this.radiosities.length), 3);
    faces.setAttribute("color", this.colors);
    this.mesh = new THREE.Mesh(faces, new THREE.MeshBasicMaterial({
      vertexColors: true, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
    }));
    this.edges = new THREE.LineSegments(geometry(edges), new THREE.LineBasicMaterial({
      color: 0xffffff, transparent: true, opacity: 0.12, depthWrite: false,
    }));
    this.group = new THREE.Group();
    this.group.add(this.mesh, this.edges);
    this.expose(0);
  }

  /// Brightens by this number of stops; at 0 the brightest fiftieth is white.
  expose(stops) {
    this.colors.array.set(colorsOf(this.radiosities, 2 ** stops / this.white));
    this.colors.needsUpdate = true;
  }

  outline(patch) {
    const corners = this.mesh.geometry.attributes.position;
    return [0, 1, 2, 3, 0].map((i) => new THREE.Vector3().fromBufferAttribute(corners, this.indices[4 * patch + i]));
  }

  describe(patch) {
    const corners = [...new Set(this.indices.subarray(4 * patch, 4 * patch + 4))];
    const lines = corners.map((c) => `(${triple(...this.radiosities.subarray(3 * c, 3 * c + 3))})`);
    return `Patch, radiosity of its corners [W/m²]\n${lines.join("\n")}`;
  }
}
