// Stability chart: heat map over speed and damping at one value of the third parameter, and its cut.
const WORDS = { 2: "stable (neutral)", 1: "stable", 0: "undecided", "-1": "unstable" };
// Cividis (Nuñez, Anderton and Renslow 2018), readable with every common colour vision and in grey; its light
// end is kept for what is unstable, so that the step at 1 is a step in lightness.
const STABLE = ["#00224e", "#123570", "#3b496c", "#575d6d", "#707173", "#8a8678", "#a59c74"];
const UNSTABLE = ["#e1cc55", "#fee838"];

// Stable colours change at the quantiles of what is there: most multipliers lie close below 1.
function colourScale(sorted) {
  const low = sorted[0], high = sorted.at(-1), place = (value) => (value - low) / (high - low || 1);
  const stable = sorted.filter((v) => v <= 1);
  const spread = (colours, from, to) => colours.map((c, i) => [from + (to - from) * i / (colours.length - 1), c]);
  if (stable.length === 0) return spread(UNSTABLE, 0, 1);
  const end = Math.min(place(1), 1);
  const inner = STABLE.slice(1, -1).map((c, i) =>
    [Math.min(place(stable[Math.floor((stable.length - 1) * (i + 1) / (STABLE.length - 1))]), end), c]);
  const scale = [[0, STABLE[0]], ...inner, [end, STABLE.at(-1)]];
  return end < 1 ? [...scale, ...spread(UNSTABLE, end, 1)] : scale;
}

const charts = page.stability.map((raw) => {
  const radius = new Float32Array(buffer(raw.radius));
  const verdict = new Int8Array(buffer(raw.verdict));
  const sorted = radius.slice().sort();
  const size = [raw.damping.length, raw.speed.length];
  return {
    ...raw, low: sorted[0], high: sorted.at(-1), colours: colourScale(sorted),
    radii: raw.values.map((_, k) => rows(radius, k, ...size)),
    verdicts: raw.values.map((_, k) => rows(verdict, k, ...size)),
  };
});
const at = { axis: 0, slice: charts[0].own, damping: 0, speed: 0 };

function stabilityTraces(chart, colours) {
  const { speed, damping } = chart;
  const z = chart.radii[at.slice], verdict = chart.verdicts[at.slice], own = chart.radii[chart.own];
  const dots = { x: [], y: [] };
  verdict.forEach((row, i) => row.forEach((v, j) => {
    if (v !== 1) { dots.x.push(speed[j]); dots.y.push(damping[i]); }
  }));
  const bad = speed.map((_, j) => j).filter((j) => verdict[at.damping][j] < 1);
  const onCut = { yaxis: "y2", type: "scatter" };
  return [
    {
      type: "heatmap", x: speed, y: damping, z, zmin: chart.low, zmax: chart.high, zsmooth: false,
      colorscale: chart.colours,
      text: verdict.map((row) => Array.from(row, (v) => WORDS[v])),
      hovertemplate: "%{x:.6~r} rpm<br>damping ratio %{y:.6~r}<br>largest multiplier %{z:.6f}<br>%{text}<extra></extra>",
      colorbar: {
        orientation: "h", yref: "container", y: 0.995, yanchor: "top", thickness: 10, len: 1.0, xpad: 0, ypad: 2,
        title: { text: "largest multiplier [-], unstable above 1", side: "top" }, outlinewidth: 0,
        tickcolor: colours.quiet,
      },
    },
    {
      type: "contour", x: speed, y: damping, z, contours: { start: 1, end: 1, size: 1, coloring: "none" },
      line: { color: "#000000", width: 2 }, showscale: false, hoverinfo: "skip",
    },
    { type: "scatter", mode: "markers", ...dots, hoverinfo: "skip", marker: { size: 3, color: "#000000" } },
    {
      type: "scatter", mode: "markers", x: [page.point.speed], y: [page.point.damping], hoverinfo: "skip",
      marker: { size: 11, symbol: "circle", color: "#ffffff", line: { color: "#000000", width: 2 } },
    },
    {
      ...onCut, mode: "lines", x: speed, y: own[at.damping], hoverinfo: "skip",
      line: { color: colours.other, width: 1.5, dash: "dash" },
    },
    {
      ...onCut, mode: "lines", x: speed, y: z[at.damping], line: { color: colours.curve, width: 2 },
      hovertemplate: "%{x:.6~r} rpm<br>largest multiplier %{y:.6f}<extra></extra>",
    },
    {
      ...onCut, mode: "markers", x: bad.map((j) => speed[j]), y: bad.map((j) => z[at.damping][j]),
      hoverinfo: "skip", marker: { symbol: "x", size: 7, color: colours.bad },
    },
    {
      ...onCut, mode: "markers", x: [speed[at.speed]], y: [z[at.damping][at.speed]], hoverinfo: "skip",
      marker: { symbol: "circle-open", size: 12, color: colours.ink, line: { width: 2 } },
    },
  ];
}

// Names of the tongues above the chart; the largest keeps its name where two would write over each other.
function tongueNames(chart, width, range) {
  const placed = [], named = new Set(), scale = width / (range[1] - range[0]);
  return chart.tongues[at.slice].filter(({ name, speed }) => {
    const x = (speed - range[0]) * scale;
    if (named.has(name) || x < 0 || x > width || placed.some((other) => Math.abs(other - x) < 15)) return false;
    placed.push(x);
    named.add(name);
    return true;
  }).map(({ name, speed }) => ({
    text: name, x: speed, xref: "x", y: 1, yref: "paper", yanchor: "bottom", showarrow: false, textangle: -90,
    font: { size: 11 }, yshift: 2,
  }));
}

function drawStability() {
  const chart = charts[at.axis], colours = theme(), plot = element("stability-plot");
  const { speed, damping } = chart;
  const range = shown(plot, "xaxis", [speed[0], speed.at(-1)]);
  const level = (y, yref, dash, colour) => ({
    type: "line", xref: "paper", yref, x0: 0, x1: 1, y0: y, y1: y, line: { color: colour, width: 1, dash },
  });
  const margin = { l: 58, r: 14, t: 108, b: 52 };
  const layout = baseLayout(colours, {
    margin, hovermode: "closest",
    xaxis: { ...speedAxis(colours, range, "y2"), showgrid: false },
    yaxis: axisStyle(colours, {
      range: shown(plot, "yaxis", [damping[0], damping.at(-1)]), title: { text: "mesh damping ratio [-]", standoff: 6 }, domain: [0.42, 1], showgrid: false,
    }),
    yaxis2: axisStyle(colours, {
      domain: [0, 0.33], fixedrange: true, range: padded([...chart.radii[at.slice][at.damping], ...chart.radii[chart.own][at.damping], 1]),
    }),
    shapes: [
      vertical(speed[at.speed], colours.ink, "dot"),
      // On the colours, dots of black between white are seen everywhere.
      ...["#ffffff", "#000000"].flatMap((colour, i) => [
        { ...vertical(speed[at.speed], colour, i ? "dot" : "solid"), yref: "y domain" },
        level(damping[at.damping], "y", i ? "dot" : "solid", colour),
      ]),
      level(1, "y2", "solid", colours.ink),
    ],
    annotations: [
      panelName(`largest multiplier [-], damping ratio ${plain(damping[at.damping], 4)}`, 0.33, colours),
      ...tongueNames(chart, plot.clientWidth - margin.l - margin.r, range),
      {
        text: "unstable above 1", x: 1, xref: "paper", xanchor: "right", y: 1, yref: "y2", yanchor: "bottom",
        showarrow: false, font: { size: 11, color: colours.ink },
      },
    ],
  });
  return Plotly.react(plot, stabilityTraces(chart, colours), layout, config);
}

function padded(values) {
  const low = Math.min(...values), high = Math.max(...values);
  return [low - 0.06 * (high - low), high + 0.14 * (high - low)];
}

function stabilityText() {
  const chart = charts[at.axis];
  const value = chart.radii[at.slice][at.damping][at.speed], word = WORDS[chart.verdicts[at.slice][at.damping][at.speed]];
  const third = `${chart.name} ${plain(chart.values[at.slice], 4)}`;
  return `Cursor: ${rpm(chart.speed[at.speed])}, mesh damping ratio ${plain(chart.damping[at.damping])}, ${third}: ` +
    `largest multiplier ${value.toFixed(6)}, ${word}.`;
}

const refreshStability = oncePerFrame(drawStability);

function showStability() {
  const chart = charts[at.axis], own = at.slice === chart.own ? " (this pair)" : "";
  element("slice-name").textContent = chart.name[0].toUpperCase() + chart.name.slice(1);
  setRange(element("slice"), chart.values.length, at.slice, plain(chart.values[at.slice], 4) + own);
  setRange(element("damping"), chart.damping.length, at.damping, plain(chart.damping[at.damping]));
  setRange(element("speed"), chart.speed.length, at.speed, rpm(chart.speed[at.speed]));
  element("stability-text").textContent = stabilityText();
  refreshStability();
}

function moveStability(change) {
  const chart = charts[at.axis];
  Object.assign(at, change);
  at.slice = clamp(at.slice, 0, chart.values.length - 1);
  at.damping = clamp(at.damping, 0, chart.damping.length - 1);
  at.speed = clamp(at.speed, 0, chart.speed.length - 1);
  follow(element("stability-plot"), [chart.speed[0], chart.speed.at(-1)], chart.speed[at.speed]);
  showStability();
}

function operatingPoint() {
  const chart = charts[at.axis];
  return {
    slice: chart.own, damping: nearest(chart.damping, page.point.damping), speed: nearest(chart.speed, page.point.speed),
  };
}

async function startStability() {
  const plot = element("stability-plot"), whole = [charts[0].speed[0], charts[0].speed.at(-1)];
  options(element("axis"), charts.map((chart) => chart.name));
  Object.assign(at, operatingPoint());
  await drawStability();
  showStability();
  const zoomBy = (factor) => zoom(plot, whole, factor, charts[at.axis].speed[at.speed]);
  const all = () => Plotly.relayout(plot, {
    "xaxis.range": whole, "yaxis.range": [charts[0].damping[0], charts[0].damping.at(-1)],
  });
  buttons(element("stability-buttons"), [
    ["Zoom in", () => zoomBy(0.5)], ["Zoom out", () => zoomBy(2)], ["Show all", all],
    ["Operating point", () => moveStability(operatingPoint())],
  ]);
  element("axis").addEventListener("change", (event) => {
    at.axis = Number(event.target.value);
    moveStability({ slice: charts[at.axis].own });
  });
  for (const name of ["slice", "damping", "speed"]) {
    element(name).addEventListener("input", (event) => moveStability({ [name]: Number(event.target.value) }));
  }
  keys(element("stability"), {
    ArrowLeft: (n) => moveStability({ speed: at.speed - n }), ArrowRight: (n) => moveStability({ speed: at.speed + n }),
    ArrowUp: (n) => moveStability({ damping: at.damping + n }), ArrowDown: (n) => moveStability({ damping: at.damping - n }),
    PageUp: () => moveStability({ slice: at.slice + 1 }), PageDown: () => moveStability({ slice: at.slice - 1 }),
    Home: () => moveStability({ speed: 0 }), End: () => moveStability({ speed: charts[at.axis].speed.length - 1 }),
    "+": () => zoomBy(0.5), "-": () => zoomBy(2), 0: all,
  });
  redraw(plot, refreshStability, all);
  plot.on("plotly_click", ({ points }) => {
    const [{ x, y, data }] = points;
    const chart = charts[at.axis];
    moveStability({ speed: nearest(chart.speed, x), ...(data.type === "heatmap" && { damping: nearest(chart.damping, y) }) });
  });
}
