// Residual and times as pictures. Colours are those of the style sheet.
import { byId, make, number, seconds, svg } from './dom.js';

const box = { width: 560, height: 240, left: 52, right: 12, top: 14, bottom: 34 };

function ticksBetween(low, high, most) {
  const step = Math.max(Math.ceil((high - low) / most), 1);
  const out = [];
  for (let x = Math.ceil(low); x <= high; x += step) out.push(x);
  return out;
}

const superscript = (exponent) =>
  `10${String(exponent).replace(/[-0-9]/g, (digit) => '⁻⁰¹²³⁴⁵⁶⁷⁸⁹'['-0123456789'.indexOf(digit)])}`;

/**
 * Curve of positive numbers over their index, logarithmic. `bands`: [{from, to, text}] along x.
 * `count`: how many there were, if `values` are some in even distances from the first to the last.
 * Returns a function that moves the cursor.
 */
function logChart(place, values, { x_label, bands, about, seek, count = values.length }) {
  const known = values.map((value, i) => [i, value])
    .filter(([, value]) => Number.isFinite(value) && value > 0);
  const exponents = known.map(([, value]) => Math.log10(value));
  // Not as arguments of one call: there may be more than a call takes.
  let low = Math.floor(exponents.reduce((a, b) => Math.min(a, b)));
  const high = Math.max(Math.ceil(exponents.reduce((a, b) => Math.max(a, b))), low + 1);
  low = Math.min(low, high - 1);
  const last = Math.max(values.length - 1, 1);
  const x = (i) => box.left + (i / last) * (box.width - box.left - box.right);
  const y = (e) => box.top + ((high - e) / (high - low)) * (box.height - box.top - box.bottom);
  const bottom = box.height - box.bottom;

  const root = svg('svg', {
    viewBox: `0 0 ${box.width} ${box.height}`, role: 'img', 'aria-label': about,
  });
  (bands ?? []).forEach((band, i) => {
    const from = x(Math.max(band.from - 0.5, 0));
    const to = x(Math.min(band.to + 0.5, last));
    root.append(svg('rect', {
      x: from, y: box.top, width: Math.max(to - from, 0), height: bottom - box.top,
      class: i % 2 ? 'band odd' : 'band',
    }, svg('title', {}, band.text)));
    if (to - from > 7 * band.text.length) {
      root.append(svg('text', { x: (from + to) / 2, y: box.top + 12, class: 'middle faint' },
        band.text));
    }
  });
  for (const e of ticksBetween(low, high, 6)) {
    root.append(svg('line', { x1: box.left, x2: box.width - box.right, y1: y(e), y2: y(e),
      class: 'grid' }),
    svg('text', { x: box.left - 6, y: y(e) + 4, class: 'end' }, superscript(e)));
  }
  const last_number = Math.max(count - 1, 1);
  for (const i of ticksBetween(0, last_number, 8)) {
    root.append(svg('text', { x: x((i / last_number) * last), y: bottom + 15, class: 'middle' }, number(i)));
  }
  root.append(svg('text', { x: (box.left + box.width - box.right) / 2, y: box.height - 3,
    class: 'middle faint' }, x_label));
  // A gap where a value is not known.
  const pieces = [];
  known.forEach(([i], k) => {
    const command = k > 0 && known[k - 1][0] === i - 1 ? 'L' : 'M';
    pieces.push(`${command}${x(i).toFixed(1)} ${y(exponents[k]).toFixed(1)}`);
  });
  root.append(svg('path', { d: pieces.join(''), class: 'curve' }));
  if (known.length <= 120) {
    known.forEach(([i, value], k) => root.append(
      svg('circle', { cx: x(i), cy: y(exponents[k]), r: 2.6, class: 'dot' },
        svg('title', {}, `${i}: ${number(value)}`))));
  }
  const cursor = svg('line', { y1: box.top, y2: bottom, class: 'cursor', visibility: 'hidden' });
  root.append(cursor);
  if (seek) {
    root.style.cursor = 'pointer';
    root.addEventListener('click', (event) => {
      const rect = root.getBoundingClientRect();
      const at = ((event.clientX - rect.left) / rect.width) * box.width;
      const along = (at - box.left) / (box.width - box.left - box.right);
      seek(Math.min(Math.max(Math.round(along * last), 0), last));
    });
  }
  place.append(root);
  return (i) => {
    cursor.setAttribute('visibility', i === null ? 'hidden' : 'visible');
    if (i !== null) {
      cursor.setAttribute('x1', x(i));
      cursor.setAttribute('x2', x(i));
    }
  };
}

function isCurve(values) {
  return values.filter((value) => Number.isFinite(value) && value > 0).length >= 2;
}

/** Returns a function that marks a frame of the history. */
export function showResiduals(data, seek) {
  const place = byId('residuals');
  place.replaceChildren();
  const report = data.report ?? {};
  let move = () => {};
  const frames = Array.isArray(data.history?.frames) ? data.history.frames : [];
  const of_frames = frames.map((frame) => frame.residual);
  if (isCurve(of_frames)) {
    const bands = [];
    frames.forEach((frame, i) => {
      const band = bands[bands.length - 1];
      if (band && band.level === frame.level) band.to = i;
      else bands.push({ level: frame.level, from: i, to: i, text: `${number(frame.nodes)} nodes` });
    });
    place.append(make('p', { class: 'hint' }, seek
      ? 'At each frame of the unfolding, coarse to fine. Click to go to a frame.'
      : 'At each frame of the unfolding, coarse to fine.'));
    move = logChart(place, of_frames, {
      x_label: 'frame', bands, seek, about: 'Residual at each frame of the unfolding',
    });
  }
  const residuals = Array.isArray(report.residuals) ? report.residuals : [];
  if (isCurve(residuals)) {
    place.append(make('p', { class: 'hint' }, 'After each iteration of the solver.'));
    logChart(place, residuals, {
      x_label: 'iteration', about: 'Residual after each iteration', count: data.residual_count,
    });
  }
  if (!place.firstChild) {
    // Coarse to fine, as they are solved.
    const levels = (Array.isArray(report.embedding?.levels) ? [...report.embedding.levels] : [])
      .reverse();
    const of_levels = levels.map((level) => level.residual);
    if (isCurve(of_levels)) {
      place.append(make('p', { class: 'hint' }, 'At the end of each level, coarse to fine.'));
      logChart(place, of_levels, {
        x_label: 'level', about: 'Residual at the end of each level',
        bands: levels.map((level, i) => ({ from: i, to: i, text: number(level.nodes) })),
      });
    } else {
      place.append(make('p', { class: 'hint' }, Number.isFinite(report.residual)
        ? `Only its last value is known: ${number(report.residual)}.` : 'Not in this file.'));
    }
  }
  return move;
}

export function showStages(data) {
  const stages = (Array.isArray(data.report?.stages) ? data.report.stages : [])
    .filter((stage) => Number.isFinite(stage.seconds));
  const place = byId('stages');
  if (stages.length === 0) {
    place.replaceChildren(make('p', { class: 'hint' }, 'Not in this file.'));
    return;
  }
  const longest = Math.max(...stages.map((stage) => stage.seconds)) || 1;
  const total = stages.reduce((sum, stage) => sum + stage.seconds, 0);
  place.replaceChildren(
    make('p', { class: 'hint' }, `${seconds(total)} in all.`),
    make('ul', { class: 'bars' }, stages.map((stage) => make('li', {},
      make('span', { class: 'bar-name' }, String(stage.name).replaceAll('_', ' ')),
      make('span', { class: 'bar-track', 'aria-hidden': 'true' },
        make('span', { class: 'bar', style: {
          width: `${Math.max((100 * stage.seconds) / longest, 0.4)}%` } })),
      make('span', { class: 'bar-value' }, seconds(stage.seconds))))));
}
