// Puts stage and panel together.

const part = (id) => document.getElementById(id);

function describeShown(view, layers) {
  const { photons, records, patches } = layers, parts = [];
  if (photons) {
    const stored = facts.maps.reduce((sum, map) => sum + map.stored, 0);
    parts.push(`${counted(photons.visible)} of ${counted(stored)} photons shown`);
  }
  if (records) parts.push(records.group.visible ? `${counted(records.count)} records` : "no records");
  if (patches) parts.push(patches.group.visible ? `${counted(patches.count)} patches` : "no patches");
  if (parts.length === 0) parts.push("The method has stored no light in this scene");
  part("shown").textContent = `${parts.join(", ")}.`;
  view.redraw();
}

function addPhotons(view, layers) {
  const photons = layers.photons, filter = photons.filter;
  const changed = () => {
    photons.apply();
    describeShown(view, layers);
  };
  part("photons").hidden = false;
  facts.maps.forEach((map, i) => {
    const share = map.shown < map.stored
      ? `${counted(map.shown)} of ${counted(map.stored)} on this page (${short((100 * map.shown) / map.stored)} %)`
      : `all ${counted(map.stored)} on this page`;
    const detail = `${share}; mean ${short(map.mean_power)} ${map.power_unit}`;
    addCheck(part("maps"), `${map.name} map`, detail, true, (on) => {
      filter.maps[i] = on;
      changed();
    });
  });
  const choices = { light: "the light's own", power: "power", bounces: "bounces", wavelength: "wavelength" };
  if (!facts.dispersive) delete choices.wavelength;
  const color = () => {
    photons.colorBy(select.value);
    exposure.disabled = select.value !== "light";
    drawLegend(part("legend"), select.value, photons);
    view.redraw();
  };
  const first = facts.dispersive ? "wavelength" : "light";
  const select = addChoice(part("maps"), "Colour", Object.entries(choices), first, () => color());
  const redraw = () => view.redraw();
  const stops = { min: -4, max: 4, step: 0.5, value: 0, text: (v) => `${v} EV` };
  const exposure = addSlider(part("photons"), "Exposure", stops, redraw);
  addBounces(photons, changed);
  if (facts.photons_of_passes && facts.passes > 1) addPasses(photons, changed);
  const points = { min: 1, max: 10, step: 0.5, value: sizeOfPoints(photons.count, view.stage), text: (v) => `${v} px` };
  const size = addSlider(part("photons"), "Size of points", points, redraw);
  view.beforeDraw = (ratio, pixels) => {
    const uniforms = photons.points.material.uniforms;
    uniforms.size.value = size.value * ratio;
    // A photon is the brighter, the fewer of them lie on a pixel if they lay evenly on the stage.
    const layers = (photons.count * size.value ** 2) / pixels;
    uniforms.exposure.value = Math.min(1, 0.25 / layers) * 2 ** exposure.value;
  };
  color();
}

/// Fewer points are larger, so that they can be seen, and so are those on a large stage [pixels of the page].
function sizeOfPoints(count, stage) {
  const size = Math.min(Math.max(4.5 - 0.75 * Math.log10(Math.max(count, 1) / 1000), 1.5), 5);
  const share = Math.min(Math.max(Math.sqrt((stage.clientWidth * stage.clientHeight) / 1e6), 0.6), 1);
  return Math.max(1, Math.round(2 * size * share) / 2);
}

function addBounces(photons, changed) {
  const { bounces } = photons.filter, limits = { min: 0, max: photons.mostBounces };
  const set = (i, value) => {
    bounces[i] = value;
    if (bounces[0] > bounces[1]) bounces[1 - i] = value;  // the other end gives way
    ends.forEach((end, k) => {
      end.value = bounces[k];
      end.update();
    });
    changed();
  };
  const ends = ["Least bounces", "Most bounces"].map((name, i) =>
    addSlider(part("photons"), name, { ...limits, value: bounces[i] }, (value) => set(i, value)));
}

function addPasses(photons, changed) {
  const set = () => {
    const last = Number(slider.value) - 1;
    photons.filter.passes = [alone.checked ? last : 0, last];
    changed();
  };
  const limits = { min: 1, max: facts.passes, value: facts.passes };
  const slider = addSlider(part("photons"), "Passes up to", limits, set);
  const alone = addCheck(part("photons"), "that pass alone", "", false, set);
}

function addRecords(view, layers) {
  const records = layers.records, place = part("records");
  place.hidden = false;
  addCheck(place, "discs of their radius", `${counted(records.count)}, white: E ${short(records.white)} W/m²`, true,
    (on) => {
      records.group.visible = on;
      describeShown(view, layers);
    });
  addSlider(place, "Radius", { min: 5, max: 100, value: 100, text: (v) => `${v} %` }, (value) => {
    records.scale(value / 100);
    view.redraw();
  });
}

function addPatches(view, layers) {
  const patches = layers.patches, place = part("patches");
  place.hidden = false;
  const detail = `${counted(patches.count)} patches, white: ${short(patches.white)} W/m²`;
  addCheck(place, "radiosity", detail, true, (on) => {
    patches.group.visible = on;
    describeShown(view, layers);
  });
  addCheck(place, "edges", "", true, (on) => {
    patches.edges.visible = on;
    view.redraw();
  });
  addSlider(place, "Exposure", { min: -4, max: 8, step: 0.5, value: 0, text: (v) => `${v} EV` }, (value) => {
    patches.expose(value);
    view.redraw();
  });
}

function addSurfaces(view, layers) {
  const { shown, whole } = facts.surfaces;
  const choices = ["solid", "translucent", "wire", "hidden"].map((name) => [name, name]);
  const first = layers.patches ? "hidden" : "solid";
  layers.surfaces.show(first);
  addChoice(part("surfaces"), "Draw them", choices, first, (how) => {
    layers.surfaces.show(how);
    view.redraw();
  });
  const cut = { min: 0, max: 100, value: 0, text: (v) => `${v} %` };
  addSlider(part("surfaces"), "Cut away", cut, (share) => {
    view.cut = share / 100;
    view.redraw();
  });
  const text = shown < whole ? `${counted(shown)} of ${counted(whole)} triangles` : `${counted(whole)} triangles`;
  element("p", part("surfaces"), { className: "facts", textContent: text });
}

/// The thing at a place on the stage: the nearest photon, else a record, else a patch; and the estimate there.
function pick(place, box, view, layers) {
  const caster = new THREE.Raycaster();
  caster.setFromCamera(place, view.camera);
  const { photons, records, patches } = layers;
  let text = "";
  const photon = photons ? photons.nearest(place, view.camera, box.width, box.height) : -1;
  const on = (layer, object) => (layer?.group.visible ? caster.intersectObject(object)[0] : undefined);
  const disc = on(records, records?.discs), face = on(patches, patches?.mesh);
  if (photon >= 0) text = photons.describe(photon);
  else if (disc) text = records.describe(disc.instanceId);
  else if (face) text = patches.describe(Math.floor(face.faceIndex / 2));
  part("picked").textContent = text;
  part("picked").hidden = text === "";
  if (!layers.estimates) return;
  caster.near = view.camera.near;  // what is cut away is not hit
  const surface = caster.intersectObject(layers.surfaces.mesh)[0];
  layers.estimates.show(surface ? layers.estimates.pixelAt(surface.point) : undefined);
  if (face && photon < 0) layers.estimates.line(patches.outline(Math.floor(face.faceIndex / 2)), 0xffe27a);
}

function start() {
  const stage = part("stage");
  let view;
  try {
    view = new View(stage);
  } catch (error) {
    element("p", stage, { className: "failure", textContent: `This browser draws no WebGL: ${error.message}` });
    return;
  }
  const layers = { surfaces: new Surfaces() };
  const passes = facts.photons_of_passes ? `, passes 1 to ${facts.passes}`
    : facts.passes > 0 ? `, after pass ${facts.passes}` : "";
  part("origin").textContent = `seed ${facts.seed}${passes}`;
  if (facts.maps.length) layers.photons = new Photons();
  if (facts.records) layers.records = new Records();
  if (facts.patches) layers.patches = new Patches();
  view.scene.add(layers.surfaces.mesh);
  if (layers.photons) view.scene.add(layers.photons.points);
  if (layers.records) view.scene.add(layers.records.group);
  if (layers.patches) view.scene.add(layers.patches.group);
  if (facts.estimates) layers.estimates = addEstimates(view, layers);
  if (layers.photons) addPhotons(view, layers);
  if (layers.records) addRecords(view, layers);
  if (layers.patches) addPatches(view, layers);
  addSurfaces(view, layers);
  view.onPick = (place, box) => pick(place, box, view, layers);
  stage.view = view;
  stage.layers = layers;
  describeShown(view, layers);
  stage.dataset.ready = "true";
}

start();
