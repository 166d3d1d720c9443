// Draws the plots of the sheet: zoom by dragging, values under the cursor, linked axes.

const WIDEST = 900, NARROWEST = 340, PANEL = 110, LEGEND = 26;
const linked = new Map();
// Drawing units of the plot that is being drawn: pixels, so that letters stay as large as they are.
let across = WIDEST;

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
  if (line.is_stepped) return line.y[low];
  const share = (place - line.x[low]) / (line.x[high] - line.x[low] || 1);
  return line.y[low] + share * (line.y[high] - line.y[low]);
}

function path(line, x, y) {
  const [first, last] = inView(line, x.low, x.high);
  let d = "";
  for (let i = first; i < last; i++) {
    const px = x.at(line.x[i]).toFixed(1), py = y.at(line.y[i]).toFixed(1);
    d += i === first ? `M${px} ${py}` : line.is_stepped ? `H${px}V${py}` : `L${px} ${py}`;
  }
  return d;
}

function fit(host, plot) {
  // A name longer than a narrow page shrinks the plot rather than being cut.
  const longest = Math.max(...plot.panels.flatMap(panel => panel.lines).map(line => line.label.length));
  const least = Math.max(NARROWEST, LEFT + 62 + 7.2 * longest);
  return Math.round(Math.min(WIDEST, Math.max(least, host.clientWidth)));
}

function legendOf(plot) {
  return [...new Map(plot.panels.flatMap(panel => panel.lines.map(line => [line.label, line.style])))];
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

function whole(plot) {
  let low = Infinity, high = -Infinity;
  for (const panel of plot.panels) for (const line of panel.lines) {
    low = Math.min(low, line.x[0]);
    high = Math.max(high, line.x[line.x.length - 1]);
  }
  return [low, high];
}

function drawLines(svg, plot, view, key) {
  const head = drawLegend(svg, legendRows(legendOf(plot)));
  const height = head + plot.panels.length * (TITLE + PANEL) + FOOT;
  svg.setAttribute("viewBox", `0 0 ${across} ${height}`);
  const x = scale(...view, LEFT, across - RIGHT, plot.x_is_log), titles = [];
  let top = head;
  plot.panels.forEach((panel, i) => {
    let low = Infinity, high = -Infinity;
    for (const line of panel.lines) {
      const [first, last] = inView(line, ...view);
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
    titles.push(add(svg, "text", {x: LEFT, y: top + TITLE - 6}, panel.y_label));
    top += TITLE;
    const y = scale(...widen(low, high, false), top + PANEL, top, false);
    frame(svg, x, y, `${key}-${i}`);
    const inside = add(svg, "g", {"clip-path": `url(#${key}-${i})`});
    for (const border of panel.borders)
      add(inside, "path", {class: "border", d: `M${x.from} ${y.at(border.y)}H${x.to}`});
    for (const line of panel.lines)
      add(inside, "path", {class: `curve s${line.style}`, d: path(line, x, y)});
    top += PANEL;
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

function start(host) {
  const key = host.dataset.plot, plot = data.plots[key];
  const svg = add(host, "svg", {role: "img", tabindex: 0, "aria-label": host.dataset.alt});
  const group = linked.get(plot.link) ?? [];
  linked.set(plot.link, group);
  const me = {full: whole(plot), drawn: null, place: null};
  me.view = me.full;
  me.draw = () => {
    across = me.width = fit(host, plot);
    svg.replaceChildren();
    me.drawn = drawLines(svg, plot, me.view, key);
  };
  me.zoom = view => { me.view = view ?? me.full; me.draw(); };
  me.point = place => { me.place = place; me.drawn.point(place); };
  group.push(me);
  me.draw();
  new ResizeObserver(() => { if (fit(host, plot) !== me.width) me.draw(); }).observe(host);
  listen(svg, me, group);
}

function listen(svg, me, group) {
  const all = action => group.forEach(action);
  const read = event => {
    const {x} = me.drawn, px = Math.min(Math.max(spotOf(svg, event).x, x.from), x.to);
    return {px, x: x.of(px)};
  };
  let begun = null, brush = null;
  svg.addEventListener("pointerdown", event => { begun = read(event); });
  svg.addEventListener("pointermove", event => {
    const now = read(event);
    all(other => other.point(now.x));
    if (!begun) return;
    brush?.remove();
    const {head} = me.drawn, height = svg.viewBox.baseVal.height - head - FOOT;
    brush = add(svg, "rect", {class: "brush", x: Math.min(begun.px, now.px), y: head, width: Math.abs(now.px - begun.px), height});
  });
  svg.addEventListener("pointerup", event => {
    const now = read(event), then = begun;
    begun = null;
    brush?.remove();
    if (!then || Math.abs(now.px - then.px) < 8) return;
    all(other => other.zoom([Math.min(then.x, now.x), Math.max(then.x, now.x)]));
  });
  svg.addEventListener("pointerleave", () => { begun = null; brush?.remove(); all(other => other.point(null)); });
  svg.addEventListener("dblclick", () => all(other => other.zoom(null)));
  svg.addEventListener("keydown", event => press(event, me, all));
}

function press(event, me, all) {
  const {x} = me.drawn, step = (x.to - x.from) / 100;
  const from = me.place === null ? (x.from + x.to) / 2 : x.at(me.place);
  const turn = {ArrowLeft: -step, ArrowRight: step}[event.key];
  const factor = {"+": 0.5, "-": 2}[event.key];
  if (turn !== undefined) {
    const place = x.of(Math.min(Math.max(from + turn, x.from), x.to));
    all(other => other.point(place));
  } else if (factor !== undefined) {
    const half = factor * (x.to - x.from) / 2;
    const low = x.of(from - half), high = x.of(from + half);
    all(other => other.zoom([Math.max(low, me.full[0]), Math.min(high, me.full[1])]));
  } else if (event.key === "0" || event.key === "Escape") all(other => other.zoom(null));
  else return;
  event.preventDefault();
}

document.querySelectorAll("[data-plot]").forEach(start);
