// Puts the interactive parts into each scene's section of the page.

/** Shows the rows of one component in the scene's tables. */
function chooseRows(section, component) {
  section.classList.add("one-component");
  for (const row of section.querySelectorAll("tr[data-component]")) row.hidden = row.dataset.component !== component;
}

function methodToggles(state, curves, redraw) {
  const methods = [...new Set(curves.map((curve) => curve.method))];
  const attributes = {role: "group", "aria-label": "methods in the charts"};
  return element("div", {className: "control methods", attributes}, ...methods.map((method) => {
    const swatch = element("span", {className: "swatch", style: `background: var(--method-${method % 10})`});
    return toggle([swatch, data.methods[method]], true, (shown) => {
      state.hidden[shown ? "delete" : "add"](method);
      redraw();
    });
  }));
}

/** The viewer of a scene, which is made when it is first needed. */
function panelOf(section) {
  const {scene} = section.dataset, place = section.querySelector(".viewer");
  const best = section.querySelector(".tile.best")?.dataset.method;
  if (data.pictures[scene]) section.panel ??= new ViewerPanel(place, scene, section.id.replace("scene-", ""), best);
  return section.panel;
}

/** Shows what an address like #viewer-0?a=2&mode=2 asks for. */
function followAddress() {
  const [, number, state] = /^#viewer-(\d+)\?(.*)$/.exec(location.hash) ?? [];
  const section = number && document.getElementById(`scene-${number}`);
  if (section) panelOf(section)?.restore(state);
}

/** Strips are drawn in turn, those out of sight too: a printer does not scroll. */
let drawing = Promise.resolve();
function setUpStrip(section) {
  section.strip = new Strip(section, section.dataset.scene, (index, quantity, seconds) => {
    panelOf(section).show(index, quantity, seconds);
  });
  drawing = drawing.then(() => section.strip.draw());
}

/** Opens all that is folded while the page is printed, and fits the charts to the paper. */
function printWhole() {
  let opened = [];
  const open = (isOpen) => {
    for (const details of opened) details.open = isOpen;
    Object.values(Chart.instances).forEach((chart) => chart.resize());
  };
  addEventListener("beforeprint", () => {
    opened = [...document.querySelectorAll("details:not([open])")];
    open(true);
  });
  addEventListener("afterprint", () => open(false));
}

function setUpScene(section) {
  const {scene} = section.dataset;
  const entry = data.scenes[scene];
  const place = section.querySelector(".scene-controls");
  if (!entry || !place) return;
  const state = {component: entry.components[0], metric: "relative", hidden: new Set()};
  const drawCharts = sceneCharts(section, scene, state);
  const redraw = () => {
    chooseRows(section, state.component);
    drawCharts();
  };
  const component = select("Component", entry.components, 0, (i) => {
    state.component = entry.components[i];
    redraw();
  });
  const metric = choice("Error", ["relative RMSE", "RMSE"], 0, (i) => {
    state.metric = Object.keys(curveMetrics)[i];
    redraw();
  });
  place.append(component.whole, metric.whole, methodToggles(state, entry.curves[entry.components[0]] ?? [], redraw));
  const sweeps = section.querySelector(".sweep-charts");
  if (sweeps) for (const sweep of entry.sweeps) setUpSweep(sweeps, sweep);
  redraw();
  onScheme(redraw);
  // Images are unpacked when their scene comes into view, because a page may have many scenes. The whole scene is
  // observed, so that the viewer is there before the keyboard comes to it.
  new IntersectionObserver((seen, observer) => {
    if (!seen.some((s) => s.isIntersecting)) return;
    observer.disconnect();
    panelOf(section);
  }, {rootMargin: "400px"}).observe(section);
  if (data.pictures[scene] && section.querySelector(".strip")) setUpStrip(section);
}

document.documentElement.classList.add("scripted");
printWhole();
for (const section of document.querySelectorAll("section.scene")) setUpScene(section);
followAddress();
addEventListener("hashchange", followAddress);
