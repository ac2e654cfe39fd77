// The stage: camera, orbit, keys, picking, and frames that are drawn only when something has changed.

class View {
  constructor(stage) {
    this.stage = stage;
    // Smooth edges would more than double the time of a frame with a million points, which cover them anyway.
    const antialias = facts.maps.reduce((sum, map) => sum + map.shown, 0) <= 300000;
    this.renderer = new THREE.WebGLRenderer({ antialias, powerPreference: "high-performance" });
    stage.prepend(this.renderer.domElement);
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera();
    this.camera.up.fromArray(facts.camera.up);
    this.camera.add(new THREE.DirectionalLight(0xffffff, 1.3));
    this.scene.add(this.camera, new THREE.AmbientLight(0xffffff, 1.9));
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.enableDamping = false;
    this.controls.addEventListener("change", () => this.redraw());
    this.frames = 0;
    this.cut = 0;
    this.reset();
    new ResizeObserver(() => this.resize()).observe(stage);
    onScheme(() => this.redraw());
    stage.addEventListener("keydown", (event) => this.key(event));
    this.listenForPicks();
    this.resize();
  }

  /// The view of the scene's own camera, which turns about the scene's middle as it lies along the view.
  reset() {
    const from = vector(facts.camera.position), along = vector(facts.camera.direction);
    const depth = vector(facts.center).sub(from).dot(along);
    this.camera.position.copy(from);
    this.controls.target.copy(from).addScaledVector(along, Math.max(depth, 0.05 * facts.diagonal));
    this.controls.minDistance = 1e-3 * facts.diagonal;
    this.controls.maxDistance = 50 * facts.diagonal + from.distanceTo(this.controls.target);
    this.controls.update();
    this.redraw();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.stage;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(width, height);
    // The whole image of the scene's camera fits in the stage.
    const half = Math.tan((facts.camera.fov * Math.PI) / 360), aspect = width / height;
    const fitting = half * Math.max(1, facts.camera.aspect / aspect);
    this.camera.fov = (Math.atan(fitting) * 360) / Math.PI;
    this.camera.aspect = aspect;
    this.redraw();
  }

  redraw() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.draw();
    });
  }

  draw() {
    const away = this.camera.position.distanceTo(vector(facts.center));
    this.camera.far = away + 1.5 * facts.diagonal;
    // The scene lies within half a diagonal of its centre; `cut` is the share of that depth which is left out in front.
    const cut = this.cut > 0 ? away + (this.cut - 0.5) * facts.diagonal : 0;
    this.camera.near = Math.max(5e-4 * this.camera.far, away - 1.5 * facts.diagonal, cut);
    this.camera.updateProjectionMatrix();
    this.scene.background = new THREE.Color(color("--stage", this.stage));
    const { clientWidth, clientHeight } = this.stage;
    if (this.beforeDraw) this.beforeDraw(this.renderer.getPixelRatio(), clientWidth * clientHeight);
    this.renderer.render(this.scene, this.camera);
    this.frames += 1;
    this.stage.dataset.calls = this.renderer.info.render.calls;
    this.stage.dataset.frames = this.frames;
  }

  /// Turns the camera about its target by angles [radians], or moves it along the stage, or towards the target.
  turn(across, down) {
    const up = new THREE.Quaternion().setFromUnitVectors(this.camera.up, new THREE.Vector3(0, 1, 0));
    const offset = this.camera.position.clone().sub(this.controls.target).applyQuaternion(up);
    const at = new THREE.Spherical().setFromVector3(offset);
    at.theta += across;
    at.phi += down;
    at.makeSafe();
    offset.setFromSpherical(at).applyQuaternion(up.invert());
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
  }

  move(right, up) {
    const distance = this.camera.position.distanceTo(this.controls.target), step = new THREE.Vector3();
    for (const [column, by] of [[0, right], [1, up]])
      step.addScaledVector(new THREE.Vector3().setFromMatrixColumn(this.camera.matrix, column), by * distance);
    this.camera.position.add(step);
    this.controls.target.add(step);
    this.controls.update();
  }

  zoom(factor) {
    const offset = this.camera.position.clone().sub(this.controls.target).multiplyScalar(factor);
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
  }

  key(event) {
    const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const arrow = arrows[event.key];
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (arrow && event.shiftKey) this.move(0.05 * arrow[0], -0.05 * arrow[1]);
    else if (arrow) this.turn(0.08 * arrow[0], 0.08 * arrow[1]);
    else if (event.key === "+" || event.key === "=") this.zoom(1 / 1.12);
    else if (event.key === "-") this.zoom(1.12);
    else if (event.key === "0") this.reset();
    else return;
    event.preventDefault();
  }

  /// A press that does not move picks what lies there.
  listenForPicks() {
    const canvas = this.renderer.domElement;
    let start = null;
    canvas.addEventListener("pointerdown", (event) => { start = [event.clientX, event.clientY]; });
    canvas.addEventListener("pointerup", (event) => {
      if (!start || Math.hypot(event.clientX - start[0], event.clientY - start[1]) > 4 || !this.onPick) return;
      const box = canvas.getBoundingClientRect();
      this.onPick(new THREE.Vector2(((event.clientX - box.left) / box.width) * 2 - 1,
        1 - ((event.clientY - box.top) / box.height) * 2), box);
    });
  }
}
