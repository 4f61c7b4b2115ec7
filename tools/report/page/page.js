// The page as a whole.

function cell(table, row, key) {
  return row[table.columns.findIndex((column) => column.key === key)];
}

function makeCard(title, technique, text) {
  return make("div", { class: "card" }, title, make("strong", {}, technique), text);
}

// The techniques with the smallest error: of all, and of those that need no more memory than msaa:8.
function makeCards(table) {
  const kBudget = 80;  // bytes per pixel
  const of = (row, key) => cell(table, row, key);
  const rivals = table.rows.filter((row) => of(row, "technique") !== "reference" && of(row, "rmse") !== undefined);
  const best = (rows) => rows.slice().sort((a, b) => of(a, "rmse") - of(b, "rmse"))[0];
  const winner = best(rivals), frugal = best(rivals.filter((row) => of(row, "peak_bytes_per_pixel") <= kBudget));
  const makeup = (row) => of(row, "a_buffer_peak_bytes") === 0 ? ""
    : ` (${numberText(of(row, "framebuffer_bytes_per_pixel"))} in the framebuffer, the rest in the A-buffer at its peak)`;
  const budget = `with at most ${kBudget} bytes per pixel, as many as 8× MSAA takes`;
  const cards = [];
  for (const [title, row] of winner === frugal ? [[`Most accurate of all, and ${budget}`, winner]]
    : [["Most accurate", winner], [`Most accurate ${budget}`, frugal]]) {
    if (!row) continue;
    const bound = { exact: "", "at least": "at least ", "at most": "at most " }[of(row, "emr_bound")];
    cards.push(makeCard(title, of(row, "technique"),
      `RMSE ${numberText(of(row, "rmse"))}, as good as MSAA with ${bound}${numberText(Math.round(of(row, "emr")))} samples. ` +
      `Takes ${numberText(of(row, "peak_bytes_per_pixel"))} bytes per pixel${makeup(row)}; such MSAA takes ` +
      `${bound}${numberText(Math.round(of(row, "msaa_bytes_per_pixel")))}.`));
  }
  return cards;
}

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

const data = JSON.parse(byId("data").textContent);
document.querySelector("h1").append(data.scene, make("small", {}, " beampipe report"));
byId("facts").append(...Object.entries(data.facts).map(([name, value]) =>
  make("div", {}, make("dt", {}, name), make("dd", {}, value))));
byId("summary").append(...makeCards(data.tables[0]));
byId("figures").append(...data.figures.map(makeFigure));
byId("tables").append(...data.tables.map(makeTable));
startInspections(data.inspections);
startTheme();
startTips();
Promise.all([startCompare(), startMaps()]).then(() => { document.documentElement.dataset.ready = "yes"; });
