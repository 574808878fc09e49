// Angles and ratios of tetrahedra: the formulas of cli/report_shapes.c.

const DEGREES = 180 / Math.PI;
const REGULAR_RADIUS_EDGE = 0.6123724356957945; // sqrt(6) / 4

// What can be measured, in the order of the plots.
export const MEASURES = ["dihedral", "radius_ratio", "radius_edge"];

// Corners of face i, which is opposite corner i.
export const FACES = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

const normals = new Float64Array(12), squares = new Float64Array(6), corner = new Float64Array(12);
const ENDS = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];

function dot(i, j) {
  return normals[3 * i] * normals[3 * j] + normals[3 * i + 1] * normals[3 * j + 1] + normals[3 * i + 2] * normals[3 * j + 2];
}

// Measures one tetrahedron: six dihedral angles to angles[6 t ..], and the ratios.
function measureOne(points, tets, t, out) {
  for (let k = 0; k < 4; k++) {
    const v = 3 * tets[4 * t + k];
    corner[3 * k] = points[v];
    corner[3 * k + 1] = points[v + 1];
    corner[3 * k + 2] = points[v + 2];
  }
  for (let f = 0; f < 4; f++) {
    const a = 3 * FACES[f][0], b = 3 * FACES[f][1], c = 3 * FACES[f][2];
    const ux = corner[b] - corner[a], uy = corner[b + 1] - corner[a + 1], uz = corner[b + 2] - corner[a + 2];
    const vx = corner[c] - corner[a], vy = corner[c + 1] - corner[a + 1], vz = corner[c + 2] - corner[a + 2];
    normals[3 * f] = uy * vz - uz * vy;
    normals[3 * f + 1] = uz * vx - ux * vz;
    normals[3 * f + 2] = ux * vy - uy * vx;
  }
  let least = 180, most = 0, shortest = Infinity, areas = 0;
  for (let e = 0; e < 6; e++) {
    const i = ENDS[e][0], j = ENDS[e][1];
    const x = corner[3 * j] - corner[3 * i], y = corner[3 * j + 1] - corner[3 * i + 1], z = corner[3 * j + 2] - corner[3 * i + 2];
    squares[e] = x * x + y * y + z * z;
    shortest = Math.min(shortest, squares[e]);
    const cosine = -dot(i, j) / Math.sqrt(dot(i, i) * dot(j, j));
    const angle = Math.acos(Math.max(-1, Math.min(1, cosine))) * DEGREES;
    out.angles[6 * t + e] = angle;
    least = Math.min(least, angle);
    most = Math.max(most, angle);
  }
  for (let f = 0; f < 4; f++) areas += Math.sqrt(dot(f, f));
  // vw, wu, uv are the opposites of the normals 1, 2, 3.
  let ox = 0, oy = 0, oz = 0;
  for (let k = 0; k < 3; k++) {
    ox -= squares[k] * normals[3 * (k + 1)];
    oy -= squares[k] * normals[3 * (k + 1) + 1];
    oz -= squares[k] * normals[3 * (k + 1) + 2];
  }
  const ux = corner[3] - corner[0], uy = corner[4] - corner[1], uz = corner[5] - corner[2];
  const determinant = -(ux * normals[3] + uy * normals[4] + uz * normals[5]);
  const length = Math.sqrt(ox * ox + oy * oy + oz * oz);
  out.minDihedral[t] = least;
  out.maxDihedral[t] = most;
  out.radiusRatio[t] = (6 * determinant * Math.abs(determinant)) / (length * areas);
  out.radiusEdge[t] = length / (2 * Math.abs(determinant) * Math.sqrt(shortest) * REGULAR_RADIUS_EDGE);
}

export function measure(points, tets) {
  const count = tets.length / 4;
  const out = {
    angles: new Float32Array(6 * count),
    minDihedral: new Float32Array(count),
    maxDihedral: new Float32Array(count),
    radiusRatio: new Float32Array(count),
    radiusEdge: new Float32Array(count),
  };
  for (let t = 0; t < count; t++) measureOne(points, tets, t, out);
  return out;
}
