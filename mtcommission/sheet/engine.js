"use strict";
// The loop of the record in pure functions, without a page: the same steps as `simulate`.
// SI throughout; matrices are arrays of rows. A "model" is the record's `what_if`.

const engine = (() => {
  const TAYLOR_TERMS = 18;   // of the exponential: converged up to
  const LARGEST_ANGLE = 2;   // pole times step; longer steps are halved, and the result squared
  const INSTANT = 1e-9;      // times closer than this are one instant [s]
  const HORIZON = 10;        // what may still leave the band so long after t_e is not settled [s]
  const DECAYED = 0.1;       // share of band and motion below which the last swings must stay
  const LEAST_SIZE = 1e-4;   // free motion below this share of the band counts as none
  const SIGMAS = 3;          // noise of the force as a standard deviation, as loop/disturbance.py

  // ---- the setpoint: closed form of the seven segments, then the filter's kernel ----

  function rampTimes(velocity, a, j) {
    const ramp = Math.min(a / j, Math.sqrt(velocity / j));
    const hold = Math.max(velocity / (j * ramp) - ramp, 0);
    return [0, ramp, ramp + hold, 2 * ramp + hold];
  }

  function peakVelocity(distance, fastest, a, j) {
    const reached = 0.5 * a * (Math.sqrt((a / j) ** 2 + 4 * distance / a) - a / j);
    const pointed = (0.5 * distance * Math.sqrt(j)) ** (2 / 3);
    return Math.min(reached >= a * a / j ? reached : pointed, fastest);
  }

  // The size of a move is its velocity step or its distance.
  const sizeOf = move => move.velocity_step ?? move.distance;
  const resize = (move, size) =>
    move.velocity_step === undefined ? {...move, distance: size} : {...move, velocity_step: size};

  function slowToFeed(move, feed) {
    if (feed === null) return move;
    if (move.velocity_step !== undefined) return {...move, velocity_step: Math.min(move.velocity_step, feed)};
    return {...move, max_velocity: Math.min(move.max_velocity ?? Infinity, feed)};
  }

  function jerkSteps(move, a, j) {
    if (move.velocity_step !== undefined)
      return {times: rampTimes(move.velocity_step, a, j), steps: [j, -j, -j, j]};
    const velocity = peakVelocity(move.distance, move.max_velocity ?? Infinity, a, j);
    const rise = rampTimes(velocity, a, j);
    const cruise = Math.max(move.distance / velocity - rise[3], 0);
    const fall = rise.map(time => time + rise[3] + cruise);
    return {times: [...rise, ...fall], steps: [j, -j, -j, j, -j, j, j, -j]};
  }

  function planSetpoint(move, limits, positionCycle) {
    const {acceleration, filter} = limits;
    // A control sees its setpoint once in a position cycle: no ramp is shorter.
    const jerk = Math.min(limits.jerk ?? Infinity, acceleration / positionCycle);
    let {times, steps} = jerkSteps(move, acceleration, jerk), order = 3;
    if (filter) {
      const {delays, shares} = filter;
      [times, steps] = [delays.flatMap(delay => times.map(time => time + delay)), shares.flatMap(share => steps.map(step => step * share))];
      for (const length of [filter.time, filter.second_time]) if (length > 0) {
        [times, steps] = [[...times, ...times.map(time => time + length)], [...steps, ...steps.map(step => -step)].map(step => step / length)];
        order += 1;
      }
    }
    const sorted = times.map((time, i) => [time, steps[i]]).sort((one, other) => one[0] - other[0]);
    const knots = Float64Array.from(sorted, pair => pair[0]), width = order + 1;
    const values = new Float64Array(knots.length * width), current = new Float64Array(width);
    sorted.forEach(([, step], i) => {
      if (i) later(current, 0, knots[i] - knots[i - 1], order, width, current);
      current[order] += step;
      values.set(current, i * width);
    });
    // At rest or coasting: rounding must not drift away.
    const last = (knots.length - 1) * width;
    values.fill(0, last + 2);
    values[last] = move.velocity_step === undefined ? move.distance : values[last];
    values[last + 1] = move.velocity_step ?? 0;
    return {move, jerk, acceleration, order, knots, values, duration: knots[knots.length - 1]};
  }

  // The first `wanted` derivatives some time after those at an offset, by Taylor.
  function later(values, offset, dt, order, wanted, result) {
    for (let k = 0; k < wanted; k++) {
      let total = 0;
      for (let higher = order; higher >= k; higher--) total = values[offset + higher] + total * dt / (higher - k + 1);
      result[k] = total;
    }
  }

  // The setpoint's first derivatives at rising times t0, t0 + dt, ...
  function sampleSetpoint(setpoint, t0, dt, count, wanted) {
    const {knots, values, order} = setpoint, width = order + 1, found = new Float64Array(count * wanted), one = new Float64Array(wanted);
    let piece = -1;
    for (let i = 0; i < count; i++) {
      const t = t0 + i * dt;
      while (piece + 1 < knots.length && knots[piece + 1] <= t + INSTANT) piece++;
      if (piece < 0) continue;
      later(values, piece * width, t - knots[piece], order, wanted, one);
      found.set(one, i * wanted);
    }
    return found;
  }

  // ---- the machine and its loop ----

  const product = (A, B) => A.map(row => {
    const sum = new Float64Array(B[0].length);
    row.forEach((value, k) => { if (value) for (let i = 0; i < sum.length; i++) sum[i] += value * B[k][i]; });
    return sum;
  });

  const identity = n => Array.from({length: n}, (_, i) => { const row = new Float64Array(n); row[i] = 1; return row; });

  function vary(plant, place) {
    const A = plant.A.map(row => Float64Array.from(row)), force = A.length - 1;
    const {payload, frequency_factor: s, damping_factor: d} = place;
    if (payload) A[plant.velocity][force] = 1 / (plant.moving_mass + payload);
    for (const {deflection, rate, payload_share} of plant.modes) {
      const loosened = 1 / (1 + payload * payload_share);
      A[rate][deflection] *= s * s * loosened;
      A[rate][rate] *= s * d * loosened;
      A[rate][force] *= loosened;
    }
    return A;
  }

  function discretise(plant, A, step) {
    const B = plant.B, n = A.length, rates = plant.modes.map(({deflection, rate}) => Math.sqrt(Math.abs(A[rate][deflection])));
    const fastest = Math.max(Math.abs(A[n - 1][n - 1]), ...rates);  // the force lag's, and the modes'
    const halvings = Math.max(Math.ceil(Math.log2(fastest * step / LARGEST_ANGLE)), 0);
    step /= 2 ** halvings;
    const joint = [...A.map((row, i) => Float64Array.from([...row, B[i]], value => value * step)), new Float64Array(n + 1)];
    let result = identity(n + 1);
    for (let k = TAYLOR_TERMS; k > 0; k--) {
      result = product(joint.map(row => row.map(value => value / k)), result);
      for (let i = 0; i <= n; i++) result[i][i] += 1;
    }
    for (let k = 0; k < halvings; k++) result = product(result, result);
    return result;
  }

  // The loop's state one velocity cycle later, with the machine as it is at a place.
  function cycleAt(plant, loop, place) {
    const n = plant.A.length, transition = discretise(plant, vary(plant, place), loop.velocity_cycle);
    // A motor that follows: position, velocity and acceleration in the modes are handed down.
    const modal = plant.modes.flatMap(({deflection, rate}) => [deflection, rate]), slaves = [plant.position, plant.velocity, n - 1];
    return loop.cycle.map((row, i) => {
      const own = Float64Array.from(row);
      if (loop.follows) {
        if (!modal.includes(i)) return own;
        for (let k = 0; k < n; k++) own[k] = slaves.includes(k) ? 0 : transition[i][k];
        slaves.forEach((slave, k) => { own[loop.held + k] = transition[i][slave]; });
        own[loop.held + 3] = transition[i][n];
      } else if (i < n) {
        for (let k = 0; k < n; k++) own[k] = transition[i][k];
        own[loop.pending] = transition[i][n];
      }
      return own;
    });
  }

  // Plant and loop at a place: those of the measured state that it names.
  function inState(model, loop, place) {
    const named = state => state.name === place.state;
    const own = place.state ? (loop.in_states ?? model.states).find(named) : null;
    return own ? {plant: own.plant, loop: own.loop} : {plant: model.plant, loop};
  }

  // The loop at the position cycle: state one cycle later, and signals at each velocity cycle.
  function lift(model, around, place) {
    const {plant, loop} = inState(model, around, place), cycle = cycleAt(plant, loop, place), n = cycle.length, N = loop.cycles;
    const over = row => { const own = new Float64Array(n); own.set(row); return own; };
    const force = new Float64Array(n);
    force[loop.pending] = 1;
    let rows = [over(plant.tcp), force, ...plant.signals.map(signal => over(signal.row))];
    const count = rows.length, signals = new Float64Array(N * count * n);
    for (let i = 0; i < N; i++) {
      rows.forEach((row, k) => signals.set(row, (i * count + k) * n));
      rows = product(rows, cycle);
    }
    let power = identity(n);
    for (let i = 0; i < N; i++) power = product(power, cycle);
    loop.by_state.forEach((row, i) => { power[loop.held + i] = Float64Array.from(row); });
    const A = new Float64Array(n * n);
    power.forEach((row, i) => A.set(row, i * n));
    return {A, signals, n, count, loop, place, rows: plant.signals};
  }

  const DELAYED = 2;  // derivatives of the delayed setpoint that signals may be less: position, velocity

  // What the setpoint hands down each position cycle, and the delayed setpoint at each velocity
  // cycle: the same in every corner, and computed as far as it is asked for.
  function driveBy(loop, setpoint) {
    const width = loop.by_setpoint[0].length, kept = width / 4 - 1, held = loop.by_setpoint.length;
    const T = loop.cycles * loop.velocity_cycle, rows = loop.by_setpoint.map(row => Float64Array.from(row));
    let handed = new Float64Array(0), delayed = new Float64Array(0);
    return {
      setpoint,
      until: setpoint.duration + loop.reference_delay,
      reach(cycles) {
        if (handed.length < cycles * held) {
          const count = 2 * cycles, r = sampleSetpoint(setpoint, -kept * T, T, count + kept, 4);
          handed = new Float64Array(count * held);
          for (let k = 0; k < count; k++) for (let h = 0; h < held; h++) {
            let sum = 0;
            for (let back = 0; back <= kept; back++) for (let d = 0; d < 4; d++) sum += rows[h][4 * back + d] * r[4 * (k + kept - back) + d];
            handed[k * held + h] = sum;
          }
          delayed = sampleSetpoint(setpoint, -loop.reference_delay, loop.velocity_cycle, count * loop.cycles, DELAYED);
        }
        return {handed, delayed, held};
      },
    };
  }

  // ---- one move on one machine ----

  function respond(lifted, drive, needs, options = {}) {
    const {A, signals, n, count, loop, rows} = lifted, N = loop.cycles, T_v = loop.velocity_cycle, T = N * T_v, band = needs.tcp_deviation;
    const {until, setpoint} = drive, first = Math.ceil(until / T) + 1, dwell = setpoint.move.dwell ?? 0;
    const window = setpoint.duration + dwell, last = first + Math.ceil(HORIZON / T);
    const block = Math.max(Math.ceil(options.swing / T), 4), follow = options.peakOnly ? first : Infinity;
    const begin = Math.ceil((until - 1e-12) / T_v);
    let X = new Float64Array(n), next = new Float64Array(n), e = [], stop = first, k = 0;
    let maxForce = 0, peak = 0, sum = 0, square = 0, outside = -1, residual = 0, swing = 0, decayed = false;
    const peaks = new Float64Array(count - 2);
    while (true) {
      const {handed, delayed, held} = drive.reach(stop);
      for (; k < stop; k++) {
        for (let i = 0; i < N; i++) {
          const at = k * N + i, from = i * count * n;
          let tool = 0, force = 0;
          for (let c = 0; c < n; c++) { tool += signals[from + c] * X[c]; force += signals[from + n + c] * X[c]; }
          const deviation = tool - delayed[at * DELAYED], size = Math.abs(deviation);
          e[at] = deviation;
          if (size > peak) peak = size;
          if (Math.abs(force) > maxForce) maxForce = Math.abs(force);
          if (at >= begin) {
            if (size > residual) residual = size;
            if (size > swing) swing = size;
            if (size > band) outside = at;
          }
          for (let s = 2; s < count; s++) {
            const {less, is_after} = rows[s - 2];
            let value = less === null ? 0 : -delayed[at * DELAYED + less];
            for (let c = 0, row = from + s * n; c < n; c++) value += signals[row + c] * X[c];
            if ((at >= begin || !is_after) && Math.abs(value) > peaks[s - 2]) peaks[s - 2] = Math.abs(value);
            if (s === 2) {
              const share = T_v * Math.min(Math.max((window - at * T_v) / T_v + 0.5, 0), 1);
              sum += share * value;
              square += share * value * value;
            }
          }
        }
        for (let r = 0; r < n; r++) {
          let value = 0;
          for (let c = 0, row = r * n; c < n; c++) value += A[row + c] * X[c];
          next[r] = value;
        }
        for (let h = 0; h < held; h++) next[loop.held + h] += handed[k * held + h];
        [X, next] = [next, X];
      }
      if (k >= follow) { decayed = true; break; }
      if (k > first) {
        const size = Math.min(band, Math.max(residual, LEAST_SIZE * band));
        decayed = swing <= DECAYED * size;
        if (decayed) break;
        if (k >= last) { decayed = swing <= size; break; }
      }
      swing = 0;
      stop = k + block;
    }
    // Judged from t_e + tau on, between two samples: there the setpoint rests or coasts.
    const speed = setpoint.move.velocity_step ?? 0, here = (begin - 1) * T_v;
    const rest = setpoint.values[setpoint.values.length - setpoint.order - 1];
    const tool = e[begin - 1] + at(drive, loop, begin - 1), before = tool - rest - speed * (here - until);
    const atEnd = Math.abs(before + (until - here) / T_v * (e[begin] - before));
    let settling = until;
    if (outside >= 0) {
      const one = Math.abs(e[outside]), other = Math.abs(e[outside + 1]);
      settling = outside * T_v + T_v * (one - band) / (one - other);
    } else if (atEnd > band) {
      settling = until + (begin * T_v - until) * (atEnd - band) / (atEnd - Math.abs(e[begin]));
    }
    const load = Math.abs(needs.static_load);
    return {
      saturated: maxForce > needs.motion_force,
      settled: decayed,
      end: until,
      settling: decayed ? settling : Infinity,
      residual: decayed ? Math.max(residual, atEnd) : Infinity,
      peak, maxForce,
      rms: Math.sqrt(square / window + load * load + 2 * load * Math.abs(sum / window)),
      peaks, deviation: e, step: T_v,
    };
  }

  const at = (drive, loop, sample) => drive.reach(Math.ceil((sample + 1) / loop.cycles)).delayed[sample * DELAYED];

  // ---- limits in all corners, judged ----

  // The longest swing of the machine: free motion is watched for as long before it counts as gone.
  function longestSwing(plant) {
    const slowest = Math.min(...plant.modes.map(({deflection, rate}) => Math.sqrt(-plant.A[rate][deflection])));
    return Math.min(Math.max(2 * 2 * Math.PI / slowest, 0.02), 1);
  }

  function evaluate(model, lifted, move, limits) {
    const {requirements: needs} = model, {loop} = lifted[0], swing = longestSwing(model.plant);
    const T = loop.cycles * loop.velocity_cycle, setpoint = planSetpoint(move, limits, T), drive = driveBy(loop, setpoint);
    const slower = slowToFeed(move, needs.contour_feed);
    const differs = sizeOf(slower) !== sizeOf(move) || slower.max_velocity !== move.max_velocity;
    const path = differs ? driveBy(loop, planSetpoint(slower, limits, T)) : null;
    const responses = lifted.map(one => {
      const found = respond(one, drive, needs, {swing});
      found.contour = path ? respond(one, path, needs, {swing, peakOnly: true}).peak : found.peak;
      found.place = one.place;
      return found;
    });
    return {setpoint, responses, ...judge(model, responses)};
  }

  // What a check of this name bounds; that of any other is the signal of the same name.
  const VALUES = {
    "residual deviation": (one, noise) => one.residual + noise.tool,
    "settling time": one => one.settling,
    "contour deviation": (one, noise) => one.contour + noise.tool,
    "set force": (one, noise) => one.maxForce + noise.force,
    "RMS force": (one, noise) => Math.hypot(one.rms, noise.force / SIGMAS),
  };

  function judge(model, responses) {
    const {requirements: needs, plant} = model;
    const noise = model.corners.reduce((most, corner) => ({tool: Math.max(most.tool, corner.tool_noise), force: Math.max(most.force, corner.force_noise)}), {tool: 0, force: 0});
    const worst = value => Math.max(...responses.map(value));
    const of = found => ({tool: found.place.tool_noise ?? noise.tool, force: found.place.force_noise ?? noise.force});
    const checks = needs.checks.map(({name, limit, of_listed}) => {
      const signal = plant.signals.findIndex(one => one.name === name);
      const value = worst(one => VALUES[name]?.(one, of(one)) ?? one.peaks[signal]);
      return {name, value, limit, of_listed, met: value <= limit};
    });
    const saturated = responses.some(one => one.saturated);
    return {
      checks, saturated,
      met: checks.every(one => one.met) && !saturated,
      // Where the force does not suffice, the linear motion is not the machine's.
      residual: saturated ? null : worst(one => one.residual),
      settling: saturated ? null : worst(one => one.settling),
      peak: saturated ? null : worst(one => one.peak),
      maxForce: worst(one => one.maxForce),
    };
  }

  // ---- over frequency ----

  // Response of b(s)/a(s) behind the bilinear transform at the velocity cycle.
  function notchAt(frequency, {frequency_hz, damping, width}, T_v) {
    const s = 2 / T_v * Math.tan(Math.PI * frequency * T_v), omega = 2 * Math.PI * frequency_hz, real = omega * omega - s * s;
    return divide([real, 2 * damping * omega * s], [real, 2 * width * omega * s]);
  }

  const times = ([a, b], [c, d]) => [a * c - b * d, a * d + b * c];
  const divide = ([a, b], [c, d]) => { const size = c * c + d * d; return [(a * c + b * d) / size, (b * c - a * d) / size]; };

  // The loop cut at F_set, as a function of the frequency [Hz]: exact at the velocity cycle, the
  // position loop in its base band.
  function openLoop(model, around, place) {
    const {plant, loop} = inState(model, around, place), cycle = cycleAt(plant, loop, place), {pending, held, by_state} = loop, N = loop.cycles;
    const own = cycle.map((_, i) => i).filter(i => i !== pending && i < held), n = own.length;
    const demand = cycle[pending], b = own.map(i => cycle[i][pending]);
    const fed = own.map(i => own.map(k => by_state.reduce((sum, row, h) => sum + cycle[i][held + h] * row[k], 0)));
    const seen = own.map(k => by_state.reduce((sum, row, h) => sum + demand[held + h] * row[k], 0));
    const re = new Float64Array(n * (n + 1)), im = new Float64Array(n * (n + 1));
    return frequency => {
      const turn = 2 * Math.PI * frequency * loop.velocity_cycle, z = [Math.cos(turn), Math.sin(turn)];
      let H = [0, 0];
      for (let i = 0; i < N; i++) { H[0] += Math.cos(-(N + i) * turn) / N; H[1] += Math.sin(-(N + i) * turn) / N; }
      const w = n + 1;
      for (let i = 0; i < n; i++) {
        for (let k = 0; k < n; k++) {
          re[i * w + k] = (i === k ? z[0] : 0) - cycle[own[i]][own[k]] - H[0] * fed[i][k];
          im[i * w + k] = (i === k ? z[1] : 0) - H[1] * fed[i][k];
        }
        re[i * w + n] = b[i]; im[i * w + n] = 0;
      }
      solve(re, im, n);
      let sum = [demand[pending], 0];
      for (let i = 0; i < n; i++) {
        const weight = [demand[own[i]] + H[0] * seen[i], H[1] * seen[i]], part = times(weight, [re[i * w + n], im[i * w + n]]);
        sum[0] += part[0]; sum[1] += part[1];
      }
      const [x, y] = divide(sum, z);
      return [-x, -y];
    };
  }

  // Gauss with pivots, in place; the solution stands in the last column.
  function solve(re, im, n) {
    const w = n + 1;
    for (let p = 0; p < n; p++) {
      let best = p, most = -1;
      for (let i = p; i < n; i++) { const size = re[i * w + p] ** 2 + im[i * w + p] ** 2; if (size > most) { most = size; best = i; } }
      if (best !== p) for (let k = p; k < w; k++) {
        const a = p * w + k, c = best * w + k;
        [re[a], re[c]] = [re[c], re[a]]; [im[a], im[c]] = [im[c], im[a]];
      }
      const pr = re[p * w + p] / most, pi = -im[p * w + p] / most;
      for (let k = p; k < w; k++) {
        const a = p * w + k, x = re[a] * pr - im[a] * pi;
        im[a] = re[a] * pi + im[a] * pr; re[a] = x;
      }
      for (let i = 0; i < n; i++) if (i !== p) {
        const fr = re[i * w + p], fi = im[i * w + p];
        if (fr || fi) for (let k = p; k < w; k++) {
          const a = i * w + k, c = p * w + k;
          re[a] -= fr * re[c] - fi * im[c]; im[a] -= fr * im[c] + fi * re[c];
        }
      }
    }
  }

  const POINTS = 400, CLUSTER = 40;

  // Frequencies up to Nyquist, with a cluster of each mode's half-width.
  function gridOf(plant, T_v, place) {
    const nyquist = 0.5 / T_v, found = [], A = vary(plant, place);
    for (let i = 0; i < POINTS; i++) found.push(0.1 * (0.999 * nyquist / 0.1) ** (i / (POINTS - 1)));
    for (const {deflection, rate} of plant.modes) {
      const omega = Math.sqrt(-A[rate][deflection]), width = Math.max(-A[rate][rate] / (2 * omega), 1e-3);
      for (let i = 0; i < CLUSTER; i++) found.push(omega / (2 * Math.PI) * (1 + width * (8 * i / (CLUSTER - 1) - 4)));
    }
    return Float64Array.from(found.filter(f => f > 0 && f < nyquist).sort((a, b) => a - b));
  }

  // The open loop without the notch that is moved, to be multiplied by it.
  function scanOpenLoop(model, around, place, old) {
    const {plant, loop} = inState(model, around, place);
    const exact = openLoop(model, around, place), frequency = gridOf(plant, loop.velocity_cycle, place);
    const at = f => old ? divide(exact(f), notchAt(f, old, loop.velocity_cycle)) : exact(f);
    return {frequency, at, values: Array.from(frequency, at), T_v: loop.velocity_cycle, turns: null};
  }

  // How often 1 + L turns about the origin: it stays while the loop stays stable.
  const turnsOf = values => values.reduce((sum, [x, y], i) => {
    if (!i) return 0;
    const [c, d] = divide([1 + x, y], [1 + values[i - 1][0], values[i - 1][1]]);
    return sum + Math.atan2(d, c) / (2 * Math.PI);
  }, 0);

  // Margins with a notch; `stable` is how many turns the loop of the record makes.
  function marginsOf(scan, notch, stable) {
    const shaped = (f, value) => notch ? times(value, notchAt(f, notch, scan.T_v)) : value;
    let frequency = [...scan.frequency], L = scan.values.map((value, i) => shaped(frequency[i], value));
    if (notch) {
      // A narrow notch turns L between two points of the grid.
      const extra = [];
      for (let i = -12; i <= 12; i++) extra.push(notch.frequency_hz * (1 + i / 6 * Math.max(notch.width, 0.005)));
      [frequency, L] = merge(frequency, L, extra.filter(f => f > 0.1 && f < 0.499 / scan.T_v), f => shaped(f, scan.at(f)));
    }
    const turns = turnsOf(L);
    for (let round = 0; round < 2; round++) {
      const extra = [], size = L.map(([x, y]) => Math.hypot(x, y)), back = L.map(([x, y]) => Math.hypot(1 + x, y));
      const nearest = back.indexOf(Math.min(...back));
      for (let i = 0; i + 1 < L.length; i++) {
        const crosses = (size[i] - 1) * (size[i + 1] - 1) < 0 || L[i][1] * L[i + 1][1] < 0 && Math.min(L[i][0], L[i + 1][0]) < 0;
        if (crosses || i === nearest || i + 1 === nearest) for (let k = 1; k < 6; k++) extra.push(frequency[i] + k / 6 * (frequency[i + 1] - frequency[i]));
      }
      [frequency, L] = merge(frequency, L, extra, f => shaped(f, scan.at(f)));
    }
    let up = Infinity, down = Infinity, phase = Infinity, peak = 0;
    for (let i = 0; i < L.length; i++) {
      const [x, y] = L[i];
      peak = Math.max(peak, 1 / Math.hypot(1 + x, y));
      if (i + 1 === L.length) break;
      const [u, v] = L[i + 1];
      if (y * v < 0) {
        const real = x + y / (y - v) * (u - x);
        if (real < 0) { const level = -20 * Math.log10(-real); if (level >= 0) up = Math.min(up, level); else down = Math.min(down, -level); }
      }
      const one = Math.log(Math.hypot(x, y)), other = Math.log(Math.hypot(u, v));
      if (one * other < 0) {
        const [c, d] = divide(L[i + 1], L[i]), angle = Math.atan2(-y, -x) + one / (one - other) * Math.atan2(d, c);
        phase = Math.min(phase, Math.abs(angle) * 180 / Math.PI);
      }
    }
    return {frequency, L, turns, stable: stable === undefined || Math.abs(turns - stable) < 0.5, gainUp: up, gainDown: down, gain: Math.min(up, down), phase, peak};
  }

  function merge(frequency, L, extra, at) {
    const all = [...frequency.map((f, i) => [f, L[i]]), ...extra.map(f => [f, at(f)])].sort((a, b) => a[0] - b[0]);
    return [all.map(pair => pair[0]), all.map(pair => pair[1])];
  }

  return {planSetpoint, sampleSetpoint, lift, evaluate, judge, resize, sizeOf, openLoop, scanOpenLoop, marginsOf, notchAt};
})();
