// Plain computations on flat arrays: x, y, z after each other.

/** Unit normals of vertices, weighted by area. */
export function vertexNormals(positions, triangles) {
  const normals = new Float32Array(positions.length);
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * triangles[t];
    const b = 3 * triangles[t + 1];
    const c = 3 * triangles[t + 2];
    const ux = positions[b] - positions[a];
    const uy = positions[b + 1] - positions[a + 1];
    const uz = positions[b + 2] - positions[a + 2];
    const vx = positions[c] - positions[a];
    const vy = positions[c + 1] - positions[a + 1];
    const vz = positions[c + 2] - positions[a + 2];
    const nx = uy * vz - uz * vy;
    const ny = uz * vx - ux * vz;
    const nz = ux * vy - uy * vx;
    for (const i of [a, b, c]) {
      normals[i] += nx;
      normals[i + 1] += ny;
      normals[i + 2] += nz;
    }
  }
  normalizeRows(normals);
  return normals;
}

export function normalizeRows(rows) {
  for (let i = 0; i < rows.length; i += 3) {
    const length = Math.hypot(rows[i], rows[i + 1], rows[i + 2]) || 1;
    rows[i] /= length;
    rows[i + 1] /= length;
    rows[i + 2] /= length;
  }
}

/** Each edge of a closed mesh once: it is run through once in each direction. */
export function edgesOf(triangles) {
  const edges = new Uint32Array(2 * triangles.length);
  let size = 0;
  for (let t = 0; t < triangles.length; t += 3) {
    for (let k = 0; k < 3; ++k) {
      const a = triangles[t + k];
      const b = triangles[t + ((k + 1) % 3)];
      if (a < b) {
        edges[size++] = a;
        edges[size++] = b;
      }
    }
  }
  return edges.subarray(0, size);
}

/**
 * Mean length of all edges, and the harmonic mean of those at each vertex: a long one, which
 * bridges a gap, says nothing about how dense the points are.
 */
export function spacings(positions, edges) {
  const at_vertex = new Float32Array(positions.length / 3);
  const counts = new Uint32Array(at_vertex.length);
  let sum = 0;
  for (let e = 0; e < edges.length; e += 2) {
    const a = 3 * edges[e];
    const b = 3 * edges[e + 1];
    const length = Math.hypot(positions[a] - positions[b], positions[a + 1] - positions[b + 1],
      positions[a + 2] - positions[b + 2]);
    sum += length;
    for (const v of [edges[e], edges[e + 1]]) {
      at_vertex[v] += 1 / Math.max(length, 1e-9);
      ++counts[v];
    }
  }
  for (let v = 0; v < at_vertex.length; ++v) at_vertex[v] = counts[v] / at_vertex[v] || 0;
  return { at_vertex, mean: edges.length ? (2 * sum) / edges.length : 0 };
}

/** The first triangle that a ray meets: {triangle, weights of its corners}, or null. */
export function hitTriangle(origin, direction, positions, triangles) {
  const [ox, oy, oz] = origin;
  const [dx, dy, dz] = direction;
  let nearest = Infinity;
  let hit = null;
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * triangles[t];
    const b = 3 * triangles[t + 1];
    const c = 3 * triangles[t + 2];
    const ax = positions[a];
    const ay = positions[a + 1];
    const az = positions[a + 2];
    const ux = positions[b] - ax;
    const uy = positions[b + 1] - ay;
    const uz = positions[b + 2] - az;
    const vx = positions[c] - ax;
    const vy = positions[c + 1] - ay;
    const vz = positions[c + 2] - az;
    const px = dy * vz - dz * vy;
    const py = dz * vx - dx * vz;
    const pz = dx * vy - dy * vx;
    const determinant = ux * px + uy * py + uz * pz;
    if (determinant === 0) continue;
    const sx = ox - ax;
    const sy = oy - ay;
    const sz = oz - az;
    const v = (sx * px + sy * py + sz * pz) / determinant;
    if (!(v >= 0 && v <= 1)) continue;
    const qx = sy * uz - sz * uy;
    const qy = sz * ux - sx * uz;
    const qz = sx * uy - sy * ux;
    const w = (dx * qx + dy * qy + dz * qz) / determinant;
    if (!(w >= 0 && v + w <= 1)) continue;
    const distance = (vx * qx + vy * qy + vz * qz) / determinant;
    if (distance > 0 && distance < nearest) {
      nearest = distance;
      hit = { triangle: t / 3, weights: [1 - v - w, v, w] };
    }
  }
  return hit;
}

/** Index of the row nearest to a place. */
export function nearestRow(rows, [x, y, z]) {
  let best = Infinity;
  let index = 0;
  for (let i = 0; i < rows.length; i += 3) {
    const distance = (rows[i] - x) ** 2 + (rows[i + 1] - y) ** 2 + (rows[i + 2] - z) ** 2;
    if (distance < best) {
      best = distance;
      index = i / 3;
    }
  }
  return index;
}

/**
 * For each query the row nearest to it, by a grid of about two rows per cell in use. Queries far
 * from all rows would have to visit all cells: those with a flag in `skipped` get row 0.
 */
export function nearestRows(rows, queries, skipped = null) {
  const count = rows.length / 3;
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < rows.length; ++i) {
    low[i % 3] = Math.min(low[i % 3], rows[i]);
    high[i % 3] = Math.max(high[i % 3], rows[i]);
  }
  // A surface meets about cells^2 of the cells^3.
  const cells = Math.min(Math.max(Math.round(Math.sqrt(count / 2)), 1), 128);
  const size = (Math.max(...high.map((x, c) => x - low[c])) || 1) / cells;
  const dims = high.map((x, c) => Math.floor((x - low[c]) / size) + 1);
  const cell_of = (x, c) => Math.min(Math.max(Math.floor((x - low[c]) / size), 0), dims[c] - 1);
  const first = new Uint32Array(dims[0] * dims[1] * dims[2] + 1);
  const cell = new Uint32Array(count);
  for (let i = 0; i < count; ++i) {
    cell[i] = (cell_of(rows[3 * i + 2], 2) * dims[1] + cell_of(rows[3 * i + 1], 1)) * dims[0] +
      cell_of(rows[3 * i], 0);
    ++first[cell[i] + 1];
  }
  for (let i = 1; i < first.length; ++i) first[i] += first[i - 1];
  const next = first.slice();
  const sorted = new Uint32Array(count);
  for (let i = 0; i < count; ++i) sorted[next[cell[i]]++] = i;

  const out = new Uint32Array(queries.length / 3);
  for (let q = 0; q < out.length; ++q) {
    if (skipped?.[q]) continue;
    const at = [queries[3 * q], queries[3 * q + 1], queries[3 * q + 2]];
    const home = at.map(cell_of);
    let best = Infinity;
    // Shells of cells around; one more after the first hit, whose rows may be nearer.
    for (let ring = 0; ring <= Math.max(...dims); ++ring) {
      // Cells of this shell are at least so far, if the query lies inside the grid.
      if (best < ((ring - 1) * size) ** 2 && ring > 0) break;
      const from = home.map((h) => Math.max(h - ring, 0));
      const to = home.map((h, c) => Math.min(h + ring, dims[c] - 1));
      for (let z = from[2]; z <= to[2]; ++z) {
        for (let y = from[1]; y <= to[1]; ++y) {
          const inside = Math.abs(z - home[2]) < ring && Math.abs(y - home[1]) < ring;
          for (let x = from[0]; x <= to[0]; ++x) {
            if (inside && Math.abs(x - home[0]) < ring) {
              x = Math.min(home[0] + ring, to[0] + 1) - 1; // to the shell's other side
              continue;
            }
            const c = (z * dims[1] + y) * dims[0] + x;
            for (let k = first[c]; k < first[c + 1]; ++k) {
              const i = sorted[k];
              const distance = (rows[3 * i] - at[0]) ** 2 + (rows[3 * i + 1] - at[1]) ** 2 +
                (rows[3 * i + 2] - at[2]) ** 2;
              if (distance < best) {
                best = distance;
                out[q] = i;
              }
            }
          }
        }
      }
    }
  }
  return out;
}

/**
 * Places that triangles with a flag form: lists of triangles that hang together by vertices,
 * the largest first.
 */
export function placesOf(flag_bits, bit, triangles) {
  const parent = new Map();
  const find = (v) => {
    while (parent.get(v) !== v) {
      parent.set(v, parent.get(parent.get(v)));
      v = parent.get(v);
    }
    return v;
  };
  const flagged = [];
  for (let t = 0; t < flag_bits.length; ++t) {
    if (!(flag_bits[t] & bit)) continue;
    flagged.push(t);
    for (let k = 0; k < 3; ++k) {
      const v = triangles[3 * t + k];
      if (!parent.has(v)) parent.set(v, v);
      parent.set(find(v), find(triangles[3 * t]));
    }
  }
  const places = new Map();
  for (const t of flagged) {
    const root = find(triangles[3 * t]);
    if (!places.has(root)) places.set(root, []);
    places.get(root).push(t);
  }
  return { triangles: flagged, places: [...places.values()].sort((a, b) => b.length - a.length) };
}

/** The rotation (quaternion x, y, z, w) that turns `from` best to `to`, rows centred (Horn 1987). */
export function bestRotation(from, to) {
  const s = new Float64Array(9);
  for (let i = 0; i < from.length; i += 3) {
    for (let r = 0; r < 3; ++r) {
      for (let c = 0; c < 3; ++c) s[3 * r + c] += from[i + r] * to[i + c];
    }
  }
  const [xx, xy, xz, yx, yy, yz, zx, zy, zz] = s;
  const n = [
    [xx + yy + zz, yz - zy, zx - xz, xy - yx],
    [yz - zy, xx - yy - zz, xy + yx, zx + xz],
    [zx - xz, xy + yx, yy - xx - zz, yz + zy],
    [xy - yx, zx + xz, yz + zy, zz - xx - yy],
  ];
  // Power iteration for the largest eigenvalue; the shift makes it that of the largest size.
  const shift = Math.max(...n.map((row) => row.reduce((sum, x) => sum + Math.abs(x), 0))) || 1;
  let q = [1, 0.02, 0.03, 0.05];
  for (let step = 0; step < 500; ++step) {
    const product = n.map((row, r) =>
      row.reduce((sum, x, c) => sum + x * q[c], shift * q[r]));
    const length = Math.hypot(...product);
    q = product.map((x) => x / length);
  }
  return [q[1], q[2], q[3], q[0]];
}
