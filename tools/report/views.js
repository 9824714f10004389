// Views of one object, drawn by one WebGL context into the parts of one canvas. They share a camera, and each has
// three.js' controls of it. A frame is drawn only when something changed.

/** Discs of a diameter in units of the object, within limits in pixels. `scale` is a uniform. */
function discMaterial(scale, { size = 0, pixels, lit = false, color = '#ffffff', on_top = false }) {
  return new THREE.ShaderMaterial({
    vertexShader: `
      uniform float size, scale;
      uniform vec2 pixels;
      varying vec3 shade;
      void main() {
        vec4 place = modelViewMatrix * vec4(position, 1.0);
        gl_Position = projectionMatrix * place;
        gl_PointSize = clamp(size * scale / -place.z, pixels.x, pixels.y);
        float facing = dot(normalize(normalMatrix * normal), normalize(-place.xyz));
        shade = ${lit ? 'color * (facing > 0.0 ? 0.45 + 0.6 * facing : 0.35)' : 'vec3(1.0)'};
      }`,
    fragmentShader: `
      uniform vec3 tint;
      varying vec3 shade;
      void main() {
        float radius = 2.0 * length(gl_PointCoord - 0.5);
        if (radius > 1.0) discard;
        gl_FragColor = vec4(${lit ? 'shade' : 'radius > 0.75 ? vec3(0.0) : tint'}, 1.0);
      }`,
    uniforms: {
      size: { value: size }, scale,
      pixels: { value: new THREE.Vector2(...pixels).multiplyScalar(devicePixelRatio) },
      tint: { value: new THREE.Color(color) },
    },
    vertexColors: lit ? THREE.VertexColors : THREE.NoColors,
    depthTest: !on_top,
    transparent: on_top, // drawn last
  });
}

/** A lit surface. Where `cells.value` is 1, every other cell of 15 degrees of the sphere is darker; the attribute
    `place` is where a vertex is on it. */
function surfaceMaterial(options, cells) {
  const material = new THREE.MeshPhongMaterial({
    vertexColors: THREE.VertexColors, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1, ...options,
  });
  material.onBeforeCompile = (shader) => {
    shader.uniforms.cells = cells;
    shader.vertexShader = `attribute vec3 place; varying vec3 v_place;
      ${shader.vertexShader.replace('#include <color_vertex>', '$&\n v_place = place;')}`;
    shader.fragmentShader = `uniform float cells; varying vec3 v_place;
      ${shader.fragmentShader.replace('#include <color_fragment>', `$&
        if (cells > 0.0) {
          vec3 direction = normalize(v_place);
          vec2 cell = floor(vec2(asin(direction.z), atan(direction.y, direction.x)) / radians(15.0));
          diffuseColor.rgb *= 1.0 - 0.17 * mod(cell.x + cell.y, 2.0);
        }`)}`;
  };
  return material;
}

function geometryOf(attributes, index) {
  const geometry = new THREE.BufferGeometry();
  for (const [name, value] of Object.entries(attributes)) geometry.setAttribute(name, value);
  if (index) geometry.setIndex(index);
  return geometry;
}

const rowsOf = (array) => new THREE.BufferAttribute(array, 3);
const colorsOf = (vertices) =>
  new THREE.BufferAttribute(new Uint8Array(3 * vertices), 3, true).setUsage(THREE.DynamicDrawUsage);

class Views extends Shape {
  constructor(canvas, context, arrays, data) {
    super(arrays, data);
    const { sphere_turn, spacing, view } = data;
    this.canvas = canvas;
    this.names = ['mesh', 'cloud', ...(arrays.sphere ? ['sphere'] : [])]; // meshes with handles have no sphere
    byId('view-sphere').hidden = !arrays.sphere;
    this.renderer = new THREE.WebGLRenderer({ canvas, context });
    this.renderer.setPixelRatio(devicePixelRatio);
    this.renderer.setScissorTest(true);
    this.renderer.setClearColor(0, 0);
    this.makeScene(arrays, spacing, view);
    if (arrays.sphere) {
      this.align = new THREE.Quaternion().setFromRotationMatrix(new THREE.Matrix4().set(...sphere_turn));
    }
    this.target = new THREE.Vector3();
    this.controls = this.names.map((name) => this.makeControls(name));
    this.reset();
    new ResizeObserver(() => this.request()).observe(canvas);
  }

  makeScene(arrays, spacing, view) {
    this.color = colorsOf(this.positions.length / 3);
    this.cells = { value: 0 };
    this.scale = { value: 1 }; // pixels of a length of 1 at a distance of 1

    this.scene = new THREE.Scene();
    this.light = new THREE.DirectionalLight(0xffffff, 0.75);
    this.scene.add(new THREE.AmbientLight(0xffffff, 0.45), this.light, this.light.target);
    this.groups = Object.fromEntries(this.names.map((name) => [name, new THREE.Group()]));
    this.scene.add(...Object.values(this.groups));

    const index = new THREE.BufferAttribute(this.triangles, 1);
    const position = rowsOf(this.positions);
    const place = this.sphere ? rowsOf(this.sphere) : position;
    const mesh = geometryOf({ position, place, color: this.color }, index);
    mesh.computeVertexNormals();
    this.normal = mesh.getAttribute('normal');
    this.surfaces = { mesh: this.addSurface('mesh', mesh) };
    if (this.sphere) {
      const sphere = geometryOf({ position: place, place, color: this.color }, index);
      // What a sensor saw faces it, which is inwards.
      if (view) sphere.computeVertexNormals();
      else sphere.setAttribute('normal', place);
      this.surfaces.sphere = this.addSurface('sphere', sphere);
    }
    let sides = 0;
    for (let t = 0; t < this.triangles.length; t += 3) {
      sides += this.vector(this.triangles[t]).distanceTo(this.vector(this.triangles[t + 1]));
    }
    this.edge = sides / (this.triangles.length / 3);
    const cloud = arrays.cloud ? rowsOf(this.normalized(arrays.cloud)) : position;
    // Discs that just cover a square grid of points.
    this.addPoints('cloud', { position: cloud, normal: this.normal, color: this.color },
      { size: spacing / this.radius, pixels: [1, 12], lit: true });
    if (arrays.left_out) {
      const points = rowsOf(this.normalized(arrays.left_out));
      this.addPoints('cloud', { position: points, normal: points }, { pixels: [6, 6], color: left_out_color });
    }
    this.marks = Object.fromEntries(this.names.map((name) => [name, this.addPoints(name,
      { position: rowsOf(new Float32Array(3)), normal: rowsOf(new Float32Array(3)) },
      { pixels: [13, 13], color: '#ffd600', on_top: true })]));
    this.flags = [];
  }

  vector(vertex, rows = this.positions) {
    return new THREE.Vector3().fromArray(rows, 3 * vertex);
  }

  /** Where vertices are in a view. */
  rowsIn(name) {
    return name === 'sphere' ? this.sphere : this.positions;
  }

  aimView(name) {
    return this.aim(byId(`view-${name}`), name === 'sphere' ? this.ball_slopes : this.slopes);
  }

  /** Both sides of a surface, of which the inner is dark, and its edges. */
  addSurface(name, geometry) {
    const group = new THREE.Group();
    group.add(...[
      surfaceMaterial({ specular: 0x141414 }, this.cells),
      surfaceMaterial({ color: 0x605858, specular: 0, side: THREE.BackSide }, this.cells),
      new THREE.MeshBasicMaterial({ wireframe: true, color: 0, opacity: 0.3, transparent: true, depthWrite: false }),
    ].map((material) => new THREE.Mesh(geometry, material)));
    group.children[2].visible = false;
    this.add(name, group);
    return group;
  }

  addPoints(name, attributes, looks) {
    return this.add(name, new THREE.Points(geometryOf(attributes), discMaterial(this.scale, looks)));
  }

  add(name, object) {
    object.traverse((part) => { part.frustumCulled = false; }); // nearly all is in sight
    this.groups[name].add(object);
    return object;
  }

  makeControls(name) {
    const panel = byId(`view-${name}`);
    const controls = new THREE.OrbitControls(this.camera, panel);
    controls.target = this.target; // of all
    controls.minDistance = 0.02;
    controls.maxDistance = 20;
    controls.screenSpacePanning = true;
    controls.addEventListener('change', () => this.request());
    // A click, which is no drag, marks a vertex.
    let down = null;
    panel.addEventListener('pointerdown', (event) => { down = event; });
    panel.addEventListener('pointerup', (event) => {
      if (down && Math.hypot(event.clientX - down.clientX, event.clientY - down.clientY) < 4) {
        this.pick(name, event);
      }
    });
    return controls;
  }

  /** Marks the vertex next to the pointer. The cloud's points are those of the mesh. */
  pick(name, event) {
    const rect = this.aimView(name);
    this.scene.updateMatrixWorld();
    const ray = new THREE.Raycaster();
    ray.setFromCamera({
      x: (2 * (event.clientX - rect.left)) / rect.width - 1,
      y: 1 - (2 * (event.clientY - rect.top)) / rect.height,
    }, this.camera);
    const surface = (this.surfaces[name] ?? this.surfaces.mesh).children[0];
    const [hit] = ray.intersectObject(surface);
    if (!hit) return this.mark(null);
    const at = surface.worldToLocal(hit.point.clone());
    const distance = (vertex) => this.vector(vertex, this.rowsIn(name)).distanceTo(at);
    return this.mark([hit.face.a, hit.face.b, hit.face.c]
      .reduce((best, vertex) => (distance(vertex) < distance(best) ? vertex : best)));
  }

  /** Marks a vertex in all views; null: none. */
  mark(vertex) {
    for (const [name, points] of Object.entries(this.marks)) {
      points.visible = vertex !== null;
      if (vertex !== null) {
        const { position } = points.geometry.attributes;
        this.vector(vertex, this.rowsIn(name)).toArray(position.array);
        position.needsUpdate = true;
      }
    }
    this.marked = vertex;
    this.onMark?.(vertex);
    this.request();
  }

  /** Brings a vertex and its place on the sphere to the middle of the views. */
  lookAt(vertex) {
    const place = this.vector(vertex);
    const normal = this.vector(vertex, this.normal.array).normalize();
    if (this.sphere) {
      const direction = this.vector(vertex, this.sphere).normalize().applyQuaternion(this.align);
      this.groups.sphere.quaternion.setFromUnitVectors(direction, normal).multiply(this.align);
      this.groups.sphere.position.copy(place).sub(normal);
    }
    this.target.copy(place);
    this.camera.position.copy(place)
      .addScaledVector(normal, Math.min(Math.max(60 * this.edge, 0.1), start_distance));
    this.mark(vertex);
    this.controls[0].update();
  }

  reset() {
    if (this.sphere) {
      this.groups.sphere.quaternion.copy(this.align);
      this.groups.sphere.position.set(0, 0, 0);
    }
    this.target.set(0, 0, 0);
    this.camera.position.copy(this.start);
    this.mark(null);
    this.controls[0].update();
  }

  setColors(colors, cells) {
    this.color.array.set(colors);
    this.cells.value = cells ? 1 : 0;
    this.color.needsUpdate = true;
    this.request();
  }

  setWireframe(on) {
    for (const surface of Object.values(this.surfaces)) surface.children[2].visible = on;
    this.request();
  }

  /** Shows triangles in colours of their own: [{color, triangles}], the first over the others. */
  setFlags(groups) {
    for (const object of this.flags) {
      object.parent.remove(object);
      object.geometry.dispose();
      object.material.dispose();
    }
    const names = Object.keys(this.surfaces);
    this.flags = groups.flatMap(({ color, triangles }, i) => names.map((name) => {
      const index = new Uint32Array(3 * triangles.length);
      triangles.forEach((t, k) => index.set(this.triangles.subarray(3 * t, 3 * t + 3), 3 * k));
      const { position, normal } = this.surfaces[name].children[0].geometry.attributes;
      const object = new THREE.Mesh(geometryOf({ position, normal }, new THREE.BufferAttribute(index, 1)),
        new THREE.MeshPhongMaterial({ color, specular: 0, side: THREE.DoubleSide }));
      object.renderOrder = groups.length - i;
      return this.add(name, object);
    }));
    this.request();
  }

  request() {
    if (this.requested) return;
    this.requested = true;
    requestAnimationFrame(() => {
      this.requested = false;
      this.draw();
    });
  }

  draw() {
    const all = this.canvas.getBoundingClientRect();
    const size = this.renderer.getSize(new THREE.Vector2());
    if (size.x !== Math.floor(all.width) || size.y !== Math.floor(all.height)) {
      this.renderer.setSize(Math.floor(all.width), Math.floor(all.height), false);
    }
    this.light.position.set(-0.5, 0.7, 1).applyQuaternion(this.camera.quaternion);
    for (const name of this.names) {
      const rect = this.aimView(name);
      const part = [rect.left - all.left, all.bottom - rect.bottom, rect.width, rect.height];
      this.renderer.setViewport(...part);
      this.renderer.setScissor(...part);
      for (const other of this.names) this.groups[other].visible = other === name;
      this.scale.value = (rect.height * devicePixelRatio) / (2 * Math.tan((this.camera.fov * Math.PI) / 360));
      this.renderer.render(this.scene, this.camera);
    }
  }
}
