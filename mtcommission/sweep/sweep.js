// The page of a sweep: results over what varies, a trade-off, a map over two keys, sortable rows.
// Draws with kit.js.

(() => {
  const {columns, count, keys: varied, plotted, flag: flagName, template, words} = JSON.parse(document.getElementById("what-if-data").textContent);
  const id = key => document.getElementById(`wi-${key}`);
  const say = (key, ...values) => words[key].replace(/%(\d)/g, (_, place) => values[place - 1]);
  const PAGE = 50, REACH = 20, TALL = 400, SHADES = 32;
  const PREFIXES = [[1e6, "M"], [1e3, "k"], [1, ""], [1e-3, "m"], [1e-6, "µ"], [1e-9, "n"]];

  // ---- columns ----

  for (const column of columns) {
    column.values ??= new Array(count).fill(column.all);
    column.isNumber = column.kind === "float" || column.kind === "int";
    // Numbers are shown between 1 and 1000 where the unit takes a prefix; the files stay in SI.
    const largest = column.kind === "float" ? column.values.reduce((most, value) => Math.max(most, Math.abs(value ?? 0)), 0) : 0;
    // Forces and stiffnesses are written in kN and MN/m; nobody writes km/s^3.
    const most = column.unit.startsWith("N") ? Infinity : 1, takes = /^(m|s|N|rad)(?![a-zA-Z])/.test(column.unit);
    const [size, prefix] = (takes && PREFIXES.find(([limit]) => largest >= limit && limit <= most)) || [1, ""];
    column.size = size;
    column.title = column.unit ? `${column.head} [${prefix}${column.unit}]` : column.head;
  }
  const by = new Map(columns.map(column => [column.name, column]));
  const keys = columns.filter(column => column.varies && column.isNumber), results = columns.filter(column => column.result && column.isNumber);
  const bounds = keys.filter(column => column.name.startsWith("requirements.peaks.")), flag = by.get(flagName).values;
  // The key with most values makes the smoothest curves.
  const variety = new Map(keys.map(column => [column, new Set(column.values).size]));
  const main = keys.reduce((best, column) => best && variety.get(best) >= variety.get(column) ? best : column, undefined) ?? by.get("case");
  const parameter = bounds[0] ?? main;
  // A cloud of many cases would hide the numbers; a single curve has room for them at any length.
  const isNumbered = keys.length > 0 && (count <= 200 || varied.length === 1), isCrowded = count > 2000;

  function text(column, row) {
    const value = column.values[row];
    if (value === null) return "";
    if (column.kind === "str") return column.words[value];
    if (column.kind === "bool") return say(value ? "yes" : "no");
    return show(value / column.size, 6);
  }

  function ends(column, isLog) {
    let low = Infinity, high = -Infinity;
    for (const value of column.values) {
      if (value === null || (isLog && value <= 0)) continue;
      low = Math.min(low, value);
      high = Math.max(high, value);
    }
    if (low > high) return isLog ? [1, 10] : [0, 1];
    // What differs by rounding only is one value.
    if (high - low <= 1e-6 * Math.abs(high)) high = low;
    return widen(low / column.size, high / column.size, isLog);
  }

  // ---- plots: drawn when they come into view, so that a long page opens at once ----

  const painters = new Map(), stale = new Set(), visible = new Set();
  const paint = svg => { if (visible.has(svg) && stale.delete(svg)) painters.get(svg)(); };
  const redraw = svg => { stale.add(svg); paint(svg); };
  const watcher = new IntersectionObserver(entries => entries.forEach(({target, isIntersecting}) => {
    if (isIntersecting) visible.add(target); else visible.delete(target);
    paint(target);
  }));

  function figure(place, name, caption, painter) {
    const box = document.createElement("figure"), head = document.createElement("figcaption"), frame = document.createElement("div");
    head.textContent = caption;
    frame.className = "plot";
    box.append(head, frame);
    id(place).append(box);
    const svg = add(frame, "svg", {id: `wi-plot-${name}`, role: "img", "aria-label": caption});
    painters.set(svg, () => painter(svg, head));
    stale.add(svg);
    watcher.observe(svg);
    return svg;
  }

  function listen(svg, points, shown, reach = REACH) {
    const nearest = event => {
      const spot = spotOf(svg, event);
      return points.reduce((best, [px, py, row]) => {
        const distance = Math.hypot(px - spot.x, py - spot.y);
        return distance < best.distance ? {distance, row} : best;
      }, {distance: reach, row: null}).row;
    };
    svg.onpointermove = event => {
      const row = nearest(event);
      svg.parentNode.title = row === null ? "" : `${say("case", row)}: ${shown.map(column => `${column.title} ${text(column, row)}`).join(", ")}`;
    };
    svg.onclick = event => { const row = nearest(event); if (row !== null) showProfile(row); };
  }

  const joined = points => points.map(([px, py], i) => `${i ? "L" : "M"}${px.toFixed(1)} ${py.toFixed(1)}`).join("");

  function scatter(svg, xColumn, yColumn, {isLog = false, front = null, high = HIGH} = {}) {
    const {x, y, inside} = chart(svg, ends(xColumn, isLog), ends(yColumn, false), [xColumn.title, front ? yColumn.title : ""], {xLog: isLog, high});
    const at = row => [x.at(xColumn.values[row] / xColumn.size), y.at(yColumn.values[row] / yColumn.size), row];
    // Of many cases on one pixel the first good and the first other one are kept.
    const points = [], taken = new Set();
    for (let row = 0; row < count; row++) {
      const a = xColumn.values[row];
      if (a === null || yColumn.values[row] === null || (isLog && a <= 0)) continue;
      const point = at(row), place = 2 * (Math.round(point[0]) + 4096 * Math.round(point[1])) + (flag[row] ? 1 : 0);
      if (isCrowded && taken.has(place)) continue;
      taken.add(place);
      points.push(point);
    }
    if (!front) {
      drawBands(inside, x, y, xColumn, isLog);
      join(inside, points, xColumn);
    }
    // What is not good is a cross, where there is room for one.
    const mark = (wanted, shape) => points.filter(([, , row]) => Boolean(flag[row]) === wanted).map(([px, py]) => `M${px.toFixed(1)} ${py.toFixed(1)}${shape}`).join("");
    const cross = isCrowded ? "h0" : "m-3 -3l6 6m-6 0l6 -6", crowd = isCrowded ? " crowd" : "";
    add(inside, "path", {class: `miss${crowd}`, d: mark(false, cross)});
    add(inside, "path", {class: `hit${crowd}`, d: mark(true, "h0")});
    if (front) drawFront(inside, x.to, front.map(at));
    listen(svg, points, [...new Set([...keys, xColumn, yColumn])]);
  }

  // Where every case at a place of the horizontal axis is good, where some are, and where none is.
  function drawBands(inside, x, y, xColumn, isLog) {
    const found = new Map();
    xColumn.values.forEach((value, row) => {
      if (value === null || (isLog && value <= 0)) return;
      const place = Math.round(x.at(value / xColumn.size));
      if (!found.has(place)) found.set(place, {good: 0, all: 0});
      const one = found.get(place);
      one.good += flag[row] ? 1 : 0;
      one.all += 1;
    });
    const places = [...found.keys()].sort((a, b) => a - b);
    places.forEach((place, i) => {
      const left = i ? (places[i - 1] + place) / 2 : place - 5, right = i + 1 < places.length ? (place + places[i + 1]) / 2 : place + 5;
      const {good, all} = found.get(place);
      add(inside, "rect", {class: `band ${good === all ? "all" : good ? "some" : "none"}`, x: left, y: y.to, width: right - left, height: y.from - y.to});
    });
  }

  // Cases that differ in the horizontal key alone belong together: a thin line joins them.
  function join(inside, points, xColumn) {
    const others = keys.filter(column => column !== xColumn);
    if (isCrowded || !keys.includes(xColumn) || others.length + 1 !== varied.length) return;
    const series = new Map();
    for (const point of points) {
      const name = others.map(column => column.values[point[2]]).join();
      if (!series.has(name)) series.set(name, []);
      series.get(name).push(point);
    }
    if (series.size * 3 > points.length) return;
    for (const part of series.values()) add(inside, "path", {class: "thin", d: joined(part.sort((a, b) => a[0] - b[0]))});
  }

  // The front as a line, its points ringed and, as far as there is room, with the parameter's value.
  function drawFront(inside, right, places) {
    add(inside, "path", {class: "thin", d: joined(places)});
    let ringed = [-Infinity, 0], named = [-Infinity, 0];
    const far = (one, px, py, least) => Math.hypot(px - one[0], py - one[1]) >= least;
    for (const [px, py, row] of places) {
      if (!far(ringed, px, py, 8)) continue;
      ringed = [px, py];
      add(inside, "circle", {class: "ring", cx: px, cy: py, r: 5});
      if (!isNumbered || !far(named, px, py, 42)) continue;
      named = ringed;
      const isLate = px > right - 70;
      add(inside, "text", {x: px + (isLate ? -8 : 8), y: Math.max(py - 6, 34), "text-anchor": isLate ? "end" : "start"}, show(parameter.values[row] / parameter.size));
    }
  }

  function paretoFront(xColumn, yColumn) {
    const a = xColumn.values, b = yColumn.values;
    let least = Infinity;
    return [...a.keys()].filter(row => a[row] !== null && b[row] !== null).sort((p, q) => a[p] - a[q] || b[p] - b[q]).filter(row => {
      const isLower = b[row] < least;
      least = Math.min(least, b[row]);
      return isLower;
    });
  }

  function drawTrade(svg, head) {
    const x = by.get(id("tx").value), y = by.get(id("ty").value);
    head.textContent = say("over", y.title, x.title) + (isNumbered ? `; ${say("numbers", parameter.title)}` : "");
    scatter(svg, x, y, {front: paretoFront(x, y), high: TALL});
  }

  // The places of a key are its values in order, one step each; some are named.
  function drawMap(svg, head) {
    const [xColumn, yColumn] = keys, value = by.get(id("value").value), width = clear(svg, TALL);
    const found = value.values.filter(one => one !== null), low = found.reduce((a, b) => Math.min(a, b), Infinity), high = found.reduce((a, b) => Math.max(a, b), -Infinity);
    const [xs, ys] = keys.map(column => [...new Set(column.values)].sort((a, b) => a - b));
    const w = (width - LEFT - RIGHT) / xs.length, h = TALL / ys.length, middles = [];
    head.textContent = say("over-two", value.title, xColumn.title, yColumn.title, show(low / value.size), show(high / value.size));
    const places = [xs, ys].map(list => new Map(list.map((one, i) => [one, i])));
    // A path for each shade: a node for each of 100,000 cells would take seconds.
    const shades = Array.from({length: SHADES}, () => ""), numbers = [];
    let missed = "";
    for (let row = 0; row < count; row++) {
      const one = value.values[row], x = LEFT + w * places[0].get(xColumn.values[row]), y = TITLE + TALL - h * (places[1].get(yColumn.values[row]) + 1);
      middles.push([x + w / 2, y + h / 2, row]);
      if (one === null) continue;
      const shade = Math.round((SHADES - 1) * (one - low) / (high - low || 1));
      shades[shade] += `M${x.toFixed(1)} ${y.toFixed(1)}h${w.toFixed(2)}v${h.toFixed(2)}h${(-w).toFixed(2)}z`;
      if (w > 44 && h > 18) numbers.push([x + w / 2, y + h / 2 + 4, shade, one]);
      if (!flag[row]) missed += `M${x + 2} ${y + 2}l${Math.min(w - 2, 6)} ${Math.min(h - 2, 6)}`;
    }
    shades.forEach((d, shade) => { if (d) add(svg, "path", {class: "cell", "fill-opacity": (0.05 + 0.8 * shade / (SHADES - 1)).toFixed(2), d}); });
    numbers.forEach(([x, y, shade, one]) => add(svg, "text", {class: shade > SHADES / 2 ? "dark" : "", x, y, "text-anchor": "middle"}, show(one / value.size)));
    add(svg, "path", {class: "miss", d: missed});
    const every = (step, room) => (_, i) => i % Math.ceil(room / step) === 0;
    xs.filter(every(w, 56)).forEach(one => add(svg, "text", {x: LEFT + w * (places[0].get(one) + 0.5), y: TITLE + TALL + 16, "text-anchor": "middle"}, show(one / xColumn.size)));
    ys.filter(every(h, 18)).forEach(one => add(svg, "text", {x: LEFT - 6, y: TITLE + TALL - h * (places[1].get(one) + 0.5) + 4, "text-anchor": "end"}, show(one / yColumn.size)));
    add(svg, "text", {x: (LEFT + width) / 2, y: TITLE + TALL + 34, "text-anchor": "middle"}, xColumn.title);
    add(svg, "text", {x: LEFT, y: TITLE - 6}, yColumn.title);
    listen(svg, middles, [xColumn, yColumn, value], Math.max(REACH, Math.hypot(w, h) / 2));
  }

  // ---- rows ----

  let order = [...Array(count).keys()], page = 0, sorted = null, isFalling = false;

  function sortBy(column) {
    isFalling = sorted === column && !isFalling;
    sorted = column;
    const value = column.kind === "str" ? row => text(column, row) : row => column.values[row];
    order.sort((a, b) => {
      const p = value(a), q = value(b);
      if (p === q) return a - b;
      if (p === null || q === null) return p === null ? 1 : -1;
      return (p < q ? -1 : 1) * (isFalling ? -1 : 1);
    });
    page = 0;
    drawRows();
  }

  function cell(line, kind, text, action) {
    const node = document.createElement(kind), inner = action ? document.createElement("button") : node;
    inner.textContent = text;
    if (action) { inner.type = "button"; inner.onclick = action; node.append(inner); }
    line.append(node);
    return node;
  }

  function drawRows() {
    const pages = Math.max(1, Math.ceil(count / PAGE));
    id("cases").replaceChildren(...order.slice(page * PAGE, (page + 1) * PAGE).map(row => {
      const line = document.createElement("tr");
      for (const column of columns) {
        const node = cell(line, "td", text(column, row), column.name === "case" ? () => showProfile(row) : null);
        node.className = column.name === "outcome" && node.textContent !== "done" ? "bad" : column.isNumber ? "number" : "";
      }
      return line;
    }));
    id("where").textContent = say("page", page + 1, pages);
    id("back").disabled = page === 0;
    id("on").disabled = page + 1 >= pages;
  }

  function showProfile(row) {
    id("profile-name").textContent = say("chosen", by.get("case").values[row]);
    id("profile").textContent = varied.reduce((profile, key, i) => {
      const column = by.get(key), value = column.values[row];
      return profile.split(`"@@${i}@@"`).join(column.kind === "str" ? JSON.stringify(column.words[value]) : String(value));
    }, template);
    id("profile-heading").scrollIntoView();
  }

  // ---- start ----

  function offer(select, options, chosen, changed) {
    options.forEach(column => select.append(new Option(column.title, column.name, column === chosen, column === chosen)));
    select.onchange = changed;
  }

  // Values that were spread by ratios are shown so.
  function isSpreadByRatios(column) {
    const values = Float64Array.from(column.values, value => value ?? NaN).sort(), middle = values[count >> 1], low = values[0], high = values[count - 1];
    return count > 4 && low > 0 && high / low > 10 && Math.abs(Math.log(middle / Math.sqrt(low * high))) < Math.abs(Math.log(middle / ((low + high) / 2)));
  }

  id("body").hidden = false;
  const head = document.createElement("tr"), first = (...names) => names.map(name => by.get(name)).find(column => column);
  for (const column of columns) {
    const node = cell(head, "th", column.title, () => sortBy(column));
    node.scope = "col";
    node.title = column.meaning;
  }
  id("head").append(head);
  id("back").onclick = () => { page--; drawRows(); };
  id("on").onclick = () => { page++; drawRows(); };
  id("log").checked = isSpreadByRatios(main);
  const over = plotted.map(name => by.get(name)).map(column => figure("plots", column.name, column.title, svg => scatter(svg, by.get(id("x").value), column, {isLog: id("log").checked})));
  const again = () => over.forEach(redraw);
  offer(id("x"), keys.length ? keys : [main], main, again);
  id("log").onchange = again;
  const trade = figure("trade", "trade", say("front"), drawTrade);
  offer(id("tx"), [...results, ...keys], first("settling_time", "t_f"), () => redraw(trade));
  const peak = bounds.length ? by.get(`peak_${bounds[0].name.slice(19)}`) : undefined;
  offer(id("ty"), [...results, ...keys], peak ?? first("peak_tcp_vibration", "residual_deviation") ?? results.at(-1), () => redraw(trade));
  if (keys.length === 2) {
    id("map-part").hidden = false;
    const map = figure("map", "map", say("map"), drawMap);
    offer(id("value"), results, first("settling_time") ?? results[0], () => redraw(map));
  }
  drawRows();
  new ResizeObserver(() => painters.forEach((_, svg) => redraw(svg))).observe(id("plots"));
})();
