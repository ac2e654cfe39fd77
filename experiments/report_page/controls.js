// Makes labelled controls. Each has a name for screen readers and works with the keyboard as usual in the browser.
let controlCount = 0;
const freshId = () => `control-${++controlCount}`;

/** A labelled <select> of the texts `options`; `onChange` receives the index. */
function select(label, options, chosen, onChange) {
  const box = element("select", {id: freshId()}, ...options.map((text, i) => new Option(text, i, false, i === chosen)));
  box.addEventListener("change", () => onChange(Number(box.value)));
  const whole = element("div", {className: "control"}, element("label", {htmlFor: box.id, textContent: label}), box);
  return {whole, set: (i) => { box.value = i; }};
}

/** A labelled slider that shows its value as text; `text` converts a number to it. */
function slider(label, {min, max, step = 1, value}, text, onInput) {
  const input = element("input", {id: freshId(), type: "range", min, max, step, value});
  const output = element("output", {htmlFor: input.id});
  const name = element("label", {htmlFor: input.id, textContent: label});
  const show = () => {
    output.textContent = text(Number(input.value));
    input.setAttribute("aria-valuetext", output.textContent);
  };
  input.addEventListener("input", () => { show(); onInput(Number(input.value)); });
  show();
  const whole = element("div", {className: "control slider"},
    element("div", {className: "heading"}, name, output), input);
  return {whole, input, name, set: (v) => { input.value = v; show(); }};
}

/** Radio buttons that look like one bar; `onChange` receives the index. */
function choice(label, options, chosen, onChange) {
  const name = freshId();
  const inputs = options.map((text, i) => element("input", {type: "radio", name, id: freshId(), checked: i === chosen,
    onchange: () => onChange(i)}));
  const whole = element("fieldset", {className: "control choice"}, element("legend", {textContent: label}),
    element("div", {className: "bar"}, ...inputs.flatMap((input, i) =>
      [input, element("label", {htmlFor: input.id, textContent: options[i]})])));
  return {whole, set: (i) => { inputs[i].checked = true; }};
}

function button(textContent, title, onclick) {
  const ariaLabel = /\w/.test(textContent) ? null : title;  // a sign is no name
  return element("button", {type: "button", textContent, title, ariaLabel, onclick});
}

/** A button that stays pressed. */
function toggle(children, pressed, onChange) {
  const made = element("button", {type: "button", className: "toggle", ariaPressed: String(pressed)}, ...children);
  made.onclick = () => {
    made.ariaPressed = String(made.ariaPressed !== "true");
    onChange(made.ariaPressed === "true");
  };
  return made;
}
