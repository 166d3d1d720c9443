"use strict";
const data = JSON.parse(document.getElementById("data").textContent);
const columns = data.columns, count = data.count, PAGE = 50;
const by = new Map(columns.map((column) => [column.name, column]));
const $ = (id) => document.getElementById(id);
const title = (column) => column.unit ? `${column.name} [${column.unit}]` : column.name;
const number = (value) => value === null ? "" : String(Number(value.toPrecision(6)));
const short = (value) => String(Number(value.toPrecision(4)));
const text = (column, row) => {
  const value = column.values[row];
  if (value === null) return "";
  if (column.kind === "str") return column.words[value];
  if (column.kind === "bool") return value ? "yes" : "no";
  return number(value);
};
const numeric = (column) => column.kind === "float" || column.kind === "int";
const keys = columns.filter((column) => column.varies && numeric(column));
const results = columns.filter((column) => column.result && numeric(column));
const flag = by.get(data.flag);
const colour = (row) => flag.values[row] ? "#1a7f37" : "#b42318";

function range(values, log) {
  let low = Infinity, high = -Infinity;
  for (const value of values) {
    if (value === null || (log && value <= 0)) continue;
    if (value < low) low = value;
    if (value > high) high = value;
  }
  if (low > high) return [0, 1];
  if (low === high) { const pad = Math.abs(low) * 0.05 || 1; return [low - (log ? 0 : pad), high + pad]; }
  return [low, high];
}

function scaleOf(values, from, to, log) {
  const [low, high] = range(values, log), f = log ? Math.log : (v) => v;
  const a = f(low), b = f(high);
  return { low, high, at: (v) => from + (to - from) * (f(v) - a) / (b - a || 1) };
}

function prepare(canvas) {
  const ratio = window.devicePixelRatio || 1, box = canvas.getBoundingClientRect();
  canvas.width = box.width * ratio; canvas.height = box.height * ratio;
  const pen = canvas.getContext("2d");
  pen.scale(ratio, ratio); pen.clearRect(0, 0, box.width, box.height); pen.font = "12px system-ui, sans-serif";
  return { pen, width: box.width, height: box.height };
}

function axes(pen, width, height, x, y, xColumn) {
  pen.fillStyle = pen.strokeStyle = "#57606a";
  pen.strokeRect(72.5, 8.5, width - 84, height - 44);
  pen.textAlign = "right"; pen.fillText(short(y.high), 68, 18); pen.fillText(short(y.low), 68, height - 38);
  pen.fillText(short(x.high), width - 12, height - 20);
  pen.textAlign = "left"; pen.fillText(short(x.low), 72, height - 20);
  pen.textAlign = "center"; pen.fillText(title(xColumn), width / 2, height - 5);
}

function scatter(canvas, xColumn, yColumn, log, ringed) {
  const { pen, width, height } = prepare(canvas);
  const x = scaleOf(xColumn.values, 78, width - 18, log), y = scaleOf(yColumn.values, height - 42, 14, false);
  axes(pen, width, height, x, y, xColumn);
  const size = count > 2000 ? 1.5 : 4, drawn = [];
  for (let row = 0; row < count; row++) {
    const a = xColumn.values[row], b = yColumn.values[row];
    if (a === null || b === null || (log && a <= 0)) continue;
    const point = [x.at(a), y.at(b), row];
    drawn.push(point);
    pen.fillStyle = colour(row);
    pen.fillRect(point[0] - size / 2, point[1] - size / 2, size, size);
  }
  if (ringed) {
    const wanted = new Set(ringed);
    pen.strokeStyle = "#1b1f24";
    for (const [px, py, row] of drawn) if (wanted.has(row)) { pen.beginPath(); pen.arc(px, py, 5, 0, 7); pen.stroke(); }
  }
  const nearest = (event) => {
    const box = canvas.getBoundingClientRect(), px = event.clientX - box.left, py = event.clientY - box.top;
    let best = null, least = 400;
    for (const point of drawn) {
      const distance = (point[0] - px) ** 2 + (point[1] - py) ** 2;
      if (distance < least) { least = distance; best = point; }
    }
    return best;
  };
  canvas.onmousemove = (event) => {
    const point = nearest(event);
    canvas.title = point ? `case ${point[2]}: ${text(xColumn, point[2])}, ${text(yColumn, point[2])}` : "";
  };
  canvas.onclick = (event) => { const point = nearest(event); if (point) showProfile(point[2]); };
}

function figure(parent, caption) {
  const box = document.createElement("figure"), head = document.createElement("figcaption"), canvas = document.createElement("canvas");
  head.textContent = caption; canvas.setAttribute("role", "img"); canvas.setAttribute("aria-label", caption);
  box.append(head, canvas); parent.append(box);
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

function drawPlots() {
  const x = by.get($("x").value);
  results.forEach((column, i) => scatter($("plots").querySelectorAll("canvas")[i], x, column, $("log").checked, null));
}

function drawTrade() {
  const x = by.get($("tx").value), y = by.get($("ty").value);
  scatter($("trade").querySelector("canvas"), x, y, false, pareto(x, y));
}

function drawHeat() {
  const canvas = $("heat").querySelector("canvas"), { pen, width, height } = prepare(canvas);
  const [xColumn, yColumn] = keys, value = by.get($("hv").value), [low, high] = range(value.values, false);
  const place = (column) => new Map([...new Set(column.values)].sort((a, b) => a - b).map((v, i) => [v, i]));
  const xs = place(xColumn), ys = place(yColumn), w = (width - 84) / xs.size, h = (height - 44) / ys.size;
  for (let row = 0; row < count; row++) {
    const v = value.values[row], share = (v - low) / (high - low || 1);
    pen.fillStyle = v === null ? "#b0b0b0" : `hsl(${240 - 190 * share} 70% ${35 + 35 * share}%)`;
    pen.fillRect(72 + w * xs.get(xColumn.values[row]), height - 36 - h * (ys.get(yColumn.values[row]) + 1), w + 0.5, h + 0.5);
  }
  const [xl, xh] = range(xColumn.values, false), [yl, yh] = range(yColumn.values, false);
  axes(pen, width, height, { low: xl, high: xh }, { low: yl, high: yh }, xColumn);
  $("heat-scale").textContent = `Vertical: ${title(yColumn)}. Blue ${number(low)} to yellow ${number(high)}; grey: no result.`;
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
  $("where").textContent = `Page ${page + 1} of ${pages}`;
  $("back").disabled = page === 0; $("on").disabled = page + 1 >= pages;
}

function showProfile(row) {
  let profile = data.template;
  data.keys.forEach((key, i) => {
    const column = by.get(key), value = column.values[row];
    const shown = column.kind === "str" ? JSON.stringify(column.words[value]) : String(value);
    profile = profile.split(`"@@${i}@@"`).join(shown);
  });
  $("profile-name").textContent = `Case ${by.get("case").values[row]}; values that vary stand in SI.`;
  $("profile").textContent = profile;
  $("profile-heading").scrollIntoView();
}

const head = document.createElement("tr");
for (const column of columns) {
  const cell = document.createElement("th"), button = document.createElement("button");
  button.type = "button"; button.textContent = title(column); button.onclick = () => sortBy(column);
  cell.scope = "col"; cell.append(button); head.append(cell);
}
$("head").append(head);
$("back").onclick = () => { page--; drawRows(); };
$("on").onclick = () => { page++; drawRows(); };
const xs = keys.length ? keys : [by.get("case")];
fill($("x"), xs, xs[0].name);
const last = results.length - 1;
fill($("tx"), [...results, ...keys], (by.get("settling_time") || results[0]).name);
fill($("ty"), [...results, ...keys], (by.get("residual_deviation") || results[last]).name);
results.forEach((column) => figure($("plots"), title(column)));
figure($("trade"), "Trade-off");
for (const id of ["x", "log"]) $(id).onchange = drawPlots;
for (const id of ["tx", "ty"]) $(id).onchange = drawTrade;
drawRows(); drawPlots(); drawTrade();
if (keys.length === 2) {
  $("heat-section").hidden = false;
  fill($("hv"), results, results[0].name);
  figure($("heat"), "Map");
  $("hv").onchange = drawHeat;
  drawHeat();
}
window.onresize = () => { drawPlots(); drawTrade(); if (keys.length === 2) drawHeat(); };
document.documentElement.dataset.ready = "yes";
