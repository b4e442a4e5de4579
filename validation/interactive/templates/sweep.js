// Response over speed for one friction law, with the law of the pair for comparison and the validity strip.
const sweep = page.sweep;
const now = { law: sweep.own, speed: nearest(sweep.speed, page.point.speed) };
const PANELS = [
  { key: "dte", axis: "y", name: "transmission error, peak to peak [µm]", domain: [0.69, 1] },
  { key: "oloa", axis: "y2", name: "pinion off line of action, peak to peak [µm]", domain: [0.44, 0.635] },
  { key: "load", axis: "y3", name: "lowest tooth load over static load [-]", domain: [0.19, 0.385] },
];
const FLAGS = ["reversal", "separation", "instability"];
const VALUES = {
  dte: "transmission error %{y:.6~r} µm", oloa: "off line of action %{y:.6~r} µm", load: "lowest load %{y:.6~r}",
};

const separates = (law, j) => law.load[j] !== null && law.load[j] < -page.limits.load;
const reversal = (law, j) => page.limits.reversal.filter((limit) => law.reversal[j] > limit).length;

function sweepTraces(colours) {
  const law = sweep.laws[now.law], own = sweep.laws[sweep.own], x = sweep.speed, made = [];
  for (const { key, axis } of PANELS) {
    if (now.law !== sweep.own) {
      made.push({
        type: "scatter", mode: "lines", x, y: own[key], yaxis: axis, hoverinfo: "skip", name: `${own.name}, as given`,
        line: { color: colours.other, width: 1.5, dash: "dash" }, showlegend: key === "dte",
      });
    }
    made.push({
      type: "scatter", mode: "lines", x, y: law[key], yaxis: axis, name: law.name, showlegend: key === "dte",
      line: { color: colours.curve, width: 2 }, hovertemplate: `%{x:.6~r} rpm<br>${VALUES[key]}<extra></extra>`,
    });
    made.push({
      type: "scatter", mode: "markers", x: [x[now.speed]], y: [law[key][now.speed]], yaxis: axis, hoverinfo: "skip",
      showlegend: false, marker: { symbol: "circle-open", size: 12, color: colours.ink, line: { width: 2 } },
    });
  }
  const strip = (test, row, symbol, name) => {
    const where = x.filter((_, j) => test(j));
    return {
      type: "scatter", mode: "markers", x: where, y: where.map(() => row), yaxis: "y4", name, showlegend: false,
      marker: { symbol, size: 9, color: colours.bad, line: { width: 1.5, color: colours.bad } },
      hovertemplate: `%{x:.6~r} rpm<br>${name}<extra></extra>`,
    };
  };
  made.push(
    strip((j) => law.radius[j] > 1, FLAGS[2], "square", "unstable motion"),
    strip((j) => separates(law, j), FLAGS[1], "x-thin", "teeth separate: not valid"),
    strip((j) => reversal(law, j) === 1, FLAGS[0], "triangle-up-open", "sliding reverses: doubtful"),
    strip((j) => reversal(law, j) === 2, FLAGS[0], "triangle-up", "sliding reverses: not valid"));
  return made;
}

function drawSweep() {
  const colours = theme(), x = sweep.speed, law = sweep.laws[now.law], plot = element("sweep-plot");
  const axes = Object.fromEntries(PANELS.map(({ key, axis, domain }) => {
    const both = [...law[key], ...sweep.laws[sweep.own][key]].filter((v) => v !== null);
    const low = Math.min(0, ...both), high = Math.max(...both);
    const span = high - low || 1;
    const range = [low && low - 0.06 * span, high + 0.08 * span];
    return [axis.replace("y", "yaxis"), axisStyle(colours, { domain, range, fixedrange: true })];
  }));
  const traces = sweepTraces(colours), named = traces.filter(({ showlegend }) => showlegend).length;
  const layout = baseLayout(colours, {
    ...axes, margin: { l: 74, r: 14, t: plot.clientWidth < 500 ? 40 + 19 * Math.max(named, 2) : 62, b: 52 }, hovermode: "closest", hoverdistance: 30, showlegend: true,
    legend: { orientation: "h", x: 0, yref: "container", y: 0.995, yanchor: "top", font: { size: 12 } },
    xaxis: speedAxis(colours, shown(plot, "xaxis", [x[0], x.at(-1)]), "y4"),
    yaxis4: axisStyle(colours, {
      domain: [0, 0.135], type: "category", categoryorder: "array", categoryarray: FLAGS, tickvals: FLAGS,
      range: [-0.6, 2.6], fixedrange: true, tickfont: { size: 11 },
    }),
    shapes: [
      ...sweep.resonances.filter((s) => s > x[0] && s < x.at(-1)).map((s) => vertical(s, colours.quiet, "dot", 0.8)),
      vertical(page.point.speed, colours.bad, "dash"), vertical(x[now.speed], colours.ink, "dot", 1.5),
      {
        type: "line", xref: "paper", yref: "y3", x0: 0, x1: 1, y0: 0, y1: 0, line: { color: colours.ink, width: 1 },
      },
    ],
    annotations: [...PANELS.map(({ name, domain }) => panelName(name, domain[1], colours)), {
      text: "operating point", x: page.point.speed, xref: "x", y: 1, yref: "paper", yanchor: "top", xanchor: "left", bgcolor: colours.page,
      showarrow: false, xshift: 3, font: { size: 11, color: colours.bad },
    }],
  });
  return Plotly.react(plot, traces, layout, config);
}

function sweepText() {
  const law = sweep.laws[now.law], j = now.speed;
  const start = `Cursor: ${rpm(sweep.speed[j])}, friction law ${law.name}: `;
  if (law.dte[j] === null) return `${start}no periodic motion.`;
  const slide = law.reversal[j] > 0 ? `reversed up to ${plain(100 * law.reversal[j], 2)} % of a base pitch from the pitch point` : "never reversed";
  return `${start}transmission error ${plain(law.dte[j], 4)} µm and off-line-of-action vibration ${plain(law.oloa[j], 4)} µm ` +
    `peak to peak, lowest tooth load ${plain(law.load[j], 3)} of the static load, sliding ${slide}. ` +
    `Model ${sweep.states[law.state[j]]}, motion ${law.radius[j] > 1 ? "unstable" : "stable"}.`;
}

const refreshSweep = oncePerFrame(drawSweep);

function showSweep() {
  const law = sweep.laws[now.law];
  element("law").value = String(now.law);
  setRange(element("sweep-speed"), sweep.speed.length, now.speed, rpm(sweep.speed[now.speed]));
  element("sweep-text").textContent = sweepText();
  element("law-note").textContent = law.note && `Outside its fitted range at the operating point: ${law.note}.`;
  refreshSweep();
}

function moveSweep(change) {
  Object.assign(now, change);
  now.law = clamp(now.law, 0, sweep.laws.length - 1);
  now.speed = clamp(now.speed, 0, sweep.speed.length - 1);
  follow(element("sweep-plot"), [sweep.speed[0], sweep.speed.at(-1)], sweep.speed[now.speed]);
  showSweep();
}

async function startSweep() {
  const plot = element("sweep-plot"), whole = [sweep.speed[0], sweep.speed.at(-1)];
  options(element("law"), sweep.laws.map((law, i) => law.name + (i === sweep.own ? " (as given)" : "")));
  await drawSweep();
  showSweep();
  const zoomBy = (factor) => zoom(plot, whole, factor, sweep.speed[now.speed]);
  const all = () => Plotly.relayout(plot, { "xaxis.range": whole });
  buttons(element("sweep-buttons"), [
    ["Zoom in", () => zoomBy(0.5)], ["Zoom out", () => zoomBy(2)], ["Show all", all],
    ["Operating point", () => moveSweep({ law: sweep.own, speed: nearest(sweep.speed, page.point.speed) })],
  ]);
  element("law").addEventListener("change", (event) => moveSweep({ law: Number(event.target.value) }));
  element("sweep-speed").addEventListener("input", (event) => moveSweep({ speed: Number(event.target.value) }));
  keys(element("sweep"), {
    ArrowLeft: (n) => moveSweep({ speed: now.speed - n }), ArrowRight: (n) => moveSweep({ speed: now.speed + n }),
    ArrowUp: () => moveSweep({ law: now.law - 1 }), ArrowDown: () => moveSweep({ law: now.law + 1 }),
    Home: () => moveSweep({ speed: 0 }), End: () => moveSweep({ speed: sweep.speed.length - 1 }),
    "+": () => zoomBy(0.5), "-": () => zoomBy(2), 0: all,
  });
  redraw(plot, refreshSweep, all);
  plot.on("plotly_click", ({ points }) => moveSweep({ speed: nearest(sweep.speed, points[0].x) }));
}
