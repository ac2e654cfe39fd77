// Puts the interactive parts into each scene's section of the page.
"use strict";
(() => {
  const {data, element, controls} = report;

  /** Shows the rows of one component in the scene's tables. */
  function chooseRows(section, component) {
    section.classList.add("one-component");
    for (const row of section.querySelectorAll("tr[data-component]")) row.hidden = row.dataset.component !== component;
  }

  const text = (cell) => cell.firstChild?.textContent.trim() ?? "";
  const swatch = (color) => element("span", {className: "swatch", style: `background: ${color}`});
  const bar = (parts) => element("span", {className: "shares"},
    ...parts.map(({share, color, title}) => element("span", {title, style: `width: ${100 * share}%; background: ${color}`})));

  /** Gives the labels of methods the colours that they have in the charts. */
  function colourMethods() {
    for (const cell of document.querySelectorAll("tbody th, td.text, .tile .name")) {
      const method = data.methods.indexOf(text(cell));
      if (method >= 0) cell.prepend(swatch(`var(--method-${method % 10})`));
    }
  }

  /** Marks the shortest measured time to each error, among the rows of one component. */
  function markTimes(section) {
    for (const head of section.querySelectorAll("thead th")) {
      if (!head.textContent.startsWith("seconds to")) continue;
      const shortest = new Map();
      for (const row of head.closest("table").tBodies[0].rows) {
        const cell = row.cells[head.cellIndex], seconds = Number(text(cell) || NaN), {component} = row.dataset;
        if (cell.textContent.includes("extrapolated") || Number.isNaN(seconds)) cell.classList.add("never");
        else if (!(shortest.get(component)?.seconds <= seconds)) shortest.set(component, {cell, seconds});
      }
      for (const {cell} of shortest.values()) cell.classList.add("best");
    }
  }

  /** Draws bars beside the shares of bias^2 and for the seconds of each stage. */
  function drawBars(section) {
    for (const cell of section.querySelectorAll("td")) {
      const share = /^(\d+) % bias$/.exec(text(cell))?.[1] / 100;
      if (share >= 0) cell.prepend(bar([{share, color: "var(--bias)", title: "bias^2"},
        {share: 1 - share, color: "var(--noise)", title: "variance"}]));
    }
    const table = [...section.querySelectorAll("summary")].find((s) => s.textContent === "Where the time goes")
      ?.parentElement.querySelector("table");
    if (!table) return;
    const heads = [...table.tHead.rows[0].cells], rows = [...table.tBodies[0].rows];
    const seconds = rows.map((row) => [...row.cells].map((cell) => Number(text(cell)) || 0));
    const longest = Math.max(...seconds.map((list) => list.reduce((a, b) => a + b)));
    const color = (i) => `var(--stage-${(i - 1) % 14})`;
    heads.forEach((head, i) => i > 0 && head.prepend(swatch(color(i))));
    rows.forEach((row, r) => row.cells[0].append(bar(seconds[r].map((s, i) =>
      ({share: s / longest, color: color(i), title: heads[i].textContent})))));
  }

  function methodToggles(state, curves, redraw) {
    const methods = [...new Set(curves.map((curve) => curve.method))];
    const attributes = {role: "group", "aria-label": "methods in the charts"};
    return element("div", {className: "control methods", attributes},
      ...methods.map((method) => {
        return controls.toggle([swatch(`var(--method-${method % 10})`), data.methods[method]], true, (shown) => {
          if (shown) state.hidden.delete(method);
          else state.hidden.add(method);
          redraw();
        });
      }));
  }

  /** The viewer of a scene, which is made when it is first needed. */
  function panelOf(section) {
    const {scene} = section.dataset;
    if (!section.panel && data.pictures[scene])
      section.panel = new report.panel.Panel(section.querySelector(".viewer"), scene);
    return section.panel;
  }

  function setUpStrip(section) {
    const strip = new report.strip.Strip(section, section.dataset.scene, (index, quantity, seconds) => {
      panelOf(section).show(index, quantity, seconds);
    });
    section.strip = strip;
    new IntersectionObserver((seen, observer) => {
      if (!seen.some((s) => s.isIntersecting)) return;
      observer.disconnect();
      strip.draw();
    }, {rootMargin: "400px"}).observe(section.querySelector(".strip"));
  }

  function setUpScene(section) {
    const {scene} = section.dataset;
    const entry = data.scenes[scene];
    const place = section.querySelector(".scene-controls");
    if (!entry || !place) return;
    const state = {component: entry.components[0], metric: "relative", hidden: new Set()};
    const charts = report.charts.sceneCharts(section, scene, state);
    const metrics = Object.keys(report.charts.metrics);
    const component = controls.select("Component", entry.components, 0, (i) => {
      state.component = entry.components[i];
      chooseRows(section, state.component);
      charts.draw();
    });
    const metric = controls.choice("Error", ["relative RMSE", "RMSE"], 0, (i) => {
      state.metric = metrics[i];
      charts.draw();
    });
    place.append(component.whole, metric.whole,
      methodToggles(state, entry.curves[entry.components[0]] ?? [], () => charts.draw()));
    chooseRows(section, state.component);
    charts.draw();
    report.onScheme(() => charts.draw());
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
  colourMethods();
  for (const section of document.querySelectorAll("section.scene")) {
    markTimes(section);
    drawBars(section);
    setUpScene(section);
  }
})();
