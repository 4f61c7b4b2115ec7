// Numbers as text for reading.

// Whole numbers with groups of three digits, others with four digits, a dash for nothing.
function numberText(value) {
  if (value === null || value === undefined) return "–";
  if (typeof value !== "number") return String(value);
  const rounded = Number.isInteger(value) ? value : Number(value.toPrecision(4));
  return Number.isInteger(rounded) ? rounded.toLocaleString("en").replaceAll(",", "\u202f") : String(rounded);
}

// With three digits.
const shortText = (value) => numberText(Number(value.toPrecision(3)));

// From which number on, the size of a unit, and its name.
const kByteScales = [[1e9, 1e9, "GB"], [1e6, 1e6, "MB"], [1e3, 1e3, "kB"]];
const kCountScales = [[1e10, 1e9, "billions"], [1e7, 1e6, "millions"], [1e4, 1e3, "thousands"]];

// The unit in which numbers up to `most` are read: { size, unit }. Bytes become kB, MB or GB, and counts of more than
// 10 000 become thousands, millions or billions. Per pixel, and of everything else, units stay as they are.
function readableUnit(unit, most) {
  const [what, per] = unit.split(" per ");
  if (what === "bytes on chip") return { size: 1024, unit: "KiB" };  // as sizes of memories are given
  const scales = per === "pixel" ? [] : what === "bytes" ? kByteScales
    : /^(items|operations|lanes|pairs|cells|triangles|tiles|pixels|positions|fragments)$/.test(what) ? kCountScales : [];
  const [, size, name] = scales.find(([from]) => most >= from) ?? [0, 1, ""];
  if (!name) return { size, unit };
  return { size, unit: (what === "bytes" ? name : `${name} of ${what}`) + (per ? ` per ${per}` : "") };
}

function bytesText(bytes, kind = "bytes") {
  const { size, unit } = readableUnit(kind, bytes);
  return `${shortText(bytes / size)} ${unit}`;
}
