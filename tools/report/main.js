// Reads the data, and puts the page together: first words, which need no WebGL, then the views.

const left_out_color = '#e14614';
const flag_kinds = [
  { bit: 1, name: 'Self-intersection', color: '#d53c00' },
  { bit: 2, name: 'Filled hole', color: '#006ebe' },
  { bit: 4, name: 'Bridge between parts', color: '#00966e' },
  { bit: 8, name: "Edge outside the graph's 2-ring", color: '#d79600', harmless: true },
];

/** The arrays of the data: {values: integers, numbers(), low, high}. */
async function readArrays(about) {
  const arrays = {};
  for (const [name, { bits, components, min, max }] of Object.entries(about)) {
    const buffer = await unpacked(`array-${name}`).arrayBuffer();
    const values = new { 8: Uint8Array, 16: Uint16Array, 32: Uint32Array }[bits](buffer);
    // Stored are differences to the row before.
    for (let i = components; i < values.length; ++i) values[i] += values[i - components];
    arrays[name] = {
      values, low: min, high: max,
      numbers: () => Float32Array.from(values, (value, i) => {
        const c = i % components;
        return min[c] + (value / (2 ** bits - 1)) * (max[c] - min[c]);
      }),
    };
  }
  return arrays;
}

/** 256 colours between some, evenly. */
function palette(...colors) {
  const stops = colors.map((color) => new THREE.Color(color));
  const out = new Uint8Array(768);
  for (let i = 0; i < 256; ++i) {
    const at = (i / 255) * (stops.length - 1);
    const stop = Math.min(Math.floor(at), stops.length - 2);
    const { r, g, b } = stops[stop].clone().lerp(stops[stop + 1], at - stop);
    out.set([255 * r, 255 * g, 255 * b], 3 * i);
  }
  return out;
}

const sequential = palette('#440154', '#3b528b', '#21918c', '#5ec962', '#fde725');
const diverging = palette('#08519c', '#6baed6', '#ececec', '#fd8d3c', '#a63603');

/** Places on the sphere as colours: neighbours look alike, distant places do not. */
const placeColors = (sphere) => Uint8Array.from(sphere, (x) => 255 * (0.6 + 0.36 * x));

/** The ways to colour by, by key: {name, colors(), about, ends, text(share)}. Some need a sphere. */
function makeModes(arrays, views) {
  const scalar = (array, ramp, more) => ({
    colors: () => Uint8Array.from({ length: 3 * array.values.length },
      (_, i) => ramp[3 * array.values[Math.floor(i / 3)] + (i % 3)]),
    at: (share) => array.low[0] + share * (array.high[0] - array.low[0]),
    array, ramp, ...more,
  });
  const uniform = (level) => () => new Uint8Array(views.positions.length).fill(level);
  const place = arrays.sphere && {
    place: {
      name: 'position on the sphere', colors: () => placeColors(views.sphere), cells: true,
      about: 'The same colour and the same cell of 15° mean the same place on the sphere.',
    },
  };
  const of_map = arrays.area && {
    area: scalar(arrays.area, diverging, {
      name: 'area distortion', about: 'Area on the sphere over area on the object, 1 on average.',
      // Each side of 1 has half of the colours.
      at: (share) => (2 * share - 1) * (share < 0.5 ? -arrays.area.low[0] : arrays.area.high[0]),
      text: (x) => `×${number(2 ** x, 3)}`,
    }),
    angle: scalar(arrays.angle, sequential, {
      name: 'angle distortion', about: 'Longest over shortest axis of what a small circle becomes.',
      text: (x) => number(10 ** x, 3),
    }),
    residual: scalar(arrays.residual, sequential, {
      name: 'residual', about: 'Distance of each point of the sphere from balance, in radii.',
      text: (x) => number(10 ** x, 2),
    }),
  };
  return {
    ...place,
    ...of_map,
    suspicious: {
      name: 'suspicious triangles', colors: uniform(190),
      about: 'Triangles to look at, each kind in its colour. The buttons below lead to them.',
    },
    ...(arrays.colors && { input: {
      name: 'colours of the cloud', colors: () => arrays.colors.values, about: 'The colours of the input.',
    } }),
    plain: { name: 'one colour', colors: uniform(185), about: '' },
  };
}

function showLegend(mode) {
  const shares = [0, 0.25, 0.5, 0.75, 1];
  const color = (share) => `rgb(${[0, 1, 2].map((c) => mode.ramp[3 * Math.round(255 * share) + c]).join(' ')})`;
  byId('legend').replaceChildren(make('div', {}, mode.about), mode.ramp ? make('div', {},
    make('div', { class: 'ramp', style: {
      background: `linear-gradient(to right, ${Array.from({ length: 9 }, (_, i) => color(i / 8)).join(', ')})`,
    } }),
    make('div', { class: 'ticks' }, shares.map((share) => make('span', {}, mode.text(mode.at(share)))))) : '');
}

/** Triangles of each kind in connected places, the largest first. */
function findFlags(marks, triangles) {
  return flag_kinds.map((kind) => {
    const flagged = [];
    marks.forEach((bits, t) => { if (bits & kind.bit) flagged.push(t); });
    const parent = new Map();
    const root = (v) => {
      for (let up = parent.get(v) ?? v; up !== v;) {
        const next = parent.get(up) ?? up;
        parent.set(v, next); // shortens long ways
        [v, up] = [up, next];
      }
      return v;
    };
    for (const t of flagged) {
      for (let k = 1; k < 3; ++k) parent.set(root(triangles[3 * t + k]), root(triangles[3 * t]));
    }
    const places = new Map();
    for (const t of flagged) {
      const place = root(triangles[3 * t]);
      if (!places.has(place)) places.set(place, []);
      places.get(place).push(t);
    }
    return { ...kind, triangles: flagged, places: [...places.values()].sort((a, b) => b.length - a.length) };
  }).filter((kind) => kind.triangles.length > 0);
}

/** The way to colour by at first: faults are not to be overlooked. */
const firstMode = (kinds) => (kinds.every((kind) => kind.harmless) ? 'place' : 'suspicious');

function showStill(data, arrays) {
  const shape = new Shape(arrays, data);
  const modes = makeModes(arrays, shape);
  const kinds = findFlags(arrays.suspicious.values, shape.triangles);
  const colors = (modes[firstMode(kinds)] ?? modes.plain).colors();
  const flagged = new Map(kinds.reverse().filter((kind) => !kind.harmless).flatMap(({ color, triangles }) => {
    const { r, g, b } = new THREE.Color(color);
    return triangles.map((t) => [t, [255 * r, 255 * g, 255 * b]]);
  }));
  byId('still').hidden = false;
  drawStill(byId('still').firstElementChild, shape, (t) =>
    flagged.get(t) ?? colors.subarray(3 * shape.triangles[3 * t], 3 * shape.triangles[3 * t] + 3));
}

/** Buttons that lead to the places of suspicious triangles, one after the other. */
function showPlaces(kinds, views, showSuspicious) {
  byId('flags').replaceChildren(kinds.length === 0 ? 'No suspicious triangles.' : 'Suspicious:', ...kinds.map((kind) => {
    let next = 0;
    const onclick = () => {
      const [triangle] = kind.places[next++ % kind.places.length];
      showSuspicious();
      // A triangle may be of several kinds.
      views.setFlags([kind, ...kinds.filter((other) => other !== kind)]);
      views.lookAt(views.triangles[3 * triangle]);
    };
    return make('button', { type: 'button', 'data-bit': kind.bit, onclick },
      make('span', { class: 'swatch', style: { background: kind.color } }),
      `${kind.name}: ${counted(kind.triangles.length, 'triangle')} in ${counted(kind.places.length, 'place')}`);
  }));
}

function describe(vertex, modes, arrays) {
  if (vertex === null) return 'No vertex is marked.';
  const place = arrays.positions.numbers().subarray(3 * vertex, 3 * vertex + 3);
  return [`Vertex at (${Array.from(place, (x) => number(x)).join(', ')})`,
    ...Object.values(modes).filter((mode) => mode.ramp).map(({ name, text, at, array }) =>
      `${name} ${text(at(array.values[vertex] / 255))}`)].join(' · ');
}

function showViews(data, arrays, context) {
  const views = new Views(byId('canvas'), context, arrays, data);
  window.report_views = views; // for tests
  const modes = makeModes(arrays, views);
  const kinds = findFlags(arrays.suspicious.values, views.triangles);
  const select = byId('color');
  select.replaceChildren(...Object.entries(modes).map(([value, { name }]) => make('option', { value }, name)));
  const first = firstMode(kinds);
  select.value = first in modes ? first : 'plain';
  const paint = () => {
    const mode = modes[select.value];
    views.setColors(mode.colors(), mode.cells);
    views.setFlags(mode === modes.suspicious ? kinds : []);
    showLegend(mode);
  };
  select.addEventListener('change', paint);
  byId('wireframe').addEventListener('change', (event) => views.setWireframe(event.target.checked));
  byId('reset').addEventListener('click', () => views.reset());
  views.onMark = (vertex) => { byId('readout').textContent = describe(vertex, modes, arrays); };
  views.onMark(null);
  if (data.left_out > 0) {
    byId('cloud-note').replaceChildren(make('span', { class: 'swatch', style: { background: left_out_color } }),
      `${counted(data.left_out, 'point')} left out`);
  }
  showPlaces(kinds, views, () => {
    select.value = 'suspicious';
    paint();
  });
  paint();
}

async function main() {
  const data = await unpacked('data').json();
  showVerdict(data);
  showTables(data);
  showStages(data.report.stages ?? []);
  byId('content').hidden = false;

  const note = (text) => Object.assign(byId('note'), { hidden: false, textContent: text });
  if (data.mesh.shown_surfaces > 1) {
    byId('shown').textContent = `The page shows ${number(data.mesh.shown_surfaces)} surfaces together. ` +
      (data.arrays.sphere ? 'The sphere has the directions in which the sensor sees them.'
        : 'They have no sphere in common: mesh_%03d.ply -report page_%03d.html makes a page of each, with its sphere.');
  }
  if (data.mesh.shown_triangles < data.mesh.triangles) {
    note(`The views show a reduced copy: ${counted(data.mesh.shown_vertices, 'vertex', 'vertices')} of the mesh, ` +
      'triangulated anew on the sphere. The numbers are those of the whole mesh.');
  }
  const context = byId('canvas').getContext('webgl2', { antialias: true });
  byId('show').hidden = !context;
  const arrays = await readArrays(data.arrays);
  if (context) showViews(data, arrays, context);
  else showStill(data, arrays);
  byId('loading').hidden = true;
  document.documentElement.dataset.report = context ? 'ready' : 'still';
}

main().catch((error) => fail(`The page failed: ${error.message ?? error}`));
