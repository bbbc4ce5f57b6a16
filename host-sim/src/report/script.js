//<![CDATA[
// Data points under the pointer, and a closer look at a stretch or an event, with its fit
// and residuals. The page is complete without it.
"use strict";
const block = document.getElementById("data");
const space = document.querySelector("svg")?.namespaceURI;
if (block && space) start(JSON.parse(block.textContent));

function start(data) {
  const samples = data.clips.flatMap(([first, from, forces]) => forces.map((force, i) => ({
    n: first + i, t: from + i * data.period, f: force === null ? NaN : force * data.step,
  })));
  samples.forEach((s, i) => {
    const [a, b] = [samples[i - 1], samples[i + 1]];
    s.rate = a && b && b.n - a.n === 2 ? (b.f - a.f) / (2 * data.period) : NaN;
  });
  const events = data.events.map((e) => ({
    index: e[0], from: e[2] - e[1], onset: e[2], stop: e[2] + e[3], to: e[2] + e[3] + e[4], fs: e[5], fp: e[6], fe: e[7],
    pull: e[8], omega: e[9], slack: e[10] === 1, mus: e[11], mu: e[12],
  }));
  const decimals = Math.min(9, Math.max(0, Math.round(-Math.log10(data.step))));
  const force = (f) => `${minus(f.toFixed(decimals))} ${data.unit}`;
  let next = 0;
  for (const s of samples) {
    while (s.t > events[next]?.to) next += 1;
    s.event = s.t >= events[next]?.from ? events[next] : undefined;
    s.residual = s.event ? s.f - model(s.event, s.t) : NaN;
  }

  const told = (s) => {
    const e = s.event;
    const during = e && s.t >= e.onset && s.t <= e.stop ? "slip" : "stick";
    const where = e ? `, ${during} of event ${e.index}, residual ${force(s.residual)}` : "";
    return `sample ${s.n}: t = ${(data.zero + s.t).toFixed(4)} s, F = ${force(s.f)}${where.replace(/, residual NaN.*/, "")}`;
  };

  for (const plot of document.querySelectorAll("svg.plot")) {
    const [x, y] = [plot.dataset.x, plot.dataset.y].map((text) => axis(text, data.zero));
    const kind = plot.id.replace(/-(wide|narrow)$/, "");
    const points = pointsOf(kind, samples, events, x, y, data.unit);
    follow(plot, x, y, (place) => nearest(points, x, y, place, told));
    if (["history", "cycles", "slip"].includes(kind)) {
      drag(plot, x, (from, to) => look(plot.closest("figure"), from, to, "Stretch"));
    }
  }
  for (const row of document.querySelectorAll("tr[data-event]")) {
    const event = events.find((e) => e.index === +row.dataset.event);
    if (!event) continue;
    row.tabIndex = 0;
    const open = () => {
      const beside = Math.max(2.5 * (event.stop - event.onset), 8 * data.period);
      look(row.closest("section").querySelector("p"), event.onset - beside, event.stop + beside, `Event ${event.index}`);
    };
    row.addEventListener("click", open);
    row.addEventListener("keydown", (key) => { if (key.key === "Enter") open(); });
  }

  let shown = null;
  const past = [];
  function look(place, from, to, name, back) {
    if (shown && !back) past.push(shown.view);
    shown?.panel.remove();
    const panel = document.createElement("div");
    panel.className = "look";
    panel.setAttribute("role", "region");
    panel.setAttribute("aria-label", "A closer look");
    place.after(panel);
    const inside = samples.filter((s) => s.t >= from && s.t <= to && Number.isFinite(s.f));
    const head = panel.appendChild(document.createElement("p"));
    const title = head.appendChild(document.createElement("b"));
    const none = inside.length ? "" : "; its samples are not kept in this page: floe replay --samples writes all";
    title.textContent = `${name}: ${(data.zero + from).toFixed(3)} to ${(data.zero + to).toFixed(3)} s, fit and residuals${none}`;
    const button = (text, act) => {
      const made = head.appendChild(document.createElement("button"));
      made.textContent = text;
      made.addEventListener("click", act);
    };
    const before = past.at(-1);
    if (before) button("Back", () => { past.pop(); look(before.place, before.from, before.to, before.name, true); });
    button("Close", () => { panel.remove(); shown = null; past.length = 0; });
    shown = { panel, view: { place, from, to, name } };
    const width = Math.max(320, Math.min(1160, panel.clientWidth - 28));
    draw(panel, width, from, to, inside, (a, b) => look(place, a, b, "Stretch"));
    panel.scrollIntoView({ block: "nearest" });
  }

  function draw(panel, width, from, to, inside, zoomed) {
    const touched = events.filter((e) => e.to >= from && e.from <= to);
    const curves = touched.map((e) => curve(e, Math.max(from, e.from), Math.min(to, e.to)));
    const residuals = inside.filter((s) => Number.isFinite(s.residual)).map((s) => ({ t: s.t, f: s.residual, s }));
    const forces = inside.map((s) => s.f).concat(curves.flat().map((p) => p.f));
    const widest = Math.max(2 * (data.noise ?? 0), ...residuals.map((r) => Math.abs(r.f)), data.step);
    const panels = [
      { height: 280, low: Math.min(...forces), high: Math.max(...forces), label: `force F (${data.unit})`, dots: inside.map((s) => ({ t: s.t, f: s.f, s })), curves },
      { height: 170, low: -widest, high: widest, label: `residual (${data.unit})`, dots: residuals, curves: [[{ t: from, f: 0 }, { t: to, f: 0 }]] },
    ];
    for (const one of panels) {
      if (!Number.isFinite(one.low)) continue;
      const svg = make("svg", { class: "plot closer", viewBox: `0 0 ${width} ${one.height}`, role: "img", "aria-label": one.label }, panel);
      const room = 0.07 * (one.high - one.low || 1);
      const x = { low: from, high: to, from: 58, to: width - 14, name: "t", unit: "s", zero: data.zero };
      const y = { low: one.low - room, high: one.high + room, from: one.height - 40, to: 26, name: "F", unit: data.unit, zero: 0 };
      const clip = `closer-${one.height}`;
      make("rect", { x: x.from, y: y.to, width: x.to - x.from, height: y.from - y.to }, make("clipPath", { id: clip }, svg));
      grid(svg, x, y, one.label);
      const inner = make("g", { "clip-path": `url(#${clip})` }, svg);
      for (const e of touched) {
        const [a, b] = [at(x, e.onset), at(x, e.stop)];
        make("rect", { class: "slip", x: a, width: Math.max(1, b - a), y: y.to, height: y.from - y.to }, inner);
      }
      for (const points of one.curves) make("path", { class: "model", d: line(points, x, y) }, inner);
      const few = one.dots.length <= (x.to - x.from) / 2.5;
      const d = few ? one.dots.map((p) => `M${at(x, p.t).toFixed(1)} ${at(y, p.f).toFixed(1)}h0`).join("") : line(one.dots, x, y);
      make("path", { class: few ? "sample" : "sample-line", d }, inner);
      const points = one.dots.map((p) => ({ x: p.t, y: p.f, s: p.s }));
      follow(svg, x, y, (place) => nearest(points, x, y, place, told));
      drag(svg, x, zoomed);
    }
  }
}

// The model of an event: stick line, ellipse, stick line.
function model(e, t) {
  if (t <= e.onset) return e.fs - e.pull * (e.onset - t);
  if (t > e.stop) return e.slack ? NaN : e.fe + e.pull * (t - e.stop);
  if (e.omega === null) return NaN;
  const [above, beside] = [e.fs - e.fp, e.pull / e.omega];
  const [a, first] = [Math.hypot(above, beside), -Math.atan2(beside, above)];
  const free = Math.acos(Math.max(-1, Math.min(1, -e.fp / a)));
  const turned = (Math.PI - 2 * first) * (t - e.onset) / (e.stop - e.onset);
  const phase = e.slack ? Math.min(first + e.omega * (t - e.onset), free) : first + turned;
  return e.fp + a * Math.cos(phase);
}

function curve(e, from, to) {
  const times = [from, e.onset, e.stop, to];
  for (let i = 1; 48 > i; i += 1) times.push(e.onset + (e.stop - e.onset) * i / 48);
  const within = times.filter((t) => t >= from && t <= to).sort((a, b) => a - b);
  return within.map((t) => ({ t, f: model(e, t) })).filter((p) => Number.isFinite(p.f));
}

// The data points of a figure, those outside its axes left out.
function pointsOf(kind, samples, events, x, y, forceUnit) {
  const size = (unit) => ({ M: 1e6, k: 1e3, m: 1e-3, "\u00b5": 1e-6 }[unit[0]] ?? 1);
  const factor = size(forceUnit) / size(y.unit);
  // What is far outside is drawn at the edge, 8 % of the height inside the frame.
  const edge = y.high / 1.16;
  const places = {
    "convergence-static": (e) => [e.index, e.mus],
    "convergence-dynamic": (e) => [e.index, e.mu],
    pair: (e) => [e.mus, e.mu],
    plane: (s) => [s.f, s.rate * factor],
    residuals: (s) => [s.t - s.event?.onset, Math.max(-edge, Math.min(edge, s.residual))],
  };
  const place = places[kind] ?? ((s) => [s.t, s.f]);
  const ofEvents = kind === "pair" || kind.startsWith("convergence");
  const points = ofEvents ? events.map((e) => ({ e, at: place(e) })) : samples.map((s) => ({ s, at: place(s) }));
  const within = (axis, value) => value !== null && value >= axis.low && axis.high >= value;
  return points.map(({ at: [px, py], ...of }) => ({ x: px, y: py, ...of })).filter((p) => within(x, p.x) && within(y, p.y));
}

// The data point nearest to a place, within a finger's width.
function nearest(points, x, y, place, told) {
  let [best, least] = [null, 24 * 24];
  for (const point of points) {
    const dx = at(x, point.x) - place.x;
    if (dx * dx > least) continue;
    const dy = at(y, point.y) - place.y;
    const far = dx * dx + dy * dy;
    if (least > far) [best, least] = [point, far];
  }
  if (!best) return null;
  const text = best.s ? told(best.s) : `event ${best.e.index}: μs = ${best.e.mus?.toFixed(4) ?? "–"}, μ = ${best.e.mu?.toFixed(4) ?? "–"}`;
  return { x: at(x, best.x), y: at(y, best.y), text };
}

function follow(plot, x, y, find) {
  const box = plot.viewBox.baseVal;
  const note = make("text", { class: "note end", x: box.width - 14, y: 11, "aria-hidden": "true" }, plot);
  const ring = make("circle", { class: "here", r: 5, visibility: "hidden" }, plot);
  plot.addEventListener("pointermove", (event) => {
    const place = inside(plot, event);
    const found = find(place);
    ring.setAttribute("visibility", found ? "visible" : "hidden");
    if (found) {
      ring.setAttribute("cx", found.x);
      ring.setAttribute("cy", found.y);
    }
    const parts = [read(x, place.x), read(y, place.y)];
    note.textContent = found ? fitted(found.text, box.width) : parts.every(Boolean) ? parts.join(", ") : "";
  });
  plot.addEventListener("pointerleave", () => { note.textContent = ""; ring.setAttribute("visibility", "hidden"); });
}

// What a narrow figure has room for.
function fitted(text, width) {
  return text.length * 7 > width - 90 ? text.replace(/, (slip|stick) .*/, "") : text;
}

function drag(plot, x, done) {
  let [from, mark] = [null, null];
  const place = (event) => Math.max(x.from, Math.min(x.to, inside(plot, event).x));
  plot.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    from = place(event);
    plot.setPointerCapture(event.pointerId);
    mark = make("rect", { class: "select", y: 26, height: plot.viewBox.baseVal.height - 66, x: from, width: 0 }, plot);
  });
  plot.addEventListener("pointermove", (event) => {
    if (from === null) return;
    mark.setAttribute("x", Math.min(from, place(event)));
    mark.setAttribute("width", Math.abs(place(event) - from));
  });
  const end = (event) => {
    if (from === null) return;
    const ends = [from, place(event)].sort((a, b) => a - b);
    mark.remove();
    from = null;
    if (event.type === "pointerup" && ends[1] - ends[0] > 6) done(value(x, ends[0]), value(x, ends[1]));
  };
  plot.addEventListener("pointerup", end);
  plot.addEventListener("pointercancel", end);
}

function grid(svg, x, y, label) {
  for (const t of ticks(x, 90)) {
    make("path", { class: "grid-line", d: `M${at(x, t.value)} ${y.from}V${y.to}` }, svg);
    make("text", { class: "mid", x: at(x, t.value), y: y.from + 18 }, svg, t.text);
  }
  for (const t of ticks(y, 38)) {
    make("path", { class: "grid-line", d: `M${x.from} ${at(y, t.value)}H${x.to}` }, svg);
    make("text", { class: "end", x: x.from - 7, y: at(y, t.value) + 4.5 }, svg, t.text);
  }
  make("text", { class: "axis", x: 4, y: 16 }, svg, label);
  make("text", { class: "axis mid", x: (x.from + x.to) / 2, y: y.from + 36 }, svg, x.zero ? `time after ${x.zero} s (s)` : "time (s)");
}

function ticks(axis, apart) {
  const rough = (axis.high - axis.low) * apart / Math.abs(axis.to - axis.from);
  const ten = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((m) => m * ten).find((s) => s >= rough);
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const all = [];
  for (let i = Math.ceil(axis.low / step); axis.high >= i * step; i += 1) {
    all.push({ value: i * step, text: minus((i * step).toFixed(decimals)) });
  }
  return all;
}

// Times are drawn from a zero on, and told in the log's own.
function axis(text, zero) {
  const [low, high, from, to, name, unit] = text.split("|");
  return { low: +low, high: +high, from: +from, to: +to, name, unit, zero: name === "t" ? zero : 0 };
}

function at(axis, value) {
  return axis.from + (value - axis.low) / (axis.high - axis.low) * (axis.to - axis.from);
}

function value(axis, place) {
  return axis.low + (place - axis.from) / (axis.to - axis.from) * (axis.high - axis.low);
}

function read(axis, place) {
  const number = value(axis, place);
  const step = Math.abs((axis.high - axis.low) / (axis.to - axis.from));
  const decimals = Math.min(9, Math.max(0, Math.ceil(-Math.log10(step))));
  const within = number >= axis.low && number <= axis.high;
  return within ? `${axis.name} = ${minus((axis.zero + number).toFixed(decimals))} ${axis.unit}`.trim() : "";
}

function line(points, x, y) {
  return points.map((p, i) => `${i ? "L" : "M"}${at(x, p.t).toFixed(1)} ${at(y, p.f).toFixed(1)}`).join("");
}

function inside(plot, event) {
  return new DOMPoint(event.clientX, event.clientY).matrixTransform(plot.getScreenCTM().inverse());
}

function minus(text) {
  return text.replace("-", +text === 0 ? "" : "\u2212");
}

function make(tag, attributes, parent, text) {
  const element = document.createElementNS(space, tag);
  for (const [name, content] of Object.entries(attributes)) element.setAttribute(name, content);
  if (text !== undefined) element.textContent = text;
  return parent.appendChild(element);
}
//]]>
