// The view that all canvases share: they move and zoom together, and read the same pixel.

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

function strokePixel(context, { x, y }, widths, colors, grown = 0) {
  widths.forEach((width, i) => {
    context.lineWidth = width;
    context.strokeStyle = colors[i];
    context.strokeRect(x - grown, y - grown, 1 + 2 * grown, 1 + 2 * grown);
  });
}

// A pane is { canvas, layer(), paint(context, drawLayer), filter(event), onCursor(), onPick(pixel, event), marks() };
// layer() has the pane's aspect ratio, and marks() are the pixels to mark.
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
  const place = () => context.setTransform(scale, 0, 0, scale, view.x * canvas.width, view.y * canvas.width);
  const drawLayer = ({ canvas: source }) => {
    place();
    context.drawImage(source, 0, 0);
  };
  pane.paint(context, drawLayer);
  place();
  const fine = ratio / scale;
  for (const mark of pane.marks()) strokePixel(context, mark, [4 * fine, 2 * fine], ["#000", "#ffd60a"], Math.max(0, 4 * fine - 0.5));
  if (view.cursor) strokePixel(context, view.cursor, [2 * fine, fine], ["#fff", "#000"]);
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
    Enter: () => view.cursor && pane.onPick(view.cursor, null),
    "+": () => zoomBy(pane, 1.5), "=": () => zoomBy(pane, 1.5), "-": () => zoomBy(pane, 1 / 1.5),
    0: () => zoomToFit(pane), ...pane.keys,
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
  canvas.addEventListener("click", (event) => {
    const pixel = pixelAt(pane, [event.offsetX, event.offsetY]);
    if (pixel) pane.onPick(pixel, event);
  });
  canvas.addEventListener("keydown", (event) => pressKey(pane, event));
  new ResizeObserver(() => requestAnimationFrame(redrawAll)).observe(canvas);
  view.panes.push(pane);
  return pane;
}
