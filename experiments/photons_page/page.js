// Puts stage and panel together.

function describeShown(view, layers) {
  const { photons, beams, records, patches } = layers, parts = [];
  if (photons) {
    const stored = facts.maps.reduce((sum, map) => sum + map.stored, 0);
    parts.push(`${counted(photons.visible)} of ${counted(stored)} photons shown`);
  }
  if (beams) parts.push(beams.group.visible ? `${counted(beams.count)} beams` : "no beams");
  if (records) parts.push(records.group.visible ? `${counted(records.count)} records` : "no records");
  if (patches) parts.push(patches.group.visible ? `${counted(patches.count)} patches` : "no patches");
  if (parts.length === 0) parts.push("The method has stored no light in this scene");
  part("shown").textContent = `${parts.join(", ")}.`;
  view.redraw();
}

function addPhotons(view, layers) {
  const { photons } = layers, { filter } = photons, { bounces } = filter, place = part("photons");
  const redraw = () => view.redraw();
  const changed = () => {
    photons.apply();
    describeShown(view, layers);
  };
  place.hidden = false;
  part("maps").append(...facts.maps.map((map, i) => {
    const share = map.shown < map.stored
      ? `${counted(map.shown)} of ${counted(map.stored)} on this page (${short((100 * map.shown) / map.stored)} %)`
      : `all ${counted(map.stored)} on this page`;
    return check(`${map.name} map`, `${share}; mean ${short(map.mean_power)} ${map.power_unit}`, (on) => {
      filter.maps[i] = on;
      changed();
    }).whole;
  }));
  const names = { light: "the light's own", power: "power", bounces: "bounces", wavelength: "wavelength" };
  if (!facts.dispersive) delete names.wavelength;
  const exposure = exposureSlider(4, redraw), keys = Object.keys(names);
  const colorBy = (i) => {
    photons.colorBy(keys[i]);
    exposure.input.disabled = keys[i] !== "light";
    part("legend").replaceChildren(...legendOf(keys[i], photons));
    redraw();
  };
  const first = facts.dispersive ? keys.indexOf("wavelength") : 0;
  part("maps").append(select("Colour", Object.values(names), first, colorBy).whole);
  // The ends of the range of bounces; where one passes the other, that one gives way.
  const ends = ["Least bounces", "Most bounces"].map((name, i) =>
    slider(name, { min: 0, max: photons.mostBounces, value: bounces[i] }, String, (value) => {
      bounces[i] = value;
      if (bounces[0] > bounces[1]) bounces[1 - i] = value;
      ends.forEach((end, k) => end.set(bounces[k]));
      changed();
    }));
  place.append(exposure.whole, ...ends.map((end) => end.whole));
  if (facts.photons_of_passes && facts.passes > 1) {
    const set = () => {
      const last = Number(passes.input.value) - 1;
      filter.passes = [alone.box.checked ? last : 0, last];
      changed();
    };
    const passes = slider("Passes up to", { min: 1, max: facts.passes, value: facts.passes }, String, set);
    const alone = check("that pass alone", "", set);
    alone.box.checked = false;
    place.append(passes.whole, alone.whole);
  }
  const value = sizeOfPoints(photons.count, view.stage);
  const size = slider("Size of points", { min: 1, max: 10, step: 0.5, value }, (v) => `${v} px`, redraw);
  place.append(size.whole);
  view.beforeDraw = (ratio, pixels) => {
    const uniforms = photons.points.material.uniforms, points = Number(size.input.value);
    uniforms.size.value = points * ratio;
    // A photon is the brighter, the fewer of them lie on a pixel if they lay evenly on the stage.
    const layers = (photons.count * points ** 2) / pixels;
    uniforms.exposure.value = Math.min(1, 0.25 / layers) * 2 ** exposure.input.value;
  };
  colorBy(first);
}

/// Fewer points are larger, so that they can be seen, and so are those on a large stage [pixels of the page].
function sizeOfPoints(count, stage) {
  const size = clamped(4.5 - 0.75 * Math.log10(Math.max(count, 1) / 1000), 1.5, 5);
  const share = clamped(Math.sqrt((stage.clientWidth * stage.clientHeight) / 1e6), 0.6, 1);
  return Math.max(1, Math.round(2 * size * share) / 2);
}

/// A section of the panel about a layer that can be hidden, with further controls.
function addLayer(view, layers, name, label, detail, ...more) {
  part(name).hidden = false;
  part(name).append(check(label, detail, (on) => {
    layers[name].group.visible = on;
    describeShown(view, layers);
  }).whole, ...more.map((control) => control.whole));
}

function addBeams(view, layers) {
  const { beams } = layers, { shown, stored } = facts.beams;
  addLayer(view, layers, "beams", "lines",
    `${shown < stored ? `${counted(shown)} of ` : "all "}${counted(stored)} on this page; white: ${short(beams.white)} W`,
    exposureSlider(8, (value) => {
      beams.expose(value);
      view.redraw();
    }));
}

function addRecords(view, layers) {
  const { records } = layers;
  addLayer(view, layers, "records", "discs of their radius",
    `${counted(records.count)}, white: E ${short(records.white)} W/m²`,
    slider("Radius", { min: 5, max: 100, value: 100 }, (v) => `${v} %`, (value) => {
      records.scale(value / 100);
      view.redraw();
    }));
}

function addPatches(view, layers) {
  const { patches } = layers;
  addLayer(view, layers, "patches", "radiosity", `${counted(patches.count)} patches, white: ${short(patches.white)} W/m²`,
    check("edges", "", (on) => {
      patches.edges.visible = on;
      view.redraw();
    }),
    exposureSlider(8, (value) => {
      patches.expose(value);
      view.redraw();
    }));
}

function addSurfaces(view, layers) {
  const { shown, whole } = facts.surfaces, ways = ["solid", "translucent", "wire", "hidden"];
  const first = layers.patches ? 3 : 0;
  const show = (i) => {
    layers.surfaces.show(ways[i]);
    view.redraw();
  };
  show(first);
  part("surfaces").append(select("Draw them", ways, first, show).whole,
    slider("Cut away", { min: 0, max: 100, value: 0 }, (v) => `${v} %`, (share) => {
      view.cut = share / 100;
      view.redraw();
    }).whole,
    element("p", { className: "facts",
      textContent: `${shown < whole ? `${counted(shown)} of ` : ""}${counted(whole)} triangles` }));
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
  caster.near = view.camera.near;  // what is cut away is not hit
  const surface = caster.intersectObject(layers.surfaces.mesh)[0];
  part("picked").textContent = text;
  part("picked").hidden = text === "";
  if (!layers.estimates) return;
  layers.estimates.show(surface ? layers.estimates.pixelAt(surface.point) : undefined);
  if (face && photon < 0) layers.estimates.line(patches.outline(Math.floor(face.faceIndex / 2)), 0xffe27a);
}

function start() {
  const stage = part("stage");
  let view;
  try {
    view = new View(stage);
  } catch (error) {
    stage.append(element("p", { className: "failure", textContent: `This browser draws no WebGL: ${error.message}` }));
    return;
  }
  const layers = { surfaces: new Surfaces() };
  const passes = facts.photons_of_passes ? `, passes 1 to ${facts.passes}`
    : facts.passes > 0 ? `, after pass ${facts.passes}` : "";
  part("origin").textContent = `seed ${facts.seed}${passes}`;
  if (facts.maps.length) layers.photons = new Photons();
  if (facts.beams.shown) layers.beams = new Beams();
  if (facts.records) layers.records = new Records();
  if (facts.patches) layers.patches = new Patches();
  view.scene.add(layers.surfaces.mesh);
  if (layers.photons) view.scene.add(layers.photons.points);
  if (layers.beams) view.scene.add(layers.beams.group);
  if (layers.records) view.scene.add(layers.records.group);
  if (layers.patches) view.scene.add(layers.patches.group);
  if (facts.estimate) layers.estimates = addEstimates(view, layers);
  if (layers.photons) addPhotons(view, layers);
  if (layers.beams) addBeams(view, layers);
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
