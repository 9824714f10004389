// What the colours mean: modes to colour by, their legends, the values at a vertex.
import {
  colorsOf, diverging, flags, gradient, placeColors, sequential, uniform,
} from './colors.js';
import { byId, counted, make, number, svg } from './dom.js';
import { placesOf } from './geometry.js';

const plain = [176, 190, 208];
const plain_of_flags = [188, 192, 198];

/** 2^x as a factor: ×0.25, ×4. */
const factor = (exponent) => `×${number(2 ** exponent, 3)}`;


/** Even steps from low to high. */
function evenScale(low, high) {
  return {
    to: (value) => (high > low ? (value - low) / (high - low) : 0.5),
    at: (t) => low + t * (high - low),
  };
}

/** Even steps of the logarithm; for numbers from 1 up. */
function ratioScale(low, high) {
  const even = evenScale(Math.log(Math.max(low, 1e-9)), Math.log(Math.max(high, 1e-9)));
  return {
    to: (value) => even.to(Math.log(Math.max(value, 1e-9))),
    at: (t) => Math.exp(even.at(t)),
  };
}

/** 0 in the middle; each side to its own end, as one may be much longer than the other. */
function twoSidedScale(low, high) {
  const below = low < 0 ? -low : Math.max(high, 1e-9);
  const above = high > 0 ? high : below;
  return {
    to: (value) => 0.5 + (0.5 * value) / (value < 0 ? below : above),
    at: (t) => (t < 0.5 ? (2 * t - 1) * below : (2 * t - 1) * above),
  };
}

/** What is known of a mode of numbers: `text` writes one, `ends` are words for the scale's ends. */
function scalar(mode) {
  return {
    ...mode,
    colors: () => colorsOf(mode.array, mode.map, mode.scale.to),
    legend: () => scalarLegend(mode),
  };
}

/** How often each of some ranges of values occurs, as bars over the colours. */
function histogram(array, scale) {
  const bins = new Array(64).fill(0);
  for (const q of array.values) {
    const t = scale.to(array.meaning(q));
    ++bins[Math.min(Math.max(Math.floor(64 * t), 0), 63)];
  }
  const most = Math.max(...bins);
  return svg('svg', { viewBox: '0 0 64 20', preserveAspectRatio: 'none', class: 'histogram',
    'aria-hidden': 'true' },
  bins.map((count, i) => {
    const height = count ? Math.max(20 * Math.sqrt(count / most), 0.6) : 0;
    return svg('rect', { x: i, y: 20 - height, width: 0.92, height });
  }));
}

function scalarLegend({ name, array, map, scale, text, about, ends }) {
  const ticks = [0, 0.25, 0.5, 0.75, 1].map((t) => scale.at(t));
  return make('figure', { class: 'scale', 'data-min': array.min[0], 'data-max': array.max[0] },
    make('figcaption', {},
      make('strong', {}, name[0].toUpperCase() + name.slice(1)), ` – ${about}`),
    histogram(array, scale),
    make('div', { class: 'ramp', style: { background: gradient(map) } }),
    make('div', { class: 'ticks' }, ticks.map((value) => make('span', {}, text(value)))),
    make('div', { class: 'ends' }, ends.map((end) => make('span', {}, end))),
    make('p', { class: 'hint' }, 'What lies beyond an end has the colour of the end. ' +
      'Bars: how many vertices (square root).'));
}

/** All modes that the file has data for, by key. */
export function makeModes(arrays, views, find_place) {
  const modes = new Map();
  const add = (mode) => modes.set(mode.key, mode);
  const vertices = arrays.positions.count;
  const words = (name, about) => () =>
    make('p', { class: 'words' }, make('strong', {}, name), ` – ${about}`);
  add({
    key: 'place', name: 'position on the sphere', grid: true,
    colors: () => placeColors(arrays.sphere.floats(), [1, 1, 1]),
    legend: words('Position on the sphere',
      'the same colour and the same cell of the grid (15° wide) mean the same place'),
  });
  const add_scalar = (key, name, array, make_scale, mode) => {
    if (!array) return;
    const scale = make_scale(array.min[0], array.max[0]);
    add(scalar({ key, name, array, scale, ...mode }));
  };
  add_scalar('area', 'area distortion', arrays.area_distortion, twoSidedScale, {
    map: diverging, text: factor,
    about: 'area on the sphere over area on the object, 1 on average',
    ends: ['squeezed', 'as it was', 'stretched'],
  });
  add_scalar('angle', 'angle distortion', arrays.angle_distortion, ratioScale, {
    map: sequential, text: (x) => number(x, 3),
    about: 'longest over shortest axis of what a small circle becomes',
    ends: ['angles kept', 'sheared'],
  });
  add_scalar('residual', 'residual', arrays.residual, evenScale, {
    map: sequential, text: (x) => number(10 ** x, 2),
    about: 'how far each point of the sphere is from balance, in radii',
    ends: ['in balance', 'not yet'],
  });
  if (arrays.suspicious) {
    const groups = flags.map((flag) => ({
      ...flag, ...placesOf(arrays.suspicious.values, flag.bit, arrays.triangles.values), next: 0,
    }));
    add({
      key: 'suspicious', name: 'suspicious triangles', groups,
      colors: () => uniform(plain_of_flags, vertices),
      legend: () => flagLegend(groups, views, find_place),
    });
  }
  if (arrays.colors) {
    add({
      key: 'input', name: 'colours of the input',
      colors: () => arrays.colors.values,
      legend: words('Colours of the input', 'as the cloud had them'),
    });
  }
  add({
    key: 'plain', name: 'one colour',
    colors: () => uniform(plain, vertices),
    legend: words('One colour', 'to look at the shape'),
  });
  return modes;
}

function flagLegend(groups, views, find_place) {
  const any = groups.some((group) => group.triangles.length > 0);
  return make('div', { class: 'flags' },
    make('p', { class: 'words' }, make('strong', {}, 'Suspicious triangles'), any
      ? ' – click to look at one place after the other, the largest first'
      : ' – none in this mesh'),
    groups.map((group) => {
      const swatch = make('span', { class: 'swatch', 'aria-hidden': 'true',
        style: { background: `rgb(${group.color.join(' ')})` } });
      const place = make('span', { class: 'hint' });
      return make('button', {
        type: 'button', class: 'flag', 'data-bit': group.bit, title: group.about,
        'data-count': group.triangles.length, disabled: group.triangles.length === 0,
        onclick: () => {
          const which = group.next % group.places.length;
          group.next = which + 1;
          // A triangle may have several flags: the one that is looked for is on top.
          views.setFlags([group, ...groups.filter((other) => other !== group)]);
          find_place(views.lookAtTriangles(group.places[which]));
          place.textContent = ` ${which + 1} of ${number(group.places.length)}`;
        },
      }, swatch, `${group.name}: ${counted(group.triangles.length, 'triangle')}`,
      group.places.length > 1 ? ` in ${counted(group.places.length, 'place')}` : null, place);
    }));
}

/** What is known about a vertex, in words. */
export function describe(spot, arrays) {
  const v = spot.vertex;
  const parts = [`Vertex ${number(v)}`];
  parts.push(`at (${[0, 1, 2].map((c) => number(arrays.positions.value(v, c), 4)).join(', ')})`);
  const add = (name, array, text) => {
    if (array) parts.push(`${name} ${text(array.value(v))}`);
  };
  add('area', arrays.area_distortion, factor);
  add('angle', arrays.angle_distortion, (x) => number(x, 3));
  add('residual', arrays.residual, (x) => number(10 ** x, 2));
  if (arrays.suspicious && spot.triangle !== undefined) {
    const bits = arrays.suspicious.values[spot.triangle];
    const names = flags.filter((flag) => bits & flag.bit).map((flag) => flag.name.toLowerCase());
    if (names.length) parts.push(names.join(', '));
  }
  return parts.join(' · ');
}

export function showLegend(mode) {
  const place = byId('legend');
  place.dataset.mode = mode.key;
  place.replaceChildren(mode.legend());
}
