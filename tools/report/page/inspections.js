// The pixels whose histories were recorded. A click on one shows its picture and its history as text.

function inspectionLabel(pixel) {
  return `pixel ${pixel.x},${pixel.y} of ${pixel.technique}, frame ${pixel.frame}`;
}

// The picture is an image, so nothing in it can run.
function makeInspection(pixel) {
  return make("figure", { id: "inspection" },
    make("img", { src: `data:image/svg+xml,${encodeURIComponent(pixel.svg)}`, alt: `The ${inspectionLabel(pixel)}, enlarged` }),
    make("details", {}, make("summary", {}, "The history as text"), make("pre", { tabindex: "0" }, pixel.text)));
}

function makeInspections(pixels) {
  const shown = make("div", { "aria-live": "polite" });
  const rows = pixels.map((pixel) => {
    const button = make("button", { type: "button", "aria-pressed": "false" }, `${pixel.x}, ${pixel.y}`);
    button.addEventListener("click", () => {
      for (const other of rows) other.querySelector("button").setAttribute("aria-pressed", String(other.contains(button)));
      shown.replaceChildren(makeInspection(pixel));
    });
    return make("tr", {}, make("th", { scope: "row" }, button), make("td", { class: "word" }, pixel.technique),
      make("td", { class: "number" }, String(pixel.frame)), make("td", { class: "number" }, numberText(pixel.error)),
      make("td", { class: "word" }, pixel.causes || "–"));
  });
  const heads = [["pixel", "word"], ["technique", "word"], ["frame", "number"], ["error (RMS)", "number"],
    ["causes", "word"]].map(([title, kind]) => make("th", { scope: "col", class: kind }, title));
  const table = make("table", {}, make("thead", {}, make("tr", {}, ...heads)), make("tbody", {}, ...rows));
  return [make("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "Inspected pixels" }, table), shown];
}

// Pages without recorded pixels have no such section.
function startInspections(pixels) {
  if (pixels.length > 0) {
    byId("inspections").append(...makeInspections(pixels));
    return;
  }
  byId("inspections").remove();
  document.querySelector('nav a[href="#inspections"]').remove();
}
