// Draws bias^2, variance and mean squared error against the parameter of a sweep.
const errorParts = {bias2: {name: "bias²", column: 1}, variance: {name: "variance", column: 4}};

function partSets(points, part) {
  const {name, column} = errorParts[part];
  const hue = color(part === "bias2" ? "--bias" : "--noise");
  const isResolved = (p) => p[column] > 0 && !(p[column + 1] <= 0);
  const at = (p, y) => ({x: p[0], y, low: p[column + 1], high: p[column + 2]});
  const shown = points.filter(isResolved);
  const resolved = shown.filter((p) => p[column + 1] > 0);
  return [
    pointSet(name, hue, shown.map((p) => at(p, p[column])), part === "variance" ? {pointStyle: "rect"} : {}),
    ...band(name, hue, resolved.map((p) => at(p, p[column + 1])), resolved.map((p) => at(p, p[column + 2]))),
    pointSet(name, hue, points.filter((p) => !isResolved(p) && p[column + 2] > 0)
      .map((p) => ({x: p[0], y: p[column + 2], isBound: true})),
    {showLine: false, pointBackgroundColor: "transparent", pointStyle: "triangle", pointRotation: 180}),
  ];
}

function sweepTip(item) {
  const {x, y, low, high, isBound} = item.raw;
  if (isBound) return `${item.dataset.label} below ${number(y, 3)} at ${number(x, 3)}`;
  const interval = Number.isFinite(low) && Number.isFinite(high) ? ` (${number(low, 3)} to ${number(high, 3)})` : "";
  return `${item.dataset.label} ${number(y, 3)}${interval} at ${number(x, 3)}`;
}

/** The line through the fitted points, and one of theory's slope through its middle. */
function lawLines({points, exponent, factor, theory}) {
  if (!exponent) return [];
  const fitted = points.filter((p) => p[2] > 0).map((p) => p[0]);
  const ends = [Math.min(...fitted), Math.max(...fitted)];
  const middle = Math.sqrt(ends[0] * ends[1]);
  const at = (x, slope) => factor * middle ** -exponent[0] * (x / middle) ** -slope;
  const line = (name, slope, extra) =>
    pointSet(name, color("--bias"), ends.map((x) => ({x, y: at(x, slope)})), {pointRadius: 0, pointHitRadius: 0, ...extra});
  return [line("fitted bias²", exponent[0], {borderWidth: 1, borderDash: [2, 3]}),
    ...(theory === null ? [] : [line("bias² by theory", theory, {borderWidth: 1, borderDash: [8, 3, 2, 3]})])];
}

/** The fitted exponent of bias², or why there is none, and the exponent by theory. */
function lawWords({points, exponent, resolved, theory}, parameter) {
  const said = theory === null ? "" : ` Theory for smooth light: ${number(theory, 3)}.`;
  if (exponent) {
    const [p, low, high] = exponent;
    return `bias² falls as ${parameter}^−p with p = ${number(p, 3)} (${number(low, 3)} to ${number(high, 3)}).${said}`;
  }
  return `The interval of bias² lies above 0 at ${resolved} of ${points.length} values; a slope needs three. More seeds or a better reference help.${said}`;
}

/** The component with the largest bias² whose interval lies above 0; else the total. */
function largestBias(components) {
  const names = Object.keys(components);
  const bias = (name) => Math.max(0, ...components[name].points.filter((p) => p[2] > 0).map((p) => p[1]));
  const parts = names.filter((name) => name !== "total" && bias(name) > 0);
  return parts.reduce((a, b) => (bias(b) > bias(a) ? b : a), parts[0] ?? names.find((name) => name === "total") ?? names[0]);
}

function setUpSweep(place, sweep) {
  const names = Object.keys(sweep.components);
  let shown = largestBias(sweep.components);
  const words = element("p", {className: "muted"});
  const box = element("div", {className: "sweep"});
  const chosen = select("Component", names, names.indexOf(shown), (i) => {
    shown = names[i];
    draw();
  });
  place.append(box);
  const panel = new ChartPanel(box, `${sweep.method}: bias and noise against ${sweep.parameter}`,
    "Mean squared error of the final images, with 95 % intervals. Dark, circles: bias². Light, squares: variance. Dashed: their sum. Dotted: the fitted law of bias². Dots and dashes: theory's slope. Triangles: upper ends of bias².", () => ({
      sets: [
        ...partSets(sweep.components[shown].points, "bias2"),
        ...partSets(sweep.components[shown].points, "variance"),
        pointSet("mean squared error", color("--muted"),
          sweep.components[shown].points.filter((p) => p[7] > 0).map((p) => ({x: p[0], y: p[7]})),
          dashed),
        ...lawLines(sweep.components[shown]),
      ],
      xAxis: () => axis("logarithmic", sweep.parameter),
      yAxis: () => axis("logarithmic", "radiance²"),
      tip: sweepTip,
      words: `bias² and variance of ${shown} against ${sweep.parameter}, both logarithmic`,
      nothing: "Bias and variance need two seeds.",
    }));
  box.firstChild.after(chosen.whole, words);
  function draw() {
    words.textContent = lawWords(sweep.components[shown], sweep.parameter);
    panel.draw();
  }
  draw();
  onScheme(draw);
}
