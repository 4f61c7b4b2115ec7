// The pixels whose histories were recorded. A click on one shows its picture and its history as text.

function inspectionLabel(pixel) {
  return `pixel ${pixel.x},${pixel.y} of ${pixel.technique}, frame ${pixel.frame}`;
}

// The recorded pixels of these techniques in the frame that is shown.
const recordedPixels = (techniques) =>
  data.inspections.filter((pixel) => pixel.frame === currentFrame().frame && techniques.includes(pixel.technique));

// The picture is an image, so nothing in it can run.
function makeInspection(pixel) {
  return make("figure", { id: "inspection" },
    make("figcaption", {}, make("b", {}, `The ${inspectionLabel(pixel)}`)),
    make("img", { src: `data:image/svg+xml,${encodeURIComponent(pixel.svg)}`, alt: `The ${inspectionLabel(pixel)}, enlarged` }),
    make("details", {}, make("summary", {}, "The history as text"), make("pre", { tabindex: "0" }, pixel.text)));
}

// Shows a history below what was clicked, and marks its line of the list.
function showInspection(place, pixel) {
  byId("inspection")?.remove();
  for (const other of document.querySelectorAll(".record")) other.replaceChildren();
  byId(place).replaceChildren(makeInspection(pixel));
  document.querySelectorAll("#inspection-list button").forEach((button, i) =>
    button.setAttribute("aria-pressed", String(data.inspections[i] === pixel)));
}

// Shows the history of a pixel of the frame that is shown, or says how to get it.
function showPixel(place, technique, { x, y }) {
  const { frame } = currentFrame();
  const found = recordedPixels([technique]).find((pixel) => pixel.x === x && pixel.y === y);
  if (found) {
    showInspection(place, found);
    return;
  }
  const what = `Pixel ${x},${y} of ${technique}, frame ${frame}, was not recorded. `;
  const command = `beampipe inspect ${data.trace}${frame > 0 ? ` --frame ${frame}` : ""} --pixel ${x},${y} -t ${technique}`;
  byId(place).replaceChildren(data.inspectable.includes(technique)
    ? make("p", {}, `${what}This shows it: `, make("code", {}, command))
    : make("p", {}, what, make("code", {}, "beampipe inspect"), ` has no histories of ${technique}.`));
}

function makeInspectionList(pixels) {
  const columns = [["pixel", "word"], ["technique", "word"], ["frame", "number"], ["error (RMS)", "number"], ["causes", "word"]];
  const rows = pixels.map((pixel) => {
    const button = make("button", { type: "button", "aria-pressed": "false" }, `${pixel.x}, ${pixel.y}`);
    button.addEventListener("click", () => showInspection("list-record", pixel));
    const cells = [pixel.technique, String(pixel.frame), numberText(pixel.error), pixel.causes || "–"];
    return make("tr", {}, make("th", { scope: "row" }, button), ...cells.map((text, i) =>
      make("td", { class: columns[i + 1][1], "data-title": columns[i + 1][0] }, text)));
  });
  const heads = columns.map(([title, kind]) => make("th", { scope: "col", class: kind }, title));
  const table = make("table", {}, make("thead", {}, make("tr", {}, ...heads)), make("tbody", {}, ...rows));
  return make("div", { class: "table" },
    make("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "Inspected pixels" }, table));
}

// Pages without recorded pixels have no such section.
function startInspections(pixels) {
  if (pixels.length > 0) byId("inspection-list").append(makeInspectionList(pixels));
  else dropSection("inspections");
}
