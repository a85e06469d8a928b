"use strict";
// Charts of a run: one time axis for all of them, colours from the page's style, so that they follow it.
(() => {
  const told = JSON.parse(document.getElementById("charts").textContent);
  const root = document.documentElement;
  const colour = (name) => getComputedStyle(root).getPropertyValue(`--${name}`).trim();
  const faint = (name, part) => `color-mix(in srgb, ${colour(name)} ${part}%, transparent)`;
  const LANE = 30, LABEL = 13, LEAST_S = 0.2, PAPER = 660;
  const plots = [];

  const figure = (name) => document.getElementById(name);
  const width = (place) => (root.classList.contains("paper") ? PAPER : Math.max(place.clientWidth, 240));

  // The faults' spans behind every chart.
  const shade = (u) => {
    const { ctx, bbox } = u;
    ctx.save();
    ctx.fillStyle = colour("shade");
    for (const [start, end] of told.faults) {
      const [a, b] = [start, end].map((t) => u.valToPos(t, "x", true));
      const left = Math.max(a, bbox.left), right = Math.min(Math.max(b, a + 2), bbox.left + bbox.width);
      if (right > left) ctx.fillRect(left, bbox.top, right - left, bbox.height);
    }
    ctx.restore();
  };

  const axis = (more) => ({
    stroke: () => colour("soft"), font: "12px system-ui, sans-serif",
    grid: { stroke: () => colour("line"), width: 1 }, ticks: { show: false }, ...more,
  });
  const seconds = (u, values, _, __, step) =>
    values.map((t) => t.toFixed((String(step).split(".")[1] ?? "").length));
  const options = (place, height, more) => ({
    width: width(place), height, padding: [8, 12, 0, 0],
    cursor: { sync: { key: "run", scales: ["x", null] }, drag: { x: true, y: false }, points: { size: 6 }, y: false },
    scales: { x: { time: false, min: 0, max: told.seconds }, ...more.scales },
    series: [{ label: "t/s", value: (u, t) => (t == null ? "–" : t.toFixed(3)) }, ...more.series],
    bands: more.bands,
    legend: { show: more.series.length > 0, markers: { stroke: (u, i) => `var(--${u.series[i].tone})` } },
    axes: [axis({ values: seconds, size: 30, gap: 4 }), axis({ size: 52, gap: 4, ...more.axis })],
    hooks: { drawClear: [shade], ...more.hooks },
  });

  const number = (digits) => (u, value) => (value == null ? "–" : value.toFixed(digits));
  const line = (label, name, digits, more) =>
    ({ label, tone: name, stroke: () => colour(name), width: 1.3, points: { show: false }, value: number(digits), ...more });
  const interval = (digits) => [
    line("FPGA 1 at least", "blue", digits, { width: 0.8 }), line("at most", "blue", digits, { width: 0.8 }),
    line("FPGA 2 at least", "orange", digits, { dash: [5, 5] }), line("at most", "orange", digits, { dash: [5, 5] }),
  ];
  const bands = [{ series: [2, 1], fill: () => faint("blue", 18) }];
  const ends = (chart) => ["low 1", "high 1", "low 2", "high 2"].map((name) => chart[name]);
  const add = (place, opts, data) => plots.push([place, new uPlot(opts, data, place)]);

  const lines = (name, height, columns, more) => {
    const place = figure(name);
    add(place, options(place, height, more), [told.times, ...columns]);
  };
  lines("speed", 260, [...ends(told.speed), told.speed.truth], {
    series: [...interval(2), line("the truth", "ink", 2, { width: 1.6 })], bands,
  });
  lines("around", 200, [...ends(told.around)], {
    series: interval(3), bands,
    scales: { y: { range: (u, low, high) => [Math.max(low ?? 0, -told.cut) * 1.06, Math.min(high ?? 0, told.cut) * 1.06] } },
  });
  lines("way", 220, [...ends(told.way), told.way["error 1"], told.way["error 2"]], {
    series: [...interval(3), line("FPGA 1", "blue", 3, { width: 1.6 }),
      line("FPGA 2", "orange", 3, { width: 1.6, dash: [6, 4] })],
    bands,
  });

  // The lanes: a label above each, the spans below it, what it is under the cursor beside the label.
  const place = figure("lanes"), labels = [];
  const at = (lane, t) => {
    const span = lane.spans.find(([start, end]) => start <= t && t < end);
    return span ? span[2] : lane.idle;
  };
  const draw = (u) => {
    const { ctx, bbox } = u, scale = devicePixelRatio;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    told.lanes.forEach((lane, i) => {
      const top = bbox.top + (i * LANE + LABEL) * scale, height = (LANE - LABEL - 7) * scale;
      ctx.fillStyle = colour("line");
      ctx.fillRect(bbox.left, top + height / 2, bbox.width, 1);
      for (const [start, end, , tone] of lane.spans) {
        const [a, b] = [start, end].map((t) => u.valToPos(t, "x", true));
        if (b < bbox.left || a > bbox.left + bbox.width) continue;
        ctx.fillStyle = colour(tone);
        ctx.fillRect(a, top, Math.max(b - a, scale), height);
      }
    });
    ctx.restore();
  };
  const label = (u) => told.lanes.forEach((lane, i) => {
    const text = document.createElement("div");
    text.className = "lane";
    text.style.top = `${i * LANE}px`;
    text.append(`${lane.name} `, document.createElement("b"));
    u.over.append(text);
    labels.push(text.lastChild);
  });
  const tell = (u) => {
    const there = u.cursor.left >= 0, t = there ? u.posToVal(u.cursor.left, "x") : 0;
    told.lanes.forEach((lane, i) => { labels[i].textContent = there ? at(lane, t) : ""; });
  };
  add(place, options(place, told.lanes.length * LANE + 40, {
    series: [], scales: { y: { range: [0, 1] } }, axis: { values: () => [], grid: { show: false } },
    hooks: { draw: [draw], init: [label], setCursor: [tell] },
  }), [[0, told.seconds]]);

  // Zooming: all charts by one of them. Dragging is the plots' own, and so is the double click.
  const first = plots[0][1];
  const zoom = (low, high) => {
    const span = Math.min(Math.max(high - low, LEAST_S), told.seconds);
    const min = Math.min(Math.max(low, 0), told.seconds - span);
    for (const [, plot] of plots) plot.setScale("x", { min, max: min + span });
  };
  const move = (shift, factor) => {
    const { min, max } = first.scales.x, half = (max - min) / 2, middle = (min + max) / 2 + shift * half;
    zoom(middle - half * factor, middle + half * factor);
  };
  const acts = {
    all: () => zoom(0, told.seconds), in: () => move(0, 0.5), out: () => move(0, 2),
    back: () => move(-1, 1), on: () => move(1, 1),
  };
  for (const button of document.querySelectorAll("[data-zoom]"))
    button.addEventListener("click", acts[button.dataset.zoom]);
  for (const button of document.querySelectorAll(".at"))
    button.addEventListener("click", () => {
      const t = Number(button.dataset.t);
      zoom(t - 2, t + 3);
      document.getElementById("over-time").scrollIntoView({ behavior: "smooth" });
    });

  // Widths and colours follow the page; on paper both are the paper's.
  const fit = () => {
    for (const [place, plot] of plots) plot.setSize({ width: width(place), height: plot.height });
  };
  new ResizeObserver(fit).observe(document.body);
  const repaint = () => { for (const [, plot] of plots) plot.redraw(false, true); };
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", repaint);
  addEventListener("beforeprint", () => { root.classList.add("paper"); fit(); repaint(); });
  addEventListener("afterprint", () => { root.classList.remove("paper"); fit(); repaint(); });
})();

// The events: by source, and by a word.
(() => {
  const rows = [...document.querySelectorAll("#events tbody tr")];
  const chips = [...document.querySelectorAll("[data-of]")], word = document.getElementById("word");
  const count = document.getElementById("count");
  const show = () => {
    const off = new Set(chips.filter((c) => c.ariaPressed === "false").map((c) => c.dataset.of));
    const wanted = word.value.toLowerCase();
    let shown = 0;
    for (const row of rows) {
      row.hidden = off.has(row.dataset.source) || !row.textContent.toLowerCase().includes(wanted);
      shown += !row.hidden;
    }
    count.textContent = `${shown} of ${rows.length}`;
  };
  for (const chip of chips)
    chip.addEventListener("click", () => { chip.ariaPressed = String(chip.ariaPressed === "false"); show(); });
  word.addEventListener("input", show);
})();
