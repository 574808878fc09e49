// What of the model is drawn: by the cut, the ranges of the plots and the choice of colour.
import { colourer } from "./colours.js";
import { FACES } from "./shapes.js";

const AXES = { x: 0, y: 1, z: 2 };

// Values this little below a bin belong to it: exact tiles have angles of 60 degrees but for the rounding of coordinates.
const ANGLE_SLACK = 2e-4, RATIO_SLACK = 1e-6;

export class Picture {
  constructor(model, view) {
    Object.assign(this, { model, view, colour: "class", ranges: {}, lines: true });
    this.cut = { axis: "none", normal: [1, 0, 0], at: 0, step: 0, flipped: false };
    this.keptTets = model.tetCount;
    this.innerFaces = 0;
    this.shellFaces = model.faceCount;
    this.buildShell();
  }

  buildShell() {
    const { model } = this, count = model.faceCount, positions = new Float32Array(9 * count), keys = new Float32Array(9 * count);
    for (let i = 0; i < count; i++) {
      const face = model.faces[i], t = face >>> 2, corners = FACES[face & 3];
      for (let k = 0; k < 3; k++) {
        const v = model.tets[4 * t + corners[k]];
        for (let c = 0; c < 3; c++) {
          positions[9 * i + 3 * k + c] = model.points[3 * v + c];
          keys[9 * i + 3 * k + c] = model.keys[3 * t + c];
        }
      }
    }
    this.shell = { positions, colours: new Uint8Array(12 * count) };
    this.paintShell();
    this.view.setShell(positions, keys, this.shell.colours);
  }

  // ---- what is kept ----

  get filtered() {
    return Object.values(this.ranges).some((range) => range);
  }

  // Normal and distance in the space of the model's keys; a tetrahedron is kept when normal . key <= distance.
  get plane() {
    const { axis, normal, at, step, flipped } = this.cut;
    if (axis === "none") return [0, 0, 0, 1];
    const sign = flipped ? -1 : 1;
    if (!this.model.whole) {
      const out = [0, 0, 0, sign * (step + 0.5)];
      out[AXES[axis]] = sign;
      return out;
    }
    return [...normal.map((x) => sign * x), sign * at];
  }

  // A function from tetrahedra to whether the cut keeps them, and one for the ranges.
  keeper() {
    const [a, b, c, d] = this.plane.map(Math.fround), { keys } = this.model;
    return (t) => a * keys[3 * t] + b * keys[3 * t + 1] + c * keys[3 * t + 2] <= d;
  }

  inRange() {
    if (!this.filtered) return () => true;
    const { angles, radiusRatio, radiusEdge } = this.model.shapes, { dihedral, radius_ratio: ratio, radius_edge: edge } = this.ranges;
    // The first and last bins hold all that is smaller and larger: turned-over tetrahedra, and radius-edge ratios from 3 on.
    const within = (value, [low, high], least, most) => (value >= low || low <= least) && (value < high || high >= most);
    return (t) => {
      if (ratio && !within(radiusRatio[t] + RATIO_SLACK, ratio, 0, 1)) return false;
      if (edge && !within(radiusEdge[t] + RATIO_SLACK, edge, 1, 2.999999)) return false;
      if (!dihedral) return true;
      for (let e = 6 * t; e < 6 * t + 6; e++) if (within(angles[e] + ANGLE_SLACK, dihedral, 0, 180)) return true;
      return false;
    };
  }

  // ---- painting ----

  sideOf() {
    const { model, colour } = this;
    return { ...(["dihedral", "radius_ratio", "radius_edge"].includes(colour) ? model.shapes : {}), classes: model.classes, regions: model.regions };
  }

  paintShell() {
    const { model, shell } = this, paint = colourer(this.colour, this.sideOf(), model), within = this.inRange();
    for (let i = 0; i < model.faceCount; i++) {
      const t = model.faces[i] >>> 2, [r, g, b] = paint(t, i), alpha = within(t) ? 255 : 0;
      for (let k = 12 * i; k < 12 * i + 12; k += 4) {
        shell.colours[k] = r;
        shell.colours[k + 1] = g;
        shell.colours[k + 2] = b;
        shell.colours[k + 3] = alpha;
      }
    }
  }

  // Colours or ranges have changed.
  async repaint() {
    this.paintShell();
    this.view.shellChanged();
    this.view.setGhost(this.filtered);
    await this.recut();
  }

  // The cut has moved: inner faces are found anew.
  async recut() {
    const ticket = (this.ticket = {});
    this.settled = false;
    this.view.setPlane(this.plane, this.planeCorners());
    const cutting = this.cut.axis !== "none";
    if (!this.model.whole && cutting && !this.filtered) {
      const section = await this.model.section(AXES[this.cut.axis], this.cut.step);
      if (this.ticket !== ticket) return;
      this.showSection(section);
    } else if (this.model.whole && (cutting || this.filtered)) {
      this.showWhole();
    } else if (this.filtered) {
      this.showLoose();
    } else {
      this.showInner([], () => {}, null);
    }
    this.countShown();
  }

  // Faces of a whole mesh between a kept tetrahedron and one that is not.
  showWhole() {
    const { model } = this, { first, second } = model.inner, keeps = this.keeper(), within = this.inRange();
    const kept = new Uint8Array(model.tetCount), faces = [];
    for (let t = 0; t < model.tetCount; t++) kept[t] = keeps(t) && within(t) ? 1 : 0;
    for (let i = 0; i < first.length; i++) {
      const a = kept[first[i] >>> 2], b = kept[second[i] >>> 2];
      if (a !== b) faces.push(a ? first[i] : second[i]);
    }
    this.showFaces(faces);
  }

  // All but boundary faces of the embedded tetrahedra that are in the ranges, where their neighbours are not known.
  showLoose() {
    const { model } = this, keeps = this.keeper(), within = this.inRange(), faces = [];
    const onBoundary = (this.onBoundary ??= new Set(model.faces));
    for (let t = 0; t < model.tetCount; t++) {
      if (!keeps(t) || !within(t)) continue;
      for (let face = 4 * t; face < 4 * t + 4; face++) if (!onBoundary.has(face)) faces.push(face);
    }
    this.showFaces(faces);
  }

  showFaces(faces) {
    const { model } = this, paint = colourer(this.colour, this.sideOf(), model);
    const positions = new Float32Array(9 * faces.length), colours = new Uint8Array(12 * faces.length);
    for (let i = 0; i < faces.length; i++) {
      const face = faces[i], t = face >>> 2, corners = FACES[face & 3];
      for (let k = 0; k < 3; k++) {
        const v = 3 * model.tets[4 * t + corners[k]];
        for (let c = 0; c < 3; c++) positions[9 * i + 3 * k + c] = model.points[v + c];
      }
      paintFace(colours, i, paint(t, -1));
    }
    this.showInner(positions, (i) => ({ tet: faces[i] >>> 2 }), colours);
  }

  showSection({ count, points, sides }) {
    const side = sides[this.cut.flipped ? 1 : 0], paint = colourer(this.colour, side, this.model), colours = new Uint8Array(12 * count);
    for (let i = 0; i < count; i++) paintFace(colours, i, paint(i, -1));
    this.showInner(points, (i) => ({ side, index: i }), colours);
  }

  showInner(positions, owner, colours) {
    this.inner = { positions, owner };
    this.innerFaces = positions.length / 9;
    this.view.setInner(positions.length ? positions : new Float32Array(0), colours ?? new Uint8Array(0));
  }

  countShown() {
    const keeps = this.keeper(), within = this.inRange(), { model } = this;
    let tets = 0, faces = 0;
    for (let t = 0; t < model.tetCount; t++) if (keeps(t) && within(t)) tets++;
    for (let i = 0; i < model.faceCount; i++) if (this.shell.colours[12 * i + 3] && keeps(model.faces[i] >>> 2)) faces++;
    this.keptTets = tets;
    this.shellFaces = faces;
    this.settled = true;
    this.onShown?.();
  }

  // ---- the plane ----

  // Where the plane is, in coordinates relative to the origin.
  get offset() {
    return this.model.whole ? this.cut.at : this.model.facts.embedded.cuts[AXES[this.cut.axis]]?.[this.cut.step] ?? 0;
  }

  // The least and largest distance of the box's corners along the normal.
  reach(normal = this.cut.normal) {
    let low = Infinity, high = -Infinity;
    for (let corner = 0; corner < 8; corner++) {
      const along = normal.reduce((sum, n, k) => sum + n * this.boxCorner(corner)[k], 0);
      low = Math.min(low, along);
      high = Math.max(high, along);
    }
    return [low, high];
  }

  boxCorner(i) {
    const { lower, upper } = this.view;
    return [i & 1 ? upper.x : lower.x, i & 2 ? upper.y : lower.y, i & 4 ? upper.z : lower.z];
  }

  // A rectangle in the plane that covers the box, a little larger.
  planeCorners() {
    if (this.cut.axis === "none") return null;
    const { normal } = this.cut, least = normal.map(Math.abs).indexOf(Math.min(...normal.map(Math.abs)));
    const help = [0, 1, 2].map((k) => +(k === least)), cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    const unit = (a) => a.map((x) => x / Math.hypot(...a)), u = unit(cross(normal, help)), v = cross(normal, u);
    const room = 0.03 * this.view.diagonal, [[u0, u1], [v0, v1]] = [this.reach(u), this.reach(v)];
    const at = (a, b) => [0, 1, 2].map((k) => normal[k] * this.offset + u[k] * a + v[k] * b);
    return [at(u0 - room, v0 - room), at(u1 + room, v0 - room), at(u1 + room, v1 + room), at(u0 - room, v1 + room)];
  }

  setCut(change) {
    Object.assign(this.cut, change);
    const { axis } = this.cut;
    if (axis in AXES) this.cut.normal = [0, 1, 2].map((k) => +(k === AXES[axis]));
    return this.recut();
  }

  // ---- picking ----

  // The visible face that a ray meets first: { face } of the boundary, or { inner }, an index of inner faces.
  hit(ray) {
    const keeps = this.keeper(), { model, shell } = this;
    const outer = nearest(shell.positions, ray, (i) => shell.colours[12 * i + 3] > 0 && keeps(model.faces[i] >>> 2));
    const inner = this.inner ? nearest(this.inner.positions, ray, () => true) : { index: -1, distance: Infinity };
    if (outer.index < 0 && inner.index < 0) return null;
    if (outer.distance <= inner.distance) return { tet: model.faces[outer.index] >>> 2, face: outer.index };
    return this.inner.owner(inner.index);
  }
}

function paintFace(colours, i, [r, g, b]) {
  for (let k = 12 * i; k < 12 * i + 12; k += 4) {
    colours[k] = r;
    colours[k + 1] = g;
    colours[k + 2] = b;
    colours[k + 3] = 255;
  }
}

// Moller and Trumbore's test over all triangles.
function nearest(positions, { from, along }, visible) {
  let best = Infinity, index = -1;
  const [ox, oy, oz] = from, [dx, dy, dz] = along;
  for (let i = 0, p = 0; p < positions.length; i++, p += 9) {
    const ax = positions[p], ay = positions[p + 1], az = positions[p + 2];
    const ux = positions[p + 3] - ax, uy = positions[p + 4] - ay, uz = positions[p + 5] - az;
    const vx = positions[p + 6] - ax, vy = positions[p + 7] - ay, vz = positions[p + 8] - az;
    const px = dy * vz - dz * vy, py = dz * vx - dx * vz, pz = dx * vy - dy * vx;
    const determinant = ux * px + uy * py + uz * pz;
    if (determinant === 0) continue;
    const sx = ox - ax, sy = oy - ay, sz = oz - az, a = (sx * px + sy * py + sz * pz) / determinant;
    if (a < 0 || a > 1) continue;
    const qx = sy * uz - sz * uy, qy = sz * ux - sx * uz, qz = sx * uy - sy * ux;
    const b = (dx * qx + dy * qy + dz * qz) / determinant;
    if (b < 0 || a + b > 1) continue;
    const t = (vx * qx + vy * qy + vz * qz) / determinant;
    if (t > 0 && t < best && visible(i)) {
      best = t;
      index = i;
    }
  }
  return { index, distance: best };
}
