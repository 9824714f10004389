// What the page says in words and tables. Text from the data only ever becomes text: file names are not to be
// trusted.
'use strict';

const byId = (id) => document.getElementById(id);

function make(tag, { style, onclick, ...attributes } = {}, ...children) {
  const node = document.createElement(tag);
  Object.assign(node.style, style);
  if (onclick) node.addEventListener('click', onclick);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  node.append(...children.flat());
  return node;
}

/** A number as people write it: 1,234 or 0.0123 or 1.2e-7. */
function number(value, digits = 4) {
  if (!Number.isFinite(value)) return '–';
  if (Number.isInteger(value) && Math.abs(value) < 1e15) return value.toLocaleString('en');
  const size = Math.abs(value);
  return size !== 0 && (size < 1e-3 || size >= 1e6)
    ? value.toExponential(Math.min(digits - 1, 2)).replace('e+', 'e') : String(Number(value.toPrecision(digits)));
}

const counted = (count, one, many = `${one}s`) => `${number(count)} ${count === 1 ? one : many}`;

function inWords(value) {
  if (value === null || value === undefined || value === '') return '–';
  if (typeof value === 'boolean') return value ? 'yes' : 'no';
  if (typeof value === 'number') return number(value, 6);
  if (Array.isArray(value)) return value.map(inWords).join(' ');
  return typeof value === 'object' ? JSON.stringify(value) : String(value);
}

/** The report of each surface. */
const partsOf = (report) => report.parts ?? [report];

/** A sum over surfaces; undefined if none has a number. */
function total(report, numberOf) {
  const numbers = partsOf(report).map(numberOf).filter((x) => x !== undefined && x !== null);
  return numbers.length > 0 ? numbers.reduce((sum, x) => sum + x) : undefined;
}

function showVerdict({ report, tool, mesh }) {
  const title = String(report.input ?? 'Report').split(/[/\\]/).pop();
  document.title = `Report on ${title}`;
  byId('title').textContent = title;
  const part = mesh.shown_surfaces > 1 ? ` ${number(mesh.shown_surfaces)} surfaces:`
    : mesh.surfaces > 1 ? ` surface ${mesh.surface} of ${number(mesh.surfaces)}:` : '';
  byId('tool').textContent = `${tool.name} ${tool.version} ·${part}`;
  const triangles = counted(mesh.triangles, 'triangle');
  byId('size').textContent = `${counted(mesh.vertices, 'vertex', 'vertices')}, ${triangles}`;

  const parts = partsOf(report);
  const crossing = total(report, (part) => part.intersecting_triangles);
  const checks = [
    [parts.every((part) => part.manifold), 'Manifold', 'Not manifold'],
    [parts.every((part) => part.oriented), 'Oriented', 'Not oriented'],
    [crossing === 0, 'No self-intersections',
      `${parts.some((part) => part.intersections_are_sampled) ? 'At least ' : ''}${number(crossing)} of ${triangles} ` +
      'intersect'],
  ];
  const closed = parts.every((part) => part.closed);
  const [{ genus, components }] = parts;
  if (parts.length === 1 && (closed || genus > 0)) {
    checks.unshift([genus !== null, `Genus ${genus}`, 'No genus'],
      [components === 1, 'One component', counted(components, 'component')]);
  }
  if (closed) checks.unshift([true, 'Closed', '']);
  const findings = report.findings ?? [];
  byId('verdict').dataset.kind = !checks.every(([good]) => good) ? 'bad'
    : findings.some((finding) => finding.is_fault) ? 'fair' : 'good';
  byId('verdict-words').textContent = report.verdict ?? '';
  byId('findings').replaceChildren(...checks.map(([good, yes, no]) =>
    make('li', { 'data-good': good }, good ? `✓ ${yes}` : `✗ ${no}`)));
  byId('warnings').replaceChildren(...findings.map(({ text, option, value }) => make('li', {}, text,
    option === '' ? [] : [': try ', make('code', {}, `-${option.replaceAll('_', '-')} ${value}`)])));
}

const headRow = (name, ...cells) => make('tr', {}, make('th', { scope: 'row' }, name), cells);

const showTable = (id, rows) => byId(id).replaceChildren(make('table', {}, rows));

const showPairs = (id, pairs) =>
  showTable(id, pairs.map(([name, value]) => headRow(name, make('td', {}, inWords(value)))));

function showTables({ report, command }) {
  const sum = (numberOf) => total(report, numberOf);
  const { embedding = {}, diagnosis, measures, smoothing } = report.parts?.length > 1 ? {} : partsOf(report)[0];
  showPairs('numbers', [
    ['Points read', report.points],
    ['Points not finite', report.left_out?.not_finite?.length || undefined],
    ['Duplicates', sum((part) => part.duplicates)],
    ['Stray points left out', report.left_out?.outliers?.length || undefined],
    ['Points in other parts', report.left_out?.other_parts?.length || undefined],
    ['Points that cannot be meshed', report.left_out?.unmeshed?.length || undefined],
    ['Stray points in the mesh', sum((part) => part.outliers?.length) || undefined],
    ['Vertices', sum((part) => part.vertices)],
    ['Triangles', sum((part) => part.triangles)],
    ['Openings left open', sum((part) => part.boundary?.length) || undefined],
    ['Handles', sum((part) => part.genus) || undefined],
    ['Edges outside the graph', diagnosis?.edges_outside_graph],
    ['Volume', sum((part) => part.measures?.volume)],
    ['Area', sum((part) => part.measures?.area)],
    ['Mean edge length', measures?.mean_edge_length],
    ['Size', measures?.box_max?.map((x, c) => number(x - measures.box_min[c])).join(' × ')],
    ['Residual', embedding.residual || undefined],
    ['Embedding', embedding.stop_reason === 'unfinished' ? null : embedding.stop_reason?.replaceAll('_', ' ')],
    ['Points moved by smoothing (max)', smoothing?.max_displacement],
    ['Peak memory [bytes]', report.peak_memory_bytes],
  ].filter(([, value]) => value !== undefined && value !== null));
  showPairs('options', Object.entries(report.options ?? {}));
  const levels = embedding.levels ?? [];
  const keys = Object.keys(levels[0] ?? {}); // of all levels
  byId('levels-card').hidden = levels.length === 0;
  showTable('levels', [
    make('tr', {}, keys.map((key) => make('th', { scope: 'col' }, key.replaceAll('_', ' ')))),
    ...levels.map((level) => make('tr', {}, keys.map((key) => make('td', {}, inWords(level[key]))))),
  ]);
  byId('command').textContent = command;
  byId('json').addEventListener('toggle', () => {
    byId('json').lastChild.textContent = JSON.stringify(report, null, 2);
  });
}

function showStages(stages) {
  const longest = Math.max(...stages.map((stage) => stage.seconds), 1e-9);
  showTable('stages', stages.map(({ name, seconds }) => headRow(name.replaceAll('_', ' '),
    make('td', { class: 'meter' }, make('div', { style: { width: `${(100 * seconds) / longest}%` } })),
    make('td', {}, `${number(seconds, 3)} s`))));
}
