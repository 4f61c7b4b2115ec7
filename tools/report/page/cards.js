// A card for each technique: its costs and its error, and each as a multiple of the baseline's.

// The technique's colour in cards, plots and maps.
const colorOf = (technique) => data.summary.cards.find((card) => card.technique === technique)?.color ?? "transparent";

// Under the number of a time: what takes so long, its range, and the other two times with theirs.
function timeLines(time) {
  const range = (key) => (time[`${key}_interval`] ?? []).map(shortText).join(" to ");
  const line = (title, key) => `${title}: ${shortText(time[key])} ms${range(key) && ` (${range(key)})`}`;
  return [`bottleneck: ${time.busiest}`, ...(range("at_once") ? [`range: ${range("at_once")} ms`] : []),
    line("on cores", "on_cores"), line("in turn", "in_turn"),
    ...(time.ratio_interval ? [`in turn: ${time.ratio.toPrecision(3)}× (${time.ratio_interval.map((end) => end.toPrecision(3)).join(" to ")})`] : [])];
}

// What a card lists: a name, the number, its text, and more lines that explain it.
function cardRows(card, implementation) {
  const time = card.modelled_ms?.[implementation], bound = { estimate: "", "at least": "≥ ", "at most": "≤ " };
  const rows = [
    ["DRAM", card.dram_bytes, bytesText, []],
    ["on chip", card.on_chip_bytes_per_pixel, (value) => `${shortText(value)} B/pixel`, [`${bytesText(card.on_chip_bytes, "bytes on chip")} per bin of ${numberText(card.bin_pixels)} pixels`,
      `pixels are ${card.pixels_on_chip ? "on chip" : "in memory"}`]],
    ["off chip", card.bytes_per_pixel, (value) => `${shortText(value)} B/pixel`, [card.off_chip]],
    ["time", time?.at_once, (value) => `${shortText(value)} ms`,
      time ? timeLines(time) : []],
    ["RMSE", card.rmse, shortText, []],
    ["EMR", card.emr, (value) => bound[card.emr_bound] + shortText(value), []],
  ];
  return rows.filter(([, value]) => value !== undefined);
}

function ratioText(value, baseline) {
  if (!(baseline > 0)) return "–";
  const ratio = value / baseline;
  return `${ratio >= 100 ? numberText(Math.round(ratio)) : ratio.toPrecision(ratio < 0.995 ? 2 : 3)}×`;
}

function makeCard(card, baseline, implementation) {
  const usual = new Map(cardRows(baseline, implementation).map(([name, value]) => [name, value]));
  const rows = cardRows(card, implementation).map(([name, value, text, more]) => make("div", { "data-name": name },
    make("dt", {}, name), make("dd", { class: "value" }, text(value)),
    make("dd", { class: "ratio" }, card === baseline || !usual.has(name) ? "" : ratioText(value, usual.get(name))),
    ...more.map((line) => make("dd", { class: "more" }, line))));
  const title = make("h3", {}, card.technique);
  if (card === baseline) title.append(make("small", {}, " baseline"));
  return make("article", { class: "card", style: `--color: ${card.color}`, "data-technique": card.technique }, title,
    make("dl", {}, ...rows));
}

function startCards(summary) {
  const select = byId("implementation"), [baseline] = summary.cards;
  fillSelect(select, summary.implementations);
  byId("implementations").hidden = summary.implementations.length === 0;
  byId("cost-note").textContent = (summary.cards.length === 1 ? "Costs are per frame." : `Costs are per frame; multiples are of ${summary.baseline}.`)
    + " The time in bold is that at once: all units, evenly. On cores, bins come one by one; in turn, stages do. Nine in ten"
    + " lie in the ranges, if rates are drawn from those of the description.";
  const show = () => byId("cards").replaceChildren(...summary.cards.map((card) => makeCard(card, baseline, select.value)));
  select.addEventListener("change", show);
  show();
}
