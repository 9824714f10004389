// Colour maps. All are made in OKLab (Björn Ottosson, 2020), in which equal steps look equal.

/** OKLab to sRGB, 0..255 each, cut to what a screen can show. */
function fromOklab(lightness, a, b) {
  const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (lightness - 0.0894841775 * a - 1.291485548 * b) ** 3;
  return [
    4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
    -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s,
  ].map((x) => {
    const bounded = Math.min(Math.max(x, 0), 1);
    const gamma = bounded <= 0.0031308 ? 12.92 * bounded : 1.055 * bounded ** (1 / 2.4) - 0.055;
    return Math.round(255 * gamma);
  });
}

function fromOklch(lightness, chroma, degrees) {
  const angle = (degrees * Math.PI) / 180;
  return fromOklab(lightness, chroma * Math.cos(angle), chroma * Math.sin(angle));
}

function table(color) {
  const out = new Uint8Array(3 * 256);
  for (let i = 0; i < 256; ++i) out.set(color(i / 255), 3 * i);
  return out;
}

/** Dark violet over green to light yellow: lightness grows evenly. */
export const sequential = table((t) =>
  fromOklch(0.27 + 0.65 * t, 0.125 + 0.035 * Math.sin(Math.PI * t), 305 - 200 * t));

/** Blue, light grey, orange: told apart by those who do not see red or green, too. */
export const diverging = table((t) => {
  const s = 2 * t - 1;
  const far = Math.abs(s);
  return fromOklch(0.93 - 0.47 * far ** 1.1, 0.16 * far ** 0.8, s < 0 ? 255 : 48);
});

/** A place in the cube of -1..1 as a colour: neighbours look alike, far places do not. */
export function placeColor(x, y, z) {
  return fromOklab(0.74 + 0.15 * z, 0.14 * x, 0.14 * y);
}

export const flags = [
  { bit: 1, name: 'Self-intersection', color: [213, 60, 0],
    about: 'triangles that cut through others' },
  { bit: 2, name: 'Lid', color: [0, 110, 190], about: 'triangles that bridge a gap in the cloud' },
  { bit: 4, name: 'Handle', color: [200, 90, 165],
    about: 'where neighbours of the cloud were torn apart' },
  { bit: 8, name: 'Bridge of parts', color: [0, 150, 110],
    about: 'triangles between parts of the cloud that lie apart' },
  { bit: 16, name: 'Far edge', color: [215, 150, 0],
    about: "triangles with an edge outside the graph's 2-ring" },
];

/** CSS gradient of a table. */
export function gradient(colors) {
  const stops = [];
  for (let i = 0; i <= 16; ++i) {
    const at = 3 * Math.round((255 * i) / 16);
    stops.push(`rgb(${colors[at]} ${colors[at + 1]} ${colors[at + 2]})`);
  }
  return `linear-gradient(to right, ${stops.join(', ')})`;
}

/** Vertex colours of a scalar; `scale` maps its value to 0..1. */
export function colorsOf(array, map, scale) {
  // Of each value that can be stored, for there are more vertices mostly.
  const of_stored = new Uint8Array(3 * (array.steps + 1));
  for (let q = 0; q <= array.steps; ++q) {
    const t = Math.min(Math.max(scale(array.meaning(q)), 0), 1);
    const at = 3 * Math.round(255 * t);
    for (let c = 0; c < 3; ++c) of_stored[3 * q + c] = map[at + c];
  }
  const out = new Uint8Array(3 * array.count);
  for (let i = 0; i < array.count; ++i) {
    const q = 3 * array.values[i];
    out[3 * i] = of_stored[q];
    out[3 * i + 1] = of_stored[q + 1];
    out[3 * i + 2] = of_stored[q + 2];
  }
  return out;
}

export function uniform(color, count) {
  const out = new Uint8Array(3 * count);
  for (let i = 0; i < out.length; ++i) out[i] = color[i % 3];
  return out;
}

/** Colours of places; `box` is half the size of what they lie in. */
export function placeColors(points, box) {
  const out = new Uint8Array(points.length);
  for (let i = 0; i < points.length; i += 3) {
    const color = placeColor(points[i] / box[0], points[i + 1] / box[1], points[i + 2] / box[2]);
    out[i] = color[0];
    out[i + 1] = color[1];
    out[i + 2] = color[2];
  }
  return out;
}
