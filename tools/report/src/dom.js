// Elements from plain values. Text only ever becomes text: file names are not to be trusted.

export const byId = (id) => document.getElementById(id);

function apply(node, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (name === 'style') Object.assign(node.style, value);
    else if (name.startsWith('on')) node.addEventListener(name.slice(2), value);
    else if (value !== null && value !== undefined && value !== false) {
      node.setAttribute(name, value === true ? '' : String(value));
    }
  }
  for (const child of children.flat()) {
    if (child !== null && child !== undefined) node.append(child);
  }
  return node;
}

export function make(tag, attributes = {}, ...children) {
  return apply(document.createElement(tag), attributes, children);
}

export function svg(tag, attributes = {}, ...children) {
  return apply(document.createElementNS('http://www.w3.org/2000/svg', tag), attributes, children);
}

/** A number as people write it: 1,234 or 0.0123 or 1.2e-7. */
export function number(value, digits = 4) {
  if (!Number.isFinite(value)) return '–';
  if (Number.isInteger(value) && Math.abs(value) < 1e15) return value.toLocaleString('en');
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e6)) {
    return value.toExponential(Math.min(digits - 1, 2)).replace('e+', 'e');
  }
  return String(Number(value.toPrecision(digits)));
}

export function seconds(value) {
  if (!Number.isFinite(value)) return '–';
  if (value >= 120) return `${Math.floor(value / 60)} min ${Math.round(value % 60)} s`;
  if (value >= 1) return `${Number(value.toPrecision(3))} s`;
  return `${Number((1000 * value).toPrecision(2))} ms`;
}

export function bytes(value) {
  const units = ['B', 'KB', 'MB', 'GB', 'TB'];
  let unit = 0;
  while (value >= 1000 && unit + 1 < units.length) {
    value /= 1000;
    ++unit;
  }
  return `${Number(value.toPrecision(3))} ${units[unit]}`;
}

export function counted(count, one, many = `${one}s`) {
  return `${number(count)} ${count === 1 ? one : many}`;
}
