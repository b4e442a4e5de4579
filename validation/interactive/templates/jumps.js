// Jump map over speed and torque: the largest stable motion, how many there are, and where the pair jumps.
const jumpMap = page.jumps;

function jumpWords(i, j) {
  const count = jumpMap.motions[i][j];
  return [
    `${plain(jumpMap.speed[j], 5)} rpm, ${plain(jumpMap.torque[i], 4)} N m`,
    `largest motion ${plain(jumpMap.rms[i][j], 4)} µm rms, tooth load up to ${plain(jumpMap.load[i][j], 4)} N`,
    count ? `${count} stable motion${count > 1 ? "s side by side" : ""}` : "beats, chaos or several mesh cycles",
    jumpMap.kept[i][j] ? "contact kept" : "contact loss",
  ];
}

function jumpTraces(colours) {
  const { speed, torque, rms, motions } = jumpMap;
  const each = (pick) => torque.map((_, i) => speed.map((_, j) => pick(i, j)));
  const dots = { x: [], y: [] };
  motions.forEach((row, i) => row.forEach((count, j) => {
    if (count > 1) { dots.x.push(speed[j]); dots.y.push(torque[i]); }
  }));
  const shown = rms.flat().filter((v) => v > 0).map(Math.log10), low = Math.min(...shown), high = Math.max(...shown);
  const ticks = Array.from({ length: 5 }, (_, k) => low + ((high - low) * k) / 4);
  const marks = ({ speed: x, torque: y }, symbol, words) => ({
    type: "scatter", mode: "markers", x, y, marker: { symbol, size: 9, color: "#ffffff", line: { color: "#000000", width: 1.2 } },
    hovertemplate: `jump on running ${words}, %{x:.5~r} rpm, %{y:.4~r} N m<extra></extra>`,
  });
  return [
    {
      type: "heatmap", x: speed, y: torque, z: each((i, j) => (rms[i][j] > 0 ? Math.log10(rms[i][j]) : null)),
      colorscale: STABLE.concat(UNSTABLE).map((c, k, all) => [k / (all.length - 1), c]), zsmooth: false,
      customdata: each((i, j) => jumpWords(i, j)),
      hovertemplate: `${[0, 1, 2, 3].map((k) => `%{customdata[${k}]}`).join("<br>")}<extra></extra>`,
      colorbar: {
        title: { text: "rms [µm]", side: "top" }, thickness: 10, outlinewidth: 0, tickcolor: colours.quiet,
        tickvals: ticks, ticktext: ticks.map((v) => plain(10 ** v, 2)),
      },
    },
    { type: "scatter", mode: "markers", ...dots, hoverinfo: "skip", marker: { size: 3, color: "#000000" } },
    marks(jumpMap.at[0], "triangle-up", "up"), marks(jumpMap.at[1], "triangle-down", "down"),
    {
      type: "scatter", mode: "markers", x: [page.point.speed], y: [jumpMap.own], hoverinfo: "skip",
      marker: { size: 11, symbol: "circle", color: "#ffffff", line: { color: "#000000", width: 2 } },
    },
  ];
}

function drawJumps() {
  const colours = theme(), { speed, torque } = jumpMap, half = Math.sqrt(torque[1] / torque[0]);
  const ends = [torque[0] / half, torque.at(-1) * half].map(Math.log10);
  return Plotly.react(element("jumps-plot"), jumpTraces(colours), baseLayout(colours, {
    dragmode: false, margin: { l: 64, r: 14, t: 24, b: 48 }, hovermode: "closest",
    xaxis: { ...speedAxis(colours, [speed[0], speed.at(-1)], "y"), fixedrange: true },
    yaxis: axisStyle(colours, {
      type: "log", range: ends, fixedrange: true, tickvals: torque, ticktext: torque.map((v) => plain(v, 3)),
    }),
    annotations: [panelName("pinion torque [N m]", 1, colours)],
  }), config);
}

async function startJumps() {
  if (!jumpMap) return;
  const plot = element("jumps-plot"), row = nearest(jumpMap.torque, jumpMap.own);
  const say = (i, j) => { element("jumps-text").textContent = `${jumpWords(i, j).join("; ")}.`; };
  await drawJumps();
  say(row, nearest(jumpMap.speed, page.point.speed));
  const again = oncePerFrame(drawJumps);
  addEventListener("resize", again);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", again);
  plot.on("plotly_hover", ({ points: [{ pointIndex }] }) => { if (Array.isArray(pointIndex)) say(...pointIndex); });
}
