// Data of the page and how numbers are written. Text reaches the page only as text, never as markup.
const page = JSON.parse(document.getElementById("page-data").textContent);
const element = (id) => document.getElementById(id);

function buffer(text) {
  return Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;
}

// Rows of one slice of an array (slices, rows, columns); views, not copies.
function rows(flat, slice, rowCount, columnCount) {
  const start = slice * rowCount * columnCount;
  return Array.from({ length: rowCount }, (_, i) =>
    flat.subarray(start + i * columnCount, start + (i + 1) * columnCount));
}

const plain = (value, digits = 6) => (value === null ? "–" : String(Number(value.toPrecision(digits))));
const rpm = (value) => `${plain(value)} rpm`;
const clamp = (value, low, high) => Math.min(Math.max(value, low), high);

function nearest(values, wanted) {
  let best = 0;
  values.forEach((value, i) => {
    if (Math.abs(value - wanted) < Math.abs(values[best] - wanted)) best = i;
  });
  return best;
}

// Colours of the style sheet, which follow the reader's light or dark setting.
function theme() {
  const style = getComputedStyle(document.documentElement);
  return Object.fromEntries(
    ["ink", "quiet", "line", "page", "soft", "curve", "other", "bad"].map((name) =>
      [name, style.getPropertyValue(`--${name}`).trim()]));
}
