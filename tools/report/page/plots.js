// Plots, drawn by D3 in the width of the page. The choice of what is modelled, on top of the page, holds for all of them.

const boundText = { none: "", lower: "≥ ", upper: "≤ ", beyond: "" };
const boundTurn = { none: 0, lower: 0, upper: 180, beyond: 90 };  // of the triangle, in degrees

// Places each label where it covers no obstacle and no other label. Labels without such a place are left out.
// Obstacles are squares: { x, y, radius }.
function placeLabels(labels, obstacles, width, height) {
  const boxes = obstacles.map(({ x, y, radius: r }) => ({ x0: x - r, y0: y - r, x1: x + r, y1: y + r }));
  const isFree = (box) => box.x0 >= 2 && box.x1 <= width + 12 && box.y0 >= -6 && box.y1 <= height - 2 &&
    boxes.every((other) => box.x1 <= other.x0 || box.x0 >= other.x1 || box.y1 <= other.y0 || box.y0 >= other.y1);
  for (const label of labels) {
    const { width: w } = label.element.getBBox(), h = 13, gap = 7;
    const places = [[1, 0], [-1, 0], [0, -1], [0, 1], [1, 1], [-1, -1], [1, -1], [-1, 1]].map(([sx, sy]) => {
      const x = label.x + sx * (gap + w / 2), y = label.y + sy * (gap + h / 2);
      return { x0: x - w / 2, y0: y - h / 2, x1: x + w / 2, y1: y + h / 2 };
    });
    const box = places.find(isFree);
    if (!box) {
      label.element.remove();
      continue;
    }
    boxes.push(box);
    label.element.setAttribute("x", (box.x0 + box.x1) / 2);
    label.element.setAttribute("y", (box.y0 + box.y1) / 2);
  }
}

// Small obstacles along a line from point to point.
function lineObstacles(points) {
  return d3.pairs(points).flatMap(([a, b]) => {
    const steps = Math.ceil(Math.hypot(b.x - a.x, b.y - a.y) / 4);
    return d3.range(1, steps).map((i) =>
      ({ x: a.x + (b.x - a.x) * i / steps, y: a.y + (b.y - a.y) * i / steps, radius: 1 }));
  });
}

// The powers of ten, on short axes also two and five times these, and on very short ones round numbers.
function logTicks(scale) {
  const [low, high] = scale.domain(), decades = Math.log10(high / low);
  if (decades < 0.7) return d3.ticks(low, high, 5);
  const values = d3.range(Math.floor(Math.log10(low)), Math.ceil(Math.log10(high)) + 1)
    .flatMap((power) => (decades < 2.5 ? [1, 2, 5] : [1]).map((times) => Number(`${times}e${power}`)));
  return values.filter((value) => value >= low && value <= high);
}

// A logarithmic scale with some room at both ends.
function logScale(values, range) {
  const low = d3.min(values), high = d3.max(values);
  const room = Math.max(1.2, (high / low) ** 0.07);
  return d3.scaleLog().domain([low / room, high * room]).range(range);
}

// A label below an area that starts at `left` in a plot of this width: in the middle of the plot, on two lines if it is
// long.
function addAxisLabel(area, label, width, left, y) {
  const kCharacter = 6.4, at = label.lastIndexOf(", ") + 1;
  const lines = label.length * kCharacter < width || at === 0 ? [label] : [label.slice(0, at), label.slice(at + 1)];
  lines.forEach((line, i) => area.append("text").attr("x", width / 2 - left).attr("y", y + 15 * (i + 1 - lines.length))
    .attr("text-anchor", "middle").text(line));
}

function drawScatter(svg, plot, width) {
  const margin = { left: 74, right: 14, top: 8, bottom: 52 }, height = Math.max(320, Math.min(440, width * 0.7));
  const inner = { width: width - margin.left - margin.right, height: height - margin.top - margin.bottom };
  const points = plot.series.flatMap((series) =>
    series.points.map((point) => ({ ...point, color: series.color, mark: series.marks })));
  const x = logScale(points.map((p) => p.x), [0, inner.width]), y = logScale(points.map((p) => p.y), [inner.height, 0]);
  svg.attr("viewBox", `0 0 ${width} ${height}`);
  const area = svg.append("g").attr("transform", `translate(${margin.left},${margin.top})`);
  area.append("g").attr("class", "axis").attr("transform", `translate(0,${inner.height})`)
    .call(d3.axisBottom(x).tickValues(logTicks(x)).tickFormat(numberText).tickSizeInner(-inner.height).tickPadding(8));
  area.append("g").attr("class", "axis")
    .call(d3.axisLeft(y).tickValues(logTicks(y)).tickFormat(numberText).tickSizeInner(-inner.width).tickPadding(8));
  addAxisLabel(area, plot.x_label, width, margin.left, inner.height + 46);
  area.append("text").attr("transform", `translate(-60,${inner.height / 2}) rotate(-90)`).attr("text-anchor", "middle")
    .text(plot.y_label);
  plot.series.forEach((series) => {
    if (!series.line) return;
    area.append("path").attr("fill", "none").attr("stroke", series.color).attr("stroke-width", 2)
      .attr("d", d3.line().x((p) => x(p.x)).y((p) => y(p.y))(series.points));
  });
  const symbol = (p) => d3.symbol().size(75).type(p.bound === "none" ? d3.symbolCircle : d3.symbolTriangle)();
  area.selectAll(".point").data(points.filter((p) => p.mark)).join("path").attr("class", "point").attr("tabindex", 0).attr("role", "img")
    .attr("transform", (p) => `translate(${x(p.x)},${y(p.y)}) rotate(${boundTurn[p.bound]})`)
    .attr("d", symbol).attr("fill", (p) => p.color)
    .attr("data-tip", (p) =>
      `${p.label}\n${plot.x_label}: ${p.bound === "beyond" ? "no bytes" : numberText(p.x)}\n${plot.y_label}: ${boundText[p.bound]}${numberText(p.y)}`)
    .attr("aria-label", function () { return this.dataset.tip; });
  const labels = area.selectAll(".label").data(points).join("text").attr("class", "label").attr("text-anchor", "middle")
    .attr("dominant-baseline", "central").attr("aria-hidden", true).text((p) => p.label);
  const place = (p) => ({ x: x(p.x), y: y(p.y), radius: 5 });
  const lines = plot.series.filter((series) => series.line).flatMap((series) => lineObstacles(series.points.map(place)));
  placeLabels(labels.nodes().map((element, i) => ({ element, ...place(points[i]) })), [...points.map(place), ...lines],
    inner.width, inner.height);
}

function drawBars(svg, plot, width) {
  const step = 26, longest = d3.max(plot.categories, (name) => name.length);
  const margin = { left: Math.min(width * 0.45, 6.6 * longest + 16), right: 12, top: 6, bottom: 52 };
  const height = margin.top + step * plot.categories.length + margin.bottom;
  const inner = { width: width - margin.left - margin.right, height: height - margin.top - margin.bottom };
  const totals = plot.categories.map((_, i) => d3.sum(plot.parts, (part) => part.values[i]));
  const side = (sign) => plot.categories.map((_, i) => d3.sum(plot.parts, (part) => Math.max(0, sign * part.values[i])));
  const x = d3.scaleLinear().domain([-d3.max(side(-1)), d3.max(side(1))]).nice().range([0, inner.width]);
  svg.attr("viewBox", `0 0 ${width} ${height}`);
  const area = svg.append("g").attr("transform", `translate(${margin.left},${margin.top})`);
  area.append("g").attr("class", "axis").attr("transform", `translate(0,${inner.height})`)
    .call(d3.axisBottom(x).ticks(inner.width / 80).tickSizeInner(-inner.height).tickPadding(8));
  addAxisLabel(area, plot.y_label, width, margin.left, inner.height + 46);
  plot.categories.forEach((name, i) => {
    const inUse = plot.parts.map((part) => ({ ...part, value: part.values[i], limit: part.limits?.[i] })).filter((part) => part.value !== 0);
    const list = inUse.map((part) => `${part.name}: ${numberText(part.value)}${part.limit ? ` (${part.limit})` : ""}`);
    if (plot.marks) list.push(`${plot.marks.name}: ${numberText(plot.marks.values[i])}`);
    const bar = area.append("g").attr("class", "bar").attr("tabindex", 0).attr("role", "img")
      .attr("transform", `translate(0,${i * step})`)
      .attr("data-tip", `${name}: ${numberText(totals[i])}, ${plot.y_label}\n${list.join("\n")}`)
      .attr("aria-label", function () { return this.dataset.tip; });
    const room = Math.floor((margin.left - 12) / 6.4);  // in characters
    bar.append("text").attr("x", -12).attr("y", step / 2).attr("text-anchor", "end").attr("dominant-baseline", "central")
      .text(name.length > room ? `${name.slice(0, room - 1)}…` : name);
    bar.append("rect").attr("x", -8).attr("y", 3).attr("width", 4).attr("height", step - 6).attr("fill", colorOf(name));
    const ends = { 1: 0, [-1]: 0 };  // of the parts on each side of zero
    for (const part of inUse) {
      const sign = Math.sign(part.value), from = ends[sign], to = from + part.value;
      ends[sign] = to;
      bar.append("rect").attr("class", "part").attr("x", x(Math.min(from, to))).attr("y", 3).attr("height", step - 6)
        .attr("width", Math.max(0, Math.abs(x(to) - x(from)) - 0.5)).attr("fill", part.color)
        .attr("data-tip", `${name}, ${part.name}: ${numberText(part.value)}, ${plot.y_label}${part.limit ? `\nlimited by ${part.limit}` : ""}`);
    }
    if (plot.marks)
      bar.append("line").attr("class", "mark").attr("x1", x(plot.marks.values[i])).attr("x2", x(plot.marks.values[i]))
        .attr("y1", 0).attr("y2", step);
  });
}

// `draw` draws it, once it has a place on the page; after that it is drawn again whenever its width changes.
function makeFigure(figure) {
  const svg = d3.create("svg").attr("role", "group");
  const key = make("div", { class: "key" }), note = make("p", { class: "note" });
  const select = make("select", { "aria-label": `${figure.title}: which` },
    ...figure.choices.map((choice, i) => make("option", { value: i }, choice.label)));
  const caption = make("figcaption", {}, make("h3", {}, figure.title), make("p", {}, figure.caption));
  if (figure.choices.length > 1) caption.append(select);
  const element = make("figure", {}, caption, svg.node(), key, note);
  let drawnWidth = 0;
  const draw = () => {
    const { plot } = figure.choices[Number(select.value)], width = element.clientWidth;
    if (width === 0) return;
    drawnWidth = width;
    svg.selectAll("*").remove();
    svg.attr("aria-label", plot.title).attr("data-plot", plot.name);
    (plot.kind === "bars" ? drawBars : drawScatter)(svg, plot, width);
    key.replaceChildren(...(plot.parts ?? plot.series).map(({ name, color }) => make("span", { style: `--swatch: ${color}` }, name)));
    note.textContent = (plot.notes ?? []).join(" ");
  };
  select.addEventListener("change", draw);
  byId("implementation").addEventListener("change", ({ target }) => {
    const at = figure.choices.findIndex((choice) => choice.label.endsWith(`.${target.value}`));
    if (at < 0) return;
    select.value = at;
    draw();
  });
  new ResizeObserver(() => requestAnimationFrame(() => {
    if (element.clientWidth !== drawnWidth) draw();
  })).observe(element);
  return { element, draw };
}
