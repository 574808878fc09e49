// The mesh as it is embedded: whole, or its boundary, sections and worst tetrahedra.
//
// A tetrahedron is kept by the cut when its centroid is on the kept side. Of whole meshes that is computed here; of others the
// program has told, for every tetrahedron and axis, how many of the possible cuts lie below it ("bins"), so that both agree.
import { hasBlock, readBlock } from "./blocks.js";
import { FACES, measure } from "./shapes.js";

const interleave = (columns) => {
  const count = columns[0].length, width = columns.length;
  const out = new columns[0].constructor(count * width);
  for (let k = 0; k < width; k++) for (let i = 0; i < count; i++) out[width * i + k] = columns[k][i];
  return out;
};

async function readColumns(id, width, read) {
  const reader = await readBlock(id), columns = [];
  for (let k = 0; k < width; k++) columns.push(read(reader));
  reader.done();
  return columns;
}

export class Model {
  static async read(facts) {
    const model = new Model(), { embedded } = facts, { vertices, tets, faces } = embedded;
    model.facts = facts;
    model.whole = embedded.whole;
    model.tetCount = tets;
    model.faceCount = faces;
    model.points = interleave(await readColumns("points", 3, (r) => r.floats(vertices)));
    model.tets = interleave(await readColumns("tets", 4, (r) => r.indices(tets)));
    model.numbers = model.whole ? null : (await readColumns("tet_numbers", 1, (r) => r.indices(tets)))[0];
    [model.classes] = await readColumns("classes", 1, (r) => r.bytesOf(tets));
    model.regions = hasBlock("regions") ? (await readColumns("regions", 1, (r) => r.shorts(tets)))[0] : null;
    [model.faces] = await readColumns("faces", 1, (r) => r.indices(faces));
    model.tags = hasBlock("tags") ? (await readColumns("tags", 1, (r) => r.shorts(faces)))[0] : null;
    model.distances = hasBlock("distances") ? (await readColumns("distances", 1, (r) => r.floats(faces)))[0] : null;
    model.keys = model.whole ? model.centroids() : Float32Array.from(interleave(await readColumns("bins", 3, (r) => r.bytesOf(tets))));
    model.sections = new Map();
    return model;
  }

  // The number that a tetrahedron has in the mesh.
  numberOf(t) {
    return this.numbers ? this.numbers[t] : t;
  }

  // The embedded tetrahedron with a number of the mesh, or -1.
  find(number) {
    if (!this.numbers) return number < this.tetCount ? number : -1;
    let low = 0, high = this.tetCount;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.numbers[middle] < number) low = middle + 1;
      else high = middle;
    }
    return this.numbers[low] === number ? low : -1;
  }

  centroids() {
    const { points, tets } = this, out = new Float32Array(3 * this.tetCount);
    for (let t = 0; t < this.tetCount; t++) {
      for (let k = 0; k < 3; k++) {
        out[3 * t + k] = (points[3 * tets[4 * t] + k] + points[3 * tets[4 * t + 1] + k] + points[3 * tets[4 * t + 2] + k] +
          points[3 * tets[4 * t + 3] + k]) / 4;
      }
    }
    return out;
  }

  get shapes() {
    return (this.measured ??= measure(this.points, this.tets));
  }

  // The three vertices of a face, given as 4 * tet + corner.
  corners(face) {
    const t = face >>> 2, [a, b, c] = FACES[face & 3], { tets } = this;
    return [tets[4 * t + a], tets[4 * t + b], tets[4 * t + c]];
  }

  // Faces between two tetrahedra of a whole mesh: pairs of 4 * tet + corner, found by their least vertex.
  get inner() {
    return (this.matched ??= this.matchFaces());
  }

  matchFaces() {
    const { tets, tetCount } = this, all = 4 * tetCount, vertexCount = this.points.length / 3;
    const low = new Uint32Array(all), middle = new Uint32Array(all), high = new Uint32Array(all);
    const starts = new Uint32Array(vertexCount + 1);
    for (let face = 0; face < all; face++) {
      const at = face & ~3, [i, j, k] = FACES[face & 3];
      const a = tets[at + i], b = tets[at + j], c = tets[at + k];
      const least = Math.min(a, b, c), most = Math.max(a, b, c);
      low[face] = least;
      high[face] = most;
      middle[face] = a + b + c - least - most;
      starts[least + 1]++;
    }
    for (let v = 0; v < vertexCount; v++) starts[v + 1] += starts[v];
    const filled = starts.slice(), waiting = new Uint32Array(all);
    const first = new Uint32Array(all / 2), second = new Uint32Array(all / 2);
    let count = 0;
    for (let face = 0; face < all; face++) {
      const v = low[face];
      let at = starts[v];
      const end = filled[v];
      while (at < end && (middle[waiting[at]] !== middle[face] || high[waiting[at]] !== high[face])) at++;
      if (at === end) {
        waiting[filled[v]++] = face;
      } else {
        first[count] = waiting[at];
        second[count++] = face;
        waiting[at] = waiting[--filled[v]];
      }
    }
    return { first: first.slice(0, count), second: second.slice(0, count) };
  }

  // The faces that lie open at a cut of a mesh that is not whole; what is known of the tetrahedra below and above.
  async section(axis, cut) {
    const key = `section-${axis}-${cut}`;
    let found = this.sections.get(key);
    if (!found) {
      found = this.readSection(key);
      this.sections.set(key, found);
      if (this.sections.size > 12) this.sections.delete(this.sections.keys().next().value);
    }
    return found;
  }

  async readSection(key) {
    const reader = await readBlock(key, false);
    const [count, vertices] = reader.indices(2);
    const { lower, upper, origin } = this.facts.embedded;
    const places = new Float32Array(3 * vertices);
    for (let k = 0; k < 3; k++) {
      const steps = reader.shorts(vertices), from = lower[k] - origin[k], step = (upper[k] - lower[k]) / 65535;
      for (let i = 0; i < vertices; i++) places[3 * i + k] = from + step * steps[i];
    }
    const points = new Float32Array(9 * count);
    for (let k = 0; k < 3; k++) {
      const corners = reader.indices(count);
      for (let i = 0; i < count; i++) points.set(places.subarray(3 * corners[i], 3 * corners[i] + 3), 9 * i + 3 * k);
    }
    const sides = [0, 1].map(() => this.readSide(reader, count));
    reader.done();
    return { count, points, sides };
  }

  readSide(reader, count) {
    const numbers = reader.indices(count);
    const scaled = (low, high) => Float32Array.from(reader.shorts(count), (value) => low + (value / 65535) * (high - low));
    return {
      numbers,
      minDihedral: scaled(0, 180),
      maxDihedral: scaled(0, 180),
      radiusRatio: scaled(0, 1),
      radiusEdge: scaled(1, 5),
      classes: reader.bytesOf(count),
      regions: this.regions ? reader.shorts(count) : null,
    };
  }
}
