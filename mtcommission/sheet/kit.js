"use strict";
// What every page draws with: nodes, numbers, scales, a plot's frame.

const LEFT = 62, RIGHT = 18, TITLE = 22, FOOT = 42, WIDE = 560, HIGH = 250;
const data = JSON.parse(document.getElementById("plots").textContent);

function add(parent, name, attributes, text) {
  const node = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  if (text !== undefined) node.textContent = text;
  parent.append(node);
  return node;
}

function show(value, digits = 4) {
  if (value === 0) return "0";
  const short = String(Number(value.toPrecision(digits)));
  return short.replace("-", "−").replace(".", data.decimal_mark);
}

function ticks(low, high, isLog) {
  if (isLog) {
    const found = [], narrow = high / low < 30;
    for (let power = Math.floor(Math.log10(low)); power <= Math.ceil(Math.log10(high)); power++)
      for (const part of narrow ? [1, 1.5, 2, 3, 5, 7] : [1]) found.push(Number((part * 10 ** power).toPrecision(3)));
    const inside = found.filter(tick => tick >= low && tick <= high);
    if (inside.length > (narrow ? 3 : 1)) return inside;
  }
  const rough = (high - low) / 5, size = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].find(part => part * size >= rough) * size;
  const found = [];
  for (let i = Math.ceil(low / step); i * step <= high * (1 + 1e-12); i++) found.push(i * step);
  return found;
}

// As many digits as tell neighbouring ticks apart.
function showTicks(values) {
  const step = values[1] - values[0];
  return values.map(value => [value, show(value, step ? Math.max(4, 2 + Math.ceil(Math.log10(Math.abs(value / step) || 1))) : 4)]);
}

function scale(low, high, from, to, isLog) {
  const forward = isLog ? Math.log : value => value, back = isLog ? Math.exp : value => value;
  const a = forward(low), b = forward(high);
  return {
    low, high, isLog, from, to,
    at: value => from + (forward(value) - a) / (b - a) * (to - from),
    of: place => back(a + (place - from) / (to - from) * (b - a)),
  };
}

function widen(low, high, isLog) {
  if (isLog) return [low / 1.08, high * 1.08];
  const room = 0.06 * (high - low) || Math.abs(high) || 1;
  return [low - room, high + room];
}

function frame(svg, x, y, clip) {
  for (const tick of ticks(x.low, x.high, x.isLog))
    add(svg, "path", {class: "grid", d: `M${x.at(tick)} ${y.from}V${y.to}`});
  for (const [tick, text] of showTicks(ticks(y.low, y.high, y.isLog))) {
    add(svg, "path", {class: "grid", d: `M${x.from} ${y.at(tick)}H${x.to}`});
    add(svg, "text", {x: x.from - 6, y: y.at(tick) + 4, "text-anchor": "end"}, text);
  }
  const box = {x: x.from, y: y.to, width: x.to - x.from, height: y.from - y.to};
  add(add(svg, "clipPath", {id: clip}), "rect", box);
  add(svg, "rect", {class: "frame", ...box});
}

function labelX(svg, x, bottom, label) {
  for (const [tick, text] of showTicks(ticks(x.low, x.high, x.isLog)))
    add(svg, "text", {x: x.at(tick), y: bottom + 16, "text-anchor": "middle"}, text);
  add(svg, "text", {x: (x.from + x.to) / 2, y: bottom + 34, "text-anchor": "middle"}, label);
}

// Empty a plot, as wide as its place on the page; its width.
function clear(svg, high) {
  const width = Math.max(300, Math.min(WIDE, svg.parentNode.clientWidth || WIDE));
  svg.replaceChildren();
  svg.setAttribute("viewBox", `0 0 ${width} ${high + FOOT + TITLE}`);
  return width;
}

// A framed plot of two axes that fills its place on the page.
function chart(svg, xs, ys, labels, {xLog = false, yLog = false, right = RIGHT, high = HIGH} = {}) {
  const width = clear(svg, high);
  const x = scale(...xs, LEFT, width - right, xLog), y = scale(...ys, TITLE + high, TITLE, yLog);
  const clip = `${svg.id}-clip`;
  frame(svg, x, y, clip);
  add(svg, "text", {x: LEFT, y: TITLE - 6}, labels[1]);
  labelX(svg, x, TITLE + high, labels[0]);
  return {svg, x, y, inside: add(svg, "g", {"clip-path": `url(#${clip})`})};
}

// Where an event happened, in the plot's own units.
function spotOf(svg, event) {
  return new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
}
