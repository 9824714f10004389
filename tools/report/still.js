// A still picture of the mesh for browsers without WebGL: a z-buffer, and each triangle in one shade.

/** Draws the mesh of a shape. `colorOf(t)` is [red, green, blue] of a triangle, up to 255. */
function drawStill(canvas, shape, colorOf) {
  const { camera, positions, triangles } = shape;
  const rect = shape.aim(canvas);
  // The browser makes it smaller, and so its edges smooth.
  const width = canvas.width = Math.round(2 * rect.width);
  const height = canvas.height = Math.round(2 * rect.height);
  const [across, , , , , up] = camera.projectionMatrix.elements;
  const corners = new Float32Array(positions.length); // x, y [pixels], 1 / depth
  const point = new THREE.Vector3();
  for (let i = 0; i < positions.length; i += 3) {
    const { x, y, z } = point.fromArray(positions, i).applyMatrix4(camera.matrixWorldInverse);
    corners.set([(0.5 - (0.5 * across * x) / z) * width, (0.5 + (0.5 * up * y) / z) * height, -1 / z], i);
  }
  const mesh = geometryOf({ position: rowsOf(positions) }, new THREE.BufferAttribute(triangles, 1));
  mesh.computeVertexNormals();
  const normals = mesh.getAttribute('normal').array;
  const light = new THREE.Vector3(-0.5, 0.7, 1).normalize().applyQuaternion(camera.quaternion);
  const nearest = new Float32Array(width * height); // 1 / depth
  const context = canvas.getContext('2d');
  const image = context.createImageData(width, height);
  for (let t = 0; t < triangles.length; t += 3) {
    const [i, j, k] = [3 * triangles[t], 3 * triangles[t + 1], 3 * triangles[t + 2]];
    const [xi, yi, zi] = [corners[i], corners[i + 1], corners[i + 2]];
    const [xj, yj, zj] = [corners[j], corners[j + 1], corners[j + 2]];
    const [xk, yk, zk] = [corners[k], corners[k + 1], corners[k + 2]];
    if (!(Math.min(zi, zj, zk) > 0 && Math.max(zi, zj, zk) < 1 / camera.near)) continue;
    const area = (xj - xi) * (yk - yi) - (xk - xi) * (yj - yi);
    if (area === 0) continue;
    // The back is dark, as in the views.
    const front = area < 0;
    const facing = [i, j, k].reduce((sum, v) => sum + light.dot(point.fromArray(normals, v)) / 3, 0);
    const shade = (front ? 1 : 0.38) * (0.45 + 0.75 * Math.max(front ? facing : -facing, 0));
    const color = colorOf(t / 3);
    const first_x = Math.max(Math.ceil(Math.min(xi, xj, xk) - 0.5), 0);
    const last_x = Math.min(Math.max(xi, xj, xk) - 0.5, width - 1);
    const last_y = Math.min(Math.max(yi, yj, yk) - 0.5, height - 1);
    for (let y = Math.max(Math.ceil(Math.min(yi, yj, yk) - 0.5), 0); y <= last_y; ++y) {
      for (let x = first_x; x <= last_x; ++x) {
        const v = ((x + 0.5 - xi) * (yk - yi) - (xk - xi) * (y + 0.5 - yi)) / area;
        const w = ((xj - xi) * (y + 0.5 - yi) - (x + 0.5 - xi) * (yj - yi)) / area;
        const z = zi + v * (zj - zi) + w * (zk - zi);
        const pixel = y * width + x;
        if (v < 0 || w < 0 || v + w > 1 || z <= nearest[pixel]) continue;
        nearest[pixel] = z;
        image.data.set([shade * color[0], shade * color[1], shade * color[2], 255], 4 * pixel);
      }
    }
  }
  context.putImageData(image, 0, 0);
}
