// Layers: pictures and maps of counters, decoded from the page's PNGs and turned into canvases.

const kPicture = "picture";
const currentFrame = () => data.layers[Number(byId("frame").value)];
const techniqueNamed = (name, frame = currentFrame()) => frame.techniques.find((technique) => technique.technique === name);
const mapNamed = (technique, kind) => techniqueNamed(technique).maps.find((map) => map.name === kind);
const layerNames = (technique) => [kPicture, ...currentFrame().kinds.map((kind) => kind.name)
  .filter((kind) => mapNamed(technique, kind))];

// The pixels of an image: { width, height, rgba }.
async function decode(url) {
  const image = new Image();
  image.src = url;
  await image.decode();
  const canvas = make("canvas", { width: image.naturalWidth, height: image.naturalHeight });
  const context = canvas.getContext("2d", { willReadFrequently: true });
  context.drawImage(image, 0, 0);
  return { width: canvas.width, height: canvas.height,
           rgba: context.getImageData(0, 0, canvas.width, canvas.height).data };
}

const decoded = new Map();
function decodeOnce(url) {
  if (!decoded.has(url)) decoded.set(url, decode(url));
  return decoded.get(url);
}

// ---- Pictures ----

// The sRGB byte of a linear value.
function srgbByte(value) {
  const v = Math.min(1, Math.max(0, value));
  return Math.round(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055));
}

// A canvas whose pixels are given by colorAt(i, pixels), which writes R, G and B at 4 i.
function paintedCanvas(width, height, colorAt) {
  const pixels = new ImageData(width, height), canvas = make("canvas", { width, height });
  pixels.data.fill(255);
  for (let i = 0; i < width * height; ++i) colorAt(i, pixels.data);
  canvas.getContext("2d").putImageData(pixels, 0, 0);
  return canvas;
}

// A technique's picture: { width, height, linearAt(i, c), canvas, valueAt(x, y) }, i the number of a pixel and c a
// channel, and the canvas at an exposure: values are multiplied by 2^exposure.
async function loadPicture(technique, exposure) {
  const { low, high, png } = techniqueNamed(technique).picture, { width, height: twice, rgba } = await decodeOnce(png);
  const height = twice / 2, below = 4 * width * height;
  const levelAt = (i, c) => 256 * rgba[4 * i + c] + rgba[below + 4 * i + c];
  const linear = Float32Array.from({ length: 65536 }, (_, q) => low + (high - low) * (q / 65535) ** 2);
  const shown = Uint8Array.from(linear, (value) => srgbByte(value * 2 ** exposure));
  const linearAt = (i, c) => linear[levelAt(i, c)];
  const canvas = paintedCanvas(width, height, (i, bytes) => {
    for (let c = 0; c < 3; ++c) bytes[4 * i + c] = shown[levelAt(i, c)];
  });
  const valueAt = (x, y) => {
    const i = y * width + x, channels = [0, 1, 2].map((c) => linearAt(i, c));
    return `sRGB ${channels.map(srgbByte).join(" ")}, linear ${channels.map((value) => value.toFixed(4)).join(" ")}`;
  };
  return { width, height, linearAt, canvas, valueAt };
}

// What pictures of differences show, of the left value and the right one, as tev does it. Red is where the left picture
// is brighter, blue where it is darker.
const kModes = {
  split: { title: "side by side" },
  signed: { title: "left − right", of: (a, b) => a - b },
  absolute: { title: "|left − right|", of: (a, b) => Math.abs(a - b) },
  squared: { title: "(left − right)²", of: (a, b) => (a - b) ** 2 },
  relative: { title: "|left − right| / (right + 0.01)", of: (a, b) => Math.abs(a - b) / (b + 0.01) },
  relativeSquared: { title: "(left − right)² / (right² + 0.01)", of: (a, b) => (a - b) ** 2 / (b * b + 0.01) },
};

// The difference of two pictures, as a layer.
function makeDifference(left, right, mode, exposure) {
  const { width, height } = left, { of } = kModes[mode], scale = 2 ** exposure;
  const differenceAt = (i, c) => of(left.linearAt(i, c), right.linearAt(i, c));
  const signedRamp = d3.range(0, 513).map((n) => d3.rgb(d3.interpolateRdBu(1 - n / 512)));
  const canvas = paintedCanvas(width, height, (i, bytes) => {
    if (mode === "signed") {
      const mean = (differenceAt(i, 0) + differenceAt(i, 1) + differenceAt(i, 2)) / 3;
      const { r, g, b } = signedRamp[Math.round(256 + 256 * Math.max(-1, Math.min(1, mean * scale)))];
      bytes.set([r, g, b], 4 * i);
    } else {
      for (let c = 0; c < 3; ++c) bytes[4 * i + c] = srgbByte(differenceAt(i, c) * scale);
    }
  });
  const valueAt = (x, y) => [0, 1, 2].map((c) => differenceAt(y * width + x, c).toFixed(5)).join(" ");
  return { width, height, canvas, valueAt };
}

// ---- Maps ----

const isLogarithmic = () => byId("map-log").checked;
const isCause = (kind) => kind.startsWith("cause_");

// The scale of a kind of map, which is the same for all techniques and frames; all causes share one. part(value) is from
// 0 to 1, value(part) is its inverse, and ramp(part) is a colour. Causes, and what has negative values, get a scale with
// two sides.
function scaleOf(kind) {
  const belongs = (map) => map.name === kind || (isCause(kind) && isCause(map.name));
  const maps = data.layers.flatMap((frame) => frame.techniques.flatMap((technique) => technique.maps.filter(belongs)));
  const isSigned = isCause(kind) || d3.min(maps, (map) => map.low) < 0;
  const most = d3.max(maps, (map) => Math.max(-map.low, map.high)) || 1;
  const scale = isLogarithmic()
    ? d3.scaleSymlog().constant(maps.every((map) => map.step === 1) ? 1 : most / 1000)
    : d3.scaleLinear();
  scale.domain([isSigned ? -most : 0, most]).range([0, 1]);
  return { ramp: isSigned ? (t) => d3.interpolateRdBu(1 - t) : d3.interpolateInferno, part: scale, value: scale.invert };
}

// A technique's map: { width, height, canvas, valueAt(x, y), mean, low, high }.
async function loadMap(technique, kind) {
  const map = mapNamed(technique, kind), { width, height, rgba } = await decodeOnce(map.png);
  const numberAt = (i) => map.low + map.step * (256 * rgba[4 * i] + rgba[4 * i + 1]);
  const scale = scaleOf(kind), colors = new Map();
  let sum = 0;
  const canvas = paintedCanvas(width, height, (i, bytes) => {
    const value = numberAt(i);
    sum += value;
    if (!colors.has(value)) colors.set(value, d3.rgb(scale.ramp(scale.part(value))));
    const { r, g, b } = colors.get(value);
    bytes.set([r, g, b], 4 * i);
  });
  return { width, height, canvas, valueAt: (x, y) => numberText(numberAt(y * width + x)),
           mean: sum / (width * height), low: map.low, high: map.high };
}

const loadLayer = (technique, name, exposure = 0) =>
  name === kPicture ? loadPicture(technique, exposure) : loadMap(technique, name);

// A bar of colours with numbers below it. `ramp(part)` and `value(part)`: of parts from 0 to 1.
function makeLegend(title, text, ramp, value) {
  const stops = d3.range(0, 1.01, 0.05).map((t) => ramp(t));
  const ticks = d3.range(0, 1.01, 0.25).map((t) => make("span", {}, shortText(value(t))));
  return make("div", { class: "legend" },
    make("div", {}, make("b", {}, title), " ", make("span", { class: "unit" }, text)),
    make("div", { class: "ramp", style: `background: linear-gradient(to right, ${stops.join(", ")})` }),
    make("div", { class: "ticks" }, ...ticks));
}

function makeMapLegend(title, kind) {
  const { unit, definition } = currentFrame().kinds.find((known) => known.name === kind);
  const { ramp, value } = scaleOf(kind);
  return makeLegend(title, `${definition}${unit && ` Unit: ${unit}.`}`, ramp, value);
}
