// Materials of the views. Colours are sRGB as they are: nothing is tone-mapped.
import { DoubleSide, ShaderMaterial } from 'three';

const surface_vertex = `
attribute vec3 shade; // colour of the vertex
attribute vec3 place; // where the vertex is on the sphere
varying vec3 v_color;
varying vec3 v_normal;
varying vec3 v_position;
varying vec3 v_place;
void main() {
  vec4 position_in_view = modelViewMatrix * vec4(position, 1.0);
  v_color = shade;
  v_normal = normalMatrix * normal;
  v_position = position_in_view.xyz;
  v_place = place;
  gl_Position = projectionMatrix * position_in_view;
}`;

const surface_fragment = `
uniform bool flat_shading;
uniform bool grid;
uniform vec3 inside;
varying vec3 v_color;
varying vec3 v_normal;
varying vec3 v_position;
varying vec3 v_place;
const float pi = 3.14159265;
float line(float distance_to_line, float width) {
  return 1.0 - smoothstep(0.4 * width, 1.2 * width, distance_to_line);
}
void main() {
  vec3 across = cross(dFdx(v_position), dFdy(v_position)); // towards the eye
  vec3 normal = flat_shading ? normalize(across)
                             : normalize(v_normal) * (gl_FrontFacing ? 1.0 : -1.0);
  vec3 to_eye = normalize(-v_position);
  float key = max(dot(normal, normalize(vec3(-0.45, 0.65, 0.75))), 0.0);
  float head = max(dot(normal, to_eye), 0.0);
  vec3 half_way = normalize(normalize(vec3(-0.45, 0.65, 0.75)) + to_eye);
  float shine = pow(max(dot(normal, half_way), 0.0), 40.0);
  vec3 color = gl_FrontFacing ? v_color : mix(v_color, inside, 0.75);
  if (grid) {
    vec3 direction = normalize(v_place);
    float width = length(fwidth(direction));
    float step = pi / 12.0;
    float latitude = asin(clamp(direction.z, -1.0, 1.0));
    float longitude = atan(direction.y, direction.x);
    float to_parallel = abs(fract(latitude / step - 0.5) - 0.5) * step;
    float to_meridian = abs(fract(longitude / step - 0.5) - 0.5) * step * cos(latitude);
    // Not where lines would be closer than pixels.
    float strength = 0.5 * (1.0 - smoothstep(0.06, 0.2, width));
    color *= 1.0 - strength * max(line(to_parallel, width), line(to_meridian, width));
  }
  gl_FragColor = vec4(color * (0.42 + 0.44 * key + 0.3 * head) + 0.07 * shine, 1.0);
}`;

export function surfaceMaterial() {
  return new ShaderMaterial({
    vertexShader: surface_vertex,
    fragmentShader: surface_fragment,
    uniforms: {
      flat_shading: { value: false },
      grid: { value: false },
      inside: { value: [0.25, 0.22, 0.24] },
    },
    side: DoubleSide,
    polygonOffset: true, // lines and marks lie in front
    polygonOffsetFactor: 1,
    polygonOffsetUnits: 1,
  });
}

/** Triangles with a flag, in one colour, over the surface. */
export function flagMaterial(color) {
  return new ShaderMaterial({
    vertexShader: `
      varying vec3 v_position;
      void main() {
        vec4 position_in_view = modelViewMatrix * vec4(position, 1.0);
        v_position = position_in_view.xyz;
        gl_Position = projectionMatrix * position_in_view;
      }`,
    fragmentShader: `
      uniform vec3 color;
      varying vec3 v_position;
      void main() {
        vec3 normal = normalize(cross(dFdx(v_position), dFdy(v_position)));
        gl_FragColor = vec4(color * (0.6 + 0.45 * max(normal.z, 0.0)), 1.0);
      }`,
    uniforms: { color: { value: color.map((c) => c / 255) } },
    side: DoubleSide,
    polygonOffset: true,
    polygonOffsetFactor: -1,
    polygonOffsetUnits: -1,
  });
}

export function lineMaterial(color, opacity) {
  return new ShaderMaterial({
    vertexShader: `
      void main() { gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }`,
    fragmentShader: `
      uniform vec4 color;
      void main() { gl_FragColor = color; }`,
    uniforms: { color: { value: [...color, opacity] } },
    transparent: true,
    depthWrite: false,
  });
}

/** Points as discs, lit by the normal of the surface there; those that look away are faint. */
export function cloudMaterial() {
  return new ShaderMaterial({
    vertexShader: `
      attribute vec3 shade;
      attribute float size; // of a disc, in the units of the object
      uniform float pixels; // per unit at distance 1
      uniform vec3 background;
      varying vec3 v_color;
      void main() {
        vec4 position_in_view = modelViewMatrix * vec4(position, 1.0);
        bool is_lit = dot(normal, normal) > 0.5; // not what was left out
        vec3 normal_in_view = is_lit ? normalize(normalMatrix * normal) : vec3(0.0, 0.0, 1.0);
        float facing = dot(normal_in_view, normalize(-position_in_view.xyz));
        float key = max(dot(normal_in_view, normalize(vec3(-0.45, 0.65, 0.75))), 0.0);
        vec3 lit = shade * (0.45 + 0.4 * key + 0.25 * max(facing, 0.0));
        v_color = mix(mix(lit, background, 0.8), lit, smoothstep(-0.15, 0.1, facing));
        gl_Position = projectionMatrix * position_in_view;
        gl_PointSize = clamp(size * pixels / -position_in_view.z, is_lit ? 1.5 : 5.0, 64.0);
      }`,
    fragmentShader: `
      varying vec3 v_color;
      void main() {
        if (length(gl_PointCoord - 0.5) > 0.5) discard;
        gl_FragColor = vec4(v_color, 1.0);
      }`,
    uniforms: {
      pixels: { value: 1 },
      background: { value: [1, 1, 1] },
    },
  });
}

/** Marks of a size in pixels: a ring (the point that is looked at) or a disc. */
export function markMaterial(color, pixels, ring, opacity, hidden) {
  return new ShaderMaterial({
    vertexShader: `
      uniform float pixels;
      void main() {
        gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
        gl_Position.z -= 2e-3 * gl_Position.w; // in front of the surface that it lies on
        gl_PointSize = pixels;
      }`,
    fragmentShader: `
      uniform vec3 color;
      uniform float opacity;
      uniform float hole;
      void main() {
        float radius = 2.0 * length(gl_PointCoord - 0.5);
        if (radius > 1.0) discard;
        // A dark and a light rim, to be seen on any colour.
        vec3 rim = radius > 0.8 ? vec3(0.0) : (radius < hole ? vec3(1.0) : color);
        gl_FragColor = vec4(hole > 0.0 ? rim : (radius > 0.72 ? vec3(1.0) : color), opacity);
      }`,
    uniforms: {
      color: { value: color.map((c) => c / 255) },
      pixels: { value: pixels },
      opacity: { value: opacity },
      hole: { value: ring ? 0.35 : 0 },
    },
    transparent: true,
    depthTest: !hidden,
    depthWrite: false,
  });
}
