// The page as a whole.

function startTheme() {
  const themes = ["auto", "light", "dark"], button = byId("theme");
  let chosen = 0;
  const apply = () => {
    document.documentElement.dataset.theme = themes[chosen];
    button.textContent = `Theme: ${themes[chosen]}`;
  };
  button.addEventListener("click", () => {
    chosen = (chosen + 1) % themes.length;
    apply();
  });
  apply();
}

function startFigures(figures) {
  for (const place of document.querySelectorAll("[data-section]")) {
    const here = figures.filter((figure) => figure.section === place.dataset.section).map(makeFigure);
    place.append(...here.map(({ element }) => element));
    for (const { draw } of here) draw();
    if (here.length === 0) place.remove();
  }
}

// The frame's number in the trace, and which frames the page has. `reload` shows the chosen frame.
function startFrames(reload) {
  const slider = byId("frame"), { layers } = data;
  const tell = () => {
    const some = layers.length < data.frames ? `; this page has ${layers.length} of ${data.frames} frames` : "";
    byId("frame-text").textContent = `${currentFrame().frame}${some}`;
  };
  slider.max = layers.length - 1;
  slider.value = layers.findIndex((frame) => frame.frame === data.shown);
  byId("frames").hidden = data.frames === 1;
  slider.disabled = layers.length === 1;
  slider.addEventListener("input", () => {
    tell();
    reload();
  });
  tell();
}

const data = JSON.parse(byId("data").textContent);
document.querySelector("h1").append(data.scene, make("small", {}, " beampipe report"));
// What the report was made with. The hardware's description can be saved as a file.
function conditionText(name, text) {
  if (name === "command") return [make("code", {}, text)];
  if (name !== "hardware" || !data.hardware) return [text];
  const address = `data:application/json;charset=utf-8,${encodeURIComponent(data.hardware.text)}`;
  return [`${text} `, make("a", { href: address, download: data.hardware.file }, "save description")];
}

byId("conditions").append(...data.conditions.map(([name, text]) =>
  make("div", {}, make("dt", {}, name), make("dd", {}, ...conditionText(name, text)))));
const loaders = [];
const reload = () => Promise.all(loaders.map((load) => load()));

function startRun() {
  startCards(data.summary);
  startInspections(data.inspections);
  startFrames(reload);
  loaders.push(startPictures(), startMaps());
}

// Of several runs, which have no pictures here.
function startOverview() {
  document.querySelector("header").append(makeTable(data.runs));
  for (const id of ["implementations", "cost-note", "cards"]) byId(id).hidden = true;
  for (const section of ["stages", "pictures", "maps", "inspections"]) dropSection(section);
}

(data.runs ? startOverview : startRun)();
startFigures(data.figures);
byId("tables").append(...data.tables.map(makeTable));
startTheme();
startTips();
reload().then(() => { document.documentElement.dataset.ready = "yes"; });
