"use strict";
(() => {
const data = JSON.parse(document.getElementById("data").textContent);
const byId = (id) => document.getElementById(id);
const SVG = "http://www.w3.org/2000/svg";

// ---- charts: the value under the pointer, or under the arrow keys ----
const format = (value) => Math.abs(value) >= 100 ? value.toFixed(0) : String(+value.toPrecision(3));
const charts = {};
for (const figure of document.querySelectorAll("figure.chart")) {
  const chart = data.charts[figure.dataset.chart];
  if (!chart) continue;
  const svg = figure.querySelector("svg"), mark = figure.querySelector(".mark"), tip = figure.querySelector(".tip");
  const box = svg.viewBox.baseVal;
  const all = chart.series.flatMap((series) => series.points.map((point) => ({series, point})));
  let at = -1;
  const dot = (x, y) => {
    const circle = document.createElementNS(SVG, "circle");
    circle.setAttribute("cx", x); circle.setAttribute("cy", y); circle.setAttribute("r", 6);
    mark.replaceChildren(circle);
  };
  const show = (index) => {
    at = index;
    const {series, point: [px, py, x, y, note]} = all[index];
    dot(px, py);
    tip.textContent = `${series.name}: ${chart.x} ${format(x)}, ${chart.y} ${format(y)}${note ? ", " + note : ""}`;
    const width = svg.clientWidth, half = Math.min(tip.offsetWidth / 2, width / 2);
    tip.style.left = Math.max(half, Math.min(width - half, px / box.width * width)) + "px";
    tip.style.top = Math.max(tip.offsetHeight + 12, py / box.height * svg.clientHeight) + "px";
  };
  const hide = () => { at = -1; tip.textContent = ""; mark.replaceChildren(); if (figure.resting) dot(...figure.resting); };
  svg.addEventListener("pointermove", (event) => {
    const frame = svg.getBoundingClientRect();
    const x = (event.clientX - frame.left) / frame.width * box.width, y = (event.clientY - frame.top) / frame.height * box.height;
    let best = -1, nearest = Infinity;
    all.forEach(({point}, index) => { const d = (point[0] - x) ** 2 + (point[1] - y) ** 2; if (d < nearest) { nearest = d; best = index; } });
    if (best >= 0) show(best);
  });
  svg.addEventListener("pointerleave", hide);
  svg.addEventListener("blur", hide);
  svg.addEventListener("keydown", (event) => {
    const step = {ArrowRight: 1, ArrowLeft: -1, ArrowUp: 1, ArrowDown: -1}[event.key];
    if (!step || !all.length) return;
    event.preventDefault(); event.stopPropagation();
    show(at < 0 ? 0 : (at + step + all.length) % all.length);
  });
  charts[figure.dataset.chart] = {chart, rest: (x, y) => { figure.resting = [x, y]; if (at < 0) dot(x, y); }, figure};
}

// ---- films that were left behind when the page was sent ----
for (const film of document.querySelectorAll("video")) {
  const leaveOut = () => { film.closest("figure").hidden = true; };
  film.addEventListener("error", leaveOut);
  if (film.error) leaveOut();  // it may be known before this script runs
}

// ---- frames ----
const browser = data.browser;
if (!browser || !browser.frames.length) return;
const OBSTACLE = [230, 74, 25], HORIZON = [255, 214, 10];
const SIDES = [[66,92,16],[107,142,35],[172,196,116],[247,247,243],[146,190,222],[51,120,186],[16,66,124]];
const HEAT = [[0,0,4],[29,17,71],[81,18,124],[131,38,129],[183,55,121],[229,80,100],[251,135,97],[254,194,135],[252,253,191]];
const mix = (table, value) => {
  const place = Math.max(0, Math.min(1, value)) * (table.length - 1), low = Math.min(table.length - 2, Math.floor(place)), share = place - low;
  return table[low].map((c, i) => c + share * (table[low + 1][i] - c));
};
const state = {order: browser.frames.map((_, i) => i), place: 0, method: browser.methods[0], level: browser.methods[0].own, shown: 0};
const decoded = new Map();
const decode = (address) => {
  if (!decoded.has(address)) decoded.set(address, new Promise((resolve, reject) => {
    const image = new Image();
    image.onload = () => {
      const canvas = document.createElement("canvas");
      canvas.width = image.naturalWidth; canvas.height = image.naturalHeight;
      const context = canvas.getContext("2d", {willReadFrequently: true});
      context.drawImage(image, 0, 0);
      resolve(context.getImageData(0, 0, canvas.width, canvas.height));
    };
    image.onerror = reject;
    image.src = address;
  }));
  while (decoded.size > 60) decoded.delete(decoded.keys().next().value);
  return decoded.get(address);
};
const canvasOf = (width, height) => { const canvas = document.createElement("canvas"); canvas.width = width; canvas.height = height; return canvas; };
const paint = (canvas, photo, horizon, colour) => {
  const context = canvas.getContext("2d"), out = context.createImageData(photo.width, photo.height);
  for (let i = 0, n = photo.width * photo.height; i < n; i++) {
    const [r, g, b] = horizon && horizon.data[4 * i] > 127 ? HORIZON : colour(i);
    out.data[4 * i] = r; out.data[4 * i + 1] = g; out.data[4 * i + 2] = b; out.data[4 * i + 3] = 255;
  }
  context.putImageData(out, 0, 0);
};
const obstacles = (map, level) => {
  const {width, height} = map, over = new Uint8Array(width * height), kept = new Uint8Array(width * height);
  for (let i = 0; i < over.length; i++) over[i] = map.data[4 * i] > level;
  let count = 0;
  for (let v = 0; v < height; v++) for (let u = 0; u < width; u++) {
    const i = v * width + u;
    if (!over[i]) continue;
    let near = 0;
    for (let y = Math.max(0, v - 1); y <= Math.min(height - 1, v + 1) && !near; y++)
      for (let x = Math.max(0, u - 1); x <= Math.min(width - 1, u + 1); x++)
        if ((x !== u || y !== v) && over[y * width + x]) { near = 1; break; }
    kept[i] = near; count += near;
  }
  return {kept, share: count / over.length};
};
const swatch = (colour, name) => `<span><i style="background:${colour}"></i>${name}</span>`;
const LEGENDS = {
  image: swatch("rgb(255,214,10)", "horizon"),
  side: swatch("rgb(107,142,35)", "looks below") + swatch("rgb(51,120,186)", "looks above"),
  score: swatch("rgb(29,17,71)", "sure") + swatch("rgb(252,253,191)", "unsure"),
  map: swatch("rgb(230,74,25)", "obstacle"),
  ranges: swatch("rgb(107,142,35)", "free") + swatch("rgb(230,74,25)", "near") + swatch("rgb(255,214,10)", "far") + swatch("rgb(64,156,255)", "heading") + "<span>&lt;1.3: at most that far, its foot is out of view</span>",
  truth: swatch("rgb(107,142,35)", "floor") + swatch("rgb(230,74,25)", "obstacle") + swatch("rgb(33,102,172)", "ceiling or sky"),
};
const cell = (name, element, legend, alt) => {
  const figure = document.createElement("figure"); figure.className = "cell"; figure.dataset.cell = legend;
  element.setAttribute("role", "img"); element.setAttribute("aria-label", alt); element.tabIndex = 0;
  if (element.tagName === "IMG") element.alt = alt;
  const caption = document.createElement("figcaption");
  const title = document.createElement("span"); title.textContent = name + " ";
  const key = document.createElement("span"); key.className = "swatches"; key.innerHTML = LEGENDS[legend];
  caption.append(title, key); figure.append(element, caption);
  const enlarge = () => {
    let large;
    if (element.tagName === "CANVAS") { large = canvasOf(element.width, element.height); large.getContext("2d").drawImage(element, 0, 0); } else large = element.cloneNode();
    byId("large").replaceChildren(large); byId("zoom").showModal();
  };
  element.addEventListener("click", enlarge);
  element.addEventListener("keydown", (event) => { if (event.key === "Enter") enlarge(); });
  return figure;
};
const percent = (value) => value == null ? "-" : (100 * value).toFixed(1) + " %";
let live = null;
const drawMap = () => {
  const {method, level} = state;
  byId("threshold-value").textContent = method.levels[level].toFixed(3);
  byId("threshold").setAttribute("aria-valuetext", `${method.score} over ${method.levels[level].toFixed(3)}`);
  let words = level === method.own ? "At the paper's threshold" : `At ${method.levels[level].toFixed(3)}`;
  if (live) {
    const {kept, share} = obstacles(live.score, level);
    paint(live.canvas, live.photo, live.horizon, (i) => {
      const grey = 40 + 0.8 * (0.299 * live.photo.data[4 * i] + 0.587 * live.photo.data[4 * i + 1] + 0.114 * live.photo.data[4 * i + 2]);
      return kept[i] ? OBSTACLE.map((c) => grey * 0.25 + c * 0.75) : [grey, grey, grey];
    });
    live.canvas.setAttribute("aria-label", `Obstacle map: ${percent(share)} of the picture is obstacle at this threshold.`);
    words += `: ${percent(share)} of this picture is called obstacle`;
  }
  if (method.tpr) {
    words += `; over all scored frames ${percent(method.tpr[level])} of the obstacle pixels are found and ${percent(method.fpr[level])} of the floor is called obstacle.`;
    const roc = charts.roc;
    if (roc) {
      const [x0, y0, x1, y1] = roc.chart.frame;
      roc.rest(x0 + method.fpr[level] * (x1 - x0), y0 + method.tpr[level] * (y1 - y0));
    }
  } else words += ".";
  byId("rates").textContent = words;
};
const show = async () => {
  const frame = browser.frames[state.order[state.place]], own = frame.maps[state.method.key], ticket = ++state.shown;
  byId("frame").value = state.place;
  byId("frame").setAttribute("aria-valuetext", frame.name);
  const auc = own && own.auc != null ? `, AUC of this frame ${own.auc.toFixed(3)}` : "", words = frame.words ? ". " + frame.words[0].toUpperCase() + frame.words.slice(1) : "";
  byId("frame-title").textContent = `${state.place + 1} of ${state.order.length}: ${frame.name}${frame.time == null ? "" : ", " + frame.time.toFixed(2) + " s"}${auc}${words}`;
  const [photo, horizon, score, side] = await Promise.all([decode(frame.photo), frame.horizon ? decode(frame.horizon) : null, own ? decode(own.score) : null, own ? decode(own.side) : null]);
  if (ticket !== state.shown) return;
  const make = () => canvasOf(photo.width, photo.height), cells = [];
  const image = make();
  paint(image, photo, horizon, (i) => [photo.data[4 * i], photo.data[4 * i + 1], photo.data[4 * i + 2]]);
  cells.push(cell("image", image, "image", `Camera image of ${frame.name}${horizon ? " with the horizon as a yellow line" : ""}.`));
  live = null;
  if (own) {
    const map = make();
    live = {canvas: map, photo, horizon, score};
    const paper = [cell(`${state.method.score} over threshold (the paper's)`, map, "map", "Obstacle map of the paper.")];
    const uncertainty = make(), span = state.method.levels.length;
    const heat = Array.from({length: span + 1}, (_, k) => mix(HEAT, state.method.values[k]));
    paint(uncertainty, photo, horizon, (i) => heat[score.data[4 * i]] || HEAT[8]);
    paper.push(cell(`${state.method.score} (the paper's)`, uncertainty, "score", `Map of the ${state.method.score}: bright where the learner is unsure.`));
    const sides = make(), shade = Array.from({length: 256}, (_, k) => mix(SIDES, k / 255));
    paint(sides, photo, horizon, (i) => shade[side.data[4 * i]]);
    if (own.ranges) { const img = new Image(); img.src = own.ranges; cells.push(cell("what is flown", img, "ranges", "Free, blocked and unknown bearings drawn into the image. " + (frame.words || ""))); }
    cells.push(cell("classification", sides, "side", "What looks like below the horizon in green, like above in blue."), ...paper);
  }
  if (frame.truth) { const img = new Image(); img.src = frame.truth; cells.push(cell("truth", img, "truth", "Truth: floor green, obstacles orange, ceiling or sky blue.")); }
  byId("cells").replaceChildren(...cells);
  drawMap();
};
const go = (place) => { state.place = Math.max(0, Math.min(state.order.length - 1, place)); show(); };
const setLevel = (level) => { state.level = Math.max(0, Math.min(state.method.levels.length - 1, level)); byId("threshold").value = state.level; drawMap(); };
const reorder = () => {
  const all = browser.frames.map((_, i) => i), kind = byId("order").value;
  const badness = (i) => { const own = browser.frames[i].maps[state.method.key]; return own && own.auc != null ? own.auc : 2; };
  state.order = kind === "all" ? all : all.filter((i) => badness(i) < 2).sort((a, b) => badness(a) - badness(b)).slice(0, kind === "ten" ? 10 : undefined);
  if (!state.order.length) state.order = all;
  byId("frame").max = state.order.length - 1;
  go(0);
};
byId("order").addEventListener("change", reorder);
byId("method").addEventListener("change", (event) => {
  state.method = browser.methods.find((one) => one.key === event.target.value);
  state.level = state.method.own;
  byId("threshold").max = state.method.levels.length - 1; byId("threshold").value = state.level;
  byId("order").value === "all" ? show() : reorder();
});
byId("previous").addEventListener("click", () => go(state.place - 1));
byId("next").addEventListener("click", () => go(state.place + 1));
byId("frame").addEventListener("input", (event) => go(+event.target.value));
byId("threshold").addEventListener("input", (event) => setLevel(+event.target.value));
byId("own-threshold").addEventListener("click", () => setLevel(state.method.own));
byId("close").addEventListener("click", () => byId("zoom").close());
document.addEventListener("keydown", (event) => {
  if (event.altKey || event.ctrlKey || event.metaKey || /^(INPUT|SELECT|VIDEO)$/.test(event.target.tagName) || event.target.closest("svg, .scroll")) return;
  const key = event.key;
  if (key === "ArrowRight") go(state.place + 1);
  else if (key === "ArrowLeft") go(state.place - 1);
  else if (byId("browser").contains(event.target) && key === "ArrowUp") setLevel(state.level + 1);
  else if (byId("browser").contains(event.target) && key === "ArrowDown") setLevel(state.level - 1);
  else if (key === "Home" && byId("browser").contains(event.target)) go(0);
  else if (key === "End" && byId("browser").contains(event.target)) go(state.order.length - 1);
  else return;
  event.preventDefault();
});
byId("threshold").max = state.method.levels.length - 1;
byId("threshold").value = state.level;
byId("browser").tabIndex = -1;
reorder();
})();
