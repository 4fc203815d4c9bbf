// SPDX-License-Identifier: Apache-2.0
// The panel: a control for each parameter of each object and post, from its type, range, doc and the names of its values.
"use strict";

/// An element with text and properties. The text is shown as it is, whatever it contains.
function element(tag, properties = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children.filter((child) => child !== null));
  return made;
}

/// Where a slider begins and ends. Without limits of its own a parameter gets limits around its value; the field of
/// the number beside the slider accepts any value that the document allows.
function sliderRange(field, value) {
  const low = field.min ?? Math.min(0, 2 * value);
  const high = field.max ?? Math.max(1, 2 * value, 2 * low);
  return [low, high];
}

function limited(field, value) {
  return Math.min(field.max ?? Infinity, Math.max(field.min ?? -Infinity, value));
}

/// A slider and a field for one number of a value. `read` and `write` access the number. Where the value is tiny in its
/// range, the slider moves more finely near the range's beginning. It gives numbers of four digits.
function numberControl(field, label, read, write) {
  const [low, high] = sliderRange(field, read());
  const whole = field.type === "integer";
  const part = (value) => Math.max(0, Math.min(1, (value - low) / (high - low)));
  const power = !whole && part(read()) > 0 && part(read()) < 0.02 ? 3 : 1;
  const range = element("input", { type: "range", min: 0, max: 1, step: whole ? 1 / (high - low) : "any", ariaLabel: label });
  const number = element("input", { type: "number", step: whole ? 1 : "any", ariaLabel: label });
  if (field.min !== undefined) number.min = floatText(field.min);
  if (field.max !== undefined) number.max = floatText(field.max);
  const take = (value) => {
    if (Number.isFinite(value)) write(limited(field, whole ? Math.round(value) : value));
  };
  range.addEventListener("input", () => take(Number((low + (high - low) * Number(range.value) ** power).toPrecision(4))));
  number.addEventListener("change", () => {
    if (number.value !== "") take(Number(number.value));
    number.value = floatText(read());
  });
  const show = () => {
    range.value = part(read()) ** (1 / power);
    range.ariaValueText = floatText(read());
    if (document.activeElement !== number) number.value = floatText(read());
  };
  return { elements: [range, number], show };
}

function choiceControl(field, read, write) {
  const select = element("select", { ariaLabel: field.name },
    ...field.names.map((name, value) => element("option", { value }, name)));
  select.addEventListener("change", () => write([Number(select.value)]));
  return { elements: [select], show: () => { select.value = read()[0]; } };
}

function checkControl(field, read, write) {
  const box = element("input", { type: "checkbox", ariaLabel: field.name });
  box.addEventListener("change", () => write([box.checked ? 1 : 0]));
  return { elements: [box], show: () => { box.checked = read()[0] !== 0; } };
}

/// Colours are linear and may be brighter than the field of colours can show: it then shows the colour divided by its
/// largest component, and keeps that brightness.
function colorControl(field, read, write) {
  const input = element("input", { type: "color", ariaLabel: field.name });
  const brightness = () => Math.max(1, ...read().slice(0, 3));
  input.addEventListener("input", () => {
    const factor = brightness();
    const picked = [1, 3, 5].map((at) => srgbDecode(parseInt(input.value.slice(at, at + 2), 16) / 255) * factor);
    write([...picked.map((value) => limited(field, value)), ...read().slice(3)]);
  });
  const show = () => {
    const factor = brightness();
    input.value = "#" + read().slice(0, 3)
      .map((value) => Math.round(255 * srgbEncode(Math.max(0, value / factor))).toString(16).padStart(2, "0")).join("");
  };
  return { elements: [input], show };
}

/// The lines of controls of a field: a line has elements and a function that shows the value. The numbers of a colour have
/// no sliders, as the field of colours takes their place.
function controlsOf(field, read, write) {
  if (field.words === 0) return [];
  if (field.type === "boolean") return [checkControl(field, read, write)];
  if (field.names) return [choiceControl(field, read, write)];
  const numbers = Array.from({ length: field.words }, (_, i) => numberControl(
    field, field.words === 1 ? field.name : `${field.name}, number ${i + 1} of ${field.words}`,
    () => read()[i], (value) => write(read().map((old, j) => (j === i ? value : old)))));
  if (!field.type.startsWith("color")) return numbers;
  const color = colorControl(field, read, write);
  const fields = { elements: numbers.map(({ elements }) => elements[1]), show: () => numbers.forEach(({ show }) => show()) };
  return [color, fields];
}

/// A row of the panel. Returns the function that shows the value in effect.
function makeRow(parent, values, owner, number) {
  const { name, varied, files } = values.owners[owner];
  const field = values.owners[owner].fields[number];
  const controls = controlsOf(field, () => values.get(owner, number), (words) => values.set(owner, number, words));
  const reset = element("button", { title: "Back to the scene's value", ariaLabel: `Reset ${name}.${field.name}` }, "\u21ba");
  reset.addEventListener("click", () => values.reset(owner, number));
  const row = element("div", { className: "row" }, element("span", { className: "name" }, field.name));
  row.title = [field.doc, varied.includes(field.name) ? "Varies over the copies; a value set here is that of all." : ""]
    .filter((text) => text).join("\n");
  row.dataset.setting = `${name}.${field.name}`;
  if (field.words === 0)
    row.append(element("span", { className: "value" }, element("span", { className: "path" }, own(files, field.name) || "no file")));
  for (const control of controls) row.append(element("span", { className: "value" }, ...control.elements));
  row.append(reset);
  parent.append(row);
  return () => {
    for (const control of controls) control.show();
    row.classList.toggle("changed", values.changed[owner].has(number));
  };
}

/// Fills the panel. Owners that have no parameters are left out.
function makePanel(panel, values) {
  const shows = values.owners.map(() => []);
  values.owners.forEach(({ name, effect, doc, fields }, owner) => {
    if (fields.length === 0) return;
    const details = element("details", { open: owner < 2, title: doc },
      element("summary", {}, name, " ", element("small", {}, effect)));
    fields.forEach((_, number) => shows[owner].push(makeRow(details, values, owner, number)));
    panel.append(details);
  });
  const show = (owner) => shows[owner].forEach((update) => update());
  values.listeners.push(show);
  values.owners.forEach((_, owner) => show(owner));
}

/// The time: a field and a box that lets it run, shown if a shader reads the time. Returns what reads it.
function makeClock(panel, initial, isRead, redraw) {
  let time = initial, started = null;
  const number = element("input", { type: "number", step: "any", value: floatText(initial), ariaLabel: "time" });
  const runs = element("input", { type: "checkbox" });
  const now = () => (started === null ? time : Math.fround(time + (performance.now() - started) / 1000));
  number.addEventListener("change", () => {
    if (!Number.isFinite(Number(number.value)) || number.value === "") return;
    time = Math.fround(Number(number.value));
    if (started !== null) started = performance.now();
    redraw();
  });
  runs.addEventListener("change", () => {
    time = now();
    started = runs.checked ? performance.now() : null;
    number.value = floatText(time);
    redraw();
  });
  panel.append(element("div", { className: "row", title: "Seconds", hidden: !isRead }, element("span", { className: "name" }, "time"),
    element("span", { className: "value" }, number, element("label", {}, runs, " runs"))));
  return {
    now,
    runs: () => started !== null,
    reset: () => { time = initial; started = null; runs.checked = false; number.value = floatText(initial); },
    settings: () => (now() === initial ? [] : [`--time ${floatText(now())}`]),
  };
}
