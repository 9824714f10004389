// Reads the data of the report: JSON and packed arrays, as the tool writes them beside the page.

/** What is wrong with the file, in words for the reader of the page. */
export class DataError extends Error {}

const byte_count = { u8: 1, u16: 2, u32: 4 };
const types = { u8: Uint8Array, u16: Uint16Array, u32: Uint32Array };

export function readReport() {
  const element = document.getElementById('report-data');
  if (!element) {
    throw new DataError('This page holds no data. Write one with the option -report of the tool.');
  }
  let data;
  try {
    data = JSON.parse(element.textContent);
  } catch {
    throw new DataError('The data of this page cannot be read: the file is damaged or cut off.');
  }
  if (!data || typeof data !== 'object' || data.format !== 1) {
    throw new DataError('The data of this page are of a format that the page does not know.');
  }
  return data;
}

function bytesOfText(text) {
  const binary = atob(text.trim());
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

async function inflate(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Undoes planes and differences; component c of row i is at i * components + c. */
export function unpack(bytes, type, components, count) {
  const width = byte_count[type];
  if (bytes.length !== width * components * count) throw new Error('size');
  const values = new types[type](components * count);
  for (let c = 0; c < components; ++c) {
    const plane = c * width * count;
    let value = 0; // of the row before; what is above the type's bits is cut off when stored
    for (let i = 0, to = c; i < count; ++i, to += components) {
      let difference = bytes[plane + i];
      if (width > 1) difference |= bytes[plane + count + i] << 8;
      if (width > 2) {
        difference |= (bytes[plane + 2 * count + i] << 16) | (bytes[plane + 3 * count + i] << 24);
      }
      value = (value + difference) | 0;
      values[to] = value;
    }
  }
  return values;
}

/** An array of the file; `values` are the integers that are stored. */
class PackedArray {
  constructor(values, about) {
    this.values = values;
    this.components = about.components;
    this.count = about.count;
    this.min = about.min;
    this.max = about.max;
    this.steps = about.type === 'u8' ? 255 : 65535;
  }

  /** What a stored integer of a component means. */
  meaning(q, c = 0) {
    return this.min[c] + (q / this.steps) * (this.max[c] - this.min[c]);
  }

  value(i, c = 0) {
    return this.meaning(this.values[i * this.components + c], c);
  }

  floats() {
    const out = new Float32Array(this.values.length);
    const n = this.components;
    for (let c = 0; c < n; ++c) {
      const from = this.min[c];
      const step = (this.max[c] - from) / this.steps;
      for (let i = c; i < out.length; i += n) out[i] = from + step * this.values[i];
    }
    return out;
  }
}

const layouts = {
  positions: { type: 'u16', components: 3, scaled: true },
  sphere: { type: 'u16', components: 3, scaled: true },
  triangles: { type: 'u32', components: 3 },
  cloud: { type: 'u16', components: 3, scaled: true },
  cloud_removed: { type: 'u8', components: 1 },
  colors: { type: 'u8', components: 3 },
  area_distortion: { type: /^u(8|16)$/, components: 1, scaled: true },
  angle_distortion: { type: /^u(8|16)$/, components: 1, scaled: true },
  residual: { type: /^u(8|16)$/, components: 1, scaled: true },
  suspicious: { type: 'u8', components: 1 },
  history_triangles: { type: 'u32', components: 3 },
  history_positions: { type: 'u16', components: 3, scaled: true },
  history_frames: { type: 'u16', components: 3, scaled: true },
};

function isOfType(type, wanted) {
  return wanted instanceof RegExp ? wanted.test(type) : type === wanted;
}

function areNumbers(list, count) {
  return Array.isArray(list) && list.length === count && list.every(Number.isFinite);
}

async function readArray(name, about) {
  const layout = layouts[name];
  const damaged = (why) => new DataError(`The array "${name}" is damaged: ${why}.`);
  if (!isOfType(about.type, layout.type) || about.components !== layout.components ||
      !Number.isSafeInteger(about.count) || about.count < 0) {
    throw damaged('its description is not as it should be');
  }
  if (layout.scaled &&
      !(areNumbers(about.min, about.components) && areNumbers(about.max, about.components))) {
    throw damaged('it has no range');
  }
  const element = document.getElementById(`array-${name}`);
  if (!element) throw damaged('it is missing');
  let bytes;
  try {
    bytes = await inflate(bytesOfText(element.textContent));
  } catch {
    throw damaged('it cannot be unpacked');
  }
  element.remove(); // the text is not needed again, and may be large
  try {
    return new PackedArray(unpack(bytes, about.type, about.components, about.count), about);
  } catch {
    throw damaged('it is too short or too long');
  }
}

function check(arrays, name, other, count) {
  if (arrays[name] && arrays[name].count !== count) {
    throw new DataError(`The array "${name}" does not fit to "${other}": ` +
      `${arrays[name].count} rows in place of ${count}.`);
  }
}

function checkIndices(arrays, name, count) {
  const array = arrays[name];
  if (array && array.values.some((index) => index >= count)) {
    throw new DataError(`The array "${name}" names vertices that there are not.`);
  }
}

/**
 * All arrays by name. A damaged one that the views can do without is left out and told in
 * `problems`; without the mesh itself there is nothing to show.
 */
export async function readArrays(data, problems) {
  const arrays = {};
  const described = data.arrays && typeof data.arrays === 'object' ? data.arrays : {};
  const attempt = async (step) => {
    try {
      await step();
    } catch (error) {
      if (!(error instanceof DataError)) throw error;
      problems.push(error.message);
      return false;
    }
    return true;
  };
  const needed = ['positions', 'sphere', 'triangles'];
  for (const name of Object.keys(layouts)) {
    if (described[name]) {
      const read = async () => { arrays[name] = await readArray(name, described[name]); };
      if (needed.includes(name)) await read();
      else await attempt(read);
    } else if (needed.includes(name)) {
      throw new DataError(`The array "${name}" is missing.`);
    }
  }
  const vertices = arrays.positions.count;
  const triangles = arrays.triangles.count;
  if (vertices === 0 || triangles === 0) throw new DataError('The mesh is empty.');
  check(arrays, 'sphere', 'positions', vertices);
  checkIndices(arrays, 'triangles', vertices);

  const optional = [
    ['colors', 'positions', vertices], ['area_distortion', 'positions', vertices],
    ['angle_distortion', 'positions', vertices], ['residual', 'positions', vertices],
    ['suspicious', 'triangles', triangles], ['cloud_removed', 'cloud', arrays.cloud?.count ?? 0],
  ];
  for (const [name, other, count] of optional) {
    if (!(await attempt(() => check(arrays, name, other, count)))) delete arrays[name];
  }
  const history_is_good = await attempt(() => {
    if (!data.history || !arrays.history_frames) return;
    const frames = Array.isArray(data.history.frames) ? data.history.frames.length : 0;
    const nodes = data.history.vertices;
    if (!arrays.history_positions || !arrays.history_triangles || !(nodes > 0) || frames === 0) {
      throw new DataError('The history is not complete.');
    }
    check(arrays, 'history_positions', 'history', nodes);
    check(arrays, 'history_frames', 'history', frames * nodes);
    checkIndices(arrays, 'history_triangles', nodes);
  });
  if (!history_is_good) delete arrays.history_frames;
  return arrays;
}
