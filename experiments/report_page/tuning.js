// Draws the charts of a tuning: time to the target over each parameter of each method.
const {tuning} = data;

/** Where an axis shows its value 0, which has no logarithm. */
function zeroPlace(settings, column) {
  const positive = settings.map((s) => s.values[column]).filter((v) => v > 0);
  return positive.length > 0 ? Math.min(...positive) / 2 : 1;
}

function parameterAxis(parameter, column, settings) {
  if (parameter.words) {
    const made = axis("linear", parameter.name);
    Object.assign(made, {min: -0.5, max: parameter.words.length - 0.5, afterBuildTicks: (scale) => {
      scale.ticks = parameter.words.map((_, value) => ({value}));
    }});
    made.ticks.callback = (value) => parameter.words[value] ?? "";
    return made;
  }
  const made = axis("logarithmic", parameter.unit ? `${parameter.name} [${parameter.unit}]` : parameter.name);
  if (!settings.some((s) => s.values[column] === 0)) return made;
  const zero = zeroPlace(settings, column), plain = made.ticks.callback;
  made.min = zero / 1.3;
  made.afterBuildTicks = (scale) => {
    scale.ticks = [{value: zero}, ...scale.ticks.filter((tick) => tick.value > 1.5 * zero)];
  };
  made.ticks.callback = (value, index, ticks) => (value === zero ? "0" : plain(value, index, ticks));
  return made;
}

function settingSets(method, column) {
  const {settings, parameters, label} = tuning.methods[method];
  const {words} = parameters[column], zero = zeroPlace(settings, column);
  const place = (value) => (words ? words.indexOf(value) : value === 0 ? zero : value);
  const shown = settings.filter((s) => s.values[column] !== null && s.seconds !== null);
  const points = (list) => list.map((s) => ({x: place(s.values[column]), y: s.seconds, setting: s}));
  const marks = {showLine: false, pointStyle: "circle"};
  return [
    methodLine(method, points(shown.filter((s) => s.measured)), marks),
    methodLine(method, points(shown.filter((s) => !s.measured)), {...marks, pointBackgroundColor: "transparent", borderWidth: 1}),
    methodLine(method, points(shown.filter((s) => s.label === label)), {...marks, pointRadius: 9, pointHoverRadius: 10, pointBackgroundColor: "transparent",
      borderColor: color("--text"), borderWidth: 2}),
  ];
}

const settingTip = (item) => [item.raw.setting.label,
  `${number(item.raw.y, 3)} s${item.raw.setting.measured ? "" : ", by the fitted law"}`];

const tuningPanels = [...document.querySelectorAll(".tuned")].flatMap((section) => {
  const method = Number(section.dataset.method), {parameters, settings} = tuning.methods[method];
  return parameters.map((parameter, column) => {
    const box = element("div");
    section.querySelector(".charts").append(box);
    return new ChartPanel(box, parameter.name, parameter.sentence, () => ({
      sets: settingSets(method, column),
      xAxis: () => parameterAxis(parameter, column, settings),
      yAxis: () => axis("logarithmic", `seconds to ${tuning.target}`),
      tip: settingTip,
      words: `seconds to ${tuning.target} against ${parameter.name}`,
      nothing: "No setting was measured.",
    }));
  });
});
const drawTuning = () => tuningPanels.forEach((panel) => panel.draw());
drawTuning();
onScheme(drawTuning);
