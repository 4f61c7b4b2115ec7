// Heatmaps: one counter of all techniques on one scale.

function startMaps() {
  const select = byId("map-kind");
  const allKinds = new Set(data.layers.flatMap((frame) => frame.kinds.map((kind) => kind.name)));
  if (allKinds.size === 0) {
    dropSection("maps");
    return async () => {};
  }
  if (![...allKinds].includes("error")) document.querySelector("#maps h2").textContent = "What happens in each pixel?";
  const makePane = (technique) => {
    const value = make("span"), canvas = make("canvas", { tabindex: "0", "aria-label": `Heatmap of ${technique}` });
    const pane = { canvas, loaded: null, technique };
    pane.layer = () => pane.loaded;
    pane.paint = (context, drawLayer) => drawLayer(pane.loaded);
    pane.marks = () => recordedPixels([technique]);
    pane.onPick = (pixel) => showPixel("map-record", technique, pixel);
    pane.onCursor = () => {
      if (!pane.loaded) return;
      const at = view.cursor, isInside = at && at.x < pane.loaded.width && at.y < pane.loaded.height;
      value.textContent = isInside ? pane.loaded.valueAt(at.x, at.y)
        : `mean ${shortText(pane.loaded.mean)}, ${pane.loaded.low < 0 ? `${shortText(pane.loaded.low)} to` : "max"} ${shortText(pane.loaded.high)}`;
    };
    pane.element = make("figure", {}, make("figcaption", {}, make("b", { style: `--color: ${colorOf(technique)}` }, technique), value), canvas);
    return addPane(pane);
  };
  let panes = [];
  const load = async () => {
    fillSelect(select, currentFrame().kinds.map((kind) => kind.name), select.value);
    view.panes = view.panes.filter((pane) => !panes.includes(pane));
    panes = currentFrame().techniques.map((t) => t.technique).filter((name) => mapNamed(name, select.value)).map(makePane);
    byId("map-grid").replaceChildren(...panes.map((pane) => pane.element));
    byId("map-legend").replaceChildren(makeMapLegend(select.value, select.value));
    for (const pane of panes) {
      pane.loaded = await loadLayer(pane.technique, select.value);
      pane.onCursor();
      drawPane(pane);
    }
  };
  select.addEventListener("change", load);
  byId("map-log").addEventListener("change", load);
  return load;
}
