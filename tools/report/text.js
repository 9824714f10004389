// What the page says in words, tables and charts. Text from the data only ever becomes text: file
// names are not to be trusted.
'use strict';

const byId = (id) => document.getElementById(id);

function fill(node, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (name === 'style') Object.assign(node.style, value);
    else if (name.startsWith('on')) node.addEventListener(name.slice(2), value);
    else if (value !== false) node.setAttribute(name, value === true ? '' : String(value));
  }
  node.append(...children.flat().filter((child) => child !== null));
  return node;
}

function make(tag, attributes = {}, ...children) {
  return fill(document.createElement(tag), attributes, children);
}

function svg(tag, attributes = {}, ...children) {
  return fill(document.createElementNS('http://www.w3.org/2000/svg', tag), attributes, children);
}

/** A number as people write it: 1,234 or 0.0123 or 1.2e-7. */
function number(value, digits = 4) {
  if (!Number.isFinite(value)) return '–';
  if (Number.isInteger(value) && Math.abs(value) < 1e15) return value.toLocaleString('en');
  const size = Math.abs(value);
  return size !== 0 && (size < 1e-3 || size >= 1e6)
    ? value.toExponential(Math.min(digits - 1, 2)).replace('e+', 'e')
    : String(Number(value.toPrecision(digits)));
}

const counted = (count, one, many = `${one}s`) => `${number(count)} ${count === 1 ? one : many}`;

function inWords(value) {
  if (value === null || value === undefined || value === '') return '–';
  if (typeof value === 'boolean') return value ? 'yes' : 'no';
  if (typeof value === 'number') return number(value, 6);
  if (Array.isArray(value)) return value.map(inWords).join(' ');
  return typeof value === 'object' ? JSON.stringify(value) : String(value);
}

function showVerdict(data) {
  const report = data.report;
  const title = String(report.input ?? 'Report').split(/[/\\]/).pop();
  document.title = `Report on ${title}`;
  byId('title').textContent = title;
  byId('tool').textContent = `${data.tool.name} ${data.tool.version} ·`;
  byId('size').textContent = `${counted(data.mesh.vertices, 'vertex', 'vertices')}, ` +
    counted(data.mesh.triangles, 'triangle');

  const crossing = report.intersecting_triangles;
  const checks = [
    [report.manifold, 'Manifold', 'Not manifold'],
    [report.oriented, 'Oriented', 'Not oriented'],
    [crossing === 0, 'No self-intersections',
      `${report.intersections_are_sampled ? 'At least ' : ''}${number(crossing)} of ${counted(data.mesh.triangles, 'triangle')} intersect`],
  ];
  const handles = (report.handles ?? []).filter((handle) => !handle.is_cut).length;
  if (report.closed || handles > 0) {
    checks.unshift([report.genus === handles, `Genus ${handles}`, `Genus ${report.genus}`],
      [report.components === 1, 'One component', counted(report.components, 'component')]);
  }
  if (report.closed) checks.unshift([true, 'Closed', '']);
  const findings = report.findings ?? [];
  byId('verdict').dataset.kind = !checks.every(([good]) => good) ? 'bad'
    : findings.some((finding) => finding.is_fault) ? 'fair' : 'good';
  byId('verdict-words').textContent = report.verdict ?? '';
  byId('findings').replaceChildren(...checks.map(([good, yes, no]) =>
    make('li', { 'data-good': String(good) }, good ? `✓ ${yes}` : `✗ ${no}`)));
  byId('warnings').replaceChildren(...findings.map(({ text, option, value }) => make('li', {}, text,
    ...(option === '' ? [] : [': try ', make('code', {}, `-${option.replaceAll('_', '-')} ${value}`)]))));
}

const headRow = (name, ...cells) =>
  make('tr', {}, make('th', { scope: 'row' }, name), ...cells);

function showPairs(id, pairs) {
  byId(id).replaceChildren(make('table', {}, pairs.map(([name, value]) =>
    headRow(name, make('td', {}, inWords(value))))));
}

/** A table of objects that have the same keys. */
function showGrid(id, list) {
  byId(`${id}-card`).hidden = list.length === 0;
  const keys = Object.keys(list[0] ?? {});
  byId(id).replaceChildren(make('table', {},
    make('tr', {}, keys.map((key) => make('th', { scope: 'col' }, key.replaceAll('_', ' ')))),
    list.map((entry) => make('tr', {}, keys.map((key) => make('td', {}, inWords(entry[key])))))));
}

function showTables(data) {
  const report = data.report;
  const embedding = report.embedding ?? {};
  const { box_min: low, box_max: high } = report.measures ?? {};
  showPairs('numbers', [
    ['Points read', report.points],
    ['Points not finite', report.left_out?.not_finite?.length || undefined],
    ['Duplicates', report.duplicates],
    ['Stray points left out', report.left_out?.outliers?.length || undefined],
    ['Stray points in the mesh', report.outliers?.length || undefined],
    ['Vertices', report.vertices],
    ['Triangles', report.triangles],
    ['Openings left open', report.boundary?.length || undefined],
    ['Handles', report.handles?.filter((handle) => !handle.is_cut).length || undefined],
    ['Edges outside the graph', report.diagnosis?.edges_outside_graph],
    ['Volume', report.measures?.volume],
    ['Area', report.measures?.area],
    ['Mean edge length', report.measures?.mean_edge_length],
    ['Size', high?.map((x, c) => number(x - low[c])).join(' × ')],
    ['Residual', embedding.residual],
    ['Stopped', embedding.stop_reason?.replaceAll('_', ' ')],
    ['Points moved by smoothing (max)', report.smoothing?.max_displacement],
    ['Peak memory [bytes]', report.peak_memory_bytes],
  ].filter(([, value]) => value !== undefined && value !== null));
  showPairs('options', Object.entries(report.options ?? {}));
  showGrid('levels', embedding.levels ?? []);
  byId('command').textContent = data.command;
  byId('json').addEventListener('toggle', () => {
    byId('json').lastChild.textContent = JSON.stringify(report, null, 2);
  });
}

function showStages(stages) {
  const longest = Math.max(...stages.map((stage) => stage.seconds), 1e-9);
  byId('stages').replaceChildren(make('table', {}, stages.map((stage) =>
    headRow(stage.name.replaceAll('_', ' '),
      make('td', { class: 'meter' },
        make('div', { style: { width: `${(100 * stage.seconds) / longest}%` } })),
      make('td', {}, `${number(stage.seconds, 3)} s`)))));
}

/**
 * A curve of positive numbers over their index on a logarithmic axis. A click calls `seek` with an
 * index. Returns a function that moves a cursor to an index; null hides it.
 */
function showCurve(id, values, label, seek) {
  const [width, height, left, bottom] = [560, 220, 50, 186];
  const last = Math.max(values.length - 1, 1);
  const known = values.map((value, i) => [i, Math.log10(value)])
    .filter(([, exponent]) => Number.isFinite(exponent));
  if (known.length < 2) return () => {};
  const exponents = known.map(([, exponent]) => exponent);
  const low = Math.floor(exponents.reduce((a, b) => Math.min(a, b)));
  const high = Math.max(Math.ceil(exponents.reduce((a, b) => Math.max(a, b))), low + 1);
  const x = (i) => left + (i / last) * (width - left - 10);
  const y = (e) => 10 + ((high - e) / (high - low)) * (bottom - 10);
  const root = svg('svg', { viewBox: `0 0 ${width} ${height}`, role: 'img', 'aria-label': label });
  const step = Math.ceil((high - low) / 6);
  for (let e = low; e <= high; e += step) {
    root.append(svg('line', { x1: left, x2: width - 10, y1: y(e), y2: y(e), class: 'grid' }),
      svg('text', { x: left - 6, y: y(e) + 4, 'text-anchor': 'end' }, `1e${e}`));
  }
  root.append(svg('text', { x: left, y: bottom + 16 }, '0'),
    svg('text', { x: width - 10, y: bottom + 16, 'text-anchor': 'end' }, number(last)),
    svg('text', { x: width / 2, y: height - 6, 'text-anchor': 'middle' }, label));
  // Not more points than the curve has pixels, and always the last.
  const stride = Math.ceil(known.length / 2000);
  const shown = known.filter((entry, k) => k % stride === 0 || k === known.length - 1);
  root.append(svg('path', { class: 'curve',
    d: `M${shown.map(([i, e]) => `${x(i).toFixed(1)} ${y(e).toFixed(1)}`).join('L')}` }));
  const cursor = svg('line', { y1: 10, y2: bottom, class: 'cursor', visibility: 'hidden' });
  root.append(cursor);
  root.addEventListener('click', (event) => {
    const rect = root.getBoundingClientRect();
    const along = (((event.clientX - rect.left) / rect.width) * width - left) / (width - left - 10);
    seek(Math.round(Math.min(Math.max(along, 0), 1) * last));
  });
  byId(id).append(root);
  return (i) => {
    cursor.setAttribute('visibility', i === null ? 'hidden' : 'visible');
    cursor.setAttribute('x1', x(i ?? 0));
    cursor.setAttribute('x2', x(i ?? 0));
  };
}
