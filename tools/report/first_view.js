// What the page shows, and where it looks from at first. Points are rows of three numbers.

const field_of_view = 28; // degrees
// A ball of radius 1 fits.
const start_distance = 1.04 / Math.sin((field_of_view * Math.PI) / 360);
const widest_angle = (50 * Math.PI) / 180; // from the axis of the camera

/** Triangles' centers, and their normals as long as their areas; of many triangles, some 20,000. */
function sampledTriangles(points, triangles, marks) {
  const stride = 3 * Math.ceil(triangles.length / 60000);
  const samples = [];
  const corner = (i) => new THREE.Vector3().fromArray(points, 3 * triangles[i]);
  for (let i = 0; i < triangles.length; i += stride) {
    if (marks[i / 3] & 2) continue; // a filled opening is no surface of the object
    const [a, b, c] = [corner(i), corner(i + 1), corner(i + 2)];
    const center = a.clone().add(b).add(c).divideScalar(3);
    samples.push({ center, normal: b.sub(a).cross(c.sub(a)).divideScalar(2) });
  }
  return samples;
}

/** Whether triangles are those of a depth image taken from `eye` along z: all are in front of it, and their fronts face
    it. Closed surfaces show it as much of their backs. */
function isDepthImage(samples, eye) {
  let front = 0;
  let all = 0;
  const ahead = Math.sign(samples[0].center.z - eye.z);
  for (const { center, normal } of samples) {
    const { x, y, z } = center.clone().sub(eye);
    if (!(Math.max(Math.abs(x), Math.abs(y)) < ahead * z)) return false; // 90 degrees
    const facing = normal.dot(eye.clone().sub(center).normalize());
    front += facing;
    all += Math.abs(facing);
  }
  return front > 0.8 * all;
}

/** How well points whose box has a diagonal of 2 stand upright about an axis: by their height, which counts up to three
    times as much if their middle is above what they stand on, the wider the more. */
function standing(points, axis) {
  const box = new THREE.Box3().setFromArray(points);
  const low = box.min.getComponent(axis);
  const foot = new THREE.Box3();
  const middle = new THREE.Vector3();
  for (let i = 0; i < points.length; i += 3) {
    const point = new THREE.Vector3().fromArray(points, i);
    middle.add(point);
    if (point.getComponent(axis) <= low + 0.04) foot.expandByPoint(point);
  }
  middle.multiplyScalar(3 / points.length).setComponent(axis, low);
  const size = box.getSize(new THREE.Vector3()).clampScalar(1e-9, 2); // no division by 0
  const height = size.getComponent(axis);
  if (!foot.containsPoint(middle)) return height;
  const share = foot.getSize(new THREE.Vector3()).divide(size).setComponent(axis, 1);
  return height * (1 + 2 * Math.sqrt(share.x * share.y * share.z));
}

/**
 * The view in which a mesh shows most: {up, toward}, unit vectors, the second to the camera.
 *
 * Depth cameras look along z with y down, or along -z with y up: what they saw is looked at from where they were. Else
 * up is z or y, about whichever the object stands better. There it is looked at from a little above, and by custom from
 * -y if z is up, from z if y is: it is turned only as far as other sides show clearly more area of the front of its
 * triangles. Of closed surfaces that is the projected area, of open ones that of the side towards which their normals
 * point, if need be from below.
 */
function firstView(points, triangles, marks, eye, closed) {
  const samples = sampledTriangles(points, triangles, marks);
  if (samples.length > 0 && isDepthImage(samples, eye)) {
    const toward = eye.clone().normalize();
    return { up: new THREE.Vector3(0, Math.sign(toward.z), 0), toward };
  }
  const z_up = standing(points, 2) >= standing(points, 1);
  const up = z_up ? new THREE.Vector3(0, 0, 1) : new THREE.Vector3(0, 1, 0);
  const ahead = z_up ? new THREE.Vector3(0, -1, 0) : new THREE.Vector3(0, 0, 1);
  const radians = Math.PI / 180;
  const from = (elevation, azimuth) => ahead.clone().applyAxisAngle(up, azimuth * radians)
    .multiplyScalar(Math.cos(elevation * radians)).addScaledVector(up, Math.sin(elevation * radians));
  const custom = from(15, 0);
  const views = [];
  for (const elevation of closed ? [15, 30, 45, 60] : [-15, 15, 30, 45, 60]) {
    for (let azimuth = -180; azimuth < 180; azimuth += 15) {
      const toward = from(elevation, azimuth);
      const area = samples.reduce((sum, { normal }) => sum + Math.max(normal.dot(toward), 0), 0);
      views.push({ toward, area, off: custom.angleTo(toward) });
    }
  }
  const most = Math.max(...views.map(({ area }) => area));
  const good = views.filter(({ area }) => area >= 0.9 * most);
  return { up, toward: good.reduce((best, view) => (view.off < best.off ? view : best)).toward };
}

/** The view of a sensor at `eye`, of what is around 0. Up is z, unless the sensor looks about along it. */
function sensorView(eye) {
  const toward = (eye.lengthSq() > 0 ? eye.clone() : new THREE.Vector3(0, -1, 0)).normalize();
  const up = Math.abs(toward.z) < 0.8 ? new THREE.Vector3(0, 0, 1) : new THREE.Vector3(0, Math.sign(toward.z), 0);
  return { up, toward };
}

/** The object with its middle at 0 and the corners of its box at distance 1, and a camera at its first place. */
class Shape {
  constructor(arrays, { view, report }) {
    const { low, high } = arrays.positions;
    const center = low.map((x, c) => (x + high[c]) / 2);
    const radius = Math.hypot(...low.map((x, c) => (high[c] - x) / 2)) || 1;
    const normalized = (rows) => rows.map((x, i) => (x - center[i % 3]) / radius);
    this.normalized = (array) => normalized(array.numbers());
    this.radius = radius;
    this.origin = new THREE.Vector3(...center).divideScalar(-radius); // of the input
    this.positions = this.normalized(arrays.positions);
    this.sphere = arrays.sphere?.numbers();
    this.triangles = arrays.triangles.values;
    const eye = view && new THREE.Vector3(...normalized(view));
    const { up, toward } = view ? sensorView(eye) : firstView(this.positions, this.triangles,
      arrays.suspicious.values, this.origin, partsOf(report).every((part) => part.closed));
    this.start = toward.multiplyScalar(view ? Math.min(Math.max(eye.length(), 0.02), start_distance) : start_distance);
    this.camera = new THREE.PerspectiveCamera(field_of_view, 1, 0.01, 50);
    this.camera.up.copy(up);
    this.camera.position.copy(this.start);
    this.camera.lookAt(0, 0, 0);
    this.camera.updateMatrixWorld();
    /** How far what is shown reaches to the sides and upwards from the camera's axis, over its depth. */
    this.ball_slopes = [0, Math.tan(Math.min(Math.asin(Math.min(1.04 / this.start.length(), 1)), widest_angle))];
    this.slopes = view ? this.slopesOfPoints() : this.ball_slopes;
  }

  slopesOfPoints() {
    const widest = Math.tan(widest_angle);
    const slopes = [0.01, 0.01];
    for (let i = 0; i < this.positions.length; i += 3) {
      const { x, y, z } = new THREE.Vector3().fromArray(this.positions, i).applyMatrix4(this.camera.matrixWorldInverse);
      [x, y].forEach((side, k) => {
        const slope = z < 0 ? (1.04 * Math.abs(side)) / -z : widest;
        slopes[k] = Math.min(Math.max(slopes[k], slope), widest);
      });
    }
    return slopes;
  }

  /** Gives the camera the shape of an element, and a field of view that shows all at first: its rectangle. */
  aim(element, [across, up] = this.slopes) {
    const rect = element.getBoundingClientRect();
    this.camera.aspect = rect.width / rect.height;
    this.camera.fov = (360 / Math.PI) * Math.atan(Math.max(up, across / this.camera.aspect));
    this.camera.updateProjectionMatrix();
    return rect;
  }
}
