"use strict";
// rows of a block of CSV as objects; texts may stand in quotes
function rows(id) {
  const block = document.getElementById(id);
  if (!block) return [];
  const lines = [], source = block.textContent.trim();
  let cell = "", line = [], quoted = false;
  for (let i = 0; i <= source.length; i++) {
    const c = i < source.length ? source[i] : "\n";
    if (quoted) {
      if (c !== '"') cell += c;
      else if (source[i + 1] === '"') { cell += c; i++; }
      else quoted = false;
    } else if (c === '"') quoted = true;
    else if (c === "," || c === "\n") {
      line.push(cell); cell = "";
      if (c === "\n") { lines.push(line); line = []; }
    } else cell += c;
  }
  const [names, ...rest] = lines;
  return rest.map(cells => Object.fromEntries(names.map((name, i) => [name, cells[i]])));
}
function element(parent, name, attributes, text) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const key in attributes) made.setAttribute(key, attributes[key]);
  if (text !== undefined) made.textContent = text;
  parent.appendChild(made);
  return made;
}
const number = cell => cell === "" || cell === undefined ? NaN : Number(cell);
const minus = text => text.replaceAll("-", "−");
const format = value => minus(Number(Number(value).toPrecision(4)).toString());
// a mark of the pictures
function mark(svg, one, x, y) {
  return element(svg, "path", { d: one.path, transform: `translate(${x.toFixed(1)} ${y.toFixed(1)})`, class: one.look, "stroke-width": 1.4, "data-type": one.type });
}
// an empty frame with its axes over the ends [x0, x1, y0, y1]; returns the two maps to the screen
function axes(svg, width, height, ends, names, logarithmic) {
  svg.replaceChildren();
  const left = 64, right = 12, top = 22, bottom = 34;
  const scale = value => logarithmic ? Math.log10(value) : value;
  const [x0, x1, y0, y1] = ends;
  const x = value => left + (scale(value) - x0) / (x1 - x0) * (width - left - right);
  const y = value => height - bottom - (value - y0) / (y1 - y0) * (height - top - bottom);
  element(svg, "rect", { x: left, y: top, width: width - left - right, height: height - top - bottom, class: "rule" });
  const ticks = (low, high, most) => {
    const raw = (high - low) / most, power = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].map(m => m * power).find(s => s >= raw), list = [];
    for (let i = Math.ceil(low / step); i * step <= high; i++) list.push(i * step);
    return list;
  };
  // powers of ten, with 2 and 5 times them where there are few
  const decades = () => {
    const list = [], digits = x1 - x0 < 2.5 ? [1, 2, 5] : [1], every = Math.max(1, Math.ceil((x1 - x0) / 7));
    for (let p = Math.floor(x0); p <= Math.ceil(x1); p++) {
      if (p % every === 0) for (const d of digits) list.push(d * 10 ** p);
    }
    const within = list.filter(v => Math.log10(v) >= x0 && Math.log10(v) <= x1);
    return within.length > 1 ? within : ticks(10 ** x0, 10 ** x1, 5);
  };
  for (const value of logarithmic ? decades() : ticks(x0, x1, width / 90)) {
    element(svg, "line", { x1: x(value), x2: x(value), y1: height - bottom, y2: height - bottom + 4, class: "rule" });
    element(svg, "text", { x: x(value), y: height - bottom + 16, "text-anchor": "middle" }, format(value));
  }
  // as many figures as tell the ticks apart
  const list = ticks(y0, y1, height / 45), finest = list.length > 1 ? list[1] - list[0] : 1;
  const decimals = Math.min(12, Math.max(0, -Math.floor(Math.log10(finest))));
  const largest = Math.max(Math.abs(y0), Math.abs(y1));
  const figure = value => minus(largest >= 1e5 || largest < 1e-4 ? value.toExponential(2) : value.toFixed(decimals));
  for (const value of list) {
    element(svg, "line", { x1: left - 4, x2: left, y1: y(value), y2: y(value), class: "rule" });
    element(svg, "text", { x: left - 7, y: y(value) + 4, "text-anchor": "end" }, figure(value));
  }
  element(svg, "text", { x: (left + width - right) / 2, y: height - 4, "text-anchor": "middle" }, names[0]);
  element(svg, "text", { x: left, y: top - 8 }, names[1]);
  const clip = svg.id + "-frame", shape = element(element(svg, "clipPath", { id: clip }), "rect", { x: left, y: top, width: width - left - right, height: height - top - bottom });
  return [x, y, element(svg, "g", { "clip-path": `url(#${clip})` }), shape];
}
// the ends of an axis over values, with room on either side
function span(list, scale = value => value) {
  let low = Infinity, high = -Infinity;
  for (const value of list) {
    const at = scale(value);
    if (Number.isFinite(at)) { low = Math.min(low, at); high = Math.max(high, at); }
  }
  if (!(low <= high)) { low = 0; high = 1; }
  const pad = 0.04 * (high - low) || Math.abs(high) * 1e-3 || 1;
  return [low - pad, high + pad];
}
function line(svg, points, attributes) {
  const text = points.map(([a, b]) => a.toFixed(1) + "," + b.toFixed(1)).join(" ");
  return element(svg, "polyline", Object.assign({ points: text, class: "ink", "stroke-width": 1.6 }, attributes));
}
const DASHES = { solid: ["none", "stable"], dashed: ["7 4", "unstable"], dotted: ["1.5 3", "stability undecided or not asked for"] };
// a select over columns, in front of a picture
function choice(parent, words, columns, chosen, changed) {
  const label = document.createElement("label"), select = document.createElement("select");
  for (const column of columns) select.add(new Option(column, column, false, column === chosen));
  select.addEventListener("change", changed);
  label.append(words + " ", select);
  parent.appendChild(label);
  return () => select.value;
}
// one picture beside the diagram: a function that shows the point of a label
function picture(parent, given, noun, zones, profiles) {
  const holder = document.createElement("div"), controls = document.createElement("div"), names = given.choices ? given.choices.split(" ") : [];
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg"), height = Number(given.height);
  controls.className = "controls";
  svg.id = given.name;
  svg.setAttribute("viewBox", `0 0 420 ${height}`);
  svg.setAttribute("role", "img");
  let last = null, known = [];
  const again = () => { if (last !== null) show(last, known); };
  const across = names.length > 1 && given.shows === "phase" ? choice(controls, "across", names, given.x, again) : () => given.x;
  const up = names.length > 1 ? choice(controls, given.shows === "phase" ? "up" : "over time", names, given.y, again) : () => given.y;
  if (controls.firstChild) holder.appendChild(controls);
  holder.appendChild(svg);
  parent.appendChild(holder);
  const lack = words => element(svg, "text", { x: 210, y: height / 2, "text-anchor": "middle" }, words);
  // stretches of a profile within one zone; at a switch there are two samples at one place
  const stretches = profile => {
    const all = [];
    for (const sample of profile) {
      const previous = all[all.length - 1];
      if (previous && previous.zone === sample.zone) previous.samples.push(sample);
      else all.push({ zone: sample.zone, samples: [sample] });
    }
    return all;
  };
  const along = label => {
    const profile = profiles(label), columns = up().split(" "), x = across();
    const values = column => profile.map(sample => sample[column]);
    const ups = columns.flatMap(values), ends = [...(given.shows === "phase" ? span(values(x)) : [values(x)[0], values(x)[profile.length - 1]]), ...span(ups)];
    const words = [given.across || x, given.up || up()];
    const [px, py, field] = axes(svg, 420, height, profile.length ? ends : [0, 1, 0, 1], words, false);
    const list = stretches(profile), named = zone => zones[zone] === undefined ? "unknown" : zones[zone];
    const told = list.map(one => `${named(one.zone)} to ${format(one.samples[one.samples.length - 1][x])}`).join(", ");
    const [low, high] = [Math.min(...ups), Math.max(...ups)].map(format);
    svg.setAttribute("aria-label", profile.length ? `${words[1]} of the ${noun} of label ${label} over ${words[0]}, from ${low} to ${high}` + (given.shows === "phase" ? "" : `; zones: ${told}`) : `no profile of this ${noun}`);
    if (!profile.length) { lack("no profile at this label"); return; }
    if (given.shows === "along") list.forEach((one, i) => {
      const from = i ? list[i - 1].samples[list[i - 1].samples.length - 1][x] : one.samples[0][x], to = one.samples[one.samples.length - 1][x];
      const area = element(field, "rect", { x: px(from), y: 0, width: Math.max(px(to) - px(from), 0) + .3, height, class: "zone-" + one.zone });
      element(area, "title", {}, named(one.zone));
    });
    for (const column of columns) {
      let before = null;
      for (const one of list) {
        // a state that jumps at a switch, or between samples of one mode at one time
        let part = [];
        const flush = () => {
          if (part.length > 1) line(field, part, given.shows === "phase" ? { class: "line-" + one.zone } : columns.length > 1 && column === columns[0] ? { style: "stroke: var(--blue)" } : {});
          part = [];
        };
        for (const sample of one.samples) {
          const here = [px(sample[x]), py(sample[column])], place = Object.values(sample)[0];
          if (before && before.place === place) {
            flush();
            if (Math.hypot(here[0] - before.at[0], here[1] - before.at[1]) > 1) line(field, [before.at, here], { class: "rule", "stroke-dasharray": "2 3", "stroke-width": 1.2 });
          } else if (before && !part.length) part.push(before.at);
          part.push(here);
          before = { place, at: here };
        }
        flush();
      }
      // what begins and ends with a jump is closed
      const ends = [0, profile.length - 1].map(i => [px(profile[i][x]), py(profile[i][column])]);
      if (given.shows === "phase" && Math.hypot(ends[0][0] - ends[1][0], ends[0][1] - ends[1][1]) > 1) line(field, ends, { class: "rule", "stroke-dasharray": "2 3", "stroke-width": 1.2 });
    }
  };
  // values in the complex plane: what grows is filled
  const plane = (label, values) => {
    const circle = given.shows === "circle", size = v => circle ? Math.hypot(v.re, v.im) : v.re;
    const growing = v => size(v) - v.error > (circle ? 1 : 0), count = values.filter(growing).length;
    const names = circle ? "multiplier" : "eigenvalue", plural = (n, word) => n + " " + word + (n === 1 ? "" : "s");
    const word = circle ? "|μ| > 1" : "Re λ > 0";
    let ends, far = [];
    if (circle) {
      const half = Math.min(3, 1.15 * Math.max(1, ...values.map(size))), wide = half * (420 - 76) / (height - 56);
      ends = [-wide, wide, -half, half];
      far = values.filter(v => Math.abs(v.re) > wide || Math.abs(v.im) > half);
    } else ends = [...span(values.map(v => v.re).concat(0)), ...span(values.map(v => v.im))];
    const [ex, ey, field] = axes(svg, 420, height, ends, [given.across, given.up], false);
    svg.setAttribute("aria-label", values.length ? `${plural(values.length, names)} of the ${noun} of label ${label}, ${count} with ${word}` : `no ${names} at this label`);
    if (!values.length) { lack(`no ${names}s at this label`); return; }
    if (circle) {
      element(field, "circle", { cx: ex(0), cy: ey(0), r: ex(1) - ex(0), class: "ink", "stroke-width": 1.2 });
      line(field, [[ex(0), 0], [ex(0), height]], { class: "rule" });
    } else line(field, [[ex(0), 0], [ex(0), height]], { class: "ink", "stroke-width": 1.2 });
    line(field, [[0, ey(0)], [420, ey(0)]], { class: "rule" });
    for (const v of values) {
      // those far out stand at the edge, in their direction
      const part = circle ? Math.min(1, .96 * ends[1] / Math.abs(v.re), .96 * ends[3] / Math.abs(v.im)) : 1, grows = growing(v);
      const dot = element(field, "circle", { cx: ex(v.re * part), cy: ey(v.im * part), r: 3.6, fill: grows ? "var(--mark)" : "var(--paper)", stroke: grows ? "var(--mark)" : "var(--blue)", "stroke-width": 1.6 });
      element(dot, "title", {}, `${format(v.re)} ${v.im < 0 ? "−" : "+"} ${format(Math.abs(v.im))} i`);
    }
    if (far.length) element(svg, "text", { x: 404, y: 14, "text-anchor": "end" }, `${far.length} at the edge: |μ| to ${format(Math.max(...far.map(size)))}`);
  };
  const show = (label, values) => {
    [last, known] = [label, values];
    if (["along", "phase"].includes(given.shows)) along(label); else plane(label, values);
  };
  return show;
}
const points = rows("points").map(row => ({ row, x: NaN, y: NaN }));
rows("looks").forEach((look, i) => Object.assign(points[i], look));
if (points.length) {
  const explorer = document.getElementById("explorer"), diagram = document.getElementById("diagram");
  const named = rows("columns"), parameter = named[0], select = document.getElementById("column");
  const box = document.getElementById("logarithmic"), [{ noun }] = rows("subject");
  const sequences = rows("sequences").map(row => row.name), marks = new Map(rows("marks").map(row => [row.type, row]));
  for (const column of named.slice(1)) select.add(new Option(column.caption, column.column));
  box.checked = parameter.logarithmic === "yes";
  for (const point of points) point.x = number(point.row[parameter.column]);
  if (points.some(p => p.x <= 0)) { box.checked = false; box.disabled = true; }
  const sentences = new Map(rows("sentences").map(row => [row.label, row]));
  const zones = rows("zones").map(row => row.name);
  const values = rows("values").map(row => ({ label: row.label, re: Number(row.re), im: Number(row.im), error: Number(row.error) || 0 }));
  const labelled = points.map((p, i) => i).filter(i => points[i].row.label);
  const sampled = labelled.some(i => document.getElementById("profile-" + points[i].row.label));
  // samples as numbers but for the number of their zone, as text
  const profiles = label => rows("profile-" + label).map(sample => Object.fromEntries(Object.entries(sample).map(([name, cell]) => [name, name === "zone" ? cell : number(cell)])));
  const beside = [], column_of_pictures = document.getElementById("beside");
  for (const given of rows("pictures")) {
    const along = ["along", "phase"].includes(given.shows);
    if (along && !sampled) document.getElementById("none").hidden = false;
    else if (along || values.length) beside.push(picture(column_of_pictures, given, noun, zones, profiles));
  }
  const undecided = points.some(p => p.row.stable === "undecided"), open = points.some(p => !p.row.stable);
  if (undecided !== open) DASHES.dotted[1] = undecided ? "stability undecided" : "stability not asked for";
  // one line for every run of equal stability within a leg; it goes on to where the next one begins
  const runs = [];
  for (let i = 0; i + 1 < points.length; i++) {
    if (points[i + 1].row.leg !== points[i].row.leg) continue;
    const last = runs[runs.length - 1], line = points[i].line;
    if (last && last.to === i && last.line === line) last.to = i + 1;
    else runs.push({ line, from: i, to: i + 1 });
  }
  let current = labelled[0] || 0, x, y, view = null, here;
  const scale = value => box.checked ? Math.log10(value) : value;
  const whole = () => [...span(points.map(p => p.x), scale), ...span(points.map(p => p.y))];
  const shown = () => named.slice(1).find(one => one.column === select.value) || named[1];
  const draw = () => {
    const column = shown();
    for (const point of points) point.y = number(point.row[column.column]);
    let field;
    [x, y, field] = axes(diagram, 640, 460, view || whole(), [parameter.caption, column.caption], box.checked);
    for (const run of runs) {
      // broken where the column has no value
      let stretch = [];
      const flush = () => { if (stretch.length > 1) line(field, stretch, { "stroke-dasharray": DASHES[run.line][0], "data-line": run.line }); stretch = []; };
      for (let i = run.from; i <= run.to; i++) {
        if (Number.isFinite(points[i].y)) stretch.push([x(points[i].x), y(points[i].y)]);
        else flush();
      }
      flush();
    }
    // words cover no mark
    const drawn = points.filter(p => marks.has(p.mark) && Number.isFinite(p.y));
    const written = drawn.map(p => [x(p.x) - 7, x(p.x) + 7, y(p.y) + 5]);
    for (const point of drawn) {
      mark(field, marks.get(point.mark), x(point.x), y(point.y));
      // many crossings lie on one branch: they carry no words
      if (["BP", "EP", "UZ"].includes(point.mark) || point.mark === "HB" && noun === "wave") continue;
      // words have a corner of the mark where they cover no others, or are left out
      const words = point.mark + " " + point.row.label, wide = 7.5 * words.length, [a, b] = [x(point.x), y(point.y)];
      const corners = [[a + 7, b - 6], [a + 7, b + 15], [a - 7 - wide, b - 6], [a - 7 - wide, b + 15]];
      const free = corners.find(([left, base]) => left > 64 && left + wide < 628 && base > 34 && base < 426 && !written.some(([l, r, low]) => left < r && left + wide > l && Math.abs(base - low) < 13));
      if (!free) continue;
      written.push([free[0], free[0] + wide, free[1]]);
      element(field, "text", { x: free[0], y: free[1] }, words);
    }
    const marked = points.filter(p => p.mark).length;
    diagram.setAttribute("aria-label", `${column.caption} against ${parameter.caption}: ${points.length} points, ${marked} of them special`);
    here = element(field, "circle", { r: 7, fill: "none", stroke: "var(--mark)", "stroke-width": 2 });
    show(current);
  };
  const show = index => {
    const point = points[index], row = point.row;
    here.setAttribute("cx", x(point.x));
    here.setAttribute("cy", Number.isFinite(point.y) ? y(point.y) : -99);
    // what belongs to the nearest label along the branch
    const near = labelled.reduce((best, i) => Math.abs(i - index) < Math.abs(best - index) ? i : best, labelled[0]);
    const label = near === undefined ? "" : points[near].row.label, event = row.label && sentences.get(row.label);
    const told = new Set([named[1], shown()]), sequence = sequences[Number(point.sequence)];
    let words = parameter.column + " = " + format(point.x);
    for (const column of told) if (row[column.column]) words += ", " + column.symbol + " = " + minus(Number(number(row[column.column]).toPrecision(8)).toString());
    if (sequence) words += "; " + sequence;
    if (row.stable) words += "; stable: " + row.stable + (row.unstable ? ", " + row.unstable + " growing" : "");
    if (row.why) words += " (" + row.why + ")";
    if (event) words += ". " + event.type + ": " + event.what;
    words += ".";
    if (label && beside.length) words += ` Beside: the ${noun} of label ${label}${near === index ? "" : ", the nearest one"}.`;
    document.getElementById("sentence").textContent = words;
    for (const [key, value] of [["min", 1], ["max", points.length], ["now", index + 1], ["text", words]]) diagram.setAttribute("aria-value" + key, value);
    for (const one of beside) one(label, values.filter(v => v.label === label));
    explorer.dataset.label = label;
  };
  // the legend: what is drawn, and no more
  const legend = document.getElementById("legend");
  const entry = (words, paint) => {
    const item = document.createElement("li");
    if (paint) paint(element(item, "svg", { viewBox: "0 0 30 14", "aria-hidden": "true" }));
    item.appendChild(document.createTextNode(words));
    legend.appendChild(item);
  };
  for (const name in DASHES) {
    if (runs.some(run => run.line === name)) entry(DASHES[name][1], svg => line(svg, [[1, 7], [29, 7]], { "stroke-dasharray": DASHES[name][0] }));
  }
  for (const one of marks.values()) entry(one.type + " " + one.words, svg => mark(svg, one, 15, 7));
  rows("zones").forEach(({ words }, i) => {
    if (words) entry(words, svg => { element(svg, "rect", { x: 5, y: 1, width: 20, height: 12, class: "zone-" + i }); line(svg, [[5, 7], [25, 7]], { class: "line-" + i }); });
  });
  for (const one of rows("key")) entry(one.words);
  // from the screen to the units of the drawing, and to parts of the frame
  const place = event => {
    const box = diagram.getBoundingClientRect(), factor = 640 / box.width;
    return [(event.clientX - box.left) * factor, (event.clientY - box.top) * factor];
  };
  const value = ([a, b]) => {
    const [x0, x1, y0, y1] = view || whole();
    return [x0 + (a - 64) / 564 * (x1 - x0), y0 + (426 - b) / 404 * (y1 - y0)];
  };
  const zoom = (factor, [a, b]) => {
    const [x0, x1, y0, y1] = view || whole();
    const next = [a + (x0 - a) * factor, a + (x1 - a) * factor, b + (y0 - b) * factor, b + (y1 - b) * factor];
    const all = whole(), wide = (next[1] - next[0]) / (all[1] - all[0]);
    if (wide > 1e-9) view = wide < 1 ? next : null;
    draw();
  };
  const at = () => [scale(points[current].x), Number.isFinite(points[current].y) ? points[current].y : (view || whole())[2]];
  const all = () => { view = null; draw(); };
  let drag = null, frame = null;
  diagram.addEventListener("pointerdown", event => { drag = place(event); diagram.setPointerCapture(event.pointerId); });
  diagram.addEventListener("pointermove", event => {
    const [a, b] = place(event);
    if (drag && Math.hypot(a - drag[0], b - drag[1]) > 6) {
      frame = frame || element(diagram, "rect", { fill: "none", stroke: "var(--mark)", "stroke-dasharray": "4 3" });
      const [left, top] = [Math.min(a, drag[0]), Math.min(b, drag[1])];
      for (const [key, length] of [["x", left], ["y", top], ["width", Math.abs(a - drag[0])], ["height", Math.abs(b - drag[1])]]) frame.setAttribute(key, length);
      return;
    }
    if (drag) return;
    let best = current, least = Infinity;
    points.forEach((p, i) => {
      const distance = (x(p.x) - a) ** 2 + (y(p.y) - b) ** 2 - (p.row.label ? 40 : 0);
      if (distance < least) { least = distance; best = i; }
    });
    if (best !== current) show(current = best);
  });
  diagram.addEventListener("pointerup", event => {
    if (frame) {
      const [one, other] = [value(drag), value(place(event))];
      view = [Math.min(one[0], other[0]), Math.max(one[0], other[0]), Math.min(one[1], other[1]), Math.max(one[1], other[1])];
      if (!(view[0] < view[1] && view[2] < view[3])) view = null;
      frame = null;
      draw();
    }
    drag = null;
  });
  diagram.addEventListener("wheel", event => { event.preventDefault(); zoom(event.deltaY > 0 ? 1.25 : 0.8, value(place(event))); }, { passive: false });
  diagram.addEventListener("dblclick", all);
  // the next label before or after a point, or the end of the branch
  const beyond = (index, step) => {
    const further = labelled.filter(i => (i - index) * step > 0);
    return further.length ? (step > 0 ? further[0] : further[further.length - 1]) : step > 0 ? points.length - 1 : 0;
  };
  const KEYS = {
    ArrowRight: i => i + 1, ArrowUp: i => i + 1, ArrowLeft: i => i - 1, ArrowDown: i => i - 1,
    Home: () => 0, End: () => points.length - 1, PageUp: i => beyond(i, 1), PageDown: i => beyond(i, -1),
  };
  diagram.addEventListener("keydown", event => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (KEYS[event.key]) { event.preventDefault(); show(current = Math.min(Math.max(KEYS[event.key](current), 0), points.length - 1)); }
    if (event.key === "+") zoom(0.5, at());
    if (event.key === "-" || event.key === "−") zoom(2, at());
    if (event.key === "0") all();
  });
  document.getElementById("closer").addEventListener("click", () => zoom(0.5, at()));
  document.getElementById("further").addEventListener("click", () => zoom(2, at()));
  document.getElementById("whole").addEventListener("click", all);
  select.addEventListener("change", all);
  box.addEventListener("change", all);
  explorer.classList.add("ready");
  draw();
}
