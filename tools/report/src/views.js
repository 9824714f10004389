// Three views of one object, drawn by one WebGL context into the parts of one canvas. They share
// rotation and zoom. A frame is drawn when something changed, never for its own sake.
import {
  BufferAttribute, BufferGeometry, LineSegments, Mesh, Object3D, PerspectiveCamera, Points,
  Quaternion, Scene, Vector3, WebGLRenderer,
} from 'three';
import {
  bestRotation, edgesOf, hitTriangle, nearestRow, nearestRows, spacings, vertexNormals,
} from './geometry.js';
import {
  cloudMaterial, flagMaterial, lineMaterial, markMaterial, surfaceMaterial,
} from './shaders.js';

export const view_names = ['mesh', 'cloud', 'sphere'];

const field_of_view = 28; // degrees
const distance = 1.04 / Math.sin((field_of_view * Math.PI) / 360); // a ball of radius 1 fits
const start = new Quaternion().setFromAxisAngle(new Vector3(1, 0, 0), -Math.PI / 2.3);
const most_normals = 15000;
const mark_color = [255, 214, 0];
export const removed_color = [225, 70, 20]; // outliers

/** A WebGL 2 context, or null; three would complain on the console where there is none. */
export function webglContext(canvas) {
  try {
    return canvas.getContext('webgl2', {
      alpha: true, antialias: true, powerPreference: 'high-performance',
    });
  } catch {
    return null;
  }
}

function attribute(rows, normalized = false) {
  return new BufferAttribute(rows, 3, normalized);
}

export class Views {
  /** `panels`: element of each view, which lie over the canvas. */
  constructor(canvas, context, panels, arrays) {
    this.canvas = canvas;
    this.panels = panels;
    this.renderer = new WebGLRenderer({ canvas, context });
    this.renderer.setClearColor(0, 0);
    this.renderer.autoClear = false;
    this.rotation = start.clone();
    this.zoom = 1;
    this.pan = [0, 0]; // in units of the object, on the screen
    this.drawn = 0; // frames
    this.fraction = null; // frame of the history that is shown, null: the result
    this.listeners = { hover: [], pick: [] };
    this.setData(arrays);
    this.listen();
  }

  setData(arrays) {
    const positions = arrays.positions.floats();
    this.triangles = arrays.triangles.values;
    // The middle of the box comes to 0, the farthest vertex to 1.
    const low = arrays.positions.min;
    const high = arrays.positions.max;
    this.center = low.map((x, c) => (x + high[c]) / 2);
    let radius = 0;
    for (let i = 0; i < positions.length; i += 3) {
      radius = Math.max(radius, Math.hypot(positions[i] - this.center[0],
        positions[i + 1] - this.center[1], positions[i + 2] - this.center[2]));
    }
    this.radius = radius || 1;
    this.positions = this.normalized(positions);
    this.box = low.map((x, c) => Math.max((high[c] - x) / 2 / this.radius, 1e-6));
    this.sphere = arrays.sphere.floats();
    this.normals = vertexNormals(this.positions, this.triangles);
    this.edges = edgesOf(this.triangles);
    const spacing = spacings(this.positions, this.edges);
    this.edge_length = spacing.mean;
    // Discs that just cover the surface between them.
    this.disc_sizes = spacing.at_vertex.map((x) =>
      1.35 * Math.min(Math.max(x, 0.6 * spacing.mean), 3 * spacing.mean));
    this.cloud = arrays.cloud ? this.normalized(arrays.cloud.floats()) : this.positions;
    this.removed = arrays.cloud_removed?.values ?? null;
    // The vertex that a point of the cloud became, or that is next to it; not of outliers, which
    // may be far from all of them.
    this.vertex_of_point = arrays.cloud
      ? nearestRows(this.positions, this.cloud, this.removed) : null;

    const vertices = this.positions.length / 3;
    this.shade = attribute(new Uint8Array(3 * vertices), true);
    this.cloud_shade = this.vertex_of_point
      ? attribute(new Uint8Array(this.cloud.length), true) : this.shade;
    this.makeScenes();
    if (arrays.history_frames) this.makeHistory(arrays);
  }

  normalized(rows) {
    const out = new Float32Array(rows.length);
    for (let i = 0; i < rows.length; ++i) {
      out[i] = (rows[i] - this.center[i % 3]) / this.radius;
    }
    return out;
  }

  makeScenes() {
    this.views = {};
    for (const name of view_names) {
      const scene = new Scene();
      const turned = new Object3D(); // by the shared rotation
      scene.add(turned);
      const camera = new PerspectiveCamera(field_of_view, 1, distance - 3, distance + 3);
      camera.position.z = distance;
      this.views[name] = {
        name, scene, turned, camera, panel: this.panels[name],
        align: new Quaternion(), focus: new Vector3(),
      };
    }
    // The sphere is turned so that its points are about where those of the object are.
    this.alignment = new Quaternion(...bestRotation(this.sphere, this.positions));
    this.views.sphere.align.copy(this.alignment);

    const index = new BufferAttribute(this.triangles, 1);
    const position = attribute(this.positions);
    const place = attribute(this.sphere);
    this.material = surfaceMaterial();
    const mesh = this.geometry({ position, place, normal: attribute(this.normals) }, index);
    const sphere = this.geometry({ position: place, place, normal: place }, index);
    mesh.setAttribute('shade', this.shade);
    sphere.setAttribute('shade', this.shade);
    this.surface = { mesh: new Mesh(mesh, this.material), sphere: new Mesh(sphere, this.material) };
    this.add('mesh', this.surface.mesh);
    this.add('sphere', this.surface.sphere);

    this.cloud_material = cloudMaterial();
    let cloud = { position, normal: attribute(this.normals) };
    let sizes = this.disc_sizes;
    if (this.vertex_of_point) {
      cloud = { position: attribute(this.cloud), normal: attribute(this.gathered(this.normals)) };
      sizes = Float32Array.from(this.vertex_of_point, (v) => this.disc_sizes[v]);
      this.removed?.forEach((flag, i) => {
        if (flag) {
          cloud.normal.array.fill(0, 3 * i, 3 * i + 3);
          sizes[i] = 1.3 * this.edge_length;
        }
      });
    }
    cloud = this.geometry({
      ...cloud, size: new BufferAttribute(sizes, 1), shade: this.cloud_shade,
    });
    this.cloud_points = new Points(cloud, this.cloud_material);
    this.add('cloud', this.cloud_points);

    this.line_material = lineMaterial([0, 0, 0], 0.4);
    this.normal_material = lineMaterial([0.85, 0.1, 0.35], 0.9);
    this.flag_objects = [];
    this.marks = {};
    for (const name of view_names) {
      const geometry = this.geometry({ position: attribute(new Float32Array(3)) });
      const group = new Object3D();
      // Seen faintly through what hides it.
      group.add(new Points(geometry, markMaterial(mark_color, 20, true, 0.35, true)));
      group.add(new Points(geometry, markMaterial(mark_color, 20, true, 1, false)));
      group.children.forEach((child, i) => { child.renderOrder = 10 + i; });
      group.visible = false;
      this.add(name, group);
      this.marks[name] = group;
    }
  }

  geometry(attributes, index = null) {
    const geometry = new BufferGeometry();
    for (const [name, value] of Object.entries(attributes)) geometry.setAttribute(name, value);
    if (index) geometry.setIndex(index);
    return geometry;
  }

  add(name, object) {
    // Nearly all is in sight: no need to look for bounds, which change with each frame.
    object.traverse((part) => { part.frustumCulled = false; });
    this.views[name].turned.add(object);
  }

  /** Rows of vertices for the points of the cloud. */
  gathered(rows) {
    const out = new rows.constructor(3 * this.vertex_of_point.length);
    for (let i = 0; i < this.vertex_of_point.length; ++i) {
      const from = 3 * this.vertex_of_point[i];
      out[3 * i] = rows[from];
      out[3 * i + 1] = rows[from + 1];
      out[3 * i + 2] = rows[from + 2];
    }
    return out;
  }

  // --- history

  makeHistory(arrays) {
    this.history_places = this.normalized(arrays.history_positions.floats());
    this.history_count = arrays.history_positions.count;
    this.history_triangles = arrays.history_triangles.values;
    this.history = arrays.history_frames;
    this.frame_count = this.history.count / this.history_count;
    this.frame = attribute(new Float32Array(3 * this.history_count));
    this.history_shade = attribute(new Uint8Array(3 * this.history_count), true);
    const index = new BufferAttribute(this.history_triangles, 1);
    const geometry = this.geometry({
      position: this.frame, normal: this.frame, place: this.frame, shade: this.history_shade,
    }, index);
    this.history_mesh = new Mesh(geometry, this.material);
    this.history_mesh.visible = false;
    this.add('sphere', this.history_mesh);
    this.history_lines = new LineSegments(
      this.geometry({ position: this.frame },
        new BufferAttribute(edgesOf(this.history_triangles), 1)),
      lineMaterial([0, 0, 0], 0.3)); // always: the colours alone hardly show how it moves
    this.history_lines.visible = false;
    this.add('sphere', this.history_lines);
  }

  /** Shows the sphere at a frame, in between if the number is not whole; null: the result. */
  setFrame(fraction) {
    this.fraction = fraction;
    const shown = fraction !== null;
    if (shown) {
      const before = Math.floor(fraction);
      const after = Math.min(before + 1, this.frame_count - 1);
      const weight = fraction - before;
      const out = this.frame.array;
      const { values, min, max, steps } = this.history;
      const row = 3 * this.history_count;
      for (let i = 0; i < row; i += 3) {
        let length = 0;
        for (let c = 0; c < 3; ++c) {
          const a = values[before * row + i + c];
          const b = values[after * row + i + c];
          const x = min[c] + ((a + weight * (b - a)) / steps) * (max[c] - min[c]);
          out[i + c] = x;
          length += x * x;
        }
        length = Math.sqrt(length) || 1;
        for (let c = 0; c < 3; ++c) out[i + c] /= length;
      }
      this.frame.needsUpdate = true;
    }
    if (this.history_mesh) {
      this.history_mesh.visible = shown;
      this.history_lines.visible = shown;
    }
    this.surface.sphere.visible = !shown;
    if (this.lines) this.lines.sphere.visible = !shown && this.wireframe;
    for (const object of this.flag_objects) {
      if (object.parent === this.views.sphere.turned) object.visible = !shown;
    }
    if (this.marked) this.mark(this.marked);
    this.request();
  }

  // --- looks

  setColors(colors) {
    this.shade.array.set(colors);
    this.shade.needsUpdate = true;
    if (this.vertex_of_point) {
      const of_points = this.gathered(colors);
      if (this.removed) {
        for (let i = 0; i < this.removed.length; ++i) {
          if (this.removed[i]) of_points.set(removed_color, 3 * i);
        }
      }
      this.cloud_shade.array.set(of_points);
      this.cloud_shade.needsUpdate = true;
    }
    this.request();
  }

  setHistoryColors(colors) {
    this.history_shade.array.set(colors);
    this.history_shade.needsUpdate = true;
  }

  setGrid(on) {
    this.material.uniforms.grid.value = on;
    this.request();
  }

  setFlat(on) {
    this.material.uniforms.flat_shading.value = on;
    this.request();
  }

  setWireframe(on) {
    this.wireframe = on;
    if (on && !this.lines) {
      const index = new BufferAttribute(this.edges, 1);
      this.lines = {};
      for (const name of ['mesh', 'sphere']) {
        const position = this.surface[name].geometry.getAttribute('position');
        this.lines[name] = new LineSegments(this.geometry({ position }, index), this.line_material);
        this.add(name, this.lines[name]);
      }
    }
    if (this.lines) {
      this.lines.mesh.visible = on;
      this.lines.sphere.visible = on && this.fraction === null;
    }
    this.request();
  }

  setNormals(on) {
    if (on && !this.normal_lines) {
      this.normal_lines = {};
      for (const [name, points, normals] of [
        ['mesh', this.positions, this.normals],
        ['cloud', this.cloud, this.cloud_points.geometry.getAttribute('normal').array],
      ]) {
        // Not more than can be told apart.
        const stride = Math.ceil(points.length / 3 / most_normals);
        const ends = new Float32Array(6 * Math.ceil(points.length / 3 / stride));
        const length = Math.max(1.2 * Math.sqrt(stride) * this.edge_length, 0.012);
        for (let i = 0, to = 0; i < points.length; i += 3 * stride, to += 6) {
          for (let c = 0; c < 3; ++c) { // of no length where there is no normal
            ends[to + c] = points[i + c];
            ends[to + 3 + c] = points[i + c] + length * normals[i + c];
          }
        }
        const lines = new LineSegments(this.geometry({ position: attribute(ends) }),
          this.normal_material);
        this.normal_lines[name] = lines;
        this.add(name, lines);
      }
    }
    for (const lines of Object.values(this.normal_lines ?? {})) lines.visible = on;
    this.request();
  }

  /** Shows triangles in colours of their own: [{color, triangles, places}], [] for none. */
  setFlags(groups) {
    for (const object of this.flag_objects) {
      object.removeFromParent();
      object.geometry.dispose();
      object.material.dispose();
    }
    this.flag_objects = [];
    groups.forEach((group, which) => {
      const order = 1 - which / groups.length; // the first lies on top
      const index = new Uint32Array(3 * group.triangles.length);
      group.triangles.forEach((t, i) =>
        index.set(this.triangles.subarray(3 * t, 3 * t + 3), 3 * i));
      for (const name of ['mesh', 'sphere']) {
        const position = this.surface[name].geometry.getAttribute('position');
        this.addFlagObject(name, new Mesh(
          this.geometry({ position }, new BufferAttribute(index, 1)),
          flagMaterial(group.color)), order);
        // A dot at each place: one triangle of many would not be seen.
        const middles = new Float32Array(3 * Math.min(group.places.length, 2000));
        for (let i = 0; i < middles.length / 3; ++i) {
          middles.set(this.middle(name, group.places[i][0]), 3 * i);
        }
        this.addFlagObject(name, new Points(this.geometry({ position: attribute(middles) }),
          markMaterial(group.color, 9 * this.pixelRatio(), false, 0.95, false)), order);
      }
    });
    this.request();
  }

  addFlagObject(name, object, order) {
    object.renderOrder = order + (object.isPoints ? 5 : 0);
    object.visible = name !== 'sphere' || this.fraction === null;
    this.add(name, object);
    this.flag_objects.push(object);
  }

  /** Middle of a triangle, on the object or on the sphere. */
  middle(name, triangle) {
    const rows = name === 'sphere' ? this.sphere : this.positions;
    const out = [0, 0, 0];
    for (let k = 0; k < 3; ++k) {
      for (let c = 0; c < 3; ++c) out[c] += rows[3 * this.triangles[3 * triangle + k] + c] / 3;
    }
    return out;
  }

  setTheme(dark) {
    this.line_opacity = dark ? 0.5 : 0.42;
    this.normal_material.uniforms.color.value = dark ? [1, 0.45, 0.6, 0.9] : [0.75, 0, 0.3, 0.8];
    this.cloud_material.uniforms.background.value = dark ? [0.1, 0.11, 0.13] : [0.96, 0.965, 0.975];
    this.request();
  }

  // --- where one looks

  reset() {
    this.rotation.copy(start);
    this.zoom = 1;
    this.pan = [0, 0];
    this.views.sphere.align.copy(this.alignment);
    for (const view of Object.values(this.views)) view.focus.set(0, 0, 0);
    this.request();
  }

  /** Turns by angles about the axes of the screen. */
  turn(about_x, about_y, about_z = 0) {
    const angle = Math.hypot(about_x, about_y, about_z);
    if (angle === 0) return;
    const axis = new Vector3(about_x, about_y, about_z).divideScalar(angle);
    this.rotation.premultiply(new Quaternion().setFromAxisAngle(axis, angle)).normalize();
    this.request();
  }

  zoomBy(factor) {
    this.zoom = Math.min(Math.max(this.zoom * factor, 0.3), 400);
    this.request();
  }

  panBy(dx, dy) {
    this.pan[0] += dx;
    this.pan[1] += dy;
    this.request();
  }

  /** Brings a place of the object to the middle of all views, its normal to the eye. */
  lookAt({ position, sphere, normal }, zoom) {
    const eye = new Vector3(0, 0, 1);
    if (normal) {
      const now = new Vector3(...normal).normalize().applyQuaternion(this.rotation);
      this.rotation.premultiply(new Quaternion().setFromUnitVectors(now, eye)).normalize();
    }
    this.views.mesh.focus.set(...position);
    this.views.cloud.focus.set(...position);
    const out = new Vector3(...sphere).normalize();
    this.views.sphere.focus.copy(out);
    if (normal) {
      // The sphere turns on so that the place is not on its far side.
      const align = this.views.sphere.align;
      const now = out.clone().applyQuaternion(align).applyQuaternion(this.rotation);
      const rest = new Quaternion().setFromUnitVectors(now, eye);
      const all = rest.multiply(this.rotation).multiply(align);
      align.copy(this.rotation.clone().invert().multiply(all)).normalize();
    }
    this.pan = [0, 0];
    if (zoom) this.zoom = Math.min(Math.max(zoom, 0.3), 400);
    this.request();
  }

  /** Brings triangles that hang together into sight, and what is around them. */
  lookAtTriangles(triangles) {
    const middles = triangles.map((t) => new Vector3(...this.middle('mesh', t)));
    const center = new Vector3();
    middles.forEach((middle) => center.addScaledVector(middle, 1 / middles.length));
    // The one in the midst of them.
    let nearest = 0;
    middles.forEach((middle, i) => {
      if (middle.distanceToSquared(center) < middles[nearest].distanceToSquared(center)) {
        nearest = i;
      }
    });
    const triangle = triangles[nearest];
    const position = middles[nearest];
    const reach = middles.reduce((far, middle) => Math.max(far, middle.distanceTo(position)),
      4 * this.edge_length);
    const [a, b, c] = [0, 1, 2].map((k) =>
      new Vector3().fromArray(this.positions, 3 * this.triangles[3 * triangle + k]));
    const normal = b.sub(a).cross(c.sub(a));
    const spot = {
      vertex: this.triangles[3 * triangle],
      triangle,
      position: position.toArray(),
      sphere: this.middle('sphere', triangle),
      normal: normal.length() > 0 ? normal.toArray() : [0, 0, 1],
    };
    this.lookAt(spot, Math.max(0.45 / reach, 1));
    return spot;
  }

  // --- a point in all views

  /** {vertex, position, sphere} at a place of a panel, or null. */
  pick(name, x, y) {
    this.place();
    const view = this.views[name];
    const ray = this.ray(view, x, y);
    if (name === 'cloud') {
      const point = this.nearestPoint(view, x, y);
      if (point < 0) return null;
      const place = row(this.cloud, point);
      if (this.removed?.[point]) return this.spotOf(nearestRow(this.positions, place), place);
      return this.spotOf(this.vertex_of_point ? this.vertex_of_point[point] : point, place);
    }
    if (name === 'sphere' && this.fraction !== null) {
      const hit = hitTriangle(ray.origin, ray.direction, this.frame.array, this.history_triangles);
      if (!hit) return null;
      const place = blend(this.history_places, this.history_triangles, hit);
      return this.spotOf(nearestRow(this.positions, place));
    }
    const rows = name === 'mesh' ? this.positions : this.sphere;
    const hit = hitTriangle(ray.origin, ray.direction, rows, this.triangles);
    if (!hit) return null;
    const best = hit.weights.indexOf(Math.max(...hit.weights));
    return {
      vertex: this.triangles[3 * hit.triangle + best],
      triangle: hit.triangle,
      position: blend(this.positions, this.triangles, hit),
      sphere: blend(this.sphere, this.triangles, hit),
    };
  }

  spotOf(vertex, position = row(this.positions, vertex)) {
    return { vertex, position, sphere: row(this.sphere, vertex) };
  }

  mark(spot) {
    this.marked = spot;
    for (const name of view_names) {
      this.marks[name].visible = spot !== null;
      if (!spot) continue;
      let place = name === 'sphere' ? spot.sphere : spot.position;
      if (name === 'sphere' && this.fraction !== null) {
        place = row(this.frame.array, nearestRow(this.history_places, spot.position));
      }
      for (const child of this.marks[name].children) {
        const position = child.geometry.getAttribute('position');
        position.array.set(place);
        position.needsUpdate = true;
        child.material.uniforms.pixels.value = 15 * this.pixelRatio();
      }
    }
    this.request();
  }

  ray(view, x, y) {
    const rect = view.panel.getBoundingClientRect();
    const at = new Vector3((2 * x) / rect.width - 1, 1 - (2 * y) / rect.height, 0.5);
    at.unproject(view.camera);
    const back = view.turned.matrixWorld.clone().invert();
    const origin = view.camera.position.clone().applyMatrix4(back);
    const direction = at.applyMatrix4(back).sub(origin).normalize();
    return { origin: origin.toArray(), direction: direction.toArray() };
  }

  /** The point of the cloud that is drawn near a place of its panel and next to the eye. */
  nearestPoint(view, x, y) {
    const rect = view.panel.getBoundingClientRect();
    const matrix = view.camera.projectionMatrix.clone()
      .multiply(view.camera.matrixWorldInverse).multiply(view.turned.matrixWorld).elements;
    const reach = 9;
    let best = Infinity;
    let found = -1;
    for (let i = 0; i < this.cloud.length; i += 3) {
      const px = this.cloud[i];
      const py = this.cloud[i + 1];
      const pz = this.cloud[i + 2];
      const w = matrix[3] * px + matrix[7] * py + matrix[11] * pz + matrix[15];
      const sx = (((matrix[0] * px + matrix[4] * py + matrix[8] * pz + matrix[12]) / w + 1) / 2) *
        rect.width - x;
      const sy = ((1 - (matrix[1] * px + matrix[5] * py + matrix[9] * pz + matrix[13]) / w) / 2) *
        rect.height - y;
      const off = sx * sx + sy * sy;
      if (off > reach * reach) continue;
      // Depth in units of the object: a pixel aside costs as much as a hundredth behind.
      const rank = w + 0.01 * Math.sqrt(off);
      if (rank < best) {
        best = rank;
        found = i / 3;
      }
    }
    return found;
  }

  // --- drawing

  pixelRatio() {
    return Math.min(window.devicePixelRatio || 1, 2);
  }

  request() {
    if (this.requested || this.lost) return;
    this.requested = true;
    requestAnimationFrame(() => {
      this.requested = false;
      this.draw();
    });
  }

  /** Puts the objects and cameras where they are looked at. */
  place() {
    for (const view of Object.values(this.views)) {
      const { width, height } = view.panel.getBoundingClientRect();
      view.camera.aspect = width / Math.max(height, 1);
      view.camera.zoom = this.zoom * Math.min(view.camera.aspect, 1);
      view.camera.updateProjectionMatrix();
      view.turned.quaternion.copy(this.rotation).multiply(view.align);
      view.turned.position.copy(view.focus).applyQuaternion(view.turned.quaternion).negate();
      view.turned.position.x += this.pan[0];
      view.turned.position.y += this.pan[1];
      view.turned.updateMatrixWorld(true);
      view.camera.updateMatrixWorld(true);
    }
  }

  draw() {
    const whole = this.canvas.parentElement.getBoundingClientRect();
    if (whole.width === 0 || whole.height === 0) return;
    const ratio = this.pixelRatio();
    const width = Math.round(whole.width * ratio);
    const height = Math.round(whole.height * ratio);
    if (this.canvas.width !== width || this.canvas.height !== height) {
      this.renderer.setPixelRatio(1);
      this.renderer.setSize(width, height, false);
    }
    this.place();
    this.renderer.setScissorTest(false);
    this.renderer.clear();
    this.renderer.setScissorTest(true);
    for (const view of Object.values(this.views)) {
      const rect = view.panel.getBoundingClientRect();
      const area = [
        (rect.left - whole.left) * ratio, (whole.bottom - rect.bottom) * ratio,
        rect.width * ratio, rect.height * ratio,
      ].map(Math.round);
      // Lines that lie closer than a few pixels would hide the surface.
      const line_gap = (this.edge_length * area[3] * view.camera.zoom) / 2 / ratio;
      this.line_material.uniforms.color.value[3] =
        this.line_opacity * Math.min(Math.max(line_gap / 6, 0.12), 1);
      this.renderer.setViewport(...area);
      this.renderer.setScissor(...area);
      this.cloud_material.uniforms.pixels.value =
        (area[3] * view.camera.zoom) / (2 * Math.tan((field_of_view * Math.PI) / 360));
      this.renderer.render(view.scene, view.camera);
    }
    ++this.drawn;
  }

  // --- mouse, touch and keys

  on(event, listener) {
    this.listeners[event].push(listener);
  }

  tell(event, ...what) {
    for (const listener of this.listeners[event]) listener(...what);
  }

  listen() {
    for (const name of view_names) this.listenTo(name, this.panels[name]);
    new ResizeObserver(() => this.request()).observe(this.canvas.parentElement);
    this.canvas.addEventListener('webglcontextlost', (event) => {
      event.preventDefault();
      this.lost = true;
    });
    this.canvas.addEventListener('webglcontextrestored', () => {
      this.lost = false;
      this.request();
    });
  }

  listenTo(name, panel) {
    const pointers = new Map();
    let moved = 0;
    let hover = null;
    const place_of = (event) => {
      const rect = panel.getBoundingClientRect();
      return [event.clientX - rect.left, event.clientY - rect.top];
    };
    const smaller_side = () => {
      const rect = panel.getBoundingClientRect();
      return Math.max(Math.min(rect.width, rect.height), 1);
    };
    // Units of the object per pixel, in the middle of the view.
    const unit = () => (2 * distance * Math.tan((field_of_view * Math.PI) / 360)) /
      (panel.getBoundingClientRect().height * this.views[name].camera.zoom);
    const move_one = (event, dx, dy) => {
      if (event.shiftKey || (event.buttons & 6) !== 0) {
        this.panBy(dx * unit(), -dy * unit());
      } else {
        const pace = 3.2 / smaller_side() / Math.max(this.zoom, 1) ** 0.8;
        this.turn(dy * pace, dx * pace);
      }
    };
    const move_two = (pointer, event) => {
      const other = [...pointers.values()].find((p) => p !== pointer);
      const before = [pointer.x - other.x, pointer.y - other.y];
      const after = [event.clientX - other.x, event.clientY - other.y];
      this.zoomBy(Math.max(Math.hypot(...after), 1) / Math.max(Math.hypot(...before), 1));
      this.turn(0, 0, Math.atan2(before[1], before[0]) - Math.atan2(after[1], after[0]));
      this.panBy(((event.clientX - pointer.x) / 2) * unit(),
        (-(event.clientY - pointer.y) / 2) * unit());
    };
    panel.addEventListener('pointerdown', (event) => {
      panel.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
      if (pointers.size === 1) moved = 0;
    });
    panel.addEventListener('pointermove', (event) => {
      const pointer = pointers.get(event.pointerId);
      if (pointer) {
        const dx = event.clientX - pointer.x;
        const dy = event.clientY - pointer.y;
        moved += Math.abs(dx) + Math.abs(dy);
        if (pointers.size === 1) move_one(event, dx, dy);
        else if (pointers.size === 2) move_two(pointer, event);
        pointer.x = event.clientX;
        pointer.y = event.clientY;
      } else if (event.pointerType !== 'touch') {
        // At most one search per frame.
        const waiting = hover !== null;
        hover = place_of(event);
        if (!waiting) {
          requestAnimationFrame(() => {
            const at = hover;
            hover = null;
            this.tell('hover', at ? this.pick(name, ...at) : null, name);
          });
        }
      }
    });
    const end = (event) => {
      const known = pointers.delete(event.pointerId);
      if (event.type === 'pointerup' && known && moved < 5 && event.button === 0) {
        this.tell('pick', this.pick(name, ...place_of(event)), name);
      }
    };
    panel.addEventListener('pointerup', end);
    panel.addEventListener('pointercancel', end);
    panel.addEventListener('pointerleave', () => {
      if (hover) hover = null;
      else this.tell('hover', null, name);
    });
    panel.addEventListener('contextmenu', (event) => event.preventDefault());
    panel.addEventListener('wheel', (event) => {
      event.preventDefault();
      const pixels = event.deltaY * [1, 16, 400][event.deltaMode];
      this.zoomBy(Math.exp(-Math.min(Math.max(pixels, -240), 240) * 0.0022));
    }, { passive: false });
    panel.addEventListener('dblclick', (event) => {
      const spot = this.pick(name, ...place_of(event));
      if (spot) this.lookAt(spot, Math.max(this.zoom, 2));
    });
    panel.addEventListener('keydown', (event) => {
      const keys = {
        ArrowLeft: () => this.turn(0, -0.15), ArrowRight: () => this.turn(0, 0.15),
        ArrowUp: () => this.turn(-0.15, 0), ArrowDown: () => this.turn(0.15, 0),
        '+': () => this.zoomBy(1.25), '=': () => this.zoomBy(1.25), '-': () => this.zoomBy(0.8),
        r: () => this.reset(), R: () => this.reset(), Home: () => this.reset(),
        Escape: () => this.tell('pick', null, name),
      };
      if (keys[event.key] && !event.ctrlKey && !event.metaKey && !event.altKey) {
        event.preventDefault();
        keys[event.key]();
      }
    });
  }
}

function row(rows, i) {
  return [rows[3 * i], rows[3 * i + 1], rows[3 * i + 2]];
}

function blend(rows, triangles, { triangle, weights }) {
  const out = [0, 0, 0];
  for (let k = 0; k < 3; ++k) {
    const at = 3 * triangles[3 * triangle + k];
    for (let c = 0; c < 3; ++c) out[c] += weights[k] * rows[at + c];
  }
  return out;
}
