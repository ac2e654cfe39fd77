// Puts the interactive parts into each scene's section of the page.
"use strict";
(() => {
  const {data, element, controls} = report;

  /** Shows the rows of one component in the scene's tables. */
  function chooseRows(section, component) {
    section.classList.add("one-component");
    for (const row of section.querySelectorAll("tr[data-component]")) row.hidden = row.dataset.component !== component;
  }

  function methodToggles(state, curves, redraw) {
    const methods = [...new Set(curves.map((curve) => curve.method))];
    const attributes = {role: "group", "aria-label": "methods in the charts"};
    return element("div", {className: "control methods", attributes},
      ...methods.map((method) => {
        const swatch = element("span", {className: "swatch"});
        swatch.style.background = `var(--method-${method % 10})`;
        return controls.toggle([swatch, data.methods[method]], true, (shown) => {
          if (shown) state.hidden.delete(method);
          else state.hidden.add(method);
          redraw();
        });
      }));
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
    section.charts = charts;
    // Images are unpacked when their scene comes into view, because a page may have many scenes.
    new IntersectionObserver((seen, observer) => {
      if (!seen.some((s) => s.isIntersecting)) return;
      observer.disconnect();
      if (data.pictures[scene]) section.panel = new report.panel.Panel(section.querySelector(".viewer"), scene);
    }, {rootMargin: "400px"}).observe(section.querySelector(".viewer"));
  }

  document.documentElement.classList.add("scripted");
  document.querySelectorAll("section.scene").forEach(setUpScene);
})();
