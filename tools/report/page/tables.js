// Tables. A click on a column's title sorts by it, and pointing at it shows what the column means. If a table has views,
// only the columns of one view are shown at a time, so that it fits the page.

// What a cell is sorted by. In place of a value it may be { text, value, href }: what is read, the number that it stands
// for, and a file beside the page.
const valueOf = (cell) => cell?.value ?? cell?.text ?? cell;

function compareCells(a, b) {
  if (a === null || b === null) return (a === null) - (b === null);  // empty cells come last
  return typeof a === "number" ? a - b : String(a).localeCompare(String(b));
}

function sortTable(heads, body, rows, column) {
  const head = heads[column];
  const descending = head.getAttribute("aria-sort") === "ascending";
  for (const other of heads) other.removeAttribute("aria-sort");
  head.setAttribute("aria-sort", descending ? "descending" : "ascending");
  const sorted = rows.slice().sort((a, b) => compareCells(a.cells[column], b.cells[column]));
  if (descending) sorted.reverse().sort((a, b) => (a.cells[column] === null) - (b.cells[column] === null));
  body.replaceChildren(...sorted.map((row) => row.element));
}

// How the numbers of each column are read: { size, unit }. `isWord`: some of its cells are texts. Columns of a view that
// count the same are read in one unit, unless one has far smaller numbers. The reference, whose counts are much larger,
// has no say in it.
function columnFormats(table) {
  const rows = table.rows.filter((row) => row[0] !== "reference");
  const columns = table.columns.map(({ unit, view }, i) => {
    const cells = rows.map((row) => valueOf(row[i])), isWord = cells.some((cell) => cell !== null && typeof cell !== "number");
    return { unit, view, isWord, most: d3.max(cells.filter((cell) => typeof cell === "number"), Math.abs) ?? 0 };
  });
  return columns.map(({ unit, view, isWord, most }) => {
    const alike = columns.filter((other) => other.unit === unit && other.view === view && other.most < 100 * most);
    return { isWord, ...readableUnit(unit || (isWord ? "" : "number"), d3.max([most, ...alike.map((other) => other.most)])) };
  });
}

function makeRow(table, formats, cells) {
  const element = make("tr");
  cells.forEach((cell, i) => {
    const column = table.columns[i], { size, unit } = formats[i], value = valueOf(cell);
    const shown = make(i === 0 ? "th" : "td", {
      class: value === null || typeof value === "number" ? "number" : "word",
      "data-key": column.key,
      "data-value": value ?? "",
      "data-title": column.title,
      "data-view": column.view,
      "data-unit": typeof value === "number" && (size !== 1 || /^(ms|bytes)\b/.test(unit)) ? unit.split(" ")[0] : "",
    }, cell?.text ?? numberText(typeof value === "number" ? value / size : value));
    if (cell?.href) {
      const address = cell.href.split("/").map(encodeURIComponent).join("/");
      shown.replaceChildren(make("a", { href: address }, cell.text));
    }
    if (i === 0) shown.scope = "row";
    element.append(shown);
  });
  return { element, cells: cells.map(valueOf) };
}

// Buttons that choose the view.
function makeViews(table, show) {
  const views = [...new Set(table.columns.map((column) => column.view).filter((view) => view))];
  if (views.length < 2) return [];
  const buttons = views.map((view) => {
    const button = make("button", { type: "button" }, view);
    button.addEventListener("click", () => choose(view));
    return button;
  });
  const choose = (view) => {
    buttons.forEach((button) => button.setAttribute("aria-pressed", String(button.textContent === view)));
    show(view);
  };
  choose(views[0]);
  return [make("div", { class: "views", role: "group", "aria-label": `${table.title}: columns` }, ...buttons)];
}

function makeTable(table) {
  const formats = columnFormats(table);
  const rows = table.rows.map((cells) => makeRow(table, formats, cells));
  const body = make("tbody", {}, ...rows.map((row) => row.element));
  const heads = table.columns.map((column, i) => {
    const { unit, isWord, size } = formats[i];
    const button = make("button", { type: "button", "data-tip": `${column.definition}${unit && `\nUnit: ${unit}`}` },
      column.title, make("span", { class: "unit" }, unit || "\u00a0"));
    return make("th", { scope: "col", class: isWord ? "word" : "number", "data-size": size, "data-view": column.view }, button);
  });
  heads.forEach((head, i) => {
    head.firstChild.addEventListener("click", () => sortTable(heads, body, rows, i));
  });
  const all = make("table", {}, make("thead", {}, make("tr", {}, ...heads)), body);
  const cells = [...heads, ...rows.flatMap((row) => [...row.element.children])];
  const show = (view) => cells.forEach((cell) => { cell.hidden = Boolean(cell.dataset.view) && cell.dataset.view !== view; });
  return make("div", { class: "table", id: `table-${table.name}` },
    make("h3", {}, table.title), make("p", { class: "note" }, table.note), ...makeViews(table, show),
    make("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": table.title }, all));
}
