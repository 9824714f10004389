// Puts the page together: words and tables first, which need no WebGL, then the views.
import { placeColors } from './colors.js';
import { showResiduals, showStages } from './charts.js';
import { DataError, readArrays, readReport } from './decode.js';
import { byId, make } from './dom.js';
import { Player } from './history.js';
import { describe, makeModes, showLegend } from './modes.js';
import { showCommand, showTables, showVerdict } from './text.js';
import { removed_color, view_names, Views, webglContext } from './views.js';

function tellProblem(text) {
  byId('problems').hidden = false;
  byId('problems').append(make('p', {}, text));
}

function hideViews(why) {
  byId('views-note').textContent = why;
  byId('views-note').hidden = false;
  for (const id of ['toolbar', 'views', 'legend', 'readout', 'unfolding', 'keys']) {
    byId(id).hidden = true;
  }
}

/** A button that is on or off. */
function toggle(id, changed) {
  const button = byId(id);
  button.addEventListener('click', () => {
    const on = button.getAttribute('aria-pressed') !== 'true';
    button.setAttribute('aria-pressed', String(on));
    changed(on);
  });
}

function follow(query, changed) {
  const media = matchMedia(query);
  media.addEventListener('change', () => changed(media.matches));
  changed(media.matches);
}

function labelCloud(arrays) {
  const removed = arrays.cloud_removed
    ? arrays.cloud_removed.values.reduce((sum, flag) => sum + (flag ? 1 : 0), 0) : 0;
  if (removed > 0) {
    byId('cloud-note').replaceChildren(
      make('span', { class: 'swatch', style: { background: `rgb(${removed_color.join(' ')})` } }),
      `${removed.toLocaleString('en')} outliers left out`);
  }
}

function showViews(data, arrays) {
  const canvas = byId('canvas');
  const context = webglContext(canvas);
  if (!context) {
    hideViews('This browser has no WebGL 2 here, which the 3D views need: all else is below. ' +
      'Try another browser, or switch on hardware acceleration in its settings.');
    return null;
  }
  const panels = Object.fromEntries(view_names.map((name) => [name, byId(`view-${name}`)]));
  byId('views').hidden = false;
  const views = new Views(canvas, context, panels, arrays);
  labelCloud(arrays);
  follow('(prefers-color-scheme: dark)', (dark) => views.setTheme(dark));
  toggle('wireframe', (on) => views.setWireframe(on));
  toggle('normals', (on) => views.setNormals(on));
  toggle('flat', (on) => views.setFlat(on));
  byId('reset').addEventListener('click', () => views.reset());

  // A click keeps a point; until then the mark follows the pointer.
  let kept = null;
  const point = (spot) => {
    views.mark(spot);
    byId('readout').textContent = spot ? describe(spot, arrays)
      : 'Point at a view: the same point is marked in all. Click to keep it.';
    byId('readout').dataset.vertex = spot ? spot.vertex : '';
  };
  const keep = (spot) => {
    kept = spot;
    point(spot);
  };
  views.on('hover', (spot) => { if (!kept) point(spot); });
  views.on('pick', keep);
  point(null);

  const modes = makeModes(arrays, views, keep);
  const select = byId('color');
  select.replaceChildren(...[...modes.values()].map((mode) =>
    make('option', { value: mode.key }, mode.name)));
  const colors_on_object = placeColors(views.positions, views.box);
  const unfolding = {
    key: 'object',
    colors: () => colors_on_object,
    legend: () => make('p', { class: 'words' }, make('strong', {}, 'Unfolding'),
      ' – while it is shown, colours mean the position on the object. Dark is what lies inside ' +
      'out: the sphere is folded there.'),
  };
  const paint = () => {
    const mode = views.fraction === null ? modes.get(select.value) : unfolding;
    views.setColors(mode.colors());
    views.setGrid(mode.grid === true);
    views.setFlags(mode.groups ?? []);
    showLegend(mode);
    select.disabled = mode === unfolding;
  };
  select.addEventListener('change', paint);

  let move_cursor = () => {};
  let player = null;
  if (arrays.history_frames) {
    views.setHistoryColors(placeColors(views.history_places, views.box));
    player = new Player(views, data.history.frames, (frame) => {
      paint();
      move_cursor(frame);
    });
    byId('unfolding').hidden = false;
    move_cursor = showResiduals(data, (frame) => {
      player.pause();
      player.show(frame);
    });
  } else {
    paint();
  }
  return views;
}

async function main() {
  const data = readReport();
  showVerdict(data);
  showTables(data);
  showCommand(data);
  showStages(data);
  showResiduals(data, null);
  byId('content').hidden = false;

  let views = null;
  const problems = [];
  try {
    const arrays = await readArrays(data, problems);
    views = showViews(data, arrays);
  } catch (error) {
    if (!(error instanceof DataError)) throw error;
    hideViews('The 3D views cannot be shown.');
    problems.push(error.message);
  }
  problems.forEach(tellProblem);
  return views;
}

function finish(state) {
  byId('loading').hidden = true;
  document.documentElement.dataset.report = state;
  window.__reportReady = true;
}

main().then((views) => {
  // For those who drive the page by a script.
  window.__reportViews = views;
  finish(views ? 'ready' : 'text');
}).catch((error) => {
  tellProblem(error instanceof DataError ? error.message
    : `The page failed: ${error?.message ?? error}`);
  finish('failed');
});
