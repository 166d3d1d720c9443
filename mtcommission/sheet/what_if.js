// What if: sliders and fields, and what the engine makes of them, frame by frame.
// Draws with kit.js.

const whatIf = (() => {
  const host = document.getElementById("what-if");
  if (!host) return null;
  const {model, words, fields, units, checks, filters, known, profile, has_jerk} = JSON.parse(document.getElementById("what-if-data").textContent);
  const id = key => document.getElementById(`wi-${key}`);
  const FRAME = 12;        // of computing in a frame that lasts 33 ms [ms]
  const REST = 180;        // after the last change all corners and sizes are looked at [ms]
  const SIZES = 64, LEAST = 0.01;
  const CELLS = 22;
  const say = (key, values = {}) => Object.entries(values).reduce((text, [name, value]) => text.replaceAll(`{${name}}`, value), words[key]);
  const withUnit = (value, unit) => value === null ? "–" : Number.isFinite(value) ? `${show(value / units[unit].size)} ${units[unit].unit}` : words.not_settled;

  // ---- what is tried ----

  const state = {move: 0, tried: null, payload: 0};
  const {field, put, listenTo} = makeKnobs({fields, state, id, outOfRange: values => say("out_of_range", values)});
  const recommended = known.length - 1;
  let filter = known[recommended].filter;

  function load(number) {
    const {limits, filter: chosen} = known[number];
    put("acceleration", limits.acceleration);
    if (has_jerk) put("jerk", limits.jerk);
    setFilter(chosen, known[number].time);
    changed();
  }

  function setFilter(key, time) {
    filter = key;
    id("filter").value = key;
    if (field.time) {
      put("time", isAverage() && time ? time : state.time);
      id("time").closest(".knob").hidden = !isAverage();
    }
  }

  const isAverage = () => filter === "moving_average";
  const average = time => ({kind: "moving_average", time, second_time: 0, delays: [0], shares: [1]});
  const filterOf = (key, time) => key === "moving_average" ? average(time) : filters[key];
  const triedLimits = () => ({
    acceleration: state.acceleration,
    jerk: has_jerk ? state.jerk : null,
    filter: filterOf(filter, state.time),
  });
  const limitsOf = number => ({...known[number].limits, filter: filterOf(known[number].filter, known[number].time)});
  const move = (number = state.move, size = state.size) => engine.resize(model.moves[number], size);

  // ---- machines: every corner, and the one with the payload and frequency error that are tried ----

  const lifts = new Map();
  function machines(loop = model.loop) {
    const own = state.payload || state.error;
    const place = {payload: state.payload, frequency_factor: 1 + state.error, damping_factor: 1};
    const key = own ? `${place.payload};${place.frequency_factor}` : "";
    let found = lifts.get(loop);
    if (!found) lifts.set(loop, found = {corners: model.corners.map(corner => engine.lift(model, loop, corner)), key: "", own: null});
    if (found.key !== key) Object.assign(found, {key, own: own ? engine.lift(model, loop, place) : null});
    return found.own ? [found.own, ...found.corners] : found.corners;
  }

  function say_place(place) {
    if (!place.state && !place.payload && place.frequency_factor === 1 && place.damping_factor === 1) return words.nominal;
    const parts = place.state ? [place.state] : [];
    if (place.payload) parts.push(withUnit(place.payload, "payload"));
    if (place.frequency_factor !== 1) parts.push(say("frequencies", {factor: show(place.frequency_factor)}));
    if (place.damping_factor !== 1) parts.push(say("damping", {factor: show(place.damping_factor)}));
    return parts.join(", ");
  }

  // ---- a frame: what is tried now; where all corners take too long, the worst ones first ----

  let slow = 0, asked = false, timer = 0, columns = [], worstPlaces = [];

  function changed() {
    stop();
    clearTimeout(timer);
    timer = setTimeout(rest, REST);
    if (asked) return;
    asked = true;
    requestAnimationFrame(() => { asked = false; compute(slow > FRAME); });
  }

  function compute(isHasty) {
    const begun = performance.now(), all = machines();
    let chosen = all;
    if (isHasty) chosen = [all[0], ...worstPlaces.map(i => all[i]).filter(one => one && one !== all[0])].slice(0, 3);
    const tried = engine.evaluate(model, chosen, move(), triedLimits());
    tried.count = chosen.length;
    tried.of = all.length;
    if (!isHasty) {
      slow = performance.now() - begun;
      worstPlaces = [one => one.residual, one => one.settling].map(value => tried.responses.reduce((best, one, i, list) => value(one) > value(list[best]) ? i : best, 0));
    }
    state.tried = tried;
    drawTable();
    drawResponse();
  }

  function compare() {
    columns = known.map((one, number) => engine.evaluate(model, machines(one.loop ?? model.loop), move(), limitsOf(number)));
  }

  let compared = "";
  function rest() {
    const key = `${state.move};${state.size};${state.payload};${state.error}`;
    if (key !== compared) { compare(); compared = key; }
    compute(false);
    sayVerdict();
    writeCommand();
    begin(scanSizes);
    begin(scanLandscape);
    begin(scanCorners);
  }

  // Work for when nothing moves: a generator each, some milliseconds of it in a frame.
  let jobs = [], running = false;
  function begin(job) { jobs.push(job()); if (!running) { running = true; requestAnimationFrame(work); } }
  function stop() { jobs = []; }
  function work() {
    const until = performance.now() + FRAME;
    while (jobs.length && performance.now() < until) if (jobs[0].next().done) jobs.shift();
    running = jobs.length > 0;
    if (running) requestAnimationFrame(work);
  }

  // ---- the table: today, recommended, tried ----

  const ROWS = [
    ["acceleration", (found, limits) => withUnit(limits.acceleration, "acceleration")],
    ["jerk", (found, limits) => withUnit(limits.jerk, "jerk")],
    ["jerk-time", (found, limits) => withUnit(limits.acceleration / limits.jerk, "time")],
    ["filter", (found, limits) => sayFilter(limits.filter)],
    ["duration", found => withUnit(found.setpoint.duration, "time")],
    ["settling", found => withUnit(found.settling, "time")],
    ["residual", found => withUnit(found.residual, "deviation")],
    ["peak", found => withUnit(found.peak, "deviation")],
    ["force", found => withUnit(found.maxForce, "force")],
    ["verdict", found => found.met ? `✓ ${words.met}` : `✗ ${words.not_met}`],
  ];

  function sayFilter(item) {
    if (!item) return words.no_setpoint_filter;
    return item.name ?? `${words.moving_average} ${withUnit(item.time, "time")}`;
  }

  function drawTable() {
    const all = [...columns.map((found, number) => [found, limitsOf(number)]), [state.tried, triedLimits()]];
    for (const [key, tell] of ROWS) all.forEach(([found, limits], k) => {
      const cell = id(`cell-${key}-${k}`);
      if (!cell || !found) return;
      const text = tell(found, limits);
      if (cell.textContent !== text) cell.textContent = text;
      if (key === "verdict") cell.className = `number ${found.met ? "good" : "bad"}`;
    });
    const {tried} = state;
    id("basis").textContent = say(tried.count < tried.of ? "worst_so_far" : "all_corners", {count: tried.count, all: tried.of});
  }

  const sayCheck = ({name, value, limit}) =>
    say("missed_check", {name: checks[name], value: withUnit(value, name), limit: withUnit(limit, name)});

  function sayVerdict() {
    const {tried} = state, line = id("verdict");
    const missed = tried.checks.filter(one => !one.met);
    const text = tried.saturated ? words.saturated : tried.met ? say("all_met", {count: tried.of}) : missed.map(sayCheck).join("; ");
    line.textContent = `${tried.met ? "✓" : "✗"} ${text}`;
    line.className = `verdict ${tried.met ? "good" : "bad"}`;
    const isShorter = has_jerk && state.jerk > 1.000001 * tried.setpoint.jerk;
    id("ramp").textContent = isShorter ? say("ramp", {value: withUnit(state.acceleration / tried.setpoint.jerk, "time")}) : "";
    id("tried-machine").textContent = state.payload || state.error ? say("tried_machine", {place: say_place(machines()[0].place), value: withUnit(tried.saturated ? null : tried.responses[0].residual, "deviation")}) : "";
  }

  function writeCommand() {
    const limits = triedLimits(), parts = [`mtcommission simulate ${profile}`];
    const digits = value => Number(value.toPrecision(10));
    parts.push(`--acceleration ${digits(limits.acceleration)}`, `--jerk ${digits(limits.jerk ?? limits.acceleration / (model.loop.cycles * model.loop.velocity_cycle))}`);
    const typed = isAverage() ? `moving_average:${digits(state.time)}s` : filter === "none" ? "none" : filters[filter].typed;
    if (typed) parts.push(`--filter ${typed}`);
    if (model.moves.length > 1) parts.push(`--move ${state.move + 1}`);
    if (Math.abs(state.size / engine.sizeOf(model.moves[state.move]) - 1) > 1e-6) parts.push(`--size ${digits(state.size)}`);
    if (state.payload) parts.push(`--payload ${digits(state.payload)}`);
    if (state.error) parts.push(`--frequency-error=${digits(state.error)}`);
    const rows = ROWS.slice(has_jerk ? 0 : 3, 4).concat(has_jerk ? [] : [ROWS[0]]).map(([key, tell]) => `${id(`name-${key}`).textContent}: ${tell(state.tried, limits)}`);
    id("command").value = [parts.join(" "), ...rows].join("\n");
  }

  // ---- plots ----

  const inHertz = say("in_unit", {name: words.frequency, unit: "Hz"});
  const inUnit = (name, unit) => say("in_unit", {name, unit: units[unit].unit});

  function curve(inside, x, y, xsize, ysize, response, className) {
    const {deviation, step} = response, every = Math.max(1, Math.floor(deviation.length / 900));
    let d = "";
    for (let i = 0; i < deviation.length; i += every) {
      const t = i * step / xsize;
      if (t > x.high) break;
      d += `${d ? "L" : "M"}${x.at(t).toFixed(1)} ${y.at(deviation[i] / ysize).toFixed(1)}`;
    }
    add(inside, "path", {class: className, d});
  }

  function drawResponse() {
    const {tried} = state, band = model.requirements.tcp_deviation / units.deviation.size;
    const shown = [tried, ...columns].filter(found => found && !found.saturated);
    const end = 1.5 * Math.max(...[tried, ...columns].map(found => found.responses[0].end)) / units.time.size;
    const most = Math.max(1.4 * band, ...shown.map(found => Math.min(found.peak / units.deviation.size, 12 * band)));
    const {x, y, inside} = chart(id("response"), [0, end], [-1.05 * most, 1.05 * most], [inUnit(words.time, "time"), inUnit(words.deviation, "deviation")]);
    for (const sign of [1, -1]) add(inside, "path", {class: "border", d: `M${x.from} ${y.at(sign * band)}H${x.to}`});
    add(inside, "path", {class: "cursor", d: `M${x.at(tried.responses[0].end / units.time.size)} ${y.from}V${y.to}`});
    const draw = (response, style) => curve(inside, x, y, units.time.size, units.deviation.size, response, style);
    if (!tried.saturated) tried.responses.slice(1).forEach(one => draw(one, "curve s4 faint"));
    columns.forEach((found, k) => { if (!found.saturated) draw(found.responses[0], `curve s${k === recommended ? 2 : 1}`); });
    if (!tried.saturated) draw(tried.responses[0], "curve s4 strong");
  }

  // ---- every smaller move ----

  const scanned = {key: "", rows: []};
  function* scanSizes() {
    const key = JSON.stringify([triedLimits(), state.payload, state.error]);
    if (scanned.key !== key) Object.assign(scanned, {key, rows: model.moves.map(() => [])});
    const all = machines(), limits = triedLimits(), every = model.requirements.every_size;
    const order = [state.move, ...model.moves.keys()].filter((one, i, list) => list.indexOf(one) === i);
    for (const number of order) {
      const largest = engine.sizeOf(model.moves[number]), rows = scanned.rows[number];
      const count = every || number === state.move ? SIZES : 1;
      for (let i = rows.length; i < count; i++) {
        const size = largest * LEAST ** (i / (SIZES - 1));
        const found = engine.evaluate(model, all, move(number, size), limits);
        rows.push({size, residual: found.saturated ? null : found.checks[0].value, met: found.met && !found.saturated, checks: found.checks, saturated: found.saturated});
        if (i % 8 === 7 && number === state.move) { drawSizes(); yield; }
        yield;
      }
      if (number === state.move) drawSizes();
    }
    saySizes();
  }

  // A smaller move need not settle within the time that is asked of the listed ones.
  const keeps = row => !row.saturated && row.checks.every(one => one.met || one.of_listed);

  function saySizes() {
    const every = model.requirements.every_size;
    const missed = scanned.rows.flatMap((rows, number) => rows.filter((row, i) => (every || i === 0) && !keeps(row)).map(row => ({...row, number})));
    const count = scanned.rows.reduce((sum, rows) => sum + (every ? rows.length : 1), 0);
    const named = (number, size) => (model.moves.length > 1 ? `${say("move", {number: number + 1})}: ` : "") + sizeText(number, size);
    if (missed.length) {
      const worst = missed.reduce((one, other) => (other.residual ?? Infinity) > (one.residual ?? Infinity) ? other : one);
      id("sizes-verdict").textContent = `✗ ${say("sizes_missed", {missed: missed.length, count, size: named(worst.number, worst.size), value: withUnit(worst.residual, "deviation")})}`;
    } else id("sizes-verdict").textContent = `✓ ${say("sizes_met", {count})}`;
  }

  const sizeUnit = number => model.moves[number].velocity_step === undefined ? "distance" : "velocity";
  const sizeText = (number, size) => withUnit(size, sizeUnit(number));

  function drawSizes() {
    const rows = scanned.rows[state.move] ?? [], unit = units[sizeUnit(state.move)], largest = engine.sizeOf(model.moves[state.move]) / unit.size;
    const size = units.deviation.size, band = model.requirements.tcp_deviation / size;
    const values = rows.filter(row => Number.isFinite(row.residual) && row.residual !== null);
    const most = Math.max(1.3 * band, ...values.map(row => Math.min(row.residual / size, 8 * band)));
    const {svg, x, y, inside} = chart(id("sizes"), [LEAST * largest, 1.05 * largest], [0, 1.05 * most], [inUnit(words.field_size, sizeUnit(state.move)), inUnit(words.residual, "deviation")], {xLog: true});
    add(inside, "path", {class: "border", d: `M${x.from} ${y.at(band)}H${x.to}`});
    const d = values.map((row, i) => `${i ? "L" : "M"}${x.at(row.size / unit.size).toFixed(1)} ${y.at(row.residual / size).toFixed(1)}`).join("");
    add(inside, "path", {class: "curve s4", d});
    const chosen = values.reduce((best, row) => Math.abs(Math.log(row.size / state.size)) < Math.abs(Math.log(best.size / state.size)) ? row : best, values[0]);
    if (chosen) add(inside, "circle", {class: "chosen", cx: x.at(state.size / unit.size), cy: y.at(chosen.residual / size), r: 6});
    svg.pick = (px, py) => { put("size", Math.min(Math.max(x.of(px), LEAST * largest), largest) * unit.size); changed(); };
  }

  // ---- acceleration over jerk time, for the filter, move and machine that are tried ----

  const land = {key: "", cells: []};
  const grid = (low, high, i) => low * (high / low) ** ((i + 0.5) / CELLS);
  const ramps = () => {
    const T = model.loop.cycles * model.loop.velocity_cycle;
    return [T, Math.max(20 * T, 4 * Math.max(...known.map(one => one.limits.acceleration / one.limits.jerk)))];
  };

  function* scanLandscape() {
    const limits = triedLimits(), key = JSON.stringify([limits.filter, state.move, state.size, state.payload, state.error]);
    if (land.key !== key) Object.assign(land, {key, cells: []});
    const all = machines(), [low, high] = ramps(), {low: least, high: most} = field.acceleration;
    for (let n = land.cells.length; n < CELLS * CELLS; n++) {
      const a = grid(least, most, Math.floor(n / CELLS)), ramp = grid(low, high, n % CELLS);
      const found = engine.evaluate(model, all, move(), {...limits, acceleration: a, jerk: a / ramp});
      land.cells.push(found.met ? found.settling : null);
      if (n % CELLS === CELLS - 1 && n + 1 < CELLS * CELLS) drawLandscape();
      yield;
    }
    drawLandscape();
  }

  function drawLandscape() {
    const [low, high] = ramps(), {low: least, high: most} = field.acceleration, a = units.acceleration.size, t = units.time.size;
    const {svg, x, y, inside} = chart(id("landscape"), [low / t, high / t], [least / a, most / a], [inUnit(words.jerk_time, "time"), inUnit(words.acceleration, "acceleration")], {xLog: true, yLog: true});
    const met = land.cells.filter(value => value !== null), fastest = Math.log(Math.min(...met)), slowest = Math.log(Math.max(...met)) + 1e-9;
    const hatch = add(svg, "pattern", {id: "wi-hatch", width: 6, height: 6, patternUnits: "userSpaceOnUse"});
    add(hatch, "path", {class: "hatch", d: "M0 6L6 0"});
    const edge = (from, to, i) => from * (to / from) ** (i / CELLS);
    land.cells.forEach((value, n) => {
      const i = Math.floor(n / CELLS), k = n % CELLS;
      const left = x.at(edge(low, high, k) / t), right = x.at(edge(low, high, k + 1) / t), top = y.at(edge(least, most, i + 1) / a), bottom = y.at(edge(least, most, i) / a);
      const box = {x: left.toFixed(1), y: top.toFixed(1), width: (right - left + 0.3).toFixed(1), height: (bottom - top + 0.3).toFixed(1)};
      if (value === null) add(inside, "rect", {fill: "url(#wi-hatch)", ...box});
      else add(inside, "rect", {class: "cell", "fill-opacity": (0.05 + 0.8 * (Math.log(value) - fastest) / (slowest - fastest)).toFixed(2), ...box});
    });
    const mark = (limits, className, r) => add(inside, "circle", {class: className, r, cx: x.at(Math.max(limits.acceleration / limits.jerk, low) / t), cy: y.at(limits.acceleration / a)});
    known.forEach((one, k) => mark(one.limits, `known k${k === recommended ? 2 : 1}`, 7));
    mark({acceleration: state.acceleration, jerk: state.tried.setpoint.jerk}, "chosen", 5);
    const isWhole = land.cells.length === CELLS * CELLS;
    id("landscape-range").textContent = !isWhole ? words.landscape_running : met.length ? say("landscape_range", {least: withUnit(Math.exp(fastest), "time"), most: withUnit(Math.exp(slowest), "time")}) : words.landscape_none;
    svg.pick = (px, py) => {
      const acceleration = y.of(py) * a, jerk = acceleration / (x.of(px) * t);
      put("acceleration", Math.min(Math.max(acceleration, least), most));
      if (has_jerk) put("jerk", Math.min(Math.max(jerk, field.jerk.low), field.jerk.high));
      changed();
    };
  }

  // ---- Bode plot with a notch ----

  const old = model.force_filters.find(item => item.kind === "notch") ?? null;
  const asNotch = item => ({frequency_hz: item.natural_frequency / (2 * Math.PI), damping: item.damping, width: item.width});
  const oldNotch = old && asNotch(old);
  const scans = new Map();
  function scanOf(corner) {
    if (!scans.has(corner)) {
      const scan = engine.scanOpenLoop(model, model.loop, corner, oldNotch);
      const before = engine.marginsOf(scan, oldNotch);
      scans.set(corner, {scan, before});
    }
    return scans.get(corner);
  }
  const notch = () => ({frequency_hz: state.notch_frequency, width: state.notch_width, damping: state.notch_width * 10 ** (-state.notch_depth / 20)});
  const withNotch = () => state.notch_depth > 0 ? notch() : null;

  const MARGINS = ["gain", "phase", "peak"];
  function sayMargins(found, column) {
    MARGINS.forEach(key => {
      const value = found && found.stable ? found[key] : null;
      const text = found && !found.stable ? words.unstable : value === null ? "–" : Number.isFinite(value) ? `${show(Number(value.toFixed(key === "peak" ? 3 : 1)))}${{gain: " dB", phase: "°", peak: ""}[key]}` : words.unlimited;
      id(`margin-${key}-${column}`).textContent = text;
    });
  }
  const worstOf = list => ({
    stable: list.every(one => one.stable), gain: Math.min(...list.map(one => one.gain)),
    phase: Math.min(...list.map(one => one.phase)), peak: Math.max(...list.map(one => one.peak)),
  });

  function drawBode() {
    if (model.loop.follows) return;  // no loop, nothing to cut
    const {scan, before} = scanOf(model.corners[0]), now = engine.marginsOf(scan, withNotch(), before.turns);
    before.stable = true;
    sayMargins(before, 0);
    sayMargins(now, 1);
    const db = ([a, b]) => 20 * Math.log10(Math.hypot(a, b)), f = now.frequency, low = field.notch_frequency.low / 4, high = f[f.length - 1];
    const {svg, x, y, inside} = chart(id("bode"), [low, high], [-60, 50], [inHertz, words.magnitude], {xLog: true});
    const line = (fs, values, className) => add(inside, "path", {class: className, d: fs.map((one, i) => one < low ? "" : `L${x.at(one).toFixed(1)} ${y.at(values[i]).toFixed(1)}`).join("").replace(/^L/, "M")});
    add(inside, "path", {class: "border", d: `M${x.from} ${y.at(0)}H${x.to}`});
    line(before.frequency, before.L.map(db), "curve s2");
    line(f, now.L.map(db), "curve s4 strong");
    const phase = chart(id("bode-phase"), [low, high], [-360, 0], [inHertz, words.phase], {xLog: true});
    add(phase.inside, "path", {class: "border", d: `M${x.from} ${phase.y.at(-180)}H${x.to}`});
    for (const [found, className] of [[before, "curve s2"], [now, "curve s4 strong"]]) {
      let d = "", last = null;
      found.frequency.forEach((one, i) => {
        if (one < low) return;
        let angle = Math.atan2(found.L[i][1], found.L[i][0]) * 180 / Math.PI;
        if (angle > 0) angle -= 360;
        d += `${last === null || Math.abs(angle - last) > 180 ? "M" : "L"}${x.at(one).toFixed(1)} ${phase.y.at(angle).toFixed(1)}`;
        last = angle;
      });
      add(phase.inside, "path", {class: className, d});
    }
    add(inside, "path", {class: "cursor", d: `M${x.at(state.notch_frequency)} ${y.at(0)}V${y.at(-state.notch_depth)}`});
    add(inside, "circle", {class: "chosen", r: 7, cx: x.at(state.notch_frequency), cy: y.at(-state.notch_depth)});
    svg.pick = (px, py) => {
      const within = (key, value) => put(key, Math.min(Math.max(value, field[key].low), field[key].high));
      within("notch_frequency", x.of(px));
      within("notch_depth", -y.of(py));
      notchChanged();
    };
  }

  let notchAsked = false, notchTimer = 0;
  function notchChanged() {
    clearTimeout(notchTimer);
    notchTimer = setTimeout(() => begin(scanCorners), REST);
    sayMargins(null, 3);
    if (notchAsked) return;
    notchAsked = true;
    requestAnimationFrame(() => { notchAsked = false; drawBode(); });
  }

  function* scanCorners() {
    if (model.loop.follows) return;
    const found = [], item = withNotch();
    for (const corner of model.corners) {
      const {scan, before} = scanOf(corner);
      before.stable = true;
      yield;
      found.push([before, engine.marginsOf(scan, item, before.turns)]);
      yield;
    }
    sayMargins(worstOf(found.map(pair => pair[0])), 2);
    sayMargins(worstOf(found.map(pair => pair[1])), 3);
    const {natural, width, depth} = {natural: state.notch_frequency, width: state.notch_width, depth: notch().damping};
    id("notch-line").textContent = item ? `force_filters = [{ kind = "notch", frequency = "${Number(natural.toPrecision(4))} Hz", damping = ${Number(depth.toPrecision(3))}, width = ${Number(width.toPrecision(3))} }]` : words.no_notch;
  }

  // ---- listening ----

  function listenToPlot(key) {
    const svg = id(key);
    let isDown = false;
    const read = event => {
      const {x, y} = spotOf(svg, event);
      svg.pick?.(x, y);
    };
    svg.addEventListener("pointerdown", event => { isDown = true; if (event.isTrusted) svg.setPointerCapture(event.pointerId); read(event); event.preventDefault(); });
    svg.addEventListener("pointermove", event => { if (isDown) read(event); });
    for (const name of ["pointerup", "pointercancel"]) svg.addEventListener(name, () => { isDown = false; });
  }

  function setMove(number) {
    state.move = number;
    const item = field.size, largest = engine.sizeOf(model.moves[number]), unit = units[sizeUnit(number)];
    Object.assign(item, {low: LEAST * largest, high: largest, least: 1e-4 * largest, most: largest, size: unit.size, unit: unit.unit});
    id("size-unit").textContent = unit.unit;
    put("size", largest);
  }

  function start() {
    id("body").hidden = false;
    fields.forEach(item => { if (item.key !== "size") put(item.key, item.value); });
    setMove(0);
    if (oldNotch) {
      put("notch_frequency", oldNotch.frequency_hz);
      put("notch_width", oldNotch.width);
      put("notch_depth", Math.max(0, -20 * Math.log10(Math.max(oldNotch.damping / oldNotch.width, 1e-3))));
    }
    fields.forEach(item => listenTo(item, item.key.startsWith("notch") ? notchChanged : changed));
    id("filter").addEventListener("change", event => { setFilter(event.target.value); changed(); });
    id("move")?.addEventListener("change", event => { setMove(Number(event.target.value)); changed(); });
    known.forEach((one, number) => id(`load-${number}`).addEventListener("click", () => load(number)));
    ["sizes", "landscape", ...(model.loop.follows ? [] : ["bode"])].forEach(listenToPlot);
    id("take").addEventListener("click", async () => {
      const box = id("command");
      writeCommand();
      box.select();
      try { await navigator.clipboard.writeText(box.value); } catch { document.execCommand("copy"); }
      id("taken").textContent = words.taken;
    });
    setFilter(known[recommended].filter, known[recommended].time);
    compare();
    compared = "";
    compute(false);
    sayVerdict();
    writeCommand();
    drawBode();
    drawSizes();
    drawLandscape();
    timer = setTimeout(rest, REST);
    new ResizeObserver(() => { drawResponse(); drawSizes(); drawLandscape(); drawBode(); }).observe(host);
  }

  start();
  return {model, state, put, changed, compute, setFilter, setMove, triedLimits, evaluate: () => engine.evaluate(model, machines(), move(), triedLimits()), frame: () => { const t = performance.now(); compute(slow > FRAME); return performance.now() - t; }, withNotch, scanOf};
})();
