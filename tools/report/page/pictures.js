// Pictures and heatmaps: layers of pixels on canvases that share one view.

// ---- Layers ----

const kPicture = "picture";
const techniqueNamed = (name) => data.layers.techniques.find((technique) => technique.technique === name);
const mapNamed = (technique, kind) => techniqueNamed(technique).maps.find((map) => map.name === kind);
const layerNames = (technique) => [kPicture, ...data.layers.kinds.map((kind) => kind.name)
  .filter((kind) => mapNamed(technique, kind))];

// The pixels of an image: { width, height, rgba }.
async function decode(url) {
  const image = new Image();
  image.src = url;
  await image.decode();
  const canvas = make("canvas", { width: image.naturalWidth, height: image.naturalHeight });
  const context = canvas.getContext("2d", { willReadFrequently: true });
  context.drawImage(image, 0, 0);
  return { width: canvas.width, height: canvas.height,
           rgba: context.getImageData(0, 0, canvas.width, canvas.height).data };
}

const decoded = new Map();
function decodeOnce(url) {
  if (!decoded.has(url)) decoded.set(url, decode(url));
  return decoded.get(url);
}

const isLogarithmic = () => byId("map-log").checked;

// The scale of a kind of map, which is the same for all techniques. part(value) is from 0 to 1, value(part) is its
// inverse, and ramp(part) is a colour.
function scaleOf(kind) {
  const maps = data.layers.techniques.flatMap((technique) => technique.maps.filter((map) => map.name === kind));
  const low = d3.min(maps, (map) => map.low), high = d3.max(maps, (map) => map.high);
  const linear = { low, high, ramp: low < 0 ? (t) => d3.interpolateRdBu(1 - t) : d3.interpolateInferno };
  if (low < 0) linear.low = -(linear.high = Math.max(-low, high));  // puts 0 in the middle
  const scale = isLogarithmic() && low >= 0
    ? d3.scaleSymlog().constant(maps.every((map) => map.step === 1) ? 1 : high / 1000)
    : d3.scaleLinear();
  scale.domain([linear.low, linear.high > linear.low ? linear.high : linear.low + 1]).range([0, 1]);
  return { ...linear, part: scale, value: scale.invert };
}

// A technique's picture or map: { width, height, canvas, valueAt(x, y) }. valueAt returns text.
async function loadLayer(technique, name) {
  const map = mapNamed(technique, name);
  const { width, height, rgba } = await decodeOnce(map ? map.png : techniqueNamed(technique).picture);
  const pixels = new ImageData(new Uint8ClampedArray(rgba), width, height);
  const numberAt = (i) => map.low + map.step * (256 * rgba[4 * i] + rgba[4 * i + 1]);
  let sum = 0;
  if (map) {
    const scale = scaleOf(name), colors = new Map();
    for (let i = 0; i < width * height; ++i) {
      const value = numberAt(i);
      sum += value;
      if (!colors.has(value)) colors.set(value, d3.rgb(scale.ramp(scale.part(value))));
      const { r, g, b } = colors.get(value);
      pixels.data.set([r, g, b], 4 * i);
    }
  }
  const canvas = make("canvas", { width, height });
  canvas.getContext("2d").putImageData(pixels, 0, 0);
  const valueAt = (x, y) => {
    const i = y * width + x;
    if (map) return numberText(numberAt(i));
    return `sRGB ${rgba[4 * i]} ${rgba[4 * i + 1]} ${rgba[4 * i + 2]}`;
  };
  return { width, height, canvas, valueAt, mean: sum / (width * height), high: map?.high };
}

function makeLegend(title, kind) {
  const { unit, definition } = data.layers.kinds.find((known) => known.name === kind);
  const scale = scaleOf(kind), stops = d3.range(0, 1.01, 0.05).map((t) => scale.ramp(t));
  const ticks = d3.range(0, 1.01, 0.25).map((t) => make("span", {}, numberText(Number(scale.value(t).toPrecision(3)))));
  return make("div", { class: "legend" },
    make("div", {}, make("b", {}, title), " ",
      make("span", { class: "unit" }, `${definition}${unit && ` Unit: ${unit}.`}`)),
    make("div", { class: "ramp", style: `background: linear-gradient(to right, ${stops.join(", ")})` }),
    make("div", { class: "ticks" }, ...ticks));
}

// ---- The view that all canvases share ----

const kLargestPixel = 64;  // the largest size of a picture's pixel on the screen, in CSS pixels
const view = { k: 1, x: 0, y: 0, panes: [], cursor: null };  // x, y: the picture's corner, in widths of the canvas

function redrawAll() {
  if (view.waiting) return;
  view.waiting = true;
  requestAnimationFrame(() => {
    view.waiting = false;
    for (const pane of view.panes) drawPane(pane);
  });
}

// A pane is { canvas, size(), paint(context, drawLayer), filter(event), onCursor() }; size() returns a layer with the
// pane's aspect ratio.
function drawPane(pane) {
  const { canvas } = pane, layer = pane.layer(), width = canvas.clientWidth;
  if (!layer || width === 0) return;
  const height = Math.round(width * layer.height / layer.width), ratio = window.devicePixelRatio;
  canvas.style.aspectRatio = `${layer.width} / ${layer.height}`;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  const context = canvas.getContext("2d");
  const scale = view.k * canvas.width / layer.width;  // device pixels per pixel of the picture
  context.imageSmoothingEnabled = scale < 1;
  const drawLayer = ({ canvas: source }) => {
    context.setTransform(scale, 0, 0, scale, view.x * canvas.width, view.y * canvas.width);
    context.drawImage(source, 0, 0);
  };
  pane.paint(context, drawLayer);
  if (view.cursor) {
    context.setTransform(scale, 0, 0, scale, view.x * canvas.width, view.y * canvas.width);
    context.lineWidth = 2 * ratio / scale;
    context.strokeStyle = "#fff";
    context.strokeRect(view.cursor.x, view.cursor.y, 1, 1);
    context.lineWidth = ratio / scale;
    context.strokeStyle = "#000";
    context.strokeRect(view.cursor.x, view.cursor.y, 1, 1);
  }
  pane.zoom.extent([[0, 0], [width, height]]).translateExtent([[0, 0], [width, height]])
    .scaleExtent([1, Math.max(1, kLargestPixel * layer.width / width)]);
  canvas.__zoom = d3.zoomIdentity.translate(view.x * width, view.y * width).scale(view.k);
  canvas.style.touchAction = view.k > 1 ? "none" : "pan-y";
}

function setCursor(cursor) {
  view.cursor = cursor;
  for (const pane of view.panes) pane.onCursor();
  redrawAll();
}

// The pixel under a place on the canvas, or null.
function pixelAt(pane, [px, py]) {
  const layer = pane.layer(), width = pane.canvas.clientWidth;
  if (!layer) return null;
  const x = Math.floor((px / width - view.x) / view.k * layer.width);
  const y = Math.floor((py / width - view.y) / view.k * layer.width);
  return x >= 0 && y >= 0 && x < layer.width && y < layer.height ? { x, y } : null;
}

function moveCursor(pane, dx, dy) {
  const layer = pane.layer(), from = view.cursor ?? { x: layer.width >> 1, y: layer.height >> 1 };
  const x = Math.max(0, Math.min(layer.width - 1, from.x + dx)), y = Math.max(0, Math.min(layer.height - 1, from.y + dy));
  const width = pane.canvas.clientWidth, center = [(x + 0.5) * width / layer.width, (y + 0.5) * width / layer.width];
  const transform = d3.zoomTransform(pane.canvas), [px, py] = transform.apply(center);
  const isInView = px >= 0 && py >= 0 && px <= width && py <= pane.canvas.clientHeight;
  if (!isInView) pane.zoom.translateTo(d3.select(pane.canvas), ...center);
  setCursor({ x, y });
}

// Zooms around the cursor, or around the middle if there is no cursor.
function zoomBy(pane, factor) {
  const layer = pane.layer(), width = pane.canvas.clientWidth;
  const around = view.cursor && d3.zoomTransform(pane.canvas)
    .apply([(view.cursor.x + 0.5) * width / layer.width, (view.cursor.y + 0.5) * width / layer.width]);
  pane.zoom.scaleBy(d3.select(pane.canvas), factor, around ?? undefined);
}

const zoomToFit = (pane) => pane.zoom.transform(d3.select(pane.canvas), d3.zoomIdentity);

function pressKey(pane, event) {
  const step = event.shiftKey ? 10 : 1;
  const actions = {
    ArrowLeft: () => moveCursor(pane, -step, 0), ArrowRight: () => moveCursor(pane, step, 0),
    ArrowUp: () => moveCursor(pane, 0, -step), ArrowDown: () => moveCursor(pane, 0, step),
    "+": () => zoomBy(pane, 1.5), "=": () => zoomBy(pane, 1.5), "-": () => zoomBy(pane, 1 / 1.5),
    0: () => zoomToFit(pane),
  };
  if (!actions[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
  event.preventDefault();
  actions[event.key]();
}

function addPane(pane) {
  const { canvas } = pane;
  // The wheel and one finger scroll the page until the picture has been clicked or zoomed.
  const mayZoom = (event) => event.type === "wheel" ? event.ctrlKey || document.activeElement === canvas
    : event.touches ? event.touches.length > 1 || view.k > 1 : event.button === 0;
  pane.zoom = d3.zoom().filter(() => mayZoom(d3.event) && (pane.filter?.(d3.event) ?? true)).on("zoom", () => {
    const { k, x, y } = d3.event.transform, width = canvas.clientWidth;
    Object.assign(view, { k, x: x / width, y: y / width });
    redrawAll();
  });
  d3.select(canvas).call(pane.zoom).on("dblclick.zoom", null);
  canvas.addEventListener("pointermove", (event) => {
    const pixel = pixelAt(pane, [event.offsetX, event.offsetY]);
    if (pixel) setCursor(pixel);
  });
  canvas.addEventListener("keydown", (event) => pressKey(pane, event));
  new ResizeObserver(() => requestAnimationFrame(redrawAll)).observe(canvas);
  view.panes.push(pane);
  return pane;
}

// ---- Two pictures with a divider ----

function startCompare() {
  const canvas = byId("compare"), slider = byId("divider"), names = data.layers.techniques.map((t) => t.technique);
  const sides = ["left", "right"].map((side) => ({
    technique: byId(`${side}-technique`), name: byId(`${side}-layer`), layer: null, title: side,
  }));
  const split = () => slider.value / 1000;
  const atDivider = (event) => Math.abs(event.offsetX - split() * canvas.clientWidth) < 12;
  const load = async () => {
    for (const side of sides) fillSelect(side.name, layerNames(side.technique.value), side.name.value);
    const layers = await Promise.all(sides.map((side) => loadLayer(side.technique.value, side.name.value)));
    sides.forEach((side, i) => { side.layer = layers[i]; });
    byId("side-legends").replaceChildren(...sides.filter((side) => side.name.value !== kPicture)
      .map((side) => makeLegend(`${side.title}: ${side.name.value} of ${side.technique.value}`, side.name.value)));
    pane.onCursor();
    redrawAll();
  };
  const pane = addPane({
    canvas,
    layer: () => sides[0].layer,
    filter: (event) => event.touches || event.type === "wheel" || !atDivider(event),
    paint: (context, drawLayer) => {
      const middle = Math.round(split() * canvas.width);
      [[0, middle], [middle, canvas.width]].forEach(([from, to], i) => {
        context.save();
        context.beginPath();
        context.rect(from, 0, to - from, canvas.height);
        context.clip();
        drawLayer(sides[i].layer);
        context.restore();
      });
      context.setTransform(1, 0, 0, 1, 0, 0);
      context.fillStyle = "#fff";
      context.fillRect(middle - window.devicePixelRatio, 0, 2 * window.devicePixelRatio, canvas.height);
    },
    onCursor: () => {
      if (!view.cursor || sides.some((side) => !side.layer)) return;
      const { x, y } = view.cursor;
      const texts = sides.map((side) =>
        `${side.technique.value}: ${side.name.value} ${side.layer.valueAt(x, y)}`);
      byId("readout").textContent = `pixel (${x}, ${y})  ·  ${texts.join("  ·  ")}`;
    },
  });
  let dragging = false;
  canvas.addEventListener("pointerdown", (event) => {
    dragging = atDivider(event);
    if (dragging) canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    canvas.style.cursor = dragging || atDivider(event) ? "ew-resize" : "crosshair";
    if (!dragging) return;
    slider.value = 1000 * event.offsetX / canvas.clientWidth;
    redrawAll();
  });
  canvas.addEventListener("pointerup", () => { dragging = false; });
  slider.addEventListener("input", redrawAll);
  byId("zoom-in").addEventListener("click", () => zoomBy(pane, 2));
  byId("zoom-out").addEventListener("click", () => zoomBy(pane, 0.5));
  byId("zoom-fit").addEventListener("click", () => zoomToFit(pane));
  sides.forEach((side, i) => {
    fillSelect(side.technique, names, i === 0 ? names[0] : names.includes("reference") ? "reference" : names[1]);
    side.technique.addEventListener("change", load);
    side.name.addEventListener("change", load);
  });
  byId("map-log").addEventListener("change", load);
  return load();
}

// ---- Heatmaps of all techniques ----

function startMaps() {
  const kinds = data.layers.kinds.map((kind) => kind.name), select = byId("map-kind");
  if (kinds.length === 0) {
    byId("maps").hidden = true;
    return;
  }
  fillSelect(select, kinds);
  const makePane = (technique) => {
    const value = make("span"), canvas = make("canvas", { tabindex: "0", "aria-label": `Heatmap of ${technique}` });
    const pane = { canvas, loaded: null, technique };
    pane.layer = () => pane.loaded;
    pane.paint = (context, drawLayer) => drawLayer(pane.loaded);
    pane.onCursor = () => {
      if (!pane.loaded) return;
      value.textContent = view.cursor ? pane.loaded.valueAt(view.cursor.x, view.cursor.y)
        : `mean ${numberText(Number(pane.loaded.mean.toPrecision(3)))}, max ${numberText(Number(pane.loaded.high.toPrecision(3)))}`;
    };
    pane.element = make("figure", {}, make("figcaption", {}, make("b", {}, technique), value), canvas);
    return addPane(pane);
  };
  let panes = [];
  const load = async () => {
    view.panes = view.panes.filter((pane) => !panes.includes(pane));
    panes = data.layers.techniques.map((t) => t.technique).filter((name) => mapNamed(name, select.value)).map(makePane);
    byId("map-grid").replaceChildren(...panes.map((pane) => pane.element));
    byId("map-legend").replaceChildren(makeLegend(select.value, select.value));
    for (const pane of panes) {
      pane.loaded = await loadLayer(pane.technique, select.value);
      pane.onCursor();
      drawPane(pane);
    }
  };
  select.addEventListener("change", load);
  byId("map-log").addEventListener("change", load);
  return load();
}
