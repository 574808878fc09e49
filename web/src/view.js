// The picture: boundary faces that the graphics card hides by the cut, inner faces that are listed anew when it moves, a picked
// tetrahedron, marked places, and the plane. Draws only when something has changed.
import { BufferAttribute, BufferGeometry, ColorManagement, DoubleSide, GLSL3, LineBasicMaterial, LineLoop, LineSegments, LinearSRGBColorSpace, Mesh,
  PerspectiveCamera, Points, RawShaderMaterial, Scene, Spherical, Vector3, Vector4, WebGLRenderer } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

// `keep`, the same at all corners of a face, says by the plane whether the face's tetrahedron is kept.
const FACE_VERTEX = `
precision highp float;
uniform mat4 modelViewMatrix, projectionMatrix;
uniform vec4 plane;
in vec3 position;
in vec4 colour;
#ifdef CUT
in vec3 keep;
#endif
out vec3 place, bary;
out vec4 tint;
void main() {
  int corner = gl_VertexID % 3;
  bary = vec3(corner == 0, corner == 1, corner == 2);
  tint = colour;
  vec4 seen = modelViewMatrix * vec4(position, 1.0);
  place = seen.xyz;
  gl_Position = projectionMatrix * seen;
  bool hidden = colour.a == 0.0;
#ifdef CUT
  hidden = hidden || dot(plane.xyz, keep) > plane.w;
#endif
  if (hidden) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}`;

// Flat shading from the slopes of the place; edges by barycentric coordinates, fading where faces are a few pixels wide.
const FACE_FRAGMENT = `
precision highp float;
uniform float lines, opacity, glow;
in vec3 place, bary;
in vec4 tint;
out vec4 pixel;
void main() {
  vec3 normal = normalize(cross(dFdx(place), dFdy(place)));
  vec3 toEye = normalize(-place);
  float key = max(0.0, dot(normal, normalize(vec3(0.35, 0.5, 0.8))));
  float fill = max(0.0, dot(normal, normalize(vec3(-0.7, -0.1, 0.5))));
  float light = 0.36 + 0.56 * key + 0.2 * fill + 0.06 * abs(dot(normal, toEye));
  vec3 lit = pow(tint.rgb, vec3(2.2)) * mix(light, 1.0, glow);
  vec3 width = fwidth(bary);
  vec3 away = smoothstep(width * 0.35, width * 1.35, bary);
  float edge = 1.0 - min(min(away.x, away.y), away.z);
  float fade = 1.0 - smoothstep(0.12, 0.4, max(max(width.x, width.y), width.z));
  lit *= 1.0 - 0.72 * edge * fade * lines;
  pixel = vec4(pow(min(lit, 1.0), vec3(1.0 / 2.2)), opacity);
}`;

const POINT_VERTEX = `
precision highp float;
uniform mat4 modelViewMatrix, projectionMatrix;
uniform float size;
in vec3 position;
in vec4 colour;
out vec4 tint;
void main() {
  tint = colour;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  gl_PointSize = size;
}`;

const POINT_FRAGMENT = `
precision highp float;
uniform float opacity;
in vec4 tint;
out vec4 pixel;
void main() {
  float radius = length(gl_PointCoord - 0.5);
  if (radius > 0.5) discard;
  pixel = vec4(radius > 0.36 ? vec3(1.0) : tint.rgb, opacity);
}`;

function faceMaterial({ cut = false, transparent = false, opacity = 1, glow = 0, depthTest = true, offset = 0 } = {}) {
  return new RawShaderMaterial({
    glslVersion: GLSL3, vertexShader: FACE_VERTEX, fragmentShader: FACE_FRAGMENT, side: DoubleSide, transparent, depthTest,
    depthWrite: !transparent, defines: cut ? { CUT: "" } : {}, polygonOffset: offset !== 0, polygonOffsetFactor: offset,
    polygonOffsetUnits: offset,
    uniforms: { plane: { value: new Vector4(0, 0, 0, 1) }, lines: { value: 1 }, opacity: { value: opacity }, glow: { value: glow } },
  });
}

function pointMaterial(opacity, depthTest) {
  return new RawShaderMaterial({
    glslVersion: GLSL3, vertexShader: POINT_VERTEX, fragmentShader: POINT_FRAGMENT, transparent: true, depthTest, depthWrite: false,
    uniforms: { size: { value: 11 * Math.min(2, window.devicePixelRatio) }, opacity: { value: opacity } },
  });
}

function geometryOf(attributes) {
  const geometry = new BufferGeometry();
  for (const [name, array, width] of attributes)
    geometry.setAttribute(name, new BufferAttribute(array, width, array instanceof Uint8Array));
  return geometry;
}

const unculled = (object) => Object.assign(object, { frustumCulled: false });

export class View {
  constructor(canvas, points, { lower, upper, origin }) {
    this.canvas = canvas;
    this.points = points;
    this.lower = new Vector3(...lower.map((x, k) => x - origin[k]));
    this.upper = new Vector3(...upper.map((x, k) => x - origin[k]));
    this.diagonal = this.upper.distanceTo(this.lower) || 1;
    ColorManagement.enabled = false; // colours are shown as they are said
    this.renderer = new WebGLRenderer({ canvas, antialias: true, powerPreference: "high-performance" });
    this.renderer.outputColorSpace = LinearSRGBColorSpace; // the shaders write what is shown
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(32, 1, 0.01, 100);
    this.frames = 0;
    this.materials = { shell: faceMaterial({ cut: true }), inner: faceMaterial(),
      ghost: faceMaterial({ cut: true, transparent: true, opacity: 0.1 }), picked: faceMaterial({ glow: 0.35, offset: -2 }),
      through: faceMaterial({ transparent: true, opacity: 0.38, glow: 1, depthTest: false }) };
    this.materials.ghost.uniforms.lines.value = 0;
    this.inner = unculled(new Mesh(new BufferGeometry(), this.materials.inner));
    this.pick = unculled(new Mesh(new BufferGeometry(), this.materials.picked));
    this.pickThrough = unculled(new Mesh(this.pick.geometry, this.materials.through));
    this.pickThrough.renderOrder = 3;
    this.pick.visible = this.pickThrough.visible = false;
    this.planeLoop = unculled(new LineLoop(geometryOf([["position", new Float32Array(12), 3]]), new LineBasicMaterial({ transparent: true, opacity: 0.75 })));
    this.planeLoop.visible = false;
    this.scene.add(this.inner, this.pick, this.pickThrough, this.planeLoop);
    this.marks = new Map();
    this.setUp("z");
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
    this.resize();
  }

  // ---- the camera ----

  setUp(axis) {
    const target = this.controls?.target.clone() ?? new Vector3();
    this.controls?.dispose();
    this.up = axis;
    this.camera.up.set(+(axis === "x"), +(axis === "y"), +(axis === "z"));
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.target.copy(target);
    this.controls.zoomToCursor = true;
    this.controls.minDistance = 1e-3 * this.diagonal;
    this.controls.maxDistance = 12 * this.diagonal;
    this.controls.addEventListener("change", () => this.draw());
    this.controls.addEventListener("start", () => (this.atHome = false));
    this.home();
  }

  // From a little above and aside, the whole in view.
  home() {
    const right = { x: [0, 1, 0], y: [0, 0, 1], z: [1, 0, 0] }[this.up], ahead = { x: [0, 0, 1], y: [1, 0, 0], z: [0, 1, 0] }[this.up];
    const from = new Vector3(...right).multiplyScalar(0.55).addScaledVector(new Vector3(...ahead), -0.75)
      .addScaledVector(this.camera.up, 0.42).normalize();
    this.controls.target.set(0, 0, 0);
    this.camera.position.copy(from);
    this.camera.lookAt(this.controls.target);
    this.camera.position.copy(from.multiplyScalar(this.fitDistance(from)));
    this.flight = null;
    this.atHome = true;
    this.controls.update();
    this.draw();
  }

  // How far away along a direction the camera must be for all points (of many, some) to be in view.
  fitDistance(direction) {
    const { points, camera } = this, right = new Vector3(), up = new Vector3(), tall = 1 / Math.tan((camera.fov * Math.PI) / 360), wide = tall / camera.aspect;
    camera.updateMatrix();
    camera.matrix.extractBasis(right, up, new Vector3());
    const step = 3 * Math.ceil(points.length / 60000), p = new Vector3();
    let most = 0.1 * this.diagonal;
    for (let i = 0; i < points.length; i += step) {
      p.fromArray(points, i);
      most = Math.max(most, p.dot(direction) + Math.max(Math.abs(p.dot(up)) * tall, Math.abs(p.dot(right)) * wide));
    }
    return 1.1 * most;
  }

  // Moves the camera towards a place until it is `distance` away, from the side where it is.
  fly(place, distance) {
    this.atHome = false;
    const target = new Vector3(...place);
    const side = this.camera.position.clone().sub(this.controls.target).normalize();
    const goal = { target, position: target.clone().addScaledVector(side, distance) };
    if (matchMedia("(prefers-reduced-motion: reduce)").matches) {
      this.controls.target.copy(goal.target);
      this.camera.position.copy(goal.position);
    } else {
      this.flight = { start: performance.now(), from: { target: this.controls.target.clone(), position: this.camera.position.clone() }, goal };
    }
    this.draw();
  }

  step(now) {
    const { start, from, goal } = this.flight, t = Math.min(1, (now - start) / 700), eased = t * t * (3 - 2 * t);
    this.controls.target.lerpVectors(from.target, goal.target, eased);
    this.camera.position.lerpVectors(from.position, goal.position, eased);
    if (t === 1) this.flight = null;
    else this.draw();
  }

  orbit(right, up) {
    this.atHome = false;
    const offset = this.camera.position.clone().sub(this.controls.target);
    const turned = (v, back) => (this.up === "y" ? v : this.up === "z" ? (back ? v.set(v.x, -v.z, v.y) : v.set(v.x, v.z, -v.y))
      : back ? v.set(v.y, -v.x, v.z) : v.set(-v.y, v.x, v.z));
    const round = new Spherical().setFromVector3(turned(offset, false));
    round.theta -= right;
    round.phi = Math.max(0.02, Math.min(Math.PI - 0.02, round.phi - up));
    this.camera.position.copy(this.controls.target).add(turned(offset.setFromSpherical(round), true));
    this.controls.update();
    this.draw();
  }

  zoom(factor) {
    this.atHome = false;
    const offset = this.camera.position.clone().sub(this.controls.target).multiplyScalar(factor);
    offset.clampLength(this.controls.minDistance, this.controls.maxDistance);
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
    this.draw();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    if (this.atHome) this.home();
    else this.draw();
  }

  draw() {
    this.waiting ??= requestAnimationFrame((now) => {
      this.waiting = null;
      if (this.flight) this.step(now);
      const distance = this.camera.position.distanceTo(this.controls.target);
      this.camera.near = Math.max(1e-4 * this.diagonal, 0.02 * distance);
      this.camera.far = distance + 2 * this.diagonal;
      this.camera.updateProjectionMatrix();
      this.camera.lookAt(this.controls.target);
      this.renderer.render(this.scene, this.camera);
      this.frames++;
      this.onDraw?.();
    });
  }

  // ---- what is drawn ----

  setShell(positions, keys, colours) {
    const geometry = geometryOf([["position", positions, 3], ["keep", keys, 3], ["colour", colours, 4]]);
    this.shell = unculled(new Mesh(geometry, this.materials.shell));
    // The same faces, all of them visible, faintly: where the filtered tetrahedra lie.
    const ghostly = geometryOf([["colour", new Uint8Array(colours.length).fill(150), 4]]);
    ghostly.setAttribute("position", geometry.getAttribute("position"));
    ghostly.setAttribute("keep", geometry.getAttribute("keep"));
    this.ghost = unculled(new Mesh(ghostly, this.materials.ghost));
    this.ghost.visible = false;
    this.ghost.renderOrder = 1;
    this.scene.add(this.shell, this.ghost);
  }

  shellChanged() {
    this.shell.geometry.getAttribute("colour").needsUpdate = true;
    this.draw();
  }

  setInner(positions, colours) {
    this.inner.geometry.dispose();
    this.inner.geometry = geometryOf([["position", positions, 3], ["colour", colours, 4]]);
    this.inner.visible = positions.length > 0;
    this.draw();
  }

  // plane: normal and distance in the space of the shell's keys; corners: of the rectangle to be shown, or null.
  setPlane(plane, corners) {
    for (const name of ["shell", "ghost"]) this.materials[name].uniforms.plane.value.set(...plane);
    this.planeLoop.visible = corners !== null;
    if (corners) {
      const attribute = this.planeLoop.geometry.getAttribute("position");
      corners.forEach((corner, i) => attribute.setXYZ(i, ...corner));
      attribute.needsUpdate = true;
    }
    this.draw();
  }

  setGhost(visible) {
    this.ghost.visible = visible;
  }

  setLines(on) {
    for (const name of ["shell", "inner", "picked"]) this.materials[name].uniforms.lines.value = +on;
    this.draw();
  }

  setTheme(background, line) {
    this.renderer.setClearColor(background);
    this.planeLoop.material.color.set(line);
    this.draw();
  }

  setPick(positions) {
    this.pick.visible = this.pickThrough.visible = positions !== null;
    if (positions) {
      const colours = new Uint8Array((4 * positions.length) / 3);
      for (let i = 0; i < colours.length; i += 4) colours.set([226, 20, 140, 255], i);
      this.pick.geometry.dispose();
      this.pick.geometry = this.pickThrough.geometry = geometryOf([["position", positions, 3], ["colour", colours, 4]]);
    }
    this.draw();
  }

  // Points, segments and faces of one kind of mark; each { points, lines, faces }: flat coordinates.
  setMarks(name, { points = [], lines = [], faces = [] }, colourOf) {
    const objects = [], filled = (count, group) => {
      const colours = new Uint8Array(4 * count);
      for (let i = 0; i < count; i++) colours.set([...colourOf(Math.floor(i / group)), 255], 4 * i);
      return colours;
    };
    const parts = [[points, 1], [lines, 2], [faces, 3]];
    for (const [coordinates, corners] of parts) {
      if (coordinates.length === 0) continue;
      const count = coordinates.length / 3;
      const geometry = geometryOf([["position", Float32Array.from(coordinates), 3], ["colour", filled(count, corners), 4]]);
      if (corners === 3) objects.push(new Mesh(geometry, faceMaterial({ glow: 1, offset: -2, transparent: true, opacity: 0.45 })));
      if (corners === 2) objects.push(new LineSegments(geometry, lineMaterial(1, true)), new LineSegments(geometry, lineMaterial(0.45, false)));
      if (corners === 1) objects.push(...pointObjects(geometry));
    }
    for (const object of objects) {
      unculled(object).renderOrder = 2;
      this.scene.add(object);
    }
    this.marks.set(name, objects);
    this.draw();
  }

  showMarks(name, visible) {
    for (const object of this.marks.get(name) ?? []) object.visible = visible;
    this.draw();
  }

  // ---- places on the screen ----

  // A ray through a place of the canvas, in pixels: { from, along }.
  ray(x, y) {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const far = new Vector3((2 * x) / width - 1, 1 - (2 * y) / height, 0.5).unproject(this.camera);
    const from = this.camera.position;
    return { from: from.toArray(), along: far.sub(from).normalize().toArray() };
  }

  // Where a place is on the canvas, in pixels; NaN behind the viewer.
  project(place) {
    const seen = new Vector3(...place).project(this.camera);
    if (seen.z > 1) return [NaN, NaN];
    return [((seen.x + 1) / 2) * this.canvas.clientWidth, ((1 - seen.y) / 2) * this.canvas.clientHeight];
  }

  direction() {
    return this.camera.position.clone().sub(this.controls.target).normalize().toArray();
  }
}

function lineMaterial(opacity, depthTest) {
  return new RawShaderMaterial({
    glslVersion: GLSL3, transparent: true, depthTest, depthWrite: false,
    vertexShader: POINT_VERTEX, fragmentShader: "precision highp float;\nuniform float opacity;\nin vec4 tint;\nout vec4 pixel;\nvoid main() { pixel = vec4(tint.rgb, opacity); }",
    uniforms: { size: { value: 1 }, opacity: { value: opacity } },
  });
}

function pointObjects(geometry) {
  return [new Points(geometry, pointMaterial(1, true)), new Points(geometry, pointMaterial(0.55, false))];
}
