// What the page tells in words and tables. Any field may be missing: it is left out then.
import { byId, bytes, counted, make, number } from './dom.js';

const is_number = Number.isFinite;

function fileName(path) {
  return typeof path === 'string' ? path.split(/[/\\]/).pop() : '';
}

/** [{good: true|false|null, text}], the worst of which makes the verdict. */
function findings(report) {
  const out = [];
  const add = (good, text) => out.push({ good, text });
  if (report.closed !== undefined) {
    add(report.closed === true, report.closed ? 'Closed' : 'Not closed');
  }
  if (report.manifold !== undefined) {
    add(report.manifold === true, report.manifold ? 'Manifold' : 'Not manifold');
  }
  if (report.oriented !== undefined) {
    add(report.oriented === true, report.oriented ? 'Oriented' : 'Not oriented');
  }
  if (is_number(report.genus)) add(report.genus === 0, `Genus ${report.genus}`);
  if (is_number(report.components) && report.components !== 1) {
    add(false, counted(report.components, 'component'));
  }
  const crossing = report.self_intersections;
  if (is_number(crossing)) {
    add(crossing === 0, crossing === 0 ? 'No self-intersections'
      : `${counted(crossing, 'pair')} of triangles intersect`);
  }
  const after = report.smoothing?.self_intersections;
  if (is_number(after) && after > 0 && !(crossing > 0)) {
    add(false, `Smoothing made ${counted(after, 'self-intersection')}`);
  }
  return out;
}

export function showVerdict(data) {
  const report = data.report ?? {};
  const input = fileName(report.input);
  document.title = input ? `Report on ${input}` : 'Report';
  byId('title').textContent = input || 'Report';
  const tool = data.tool ?? {};
  byId('tool').textContent = [tool.name, tool.version].filter(Boolean).join(' ');

  const list = findings(report);
  const diagnosis = report.diagnosis ?? {};
  const warnings = (Array.isArray(report.warnings) ? report.warnings : []).map(String);
  const sound = list.every((finding) => finding.good !== false);
  const looks_right = diagnosis.looks_closed_genus0 !== false;
  const verdict = byId('verdict');
  const [kind, words] = !sound ? ['bad', 'The mesh has faults']
    : !looks_right || warnings.length > 0 ? ['fair', 'A sound mesh, with doubts about the input']
      : ['good', 'A sound mesh'];
  verdict.dataset.kind = kind;
  byId('verdict-words').textContent = list.length ? words : 'No verdict in this file';
  byId('verdict-icon').textContent = { good: '✓', fair: '!', bad: '✗' }[kind];
  byId('summary').textContent = diagnosis.summary ?? '';
  byId('findings').replaceChildren(...list.map((finding) =>
    make('li', { 'data-good': String(finding.good) },
      make('span', { 'aria-hidden': 'true' }, finding.good ? '✓ ' : '✗ '), finding.text)));
  byId('warnings').replaceChildren(
    ...warnings.filter((text) => text !== diagnosis.summary)
      .map((text) => make('li', {}, text)));
  byId('warnings').hidden = warnings.length === 0;
  showSize(data);
}

function showSize(data) {
  const mesh = data.mesh ?? {};
  const parts = [];
  if (is_number(mesh.vertices)) parts.push(counted(mesh.vertices, 'vertex', 'vertices'));
  if (is_number(mesh.triangles)) parts.push(counted(mesh.triangles, 'triangle'));
  byId('size').textContent = parts.join(', ');
  const note = byId('decimated');
  note.hidden = mesh.decimated !== true;
  note.textContent = note.hidden ? '' :
    `This page shows a simplified copy: ${number(mesh.shown_triangles)} of ` +
    `${counted(mesh.triangles, 'triangle')}, ${number(mesh.shown_vertices)} of ` +
    `${counted(mesh.vertices, 'vertex', 'vertices')}. ` +
    'Tables tell of the whole mesh, legends of the copy.';
}

function table(rows, caption) {
  return make('table', {},
    make('caption', {}, caption),
    make('tbody', {}, rows.map(([name, value]) =>
      make('tr', {}, make('th', { scope: 'row' }, name), make('td', {}, value)))));
}

function inWords(value) {
  if (value === null || value === undefined || value === '') return '–';
  if (value === true) return 'yes';
  if (value === false) return 'no';
  if (typeof value === 'number') return number(value, 6);
  if (Array.isArray(value)) return value.map(inWords).join(' ');
  return typeof value === 'object' ? JSON.stringify(value) : String(value);
}

export function showTables(data) {
  const report = data.report ?? {};
  const embedding = report.embedding ?? {};
  const levels = Array.isArray(embedding.levels) ? embedding.levels : [];
  const rows = [];
  const add = (name, value, text = inWords) => {
    if (value !== undefined && value !== null) rows.push([name, text(value)]);
  };
  add('Points read', report.points);
  add('Points not finite', report.ignored_points);
  add('Duplicates', report.duplicates);
  add('Outliers left out', report.outliers?.count);
  add('Vertices', report.vertices);
  add('Triangles', report.triangles);
  add('Self-intersecting pairs', report.self_intersections);
  add('Edges outside the graph', report.edges_outside_graph,
    (value) => `${number(100 * value, 3)} %`);
  add('Volume', report.volume, (value) => number(value, 6));
  add('Area', report.area, (value) => number(value, 6));
  add('Mean edge length', report.measures?.mean_edge_length);
  const box = report.measures?.bounding_box;
  if (Array.isArray(box?.min) && Array.isArray(box?.max)) {
    add('Box', box.max.map((x, c) => number(x - box.min[c])).join(' × '), String);
  }
  add('Graph edges', report.graph?.edges);
  add('Energy of the sphere', embedding.energy);
  add('Residual', report.residual);
  add('Stopped', report.stop_reason, String);
  add('Starts', embedding.starts);
  add('Diagnosis', report.diagnosis?.kind, String);
  add('Smoothing steps', report.smoothing?.steps);
  add('Points moved by smoothing (max)', report.smoothing?.max_displacement);
  add('Peak memory', report.peak_memory_bytes, bytes);
  byId('numbers').replaceChildren(table(rows, 'Numbers'));

  const options = Object.entries(report.options ?? {});
  byId('options').replaceChildren(
    table(options.map(([name, value]) => [name, inWords(value)]), 'Options'));
  showGrid('levels', 'Levels, the finest first', levels, [
    ['Nodes', 'nodes'], ['Edges', 'edges'], ['Sweeps', 'sweeps'],
    ['Newton', 'newton_iterations'], ['CG', 'linear_iterations'], ['Residual', 'residual'],
  ]);
  const attempts = Array.isArray(report.attempts) ? report.attempts : [];
  showGrid('attempts', 'Attempts', attempts.length > 1 ? attempts : [], [
    ['Attempt', 'description'], ['Self-intersections', 'self_intersections'],
    ['Energy', 'energy'], ['Chosen', 'chosen'],
  ]);
}

function showGrid(id, caption, list, columns) {
  const place = byId(id);
  place.hidden = list.length === 0;
  if (place.hidden) return;
  place.replaceChildren(make('table', { class: 'grid' },
    make('caption', {}, caption),
    make('thead', {}, make('tr', {}, columns.map(([title]) =>
      make('th', { scope: 'col' }, title)))),
    make('tbody', {}, list.map((entry) => make('tr', {}, columns.map(([, key]) =>
      make('td', {}, inWords(entry[key]))))))));
}

async function copyText(text) {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    // Not allowed, or an old browser: the way of old.
    const area = make('textarea', { readonly: true, 'aria-hidden': 'true' });
    area.value = text;
    document.body.append(area);
    area.select();
    const done = document.execCommand('copy');
    area.remove();
    return done;
  }
}

export function showCommand(data) {
  const command = typeof data.command === 'string' ? data.command : '';
  byId('command').textContent = command;
  const button = byId('copy');
  button.disabled = command === '';
  button.addEventListener('click', async () => {
    const done = await copyText(command);
    byId('copied').textContent = done ? 'Copied' : 'Select the text and copy it by hand';
    if (!done) getSelection().selectAllChildren(byId('command'));
    setTimeout(() => { byId('copied').textContent = ''; }, 4000);
  });
}
