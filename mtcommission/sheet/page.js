"use strict";
// Draws the plots of the sheet: zoom by dragging, values under the cursor, linked axes.

const WIDEST = 900, NARROWEST = 340, LEFT = 62, RIGHT = 18, PANEL = 110, SQUARE = 340, TITLE = 22, LEGEND = 26, FOOT = 42;
const data = JSON.parse(document.getElementById("plots").textContent);
const linked = new Map();
// Drawing units of the plot that is being drawn: pixels, so that letters stay as large as they are.
let across = WIDEST;

function add(parent, name, attributes, text) {
  const node = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  if (text !== undefined) node.textContent = text;
  parent.append(node);
  return node;
}

function show(value) {
  if (value === 0) return "0";
  const short = String(Number(value.toPrecision(4)));
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
  for (const tick of ticks(y.low, y.high, y.isLog)) {
    add(svg, "path", {class: "grid", d: `M${x.from} ${y.at(tick)}H${x.to}`});
    add(svg, "text", {x: x.from - 6, y: y.at(tick) + 4, "text-anchor": "end"}, show(tick));
  }
  const box = {x: x.from, y: y.to, width: x.to - x.from, height: y.from - y.to};
  add(add(svg, "clipPath", {id: clip}), "rect", box);
  add(svg, "rect", {class: "frame", ...box});
}

function labelX(svg, x, bottom, label) {
  for (const tick of ticks(x.low, x.high, x.isLog))
    add(svg, "text", {x: x.at(tick), y: bottom + 16, "text-anchor": "middle"}, show(tick));
  add(svg, "text", {x: (x.from + x.to) / 2, y: bottom + 34, "text-anchor": "middle"}, label);
}

function inView(line, low, high) {
  const x = line.x;
  let first = x.findIndex(value => value >= low), last = x.findLastIndex(value => value <= high);
  if (first < 0 || last < 0) return [0, 0];
  return [Math.max(0, first - 1), Math.min(x.length, last + 2)];
}

function valueAt(line, place) {
  if (place < line.x[0] || place > line.x[line.x.length - 1]) return null;
  let low = 0, high = line.x.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (line.x[middle] <= place) low = middle; else high = middle;
  }
  if (place >= line.x[high]) return line.y[high];
  if (line.stepped) return line.y[low];
  const share = (place - line.x[low]) / (line.x[high] - line.x[low] || 1);
  return line.y[low] + share * (line.y[high] - line.y[low]);
}

function path(line, x, y) {
  const [first, last] = inView(line, x.low, x.high);
  let d = "";
  for (let i = first; i < last; i++) {
    const px = x.at(line.x[i]).toFixed(1), py = y.at(line.y[i]).toFixed(1);
    d += i === first ? `M${px} ${py}` : line.stepped ? `H${px}V${py}` : `L${px} ${py}`;
  }
  return d;
}

function namesIn(plot) {
  const curves = plot.panels?.flatMap(panel => panel.lines) ?? plot.marks;
  return curves.map(curve => curve.label);
}

function fit(host, plot) {
  // A name longer than a narrow page shrinks the plot rather than being cut.
  const longest = Math.max(...namesIn(plot).map(name => name.length));
  const least = Math.max(NARROWEST, LEFT + 62 + 7.2 * longest);
  return Math.round(Math.min(WIDEST, Math.max(least, host.clientWidth)));
}

function namesOf(lines) {
  return [...new Map(lines.map(line => [line.label, line.style]))];
}

function legendRows(named) {
  const rows = [];
  let used = Infinity;
  for (const entry of named) {
    const width = 62 + 7.2 * entry[0].length;
    if (used + width > across - LEFT) { rows.push([]); used = 0; }
    rows.at(-1).push([...entry, LEFT + used]);
    used += width;
  }
  return rows;
}

function drawLegend(svg, rows) {
  rows.forEach((row, k) => row.forEach(([label, style, left]) => {
    const down = 12 + LEGEND * k;
    add(svg, "path", {class: `curve s${style}`, d: `M${left} ${down}h34`});
    add(svg, "text", {x: left + 40, y: down + 4}, label);
  }));
  return LEGEND * rows.length;
}

function wholeLines(plot) {
  let low = Infinity, high = -Infinity;
  for (const panel of plot.panels) for (const line of panel.lines) {
    low = Math.min(low, line.x[0]);
    high = Math.max(high, line.x[line.x.length - 1]);
  }
  return {x: [low, high]};
}

function drawLines(svg, plot, view, key) {
  const head = drawLegend(svg, legendRows(namesOf(plot.panels.flatMap(panel => panel.lines))));
  svg.setAttribute("viewBox", `0 0 ${across} ${head + plot.panels.length * (TITLE + PANEL) + FOOT}`);
  const x = scale(...view.x, LEFT, across - RIGHT, plot.x_is_log), titles = [];
  let top = head;
  plot.panels.forEach((panel, i) => {
    let low = Infinity, high = -Infinity;
    for (const line of panel.lines) {
      const [first, last] = inView(line, ...view.x);
      for (let k = first; k < last; k++) {
        low = Math.min(low, line.y[k]);
        high = Math.max(high, line.y[k]);
      }
    }
    if (low > high) [low, high] = [0, 1];
    for (const border of panel.borders) {
      low = Math.min(low, border.y);
      high = Math.max(high, border.y);
    }
    const y = scale(...widen(low, high, false), top + TITLE + PANEL, top + TITLE, false);
    frame(svg, x, y, `${key}-${i}`);
    const inside = add(svg, "g", {"clip-path": `url(#${key}-${i})`});
    for (const border of panel.borders)
      add(inside, "path", {class: "border", d: `M${x.from} ${y.at(border.y)}H${x.to}`});
    for (const line of panel.lines)
      add(inside, "path", {class: `curve s${line.style}`, d: path(line, x, y)});
    titles.push(add(svg, "text", {x: LEFT, y: top + TITLE - 6}, panel.y_label));
    top += TITLE + PANEL;
  });
  labelX(svg, x, top, plot.x_label);
  const cursor = add(svg, "path", {class: "cursor"});
  const point = place => {
    const isInside = place !== null && place >= x.low && place <= x.high;
    cursor.setAttribute("d", isInside ? `M${x.at(place)} ${head + TITLE}V${top}` : "");
    plot.panels.forEach((panel, i) => {
      titles[i].textContent = panel.y_label;
      if (!isInside) return;
      if (i === 0) add(titles[i], "tspan", {dx: 16}, `${plot.x_label}: ${show(place)}`);
      for (const line of panel.lines) {
        const value = valueAt(line, place);
        if (value !== null) add(titles[i], "tspan", {dx: 16, class: `s${line.style}`}, show(value));
      }
    });
  };
  return {x, point, head};
}

function span(values, extra) {
  return widen(Math.min(...values, ...extra), Math.max(...values, ...extra), true);
}

function wholePoints(plot) {
  return {x: span(plot.marks.map(mark => mark.x), []), y: span(plot.marks.map(mark => mark.y), [plot.border.y])};
}

function drawMark(parent, mark, px, py) {
  const shapes = [
    `M${px} ${py - 9}l2.6 6 6.4.6-4.9 4.3 1.5 6.3-5.6-3.4-5.6 3.4 1.5-6.3-4.9-4.3 6.4-.6z`,
    `M${px - 5} ${py - 5}h10v10h-10z`,
    `M${px - 5} ${py}a5 5 0 1 0 10 0a5 5 0 1 0-10 0`,
  ];
  return add(parent, "path", {class: `m${mark.style}`, d: shapes[mark.style]});
}

function drawPoints(svg, plot, view, key) {
  const bottom = TITLE + SQUARE;
  svg.setAttribute("viewBox", `0 0 ${across} ${bottom + FOOT}`);
  const x = scale(...view.x, LEFT, across - RIGHT, true), y = scale(...view.y, bottom, TITLE, true);
  frame(svg, x, y, key);
  const title = add(svg, "text", {x: LEFT, y: TITLE - 6}, plot.y_label);
  add(svg, "path", {class: "border", d: `M${x.to - 24 - 7.2 * plot.border.label.length} ${TITLE - 10}h-34`});
  add(svg, "text", {x: x.to, y: TITLE - 6, "text-anchor": "end"}, plot.border.label);
  const inside = add(svg, "g", {"clip-path": `url(#${key})`});
  add(inside, "path", {class: "border", d: `M${x.from} ${y.at(plot.border.y)}H${x.to}`});
  for (const mark of plot.marks) {
    drawMark(inside, mark, x.at(mark.x), y.at(mark.y));
    const [dx, dy] = mark.beside, px = x.at(mark.x), py = y.at(mark.y), half = 3.6 * mark.name.length;
    const apart = Math.hypot(Math.max(Math.abs(dx) - half, 0), Math.max(Math.abs(dy) - 7, 0));
    if (apart > 14) add(inside, "path", {class: "grid", d: `M${px} ${py}L${px + Math.sign(dx) * Math.max(Math.abs(dx) - half, 0)} ${py + dy}`});
    add(inside, "text", {x: px + dx, y: py + dy + 4, "text-anchor": "middle"}, mark.name);
  }
  labelX(svg, x, bottom, plot.x_label);
  const point = (place, height) => {
    title.textContent = plot.y_label;
    if (place === null) return;
    const far = mark => Math.hypot(x.at(mark.x) - x.at(place), y.at(mark.y) - y.at(height));
    const near = plot.marks.reduce((best, mark) => far(mark) < far(best) ? mark : best);
    if (far(near) < 40) add(title, "tspan", {dx: 16}, `${near.label}: ${show(near.x)}; ${show(near.y)}`);
  };
  return {x, y, point, stops: plot.marks.map(mark => [mark.x, mark.y]).sort((a, b) => a[0] - b[0])};
}

const KINDS = {
  LinePlot: [drawLines, wholeLines],
  PointPlot: [drawPoints, wholePoints],
};

function start(host) {
  const key = host.dataset.plot, plot = data.plots[key], [draw, whole] = KINDS[plot.kind];
  const svg = add(host, "svg", {role: "img", tabindex: 0, "aria-label": host.dataset.alt});
  const group = linked.get(plot.link ?? key) ?? [];
  linked.set(plot.link ?? key, group);
  const me = {full: whole(plot), drawn: null, place: null};
  me.view = me.full;
  me.draw = () => {
    across = me.width = fit(host, plot);
    svg.replaceChildren();
    me.drawn = draw(svg, plot, me.view, key);
  };
  me.zoom = view => { me.view = view ?? me.full; me.draw(); };
  me.point = (place, height) => { me.place = place; me.drawn.point(place, height); };
  group.push(me);
  me.draw();
  new ResizeObserver(() => { if (fit(host, plot) !== me.width) me.draw(); }).observe(host);
  listen(svg, me, group);
}

function listen(svg, me, group) {
  const all = action => group.forEach(action);
  const read = event => {
    const spot = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
    const {x, y} = me.drawn;
    const px = Math.min(Math.max(spot.x, x.from), x.to), py = y ? Math.min(Math.max(spot.y, y.to), y.from) : 0;
    return {px, py, x: x.of(px), y: y ? y.of(py) : 0};
  };
  let begun = null, brush = null;
  svg.addEventListener("pointerdown", event => { begun = read(event); });
  svg.addEventListener("pointermove", event => {
    const now = read(event);
    all(other => other.point(now.x, now.y));
    if (!begun) return;
    brush?.remove();
    const {y} = me.drawn, [top, bottom] = y ? [Math.min(begun.py, now.py), Math.abs(now.py - begun.py)] : [me.drawn.head, svg.viewBox.baseVal.height - me.drawn.head - FOOT];
    brush = add(svg, "rect", {class: "brush", x: Math.min(begun.px, now.px), y: top, width: Math.abs(now.px - begun.px), height: bottom});
  });
  svg.addEventListener("pointerup", event => {
    const now = read(event), then = begun;
    begun = null;
    brush?.remove();
    if (!then || Math.abs(now.px - then.px) < 8 || (me.drawn.y && Math.abs(now.py - then.py) < 8)) return;
    const order = (a, b) => a < b ? [a, b] : [b, a];
    const view = {x: order(then.x, now.x)};
    if (me.drawn.y) view.y = order(then.y, now.y);
    all(other => other.zoom(view));
  });
  svg.addEventListener("pointerleave", () => { begun = null; brush?.remove(); all(other => other.point(null)); });
  svg.addEventListener("dblclick", () => all(other => other.zoom(null)));
  svg.addEventListener("keydown", event => press(event, me, all));
}

function press(event, me, all) {
  const {x, y} = me.drawn, step = (x.to - x.from) / 100;
  const from = me.place === null ? (x.from + x.to) / 2 : x.at(me.place);
  const turn = {ArrowLeft: -step, ArrowRight: step}[event.key];
  const factor = {"+": 0.5, "-": 2}[event.key];
  if (turn !== undefined && me.drawn.stops) {
    // Point plots have nothing between their points: the arrows go from one to the next.
    const {stops} = me.drawn;
    me.stop = ((me.stop ?? (turn > 0 ? -1 : 0)) + Math.sign(turn) + stops.length) % stops.length;
    all(other => other.point(...stops[me.stop]));
  } else if (turn !== undefined) {
    const place = x.of(Math.min(Math.max(from + turn, x.from), x.to));
    all(other => other.point(place, y ? y.of((y.from + y.to) / 2) : 0));
  } else if (factor !== undefined) {
    const half = factor * (x.to - x.from) / 2;
    const low = x.of(from - half), high = x.of(from + half);
    const view = {x: [Math.max(low, me.full.x[0]), Math.min(high, me.full.x[1])]};
    if (y) view.y = me.view.y;
    all(other => other.zoom(view));
  } else if (event.key === "0" || event.key === "Escape") all(other => other.zoom(null));
  else return;
  event.preventDefault();
}

document.querySelectorAll("[data-plot]").forEach(start);
