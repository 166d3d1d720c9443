"use strict";
const data = JSON.parse(document.getElementById("data").textContent);
const columns = data.columns, count = data.count, PAGE = 50;
for (const column of columns) if (!("values" in column)) column.values = new Array(count).fill(column.all);
const by = new Map(columns.map((column) => [column.name, column]));
const $ = (id) => document.getElementById(id);
const say = (name, ...values) => data.words[name].replace(/%(\d)/g, (_, place) => values[place - 1]);
const PREFIXES = [[1e6, "M"], [1e3, "k"], [1, ""], [1e-3, "m"], [1e-6, "µ"], [1e-9, "n"]];
for (const column of columns) {
  // Numbers are shown between 1 and 1000 where the unit takes a prefix; the files stay in SI.
  let largest = 0;
  if (column.kind === "float") for (const value of column.values) if (value !== null && Math.abs(value) > largest) largest = Math.abs(value);
  const takes = /^(m|s|N|rad)(?![a-zA-Z])/.test(column.unit);
  // Forces and stiffnesses are written in kN and MN/m; nobody writes km/s^3.
  const most = column.unit.startsWith("N") ? Infinity : 1;
  const [size, prefix] = (takes && PREFIXES.find(([limit]) => largest >= limit && limit <= most)) || [1, ""];
  column.size = size; column.shown = prefix + column.unit;
}
const title = (column) => column.shown ? `${column.head} [${column.shown}]` : column.head;
const number = (value) => value === null ? "" : String(Number(value.toPrecision(6)));
const short = (value) => String(Number(value.toPrecision(4)));
// As many digits as tell neighbouring ticks apart.
const tick = (value, step) => step ? String(Number(value.toPrecision(Math.max(4, 2 + Math.ceil(Math.log10(Math.abs(value / step) || 1)))))) : short(value);
const text = (column, row) => {
  const value = column.values[row];
  if (value === null) return "";
  if (column.kind === "str") return column.words[value];
  if (column.kind === "bool") return value ? say("yes") : say("no");
  return number(value / column.size);
};
const numeric = (column) => column.kind === "float" || column.kind === "int";
const keys = columns.filter((column) => column.varies && numeric(column));
const results = columns.filter((column) => column.result && numeric(column));
const plotted = data.plotted.map((name) => by.get(name));
const bounds = keys.filter((column) => column.name.startsWith("requirements.peaks."));
// The key with most values makes the smoothest curves.
const variety = new Map(keys.map((column) => [column, keys.length > 1 ? new Set(column.values).size : count]));
const main = keys.reduce((best, column) => (best && variety.get(best) >= variety.get(column) ? best : column), undefined);
const parameter = bounds[0] || main;
// A cloud of many cases would hide the numbers; a single curve has room for them at any length.
const labelled = parameter && (count <= 200 || data.keys.length === 1), isCrowded = count > 2000;
const flag = by.get(data.flag);
// Colours come from the style sheet, which knows light and dark.
const tint = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

function range(values, log) {
  let low = Infinity, high = -Infinity;
  for (const value of values) {
    if (value === null || (log && value <= 0)) continue;
    if (value < low) low = value;
    if (value > high) high = value;
  }
  if (low > high) return [0, 1];
  // What differs by rounding only is one value.
  if (high - low <= 1e-6 * Math.abs(high)) { const pad = Math.abs(low) * 0.05 || 1; return [low - (log ? 0 : pad), high + pad]; }
  return [low, high];
}

function scaleOf(values, from, to, log) {
  const [low, high] = range(values, log), f = log ? Math.log : (v) => v;
  const a = f(low), b = f(high);
  return { low, high, log, at: (v) => from + (to - from) * (f(v) - a) / (b - a || 1) };
}

function prepare(canvas) {
  const ratio = window.devicePixelRatio || 1, box = canvas.getBoundingClientRect();
  canvas.width = box.width * ratio; canvas.height = box.height * ratio;
  const pen = canvas.getContext("2d");
  pen.scale(ratio, ratio); pen.clearRect(0, 0, box.width, box.height); pen.font = "12px system-ui, sans-serif";
  return { pen, width: box.width, height: box.height };
}

// Round numbers inside a range: 1, 2 or 5 times a power of ten.
function ticks(low, high, most, log, whole) {
  const found = [];
  if (log && high / low > 20) {
    for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power++)
      for (const head of high / low > 1e4 ? [1] : [1, 2, 5]) found.push(Number(`${head}e${power}`));
  } else {
    const raw = (high - low) / most, power = 10 ** Math.floor(Math.log10(raw));
    const fine = power * [1, 2, 5, 10].find((head) => head * power >= raw * (1 - 1e-9));
    const step = whole ? Math.max(fine, 1) : fine;
    for (let i = Math.ceil(low / step); i <= high / step; i++) found.push(Number((i * step).toPrecision(12)));
  }
  return found.filter((value) => value >= low && value <= high);
}

function axes(pen, width, height, x, y, xColumn, yColumn) {
  pen.lineWidth = 1; pen.strokeStyle = tint("grid"); pen.fillStyle = tint("dim");
  pen.textAlign = "right";
  const rungs = ticks(y.low / yColumn.size, y.high / yColumn.size, height / 40, false, yColumn.kind === "int");
  for (const value of rungs) {
    const py = Math.round(y.at(value * yColumn.size)) + 0.5;
    pen.beginPath(); pen.moveTo(72, py); pen.lineTo(width - 12, py); pen.stroke();
    pen.fillText(tick(value, rungs[1] - rungs[0]), 68, py + 4);
  }
  pen.textAlign = "center";
  const marks = ticks(x.low / xColumn.size, x.high / xColumn.size, width / 80, x.log, xColumn.kind === "int");
  for (const value of marks) {
    const px = Math.round(x.at(value * xColumn.size)) + 0.5;
    pen.beginPath(); pen.moveTo(px, 8); pen.lineTo(px, height - 36); pen.stroke();
    pen.fillText(tick(value, x.log ? 0 : marks[1] - marks[0]), Math.min(px, width - 20), height - 22);
  }
  pen.strokeStyle = tint("dim"); pen.strokeRect(72.5, 8.5, width - 84, height - 44);
  pen.fillText(title(xColumn), (width + 60) / 2, height - 5);
}

// Where every case at a place of the horizontal axis is good, and where some are.
function bands(pen, width, height, xColumn, x, log) {
  const good = new Uint32Array(Math.ceil(width) + 1), bad = new Uint32Array(Math.ceil(width) + 1), sorted = [];
  for (let row = 0; row < count; row++) {
    const value = xColumn.values[row];
    if (value !== null && !(log && value <= 0)) (flag.values[row] ? good : bad)[Math.round(x.at(value))]++;
  }
  for (let px = 0; px < good.length; px++) if (good[px] || bad[px]) sorted.push(px);
  const all = tint("band-good"), some = tint("band-some"), none = tint("band-none");
  sorted.forEach((px, i) => {
    const left = i ? Math.round((sorted[i - 1] + px) / 2) : px - 5;
    const right = i + 1 < sorted.length ? Math.round((px + sorted[i + 1]) / 2) : px + 5;
    pen.fillStyle = bad[px] === 0 ? all : good[px] === 0 ? none : some;
    pen.fillRect(left, 9, right - left, height - 45);
  });
}

// What is not good is a cross, where there is room for one.
function dots(pen, points) {
  const size = isCrowded ? 1.5 : 4, good = tint("good"), bad = tint("bad");
  for (const [px, py, row] of points) {
    const isGood = flag.values[row];
    pen.fillStyle = pen.strokeStyle = isGood ? good : bad;
    if (isGood || isCrowded) { pen.fillRect(px - size / 2, py - size / 2, size, size); continue; }
    pen.beginPath(); pen.moveTo(px - 3, py - 3); pen.lineTo(px + 3, py + 3);
    pen.moveTo(px - 3, py + 3); pen.lineTo(px + 3, py - 3); pen.stroke();
  }
}

// Cases that differ in the horizontal key alone belong together: a thin line joins them.
function join(pen, points, xColumn) {
  const others = keys.filter((column) => column !== xColumn);
  if (isCrowded || !keys.includes(xColumn) || others.length + 1 !== data.keys.length) return;
  const series = new Map();
  for (const point of points) {
    const name = others.map((column) => column.values[point[2]]).join();
    if (!series.has(name)) series.set(name, []);
    series.get(name).push(point);
  }
  if (series.size * 3 > points.length) return;
  pen.strokeStyle = tint("dim"); pen.globalAlpha = 0.5;
  for (const part of series.values()) {
    part.sort((a, b) => a[0] - b[0]); pen.beginPath();
    part.forEach(([px, py], i) => (i ? pen.lineTo(px, py) : pen.moveTo(px, py)));
    pen.stroke();
  }
  pen.globalAlpha = 1;
}

const REACH = 20;

function nearest(canvas, points, event, reach) {
  const box = canvas.getBoundingClientRect(), px = event.clientX - box.left, py = event.clientY - box.top;
  let best = null, least = reach ** 2;
  for (const point of points) {
    const distance = (point[0] - px) ** 2 + (point[1] - py) ** 2;
    if (distance < least) { least = distance; best = point; }
  }
  return best;
}

function listen(canvas, points, shown, reach = REACH) {
  canvas.onmousemove = (event) => {
    const point = nearest(canvas, points, event, reach);
    canvas.title = point ? `${say("case", point[2])}: ${shown.map((column) => `${title(column)} ${text(column, point[2])}`).join(", ")}` : "";
  };
  canvas.onclick = (event) => { const point = nearest(canvas, points, event, reach); if (point) showProfile(point[2]); };
}

function scatter(canvas, xColumn, yColumn, log, front) {
  const { pen, width, height } = prepare(canvas);
  const x = scaleOf(xColumn.values, 78, width - 18, log), y = scaleOf(yColumn.values, height - 42, 14, false);
  if (!front) bands(pen, width, height, xColumn, x, log);
  axes(pen, width, height, x, y, xColumn, yColumn);
  // Of many cases on one pixel the first good and the first other one are kept.
  const drawn = [], across = 2 * Math.ceil(width) + 2, taken = new Uint8Array(isCrowded ? across * Math.ceil(height + 1) : 0);
  for (let row = 0; row < count; row++) {
    const a = xColumn.values[row], b = yColumn.values[row];
    if (a === null || b === null || (log && a <= 0)) continue;
    const px = x.at(a), py = y.at(b);
    if (isCrowded) {
      const place = Math.round(py) * across + 2 * Math.round(px) + (flag.values[row] ? 1 : 0);
      if (taken[place]) continue;
      taken[place] = 1;
    }
    drawn.push([px, py, row]);
  }
  if (!front) join(pen, drawn, xColumn);
  dots(pen, drawn);
  if (front) ring(pen, width, front, x, y, xColumn, yColumn);
  listen(canvas, drawn, [...new Set([...keys, xColumn, yColumn])]);
}

// The front as a line, its points ringed and, as far as there is room, with the parameter's value.
function ring(pen, width, front, x, y, xColumn, yColumn) {
  const places = front.map((row) => [x.at(xColumn.values[row]), y.at(yColumn.values[row]), row]);
  pen.strokeStyle = pen.fillStyle = tint("ink"); pen.beginPath();
  places.forEach(([px, py], i) => (i ? pen.lineTo(px, py) : pen.moveTo(px, py)));
  pen.stroke();
  let last = null, ringed = null;
  for (const [px, py, row] of places) {
    if (ringed && Math.hypot(px - ringed[0], py - ringed[1]) < 8) continue;
    ringed = [px, py];
    pen.beginPath(); pen.arc(px, py, 5, 0, 7); pen.stroke();
    if (!labelled) continue;
    const word = short(parameter.values[row] / parameter.size), long = pen.measureText(word).width;
    const left = px > width - 90 ? px - 8 - long : px + 8, base = Math.max(py - 6, 20);
    // The front falls to the right: only the number before can be in the way.
    if (last && left < last.right + 8 && left + long > last.left - 8 && Math.abs(base - last.base) < 24) continue;
    last = { left, right: left + long, base };
    pen.textAlign = "left"; pen.fillText(word, left, base);
  }
}

function figure(parent, caption, meaning = "") {
  const box = document.createElement("figure"), head = document.createElement("figcaption"), canvas = document.createElement("canvas");
  head.textContent = caption; canvas.setAttribute("role", "img"); canvas.setAttribute("aria-label", caption);
  head.title = meaning; box.append(head, canvas); parent.append(box);
  return canvas;
}

function pareto(xColumn, yColumn) {
  const rows = [];
  for (let row = 0; row < count; row++) if (xColumn.values[row] !== null && yColumn.values[row] !== null) rows.push(row);
  rows.sort((a, b) => xColumn.values[a] - xColumn.values[b] || yColumn.values[a] - yColumn.values[b]);
  const front = [];
  let least = Infinity;
  for (const row of rows) if (yColumn.values[row] < least) { least = yColumn.values[row]; front.push(row); }
  return front;
}

function fill(select, options, chosen) {
  for (const column of options) {
    const option = document.createElement("option");
    option.value = column.name; option.textContent = title(column); option.selected = column.name === chosen;
    select.append(option);
  }
}

// A plot is drawn when it comes into view, so that a long page opens at once.
const painters = new Map(), stale = new Set(), visible = new Set();
const paint = (canvas) => { if (stale.delete(canvas)) painters.get(canvas)(); };
const watcher = new IntersectionObserver((entries) => {
  for (const entry of entries) {
    if (entry.isIntersecting) { visible.add(entry.target); paint(entry.target); } else visible.delete(entry.target);
  }
});
function redraw(canvas) { stale.add(canvas); if (visible.has(canvas)) paint(canvas); }
function keep(canvas, painter) { painters.set(canvas, painter); stale.add(canvas); watcher.observe(canvas); }

function drawTrade(canvas) {
  const x = by.get($("tx").value), y = by.get($("ty").value);
  $("trade-caption").textContent = say("over", title(y), title(x)) + (labelled ? `; ${say("numbers", title(parameter))}` : "");
  scatter(canvas, x, y, false, pareto(x, y));
}

const shade = (share) => `hsl(${240 - 190 * share} 70% ${35 + 35 * share}%)`;

// The places of a key are its values in order, one step each; some are named.
function places(column) {
  const values = [...new Set(column.values)].sort((a, b) => a - b);
  return { values, at: new Map(values.map((value, i) => [value, i])) };
}

function nameAll({ values }, column, step, room, write) {
  const every = Math.ceil(room / step);
  values.forEach((value, i) => { if (i % every === 0) write(short(value / column.size), (i + 0.5) * step); });
}

function drawHeat(canvas) {
  const { pen, width, height } = prepare(canvas);
  const [xColumn, yColumn] = keys, value = by.get($("hv").value), [low, high] = range(value.values, false);
  const xs = places(xColumn), ys = places(yColumn), w = (width - 150) / xs.values.length, h = (height - 44) / ys.values.length;
  const bottom = height - 36, right = width - 78, middles = [];
  $("map-caption").textContent = say("over-two", title(value), title(xColumn), title(yColumn));
  pen.textAlign = "center";
  for (let row = 0; row < count; row++) {
    const v = value.values[row], share = (v - low) / (high - low || 1);
    const px = 72 + w * xs.at.get(xColumn.values[row]), py = bottom - h * (ys.at.get(yColumn.values[row]) + 1);
    pen.fillStyle = v === null ? "#b0b0b0" : shade(share);
    pen.fillRect(Math.floor(px), Math.floor(py), Math.ceil(px + w) - Math.floor(px), Math.ceil(py + h) - Math.floor(py));
    const isRoomy = w > 44 && h > 18;
    if (v !== null && isRoomy) { pen.fillStyle = share < 0.5 ? "#fff" : "#000"; pen.fillText(short(v / value.size), px + w / 2, py + h / 2 + 4); }
    if (!flag.values[row] && v !== null && w > 3 && h > 3) { pen.fillStyle = "#ff5a4d"; pen.fillRect(px + 1, py + 1, Math.min(w - 2, 7), Math.min(h - 2, 7)); }
    middles.push([px + w / 2, py + h / 2, row]);
  }
  pen.fillStyle = pen.strokeStyle = tint("dim");
  nameAll(xs, xColumn, w, 56, (word, along) => pen.fillText(word, 72 + along, height - 22));
  pen.fillText(title(xColumn), (72 + right) / 2, height - 5);
  pen.textAlign = "right";
  nameAll(ys, yColumn, h, 18, (word, along) => pen.fillText(word, 68, bottom - along + 4));
  pen.textAlign = "left";
  for (let i = 0; i < 100; i++) { pen.fillStyle = shade(i / 99); pen.fillRect(right + 10, bottom - (i + 1) * (bottom - 8) / 100, 14, (bottom - 8) / 100 + 1); }
  pen.fillStyle = tint("dim");
  for (const share of [0, 0.25, 0.5, 0.75, 1]) pen.fillText(short((low + share * (high - low)) / value.size), right + 28, bottom - share * (bottom - 18));
  listen(canvas, middles, [xColumn, yColumn, value], Math.max(REACH, Math.hypot(w, h) / 2));
}

let order = Array.from({ length: count }, (_, row) => row), page = 0, sorted = "", falling = false;

function sortBy(column) {
  falling = sorted === column.name ? !falling : false;
  sorted = column.name;
  const value = column.kind === "str" ? (row) => text(column, row) : (row) => column.values[row];
  order.sort((a, b) => {
    const p = value(a), q = value(b);
    if (p === q) return a - b;
    if (p === null) return 1;
    if (q === null) return -1;
    return (p < q ? -1 : 1) * (falling ? -1 : 1);
  });
  page = 0; drawRows();
}

function drawRows() {
  const body = $("body"), pages = Math.max(1, Math.ceil(count / PAGE));
  body.replaceChildren();
  for (const row of order.slice(page * PAGE, (page + 1) * PAGE)) {
    const line = document.createElement("tr");
    columns.forEach((column) => {
      const cell = document.createElement("td");
      if (column.name === "case") {
        const button = document.createElement("button");
        button.type = "button"; button.textContent = text(column, row); button.onclick = () => showProfile(row);
        cell.append(button);
      } else cell.textContent = text(column, row);
      if (column.name === "outcome" && cell.textContent !== "done") cell.className = "bad";
      line.append(cell);
    });
    body.append(line);
  }
  $("where").textContent = say("page", page + 1, pages);
  $("back").disabled = page === 0; $("on").disabled = page + 1 >= pages;
}

function showProfile(row) {
  let profile = data.template;
  data.keys.forEach((key, i) => {
    const column = by.get(key), value = column.values[row];
    const shown = column.kind === "str" ? JSON.stringify(column.words[value]) : String(value);
    profile = profile.split(`"@@${i}@@"`).join(shown);
  });
  $("profile-name").textContent = say("chosen", by.get("case").values[row]);
  $("profile").textContent = profile;
  $("profile-heading").scrollIntoView();
}

const head = document.createElement("tr");
for (const column of columns) {
  const cell = document.createElement("th"), button = document.createElement("button");
  button.type = "button"; button.textContent = title(column); button.title = column.meaning; button.onclick = () => sortBy(column);
  cell.scope = "col"; cell.append(button); head.append(cell);
}
$("head").append(head);
$("back").onclick = () => { page--; drawRows(); };
$("on").onclick = () => { page++; drawRows(); };
const xs = keys.length ? keys : [by.get("case")];
fill($("x"), xs, (main || xs[0]).name);
// Values that were spread by ratios are shown so.
function isSpreadByRatios(column) {
  const values = Float64Array.from(column.values, (value) => value ?? NaN).sort(), middle = values[count >> 1];
  const low = values[0], high = values[count - 1];
  return count > 4 && low > 0 && high / low > 10 && Math.abs(Math.log(middle / Math.sqrt(low * high))) < Math.abs(Math.log(middle / ((low + high) / 2)));
}
$("log").checked = isSpreadByRatios(main || xs[0]);
const peak = bounds.length ? by.get(`peak_${bounds[0].name.slice(19)}`) : undefined;
const firstOf = (...names) => names.map((name) => by.get(name)).find((column) => column);
fill($("tx"), [...results, ...keys], firstOf("settling_time", "t_f").name);
fill($("ty"), [...results, ...keys], (peak || firstOf("peak_tcp_vibration", "residual_deviation") || results[results.length - 1]).name);
const over = plotted.map((column) => [figure($("plots"), title(column), column.meaning), column]);
for (const [canvas, column] of over) keep(canvas, () => scatter(canvas, by.get($("x").value), column, $("log").checked, null));
for (const id of ["x", "log"]) $(id).onchange = () => over.forEach(([canvas]) => redraw(canvas));
const trade = figure($("trade"), say("front"));
trade.previousSibling.id = "trade-caption";
keep(trade, () => drawTrade(trade));
for (const id of ["tx", "ty"]) $(id).onchange = () => redraw(trade);
if (keys.length === 2) {
  $("heat-section").hidden = false;
  fill($("hv"), results, (by.get("settling_time") || results[0]).name);
  const map = figure($("heat"), say("map"));
  map.previousSibling.id = "map-caption";
  keep(map, () => drawHeat(map));
  $("hv").onchange = () => redraw(map);
}
drawRows();
const redrawAll = () => { for (const canvas of painters.keys()) redraw(canvas); };
window.onresize = redrawAll;
matchMedia("(prefers-color-scheme: dark)").onchange = redrawAll;
document.documentElement.dataset.ready = "yes";
