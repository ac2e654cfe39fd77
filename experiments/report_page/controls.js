// Makes labelled controls. Each has a name for screen readers and works with the keyboard as usual in the browser.
"use strict";
report.controls = (() => {
  const {element} = report;
  let count = 0;
  const freshId = () => `control-${++count}`;

  /** A labelled <select> of the texts `options`; `onChange` receives the index. */
  function select(label, options, chosen, onChange) {
    const id = freshId();
    const box = element("select", {id}, ...options.map((text, i) =>
      element("option", {value: String(i), textContent: text, selected: i === chosen})));
    box.addEventListener("change", () => onChange(Number(box.value)));
    const whole = element("div", {className: "control"}, element("label", {htmlFor: id, textContent: label}), box);
    return {whole, box, set: (i) => { box.value = String(i); }};
  }

  /** A labelled slider that shows its value as text; `text` converts a number to it. */
  function slider(label, {min, max, step, value}, text, onInput) {
    const id = freshId();
    const input = element("input", {id, type: "range", min, max, step, value});
    const output = element("output", {htmlFor: id});
    const name = element("label", {htmlFor: id, textContent: label});
    const show = () => {
      output.textContent = text(Number(input.value));
      input.setAttribute("aria-valuetext", output.textContent);
    };
    input.addEventListener("input", () => { show(); onInput(Number(input.value)); });
    show();
    const whole = element("div", {className: "control slider"},
      element("div", {className: "heading"}, name, output), input);
    return {whole, input, name, show, set: (v) => { input.value = v; show(); }};
  }

  /** Radio buttons that look like one bar; `onChange` receives the index. */
  function choice(label, options, chosen, onChange) {
    const name = freshId();
    const inputs = options.map((text, i) => element("input", {type: "radio", name, id: freshId(), value: String(i),
      checked: i === chosen}));
    const parts = inputs.flatMap((input, i) => {
      input.addEventListener("change", () => onChange(i));
      return [input, element("label", {htmlFor: input.id, textContent: options[i]})];
    });
    const whole = element("fieldset", {className: "control choice"}, element("legend", {textContent: label}),
      element("div", {className: "bar"}, ...parts));
    return {whole, inputs, set: (i) => { inputs[i].checked = true; }};
  }

  function button(text, title, onClick) {
    const made = element("button", {type: "button", textContent: text, title});
    made.addEventListener("click", onClick);
    return made;
  }

  /** A button that stays pressed. */
  function toggle(children, pressed, onChange) {
    const made = element("button", {type: "button", className: "toggle", attributes: {"aria-pressed": String(pressed)}},
      ...children);
    made.addEventListener("click", () => {
      const now = made.getAttribute("aria-pressed") !== "true";
      made.setAttribute("aria-pressed", String(now));
      onChange(now);
    });
    return made;
  }

  return {select, slider, choice, button, toggle};
})();
