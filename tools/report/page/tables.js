// Tables. A click on a column's title sorts by it, and hovering over it shows what the column means.

function compareCells(a, b) {
  if (a === null || b === null) return (a === null) - (b === null);  // empty cells come last
  return typeof a === "number" ? a - b : a.localeCompare(b);
}

function sortTable(table, heads, body, rows, column) {
  const head = heads[column];
  const descending = head.getAttribute("aria-sort") === "ascending";
  for (const other of heads) other.removeAttribute("aria-sort");
  head.setAttribute("aria-sort", descending ? "descending" : "ascending");
  const sorted = rows.slice().sort((a, b) => compareCells(a.cells[column], b.cells[column]));
  if (descending) sorted.reverse().sort((a, b) => (a.cells[column] === null) - (b.cells[column] === null));
  body.replaceChildren(...sorted.map((row) => row.element));
}

function makeRow(table, cells) {
  const element = make("tr");
  cells.forEach((cell, i) => {
    const shown = make(i === 0 ? "th" : "td", {
      class: typeof cell === "string" ? "word" : "number",
      "data-key": table.columns[i].key,
      "data-value": cell ?? "",
    }, numberText(cell));
    if (i === 0) shown.scope = "row";
    element.append(shown);
  });
  return { element, cells };
}

function makeTable(table) {
  const rows = table.rows.map((cells) => makeRow(table, cells));
  const body = make("tbody", {}, ...rows.map((row) => row.element));
  const heads = table.columns.map((column, i) => {
    const isWord = table.rows.some((cells) => typeof cells[i] === "string");
    const unit = column.unit || (isWord ? "" : "number");
    const button = make("button", { type: "button", "data-tip": `${column.definition}${unit && `\nUnit: ${unit}`}` },
      column.title, make("span", { class: "unit" }, unit || "\u00a0"));
    return make("th", { scope: "col", class: isWord ? "word" : "number" }, button);
  });
  heads.forEach((head, i) => {
    head.firstChild.addEventListener("click", () => sortTable(table, heads, body, rows, i));
  });
  return make("div", { class: "table", id: `table-${table.name}` },
    make("h3", {}, table.title),
    make("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": table.title },
      make("table", {}, make("thead", {}, make("tr", {}, ...heads)), body)));
}
