// Draws the charts of a scene: error against time, and the spectra of noise and bias.
const methodMarks = ["circle", "rect", "triangle", "rectRot", "star", "crossRot"];
const methodMark = (index) => methodMarks[index % methodMarks.length];
const methodColor = (index) => color(`--method-${index % 10}`);
const curveMetrics = {
  relative: {label: "relative RMSE %", column: 2, factor: 100},
  absolute: {label: "RMSE", column: 5, factor: 1},
};

/** Labels the ticks at powers of ten and, if there is room, at 2 and 5 times these. */
function tickText(value, index, ticks) {
  const mantissa = Number((value / 10 ** Math.floor(Math.log10(value) + 1e-9)).toPrecision(3));
  const few = ticks.length < 20;
  if (mantissa !== 1 && !(few && (mantissa === 2 || mantissa === 5))) return "";
  return value >= 1e-3 && value < 1e5 ? String(Number(value.toPrecision(3))) : value.toExponential(0);
}

function axis(type, title) {
  const grid = {color: color("--line"), borderColor: color("--muted")};
  const made = {
    type,
    grid,
    title: {display: true, text: title, color: color("--text")},
    ticks: {color: color("--muted"), maxRotation: 0, autoSkipPadding: 8},
  };
  if (type === "logarithmic") {
    made.ticks.callback = tickText;
    made.ticks.autoSkip = false;
  }
  return made;
}

function chartOptions(xAxis, yAxis, tooltip) {
  const narrow = innerWidth < 600;
  return {
    animation: false,
    maintainAspectRatio: false,
    scales: {x: xAxis, y: yAxis},
    interaction: {mode: "nearest", axis: "xy", intersect: false},
    plugins: {
      legend: {display: false},
      tooltip: {
        filter: (item) => item.dataset.hover !== false,
        callbacks: {title: () => "", label: tooltip},
        displayColors: !narrow,
        backgroundColor: color("--tip"),
        titleColor: color("--text"),
        bodyColor: color("--text"),
        borderColor: color("--line"),
        borderWidth: 1,
      },
    },
  };
}

/** A line through points, whose colour is of the form #rrggbb. */
function pointSet(label, color, points, extra = {}) {
  return {
    label, data: points, showLine: true, borderColor: color, backgroundColor: color, borderWidth: 2, pointRadius: 3.5,
    pointHoverRadius: 6, ...extra,
  };
}

const methodLine = (method, points, extra = {}) => pointSet(data.methods[method], methodColor(method), points,
  {pointStyle: methodMark(method), ...extra});

/** Two lines without marks; the area between them is filled. */
function band(label, color, low, high) {
  const plain = {hover: false, borderWidth: 0, pointRadius: 0, pointHoverRadius: 0, pointHitRadius: 0};
  return [pointSet(label, color, low, {...plain, fill: false}),
    pointSet(label, color, high, {...plain, fill: "-1", backgroundColor: `${color}2e`})];
}

const dashed = {borderDash: [5, 4], borderWidth: 1.5, pointRadius: 0, pointHitRadius: 6};

function curveSets(scene, component, metric, hidden) {
  const {column, factor} = curveMetrics[metric];
  const shown = data.scenes[scene].curves[component] ?? [];
  const sets = [];
  let times = [];
  for (const {method, points, stops} of shown) {
    if (hidden.has(method)) continue;
    const at = (offset) => points.filter((p) => p[column + offset] !== null)
      .map((p) => ({x: p[1], y: factor * p[column + offset], passes: p[0], least: p[8],
        low: factor * p[column + 1], high: factor * p[column + 2]}));
    times = times.concat(points.map((p) => p[1]));
    const isStop = (item) => stops.includes(item.raw?.passes);
    sets.push(methodLine(method, at(0), {
      pointRadius: (item) => (isStop(item) ? 7 : 3.5),
      pointBackgroundColor: (item) => (isStop(item) ? "transparent" : methodColor(method)),
      pointBorderWidth: (item) => (isStop(item) ? 2 : 1),
      stops,
    }), ...band(data.methods[method], methodColor(method), at(1), at(2)));
  }
  const floor = metric === "relative" ? data.scenes[scene].noise_floor[component] : 0;
  if (floor > 0 && times.length > 0)
    sets.push(pointSet("noise of the reference", color("--muted"),
      [Math.min(...times), Math.max(...times)].map((x) => ({x, y: factor * floor})), dashed));
  return sets;
}

function spectrumSets(scene, component, kind, hidden) {
  return (data.scenes[scene].spectra[component] ?? [])
    .filter((s) => !hidden.has(s.method) && s[kind].some(([, power]) => power > 0))
    .map((s) => methodLine(s.method,
      s[kind].map(([x, power]) => ({x, y: power > 0 ? power : NaN, power})),
      {pointRadius: 0, pointHitRadius: 4, spanGaps: false}));
}

function curveTip(item) {
  const {x, y, low, high, passes, least} = item.raw;
  if (passes === undefined) return `${item.dataset.label}: ${number(y, 3)}`;
  const interval = Number.isFinite(low) && low > 0 ? ` (${number(low, 3)} to ${number(high, 3)})` : "";
  return [item.dataset.label, `${number(y, 3)}${interval} after ${number(x, 3)} s`,
    `${least < passes ? `${least} to ` : ""}${passes} pass${passes === 1 ? "" : "es"}${item.dataset.stops?.includes(passes) ? ", a stop" : ""}`];
}

const spectrumTip = (item) => [item.dataset.label,
  `power ${number(item.raw.power, 3)} at ${number(item.raw.x, 3)} cycles per pixel`];

/**
 * A chart with its heading and canvas. `make` returns {sets, xAxis, yAxis, tip, words, nothing}; if no set has
 * points, the text `nothing` replaces the chart.
 */
class ChartPanel {
  constructor(place, heading, note, make) {
    this.make = make;
    this.canvas = element("canvas", {attributes: {role: "img", "aria-label": heading}});
    this.empty = element("p", {className: "muted empty", hidden: true});
    this.box = element("div", {className: "chart-box"}, this.canvas);
    place.append(element("h3", {textContent: heading}), this.box, this.empty,
      element("p", {className: "muted", textContent: note}));
  }

  draw() {
    const {sets, xAxis, yAxis, tip, words, nothing} = this.make();
    this.chart?.destroy();
    this.chart = null;
    const any = sets.some((set) => set.data.length > 0);
    this.box.hidden = !any;
    this.empty.hidden = any;
    this.empty.textContent = nothing;
    if (!any) return;
    this.canvas.setAttribute("aria-label", words);
    this.chart = new Chart(this.canvas,
      {type: "scatter", data: {datasets: sets}, options: chartOptions(xAxis(), yAxis(), tip)});
  }
}

/** Draws the charts of one scene whenever it is called. They show what `state` says: {component, metric, hidden}. */
function sceneCharts(section, scene, state) {
  const spectrum = (kind, note, power, nothing) => new ChartPanel(section.querySelector(`.${kind}-chart`),
    `Spectrum of the ${kind}`, note, () => ({
      sets: spectrumSets(scene, state.component, kind, state.hidden),
      xAxis: () => axis("linear", "cycles per pixel"),
      yAxis: () => axis("logarithmic", power),
      tip: spectrumTip,
      words: `power of the ${kind} of ${state.component} by frequency`,
      nothing,
    }));
  const panels = [
    new ChartPanel(section.querySelector(".curve-chart"), "Error against time",
      "Mean over the seeds with its 95 % band. Below the dashed line lies the reference's noise. Rings: ends of labels with a smaller " +
      "spp. Time is charged wall-clock time, preparation included.", () => ({
        sets: curveSets(scene, state.component, state.metric, state.hidden),
        xAxis: () => axis("logarithmic", "seconds"),
        yAxis: () => axis("logarithmic", curveMetrics[state.metric].label),
        tip: curveTip,
        words: `${curveMetrics[state.metric].label} of ${state.component} against seconds, both logarithmic`,
        nothing: "There is no curve of this component.",
      })),
    spectrum("noise", "White noise has 1. Power at low frequencies is blotchy noise, which the eye sees easily.",
      "power, white noise = 1", "A spectrum of the noise needs at least three seeds."),
    spectrum("bias", "In the gaps bias is below the noise of seeds and reference.",
      "power [radiance²]", "Bias is below the noise of seeds and reference."),
  ];
  return () => panels.forEach((panel) => panel.draw());
}
