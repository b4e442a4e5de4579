// What both charts share: layout, native controls, zoom buttons, and keys while the chart has the focus.
const touch = matchMedia("(pointer: coarse)").matches;
const config = { displayModeBar: false, responsive: true, doubleClick: false, scrollZoom: false };

function axisStyle(colours, more) {
  return {
    color: colours.ink, gridcolor: colours.line, linecolor: colours.quiet, zeroline: false, showline: true,
    ticks: "outside", tickcolor: colours.quiet, automargin: false, exponentformat: "none", ...more,
  };
}

const speedAxis = (colours, range, anchor) =>
  axisStyle(colours, { range, anchor, tickformat: "~f", title: { text: "pinion speed [rpm]", standoff: 6 } });

// What the reader has zoomed to stays when the chart is drawn anew.
const shown = (plot, axis, whole) => plot.layout?.[axis]?.range?.slice() ?? whole;

function baseLayout(colours, more) {
  const family = getComputedStyle(document.body).fontFamily;
  return {
    dragmode: touch ? false : "zoom", // a finger scrolls the page; the buttons zoom
    paper_bgcolor: colours.page, plot_bgcolor: colours.page, showlegend: false,
    font: { family, size: 12, color: colours.ink },
    hoverlabel: { bgcolor: colours.page, bordercolor: colours.ink, font: { color: colours.ink, size: 13, family } },
    ...more,
  };
}

// Name of a panel, above its left corner: legible at any width, where an upright title is not.
const panelName = (text, domainEnd, colours) => ({
  text, x: 0, xref: "paper", xanchor: "left", y: domainEnd, yref: "paper", yanchor: "bottom", yshift: 2,
  showarrow: false, font: { size: 12.5, color: colours.ink }, bgcolor: colours.page, borderpad: 1,
});

const vertical = (x, colour, dash, width = 1) => ({
  type: "line", xref: "x", yref: "paper", x0: x, x1: x, y0: 0, y1: 1, layer: "above",
  line: { color: colour, dash, width },
});

function options(select, names) {
  names.forEach((name, i) => select.add(new Option(name, String(i))));
}

function setRange(input, count, index, text) {
  input.max = String(count - 1);
  input.value = String(index);
  input.setAttribute("aria-valuetext", text);
  element(`${input.id}-value`).textContent = text;
}

// Zoom of the speed axis about a place, within the whole range; the event of the change draws the rest.
function zoom(plot, whole, factor, place) {
  const [low, high] = plot.layout.xaxis.range;
  const width = Math.min((high - low) * factor, whole[1] - whole[0]);
  const start = clamp(place - width / 2, whole[0], whole[1] - width);
  return Plotly.relayout(plot, { "xaxis.range": [start, start + width] });
}

// Keep the cursor inside a zoomed window.
function follow(plot, whole, place) {
  const [low, high] = plot.layout.xaxis.range;
  if (place < low || place > high) zoom(plot, whole, 1, place);
}

// At most one drawing a frame, however fast a slider moves.
function oncePerFrame(draw) {
  let asked = false;
  return () => {
    if (asked) return;
    asked = true;
    requestAnimationFrame(() => { asked = false; draw(); });
  };
}

// Draw again after a zoom by any means, a change of the window, or of light and dark.
function redraw(plot, draw, all) {
  plot.on("plotly_relayout", draw);
  plot.on("plotly_doubleclick", all);
  addEventListener("resize", draw);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
}

function buttons(parent, actions) {
  for (const [text, act] of actions) {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = text;
    button.addEventListener("click", act);
    parent.append(button);
  }
}

function keys(chart, actions) {
  chart.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const act = actions[event.key];
    if (!act) return;
    event.preventDefault();
    act(event.shiftKey ? 10 : 1);
  });
}
