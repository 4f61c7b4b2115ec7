// Two pictures with a divider, or their difference.

function startPictures() {
  const canvas = byId("compare"), slider = byId("divider"), names = data.layers[0].techniques.map((t) => t.technique);
  const mode = byId("mode"), exposure = byId("exposure");
  const sides = ["left", "right"].map((side) => ({
    technique: byId(`${side}-technique`), name: byId(`${side}-layer`), layer: null, title: side,
  }));
  let difference = null;
  const isSplit = () => mode.value === "split";
  const split = () => slider.value / 1000;
  const atDivider = (event) => isSplit() && Math.abs(event.offsetX - split() * canvas.clientWidth) < 12;
  const legends = () => {
    if (isSplit())
      return sides.filter((side) => side.name.value !== kPicture)
        .map((side) => makeMapLegend(`${side.title}: ${side.name.value} of ${side.technique.value}`, side.name.value));
    if (mode.value !== "signed") return [];
    const most = 2 ** -Number(exposure.value);
    return [makeLegend("left − right", "Mean of R, G and B. Red: the left picture is brighter.",
      (t) => d3.interpolateRdBu(1 - t), (t) => (2 * t - 1) * most)];
  };
  const load = async () => {
    for (const side of sides) {
      fillSelect(side.name, layerNames(side.technique.value), side.name.value);
      side.name.disabled = !isSplit();
    }
    slider.disabled = !isSplit();
    const ev = Number(exposure.value);
    byId("exposure-text").textContent = `${ev > 0 ? "+" : ""}${ev} EV`.replace("-", "−");
    const layers = await Promise.all(sides.map((side) =>
      loadLayer(side.technique.value, isSplit() ? side.name.value : kPicture, ev)));
    sides.forEach((side, i) => { side.layer = layers[i]; });
    difference = isSplit() ? null : makeDifference(layers[0], layers[1], mode.value, ev);
    byId("side-legends").replaceChildren(...legends());
    pane.onCursor();
    redrawAll();
  };
  const changeExposure = (by) => {
    exposure.value = Number(exposure.value) + by;
    load();
  };
  const sideAt = (x) => sides[isSplit() && x > split() * canvas.clientWidth ? 1 : 0];
  const pane = addPane({
    canvas,
    layer: () => sides[0].layer,
    keys: { e: () => changeExposure(0.5), E: () => changeExposure(-0.5) },
    filter: (event) => event.touches || event.type === "wheel" || !atDivider(event),
    marks: () => recordedPixels(sides.map((side) => side.technique.value)),
    onPick: (pixel, event) => showPixel("picture-record", (event ? sideAt(event.offsetX) : sides[0]).technique.value, pixel),
    paint: (context, drawLayer) => {
      if (difference) return drawLayer(difference);
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
      if (x >= sides[0].layer.width || y >= sides[0].layer.height) return;
      const texts = sides.map((side) =>
        `${side.technique.value}: ${difference ? kPicture : side.name.value} ${side.layer.valueAt(x, y)}`);
      if (difference) texts.push(`${kModes[mode.value].title}: ${difference.valueAt(x, y)}`);
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
  const other = names.includes("reference") ? "reference" : names[1] ?? names[0];
  sides.forEach((side, i) => {
    fillSelect(side.technique, names, i === 0 ? names[0] : other);
    side.technique.addEventListener("change", load);
    side.name.addEventListener("change", load);
  });
  fillSelect(mode, Object.entries(kModes).map(([name, { title }]) => [name, title]));
  mode.addEventListener("change", load);
  exposure.addEventListener("input", load);
  byId("map-log").addEventListener("change", load);
  return load;
}
