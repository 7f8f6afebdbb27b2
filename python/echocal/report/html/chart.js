"use strict";
// Axes, values and zoom of the figures. A path holds its values in the units of the data.
addEventListener("DOMContentLoaded", () => document.querySelectorAll("svg.chart").forEach(chart));

function chart(svg) {
  const make = (tag, facts, parent, text = "") => {
    const one = document.createElementNS("http://www.w3.org/2000/svg", tag);
    for (const [name, value] of Object.entries(facts)) one.setAttribute(name, value);
    if (text) one.textContent = text;
    parent.append(one);
    return one;
  };
  const ends = text => text.split(" ").map(Number);
  const whole = ends(svg.dataset.x), begin = svg.dataset.begin ? Date.parse(svg.dataset.begin) : null;
  let x = [...whole], width = 0, pressed = null;
  const panels = [...svg.querySelectorAll("g.panel")].map(group => {
    const whole = group.dataset.y ? ends(group.dataset.y) : null;
    const axes = make("g", {}, group), plot = make("svg", {class: "plot"}, group);
    const marks = [...group.querySelectorAll("path")];
    marks.forEach(path => plot.append(path));
    return {group, axes, plot, marks, whole, y: whole && [...whole], high: whole ? 190 : 16};
  });
  const figure = svg.closest("figure"), tip = document.createElement("output");
  const tools = document.createElement("p");
  tools.className = "tools";
  for (const [sign, say, act] of [["+", "closer", () => zoom(0.5)], ["−", "wider", () => zoom(2)], ["↺", "whole", reset]]) {
    const button = document.createElement("button");
    button.textContent = sign; button.type = "button"; button.title = say; button.onclick = act;
    tools.append(button);
  }
  const ring = make("circle", {class: "ring", r: 0}, svg);
  figure.prepend(tools);
  figure.append(tip);

  function draw() {
    const texts = panels.map(p => p.y ? ticks(p.y, 5).map(([at, text]) => [at, text]) : []);
    const left = 10 + 7.5 * Math.max(1, ...texts.flat().map(([, text]) => text.length));
    const right = width - 12;
    let top = 4;
    panels.forEach((panel, place) => {
      const {group, axes, plot, marks, y, high} = panel, title = group.dataset.title, label = group.dataset.yLabel;
      axes.replaceChildren();
      const above = [title, label].filter(Boolean), together = above.join("; ");
      for (const text of 7.2 * together.length < width ? [together] : above)
        if (text) { make("text", {x: 2, y: top + 13, class: "title"}, axes, text); top += 18; }
      top += 4;
      panel.box = {left, top, wide: right - left, high};
      for (const [name, value] of Object.entries({x: left, y: top, width: right - left, height: high})) plot.setAttribute(name, value);
      const sx = (right - left) / (x[1] - x[0]), sy = y ? high / (y[1] - y[0]) : 1;
      const last = place === panels.length - 1;
      for (const [at, text] of ticks(x, Math.max(2, width / (begin === null ? 90 : 120)), begin)) {
        const to = left + sx * (at - x[0]);
        make("path", {class: "grid", d: `M${to} ${top}v${high}`}, axes);
        const half = 3.5 * text.length;
        if (last) make("text", {x: Math.min(to, width - half), y: top + high + 16, class: "tick", "text-anchor": "middle"}, axes, text);
      }
      for (const [at, text] of texts[place]) {
        const to = top + high - sy * (at - y[0]);
        make("path", {class: at === 0 ? "zero" : "grid", d: `M${left} ${to}H${right}`}, axes);
        make("text", {x: left - 5, y: to + 4, class: "tick", "text-anchor": "end"}, axes, text);
      }
      for (const path of marks) path.setAttribute("transform", path.classList.contains("rug") || !y
        ? `matrix(${sx} 0 0 1 ${-sx * x[0]} 0)`
        : `matrix(${sx} 0 0 ${-sy} ${-sx * x[0]} ${high + sy * y[0]})`);
      top += high + (last ? 24 : 14);
    });
    make("text", {x: (left + right) / 2, y: top + 10, class: "tick", "text-anchor": "middle"}, panels.at(-1).axes, svg.dataset.xLabel);
    svg.setAttribute("viewBox", `0 0 ${width} ${top + 18}`);
    svg.style.touchAction = x[0] === whole[0] && x[1] === whole[1] ? "auto" : "pan-y";
  }

  // Ticks with their texts: numbers at 1, 2, 5 times a power of ten; dates at whole units of the calendar.
  function ticks([low, high], most, begin = null) {
    const found = [];
    if (begin === null) {
      const raw = (high - low) / most, power = 10 ** Math.floor(Math.log10(raw));
      const step = [1, 2, 5, 10].find(s => s * power >= raw) * power, digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
      for (let n = Math.ceil(low / step); n * step <= high; n++)
        found.push([n * step, step < 1e-4 || high > 1e7 ? (n * step).toPrecision(3) : (n * step).toFixed(digits).replace("-", "\u2212")]);
      return found;
    }
    const day = 86400, steps = [1, 2, 5, 10, 30, 60, 120, 300, 600, 1800, 3600, 7200, 10800, 21600, 43200, day, 2 * day, 5 * day, 10 * day];
    const raw = (high - low) / most, step = steps.find(s => s >= raw);
    const push = time => { if (time >= begin + 1e3 * low && time <= begin + 1e3 * high) found.push([(time - begin) / 1e3, said(time)]); };
    const said = time => {
      const text = new Date(time).toISOString();
      return step >= day || !step ? text.slice(0, 10) : text.slice(5, step < 60 ? 19 : 16).replace("T", " ");
    };
    if (step) {
      const origin = step < day ? 0 : Date.UTC(new Date(begin).getUTCFullYear(), 0, 1);
      for (let n = Math.ceil((begin + 1e3 * low - origin) / (1e3 * step)); origin + 1e3 * n * step <= begin + 1e3 * high; n++) push(origin + 1e3 * n * step);
    } else {
      const months = [1, 2, 3, 6, 12, 24, 60, 120, 240].find(m => m * 30 * day >= raw) ?? 600, first = new Date(begin + 1e3 * low);
      for (let year = first.getUTCFullYear() - first.getUTCFullYear() % Math.max(1, months / 12), month = 0, time; (time = Date.UTC(year, month, 1)) <= begin + 1e3 * high; month += months) push(time);
    }
    return found;
  }

  function zoom(factor) {
    const about = ([low, high]) => [(low + high) / 2 - factor * (high - low) / 2, (low + high) / 2 + factor * (high - low) / 2];
    x = inside(about(x), whole);
    for (const panel of panels) if (panel.y) panel.y = inside(about(panel.y), panel.whole);
    draw();
  }
  const inside = ([low, high], [least, most]) => high - low >= most - least ? [least, most]
    : low < least ? [least, least + high - low] : high > most ? [most - high + low, most] : [low, high];
  function reset() { x = [...whole]; for (const panel of panels) panel.y = panel.whole && [...panel.whole]; draw(); }

  const values = path => path.known ??= (() => {
    const numbers = path.getAttribute("d").match(/-?[\d.]+(?:e[-+]?\d+)?/g).map(Number), every = path.classList.contains("line") ? 2 : 3;
    const rows = path.dataset.rows?.split(" "), found = [];
    for (let n = 0; n + 1 < numbers.length; n += every) found.push([numbers[n], numbers[n + 1], rows?.[n / every]]);
    return found;
  })();
  const place = event => {
    const box = svg.getBoundingClientRect();
    return [(event.clientX - box.left) * width / box.width, (event.clientY - box.top) * width / box.width];
  };
  const panelAt = ([, py]) => panels.find(({box}) => py >= box.top - 8 && py <= box.top + box.high + 8);
  const data = ([px, py], {box, y}) => [x[0] + (px - box.left) / box.wide * (x[1] - x[0]), y && y[1] - (py - box.top) / box.high * (y[1] - y[0])];
  const number = value => String(+value.toPrecision(5)).replace("-", "\u2212");
  const unit = label => /\[(.*)\]$/.exec(label ?? "")?.[1] ?? "";
  const told = (value, label, begin) => begin !== null ? new Date(begin + 1e3 * value).toISOString().slice(0, 19).replace("T", " ")
    : label === "row" ? `row ${value}` : `${number(value)} ${unit(label)}`;

  function show(event) {
    const at = place(event), panel = panelAt(at);
    let best = 24 ** 2, near = null;
    if (panel) {
      const {box, y, marks} = panel, sx = box.wide / (x[1] - x[0]), sy = y ? box.high / (y[1] - y[0]) : 0;
      for (const path of marks) for (const [vx, vy, row] of values(path)) {
        const rug = path.classList.contains("rug") || !y, px = box.left + sx * (vx - x[0]), py = rug ? box.top + 5 : box.top + box.high - sy * (vy - y[0]);
        const far = (px - at[0]) ** 2 + (py - at[1]) ** 2;
        if (far < best) { best = far; near = {px, py, vx, vy, row, rug, name: path.dataset.name, label: panel.group.dataset.yLabel}; }
      }
    }
    tip.hidden = !near;
    ring.setAttribute("r", near ? 6 : 0);
    if (!near) return;
    ring.setAttribute("cx", near.px);
    ring.setAttribute("cy", near.py);
    const {px, py, vx, vy, row, rug, name, label} = near, xs = svg.dataset.xLabel;
    tip.textContent = [name, row && xs !== "row" ? `row ${row}` : "", told(vx, xs, begin), rug ? "" : told(vy, label, null)].filter(Boolean).join(", ");
    tip.style.left = `${Math.max(0, Math.min(px - 20, width - tip.offsetWidth))}px`;
    const base = svg.getBoundingClientRect().top - figure.getBoundingClientRect().top;
    tip.style.top = `${base + py * svg.getBoundingClientRect().width / width + 14}px`;
  }
  svg.onpointerdown = event => {
    const at = place(event), panel = panelAt(at);
    show(event);
    if (!panel) return;
    pressed = {at, panel, x: [...x]};
    if (event.pointerType === "mouse") pressed.frame = make("rect", {class: "frame"}, svg);
    svg.setPointerCapture(event.pointerId);
  };
  svg.onpointermove = event => {
    if (!pressed) { show(event); return; }
    const at = place(event), {at: from, panel, frame} = pressed;
    if (!frame) {
      const moved = (at[0] - from[0]) / panel.box.wide * (x[1] - x[0]);
      x = inside(pressed.x.map(end => end - moved), whole);
      draw();
      return;
    }
    const [low, high] = [0, 1].map(k => [Math.min(from[k], at[k]), Math.abs(from[k] - at[k])]);
    for (const [name, value] of Object.entries({x: low[0], width: low[1], y: high[0], height: high[1]})) frame.setAttribute(name, value);
  };
  svg.onpointerup = svg.onpointercancel = event => {
    if (!pressed) return;
    const {at: from, panel, frame} = pressed, at = place(event);
    pressed = null;
    frame?.remove();
    if (!frame || Math.abs(at[0] - from[0]) < 8) return;
    const [a, b] = [data(from, panel), data(at, panel)];
    x = inside([Math.min(a[0], b[0]), Math.max(a[0], b[0])], whole);
    if (panel.y && Math.abs(at[1] - from[1]) > 8) panel.y = inside([Math.min(a[1], b[1]), Math.max(a[1], b[1])], panel.whole);
    draw();
  };
  svg.onpointerleave = () => { tip.hidden = true; ring.setAttribute("r", 0); };
  svg.ondblclick = reset;
  tip.hidden = true;
  new ResizeObserver(() => { const now = svg.clientWidth; if (now && now !== width) { width = now; draw(); } }).observe(svg);
  width = svg.clientWidth || 640;
  draw();
}
