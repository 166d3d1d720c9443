// Circles and corners of a group from how its axes answer, as page.py and contours.py; SI.

const contours = (() => {
  const PLACES = 720, DIRECTIONS = 16, HALVINGS = 9;

  const times = ([a, b], [c, d]) => [a * c - b * d, a * d + b * c];
  const turn = angle => [Math.cos(angle), Math.sin(angle)];

  // The interval of rising values that x lies in, and the share of it; the ends beyond them.
  function between(known, x) {
    if (x <= known[0] || known.length === 1) return [0, 0];
    let low = 0, high = known.length - 1;
    if (x >= known[high]) return [high - 1, 1];
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (known[middle] <= x) low = middle; else high = middle;
    }
    return [low, (x - known[low]) / (known[high] - known[low])];
  }
  const mix = (values, [i, share]) => share ? values[i] + share * (values[i + 1] - values[i]) : values[i];

  function filterAt(item, omega) {
    if (!item) return [1, 0];
    let found = [0, 0];
    item.delays.forEach((delay, k) => {
      const [a, b] = turn(-omega * delay);
      found = [found[0] + item.shares[k] * a, found[1] + item.shares[k] * b];
    });
    for (const time of [item.time, item.second_time]) if (time > 0) {
      const half = 0.5 * omega * time, size = Math.sin(half) / half;
      found = times(found, turn(-half)).map(part => part * size);
    }
    return found;
  }

  // The responses of an axis in each of its corners.
  function answers(model, axis, omega) {
    const at = between(model.logs ??= model.omega.map(Math.log), Math.log(omega));
    const common = times(filterAt(model.filter, omega), turn(-omega * axis.delay));
    return axis.real.map((real, i) => times([mix(real, at), mix(axis.imaginary[i], at)], common));
  }

  // The worst circle of every pair of corners, and the deviation where it is entered.
  function circle(model, radius, feed) {
    const omega = feed / radius, [first, second] = model.axes.map(axis => answers(model, axis, omega));
    let worst = null;
    for (const [a, b] of first) for (const [c, d] of second) {
      const off = radius * (0.5 * Math.hypot(a + c, b + d) - 1), form = radius * Math.hypot(a - c, b - d);
      const largest = Math.abs(off) + 0.5 * form;
      if (!worst || largest > worst.largest) worst = {radius: off, form, largest};
    }
    return {...worst, entry: radius * mix(model.entry, between(model.logs, Math.log(omega)))};
  }

  function throwOff(axis, acceleration) {
    const at = between(axis.reversals.map(one => Math.log(one.acceleration)), Math.log(acceleration));
    return axis.reversals[0].outwards.map((_, i) => mix(axis.reversals.map(one => one.outwards[i]), at));
  }

  // The circle of the nominal machine as a ballbar sees it, counterclockwise.
  function trace(model, radius, feed) {
    const omega = feed / radius, whole = 2 * Math.PI, phases = [];
    for (let i = 0; i < PLACES; i++) phases.push(whole * i / PLACES);
    const parts = model.axes.map((axis, k) => {
      const quarter = k * Math.PI / 2, late = omega * axis.reverses;
      for (const half of [0, 1]) for (const since of axis.since) phases.push((half * Math.PI + quarter + late + omega * since) % whole);
      return {answer: answers(model, axis, omega)[0], quarter, late, known: axis.since, off: axis.reversals.length ? throwOff(axis, feed * feed / radius) : null};
    });
    const points = phases.sort((a, b) => a - b).map(phase => {
      const [x, y] = parts.map(({answer, quarter, late, known, off}) => {
        const position = radius * times(answer, turn(phase - quarter))[0];
        if (!off) return position;
        const halves = Math.floor((phase - quarter - late) / Math.PI), since = (phase - quarter - late - halves * Math.PI) / omega;
        // No longer than it was followed.
        const out = since > known[known.length - 1] ? 0 : mix(off, between(known, since));
        return position + (halves % 2 ? -out : out);
      });
      return {angle: Math.atan2(y, x), off: Math.hypot(x, y) - radius};
    });
    let most = -Infinity, least = Infinity;
    for (const {off} of points) { most = Math.max(most, off); least = Math.min(least, off); }
    const peaks = parts.map(({off}) => off ? Math.max(...off.map(Math.abs)) : null);
    return {points, most, least, circular: most - least, peaks};
  }

  // ---- corners ----

  const NO_ARC = {radius: 0, deviation: 0};
  const arcWithin = (deviation, angle) => { const s = Math.cos(0.5 * angle); return {radius: deviation * s / (1 - s), deviation}; };

  // The tool's path about the corner, entered in a direction, in one pair of corners of the machine,
  // with the corner at one phase of the position cycle.
  function path(model, [phase, i, k], angle, speed, arc, direction) {
    const step = model.step, count = Math.max(Math.ceil(angle * arc.radius / speed / step), 1);
    const begin = -arc.radius * Math.sin(0.5 * angle) / Math.max(Math.cos(0.5 * angle), 1e-9) / speed;
    const start = model.starts[phase], tools = [model.axes[0].turned[phase][i], model.axes[1].turned[phase][k]], lags = [model.axes[0].lag[i], model.axes[1].lag[k]];
    const length = Math.max(...tools.map(tool => tool.length)) + count;
    return tools.map((tool, axis) => {
      const heading = n => Math.cos(direction + angle * Math.min(n / count, 1) - axis * Math.PI / 2), last = tool.length - 1;
      const found = new Float64Array(length), first = heading(0);
      for (let n = 0; n < length; n++) found[n] = first * (begin + step * n - start - lags[axis]);
      for (let m = 0; m < count; m++) {
        const change = heading(m + 1) - heading(m);
        for (let n = m; n < length; n++) found[n] += change * (n - m <= last ? tool[n - m] : tool[last] + step * (n - m - last));
      }
      return found.map(value => speed * value);
    });
  }

  // The distance between a path and the corner at the origin, either way.
  function distance([x, y], direction, angle) {
    const sides = [[direction, -1], [direction + angle, 1]].map(([heading, sign]) => [Math.cos(heading), Math.sin(heading), sign]);
    let far = 0, closest = Infinity;
    for (let n = 0; n < x.length; n++) {
      const out = Math.hypot(x[n], y[n]);
      let near = out;
      for (const [c, s, sign] of sides) if (sign * (c * x[n] + s * y[n]) > 0) near = Math.min(near, Math.abs(s * x[n] - c * y[n]));
      far = Math.max(far, near);
      if (n) {
        const u = x[n] - x[n - 1], v = y[n] - y[n - 1];
        const share = Math.min(Math.max(-(x[n - 1] * u + y[n - 1] * v) / Math.max(u * u + v * v, 1e-300), 0), 1);
        closest = Math.min(closest, Math.hypot(x[n - 1] + share * u, y[n - 1] + share * v));
      }
    }
    return Math.max(far, closest);
  }

  function cornerDeviation(model, angle, speed, arc = NO_ARC) {
    const [first, second] = model.axes.map(axis => axis.lag.length), phases = arc.radius ? 1 : model.starts.length;
    let worst = 0;
    for (let phase = 0; phase < phases; phase++) for (let i = 0; i < first; i++) for (let k = 0; k < second; k++) for (let n = 0; n < DIRECTIONS; n++) {
      const direction = n * Math.PI / DIRECTIONS;
      worst = Math.max(worst, distance(path(model, [phase, i, k], angle, speed, arc, direction), direction, angle));
    }
    return worst;
  }

  // How fast a corner is passed within the tolerance; on the arc that the control puts in, if it does.
  function cornerSpeed(model, angle, feed, isOnArc = model.arc > 0) {
    const off = cornerDeviation(model, angle, feed), tolerance = model.allowed;
    const byForce = (model.largest_step ?? Infinity) / (2 * Math.sin(0.5 * angle));
    if (!isOnArc) return {speed: Math.min(feed, feed * tolerance / off, byForce), arc: NO_ARC, off};
    const arc = arcWithin(model.arc, angle), top = Math.min(feed, Math.sqrt(model.arc_acceleration * arc.radius));
    if (cornerDeviation(model, angle, top, arc) <= tolerance) return {speed: top, arc, off};
    let low = 0, high = top;
    for (let n = 0; n < HALVINGS; n++) {
      const middle = 0.5 * (low + high);
      if (cornerDeviation(model, angle, middle, arc) <= tolerance) low = middle; else high = middle;
    }
    return {speed: low, arc, off};
  }

  return {circle, trace, path, cornerDeviation, cornerSpeed, NO_ARC};
})();

const groupPage = (() => {
  const {model, words, fields} = JSON.parse(document.getElementById("what-if-data").textContent);
  const id = key => document.getElementById(`wi-${key}`);
  const say = (key, values) => Object.entries(values).reduce((text, [name, value]) => text.replaceAll(`{${name}}`, value), words[key]);
  const state = {};
  const {put, listenTo} = makeKnobs({fields, state, id, outOfRange: values => say("out_of_range", values)});
  const micro = value => `${show(1e6 * value)} µm`, perMinute = value => `${show(60 * value)} m/min`;
  const SIDE = 380, NOMINAL = 110, BAND = 56, TURN = 180;
  const FRAME = 12;  // of computing in a frame that lasts 33 ms [ms]
  const REST = 150;  // after the last change arcs in corners are sought, where that takes longer [ms]

  function tell(key, value, limit = "") {
    if (!id(`${key}-value`)) return;
    id(`${key}-value`).textContent = value;
    id(`${key}-limit`).textContent = limit;
  }

  let slow = 0, asked = false, timer = 0;

  function compute(isHasty) {
    const begun = performance.now(), {feed, radius, angle} = state, found = contours.circle(model, radius, feed), trace = contours.trace(model, radius, feed);
    const corner = contours.cornerSpeed(model, angle, feed, model.arc > 0 && !isHasty), path = feed * feed / radius;
    tell("acceleration", `${show(path)} m/s²`, `${show(model.acceleration)} m/s²`);
    tell("largest", micro(found.largest), micro(model.allowed));
    tell("radius", micro(found.radius));
    tell("form", micro(found.form));
    tell("entry", micro(found.entry), micro(model.allowed));
    for (const key of ["most", "least", "circular"]) tell(key, micro(trace[key]));
    trace.peaks.forEach((peak, k) => { if (peak !== null) tell(`peak-${k + 1}`, micro(peak), micro(model.tolerance)); });
    tell("corner", micro(corner.off), micro(model.allowed));
    tell("speed", perMinute(corner.speed));
    sayVerdict(found, path, Math.max(0, ...trace.peaks));
    drawCircle(trace);
    drawCorner(corner);
    if (!isHasty) slow = performance.now() - begun;
  }

  function sayVerdict({largest, entry}, path, peak) {
    const off = Math.max(largest, entry), line = id("verdict");
    const isBeyond = state.feed / state.radius > model.omega[model.omega.length - 1];
    const isFast = path > model.acceleration * (1 + 1e-6), isThrown = peak > model.tolerance, isKept = off <= model.allowed;
    const key = isBeyond ? "beyond" : isFast ? "too_fast" : !isKept ? "misses" : isThrown ? "throws" : "keeps";
    const values = isFast ? {value: `${show(path)} m/s²`, limit: `${show(model.acceleration)} m/s²`} :
      key === "throws" ? {value: micro(peak), limit: micro(model.tolerance)} : {value: micro(off), limit: micro(model.allowed)};
    line.textContent = `${key === "keeps" ? "✓" : "✗"} ${say(key, values)}`;
    line.className = `verdict ${key === "keeps" ? "good" : "bad"}`;
  }

  function roundUp(value) {
    const size = 10 ** Math.floor(Math.log10(value));
    return [1, 2, 5, 10].find(part => part * size >= 0.999 * value) * size;
  }

  const d = points => points.map(([x, y], i) => `${i ? "L" : "M"}${x.toFixed(1)} ${y.toFixed(1)}`).join("");

  function sheetOf(key) {
    const svg = id(key);
    svg.replaceChildren();
    svg.setAttribute("viewBox", `0 0 ${SIDE} ${SIDE + 20}`);
    return svg;
  }

  function drawCircle({points, most, least}) {
    const svg = sheetOf("circle"), middle = SIDE / 2, seen = Math.max(model.tolerance, most, -least);
    const division = roundUp(seen / 3), end = division * Math.ceil(1.05 * seen / division);
    const at = (angle, off) => { const r = Math.max(NOMINAL + BAND / end * off, 0); return [middle + r * Math.cos(angle), middle - r * Math.sin(angle)]; };
    const round = (off, name) => add(svg, "path", {class: name, d: d(Array.from({length: TURN + 1}, (_, i) => at(2 * Math.PI * i / TURN, off)))});
    for (let k = -Math.floor(end / division); k <= end / division; k++) round(k * division, "grid");
    const far = NOMINAL + BAND, [first, second] = model.names;
    add(svg, "path", {class: "grid", d: `M${middle - far} ${middle}H${middle + far}M${middle} ${middle - far}V${middle + far}`});
    round(0, "frame");
    round(model.tolerance, "border");
    round(-model.tolerance, "border");
    add(svg, "path", {class: "curve s4", d: `${d([...points].sort((a, b) => a.angle - b.angle).map(one => at(one.angle, one.off)))}Z`});
    add(svg, "text", {x: middle + far + 4, y: middle + 4}, `+${first}`);
    add(svg, "text", {x: middle, y: middle - far - 5, "text-anchor": "middle"}, `+${second}`);
    add(svg, "text", {x: middle, y: middle - 6, "text-anchor": "middle"}, say("division", {value: micro(division)}));
    add(svg, "text", {x: middle, y: middle + 18, "text-anchor": "middle"}, say("band", {value: micro(model.tolerance)}));
  }

  function drawCorner({speed, arc, off}) {
    const svg = sheetOf("corner"), {feed, angle} = state, room = 2.2 * Math.max(off, model.tolerance), scale = SIDE / 2 / room;
    // Entered from the left, and turned upwards.
    const place = (x, y) => [SIDE / 2 + scale * x, 0.78 * SIDE - scale * y];
    const clip = "wi-clip-corner", box = {x: 0, y: 0, width: SIDE, height: SIDE};
    add(add(svg, "clipPath", {id: clip}), "rect", box);
    const inside = add(svg, "g", {"clip-path": `url(#${clip})`});
    const [mx, my] = place(0, 0), far = 3 * room;
    add(inside, "path", {class: "frame", d: d([place(-far, 0), place(0, 0), place(far * Math.cos(angle), far * Math.sin(angle))])});
    add(inside, "circle", {class: "border", cx: mx, cy: my, r: scale * model.tolerance});
    const draw = (own, rounded, name) => {
      const [x, y] = contours.path(model, [0, 0, 0], angle, own, rounded, 0);
      add(inside, "path", {class: name, d: d([[x[0] - far, y[0]], ...Array.from(x, (value, n) => [value, y[n]])].map(([u, v]) => place(u, v)))});
    };
    draw(speed, arc, "curve s2");
    draw(feed, contours.NO_ARC, "curve s4");
    [["s4", say("unslowed", {value: perMinute(feed), size: micro(off)})], ["s2", say("slowed", {value: perMinute(speed)})]].forEach(([style, text], k) => {
      add(svg, "path", {class: `curve ${style}`, d: `M8 ${SIDE - 4 + 18 * k}h30`});
      add(svg, "text", {x: 44, y: SIDE + 18 * k}, text);
    });
  }

  function changed() {
    clearTimeout(timer);
    if (slow > FRAME) timer = setTimeout(() => compute(false), REST);
    if (asked) return;
    asked = true;
    requestAnimationFrame(() => { asked = false; compute(slow > FRAME); });
  }

  id("body").hidden = false;
  for (const item of fields) { put(item.key, item.value); listenTo(item, changed); }
  compute(false);
  return {model, state, put, frame: () => { const begun = performance.now(); compute(slow > FRAME); return performance.now() - begun; }};
})();
