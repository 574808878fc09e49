// The certificate as a table for people.
import { count, degrees, make, number } from "./words.js";

const percent = (part, whole) => `${((100 * part) / whole).toFixed(1)} %`;

function section(title, rows) {
  const body = make("tbody", {}, make("tr", { className: "head" }, make("th", { colSpan: 2, scope: "rowgroup", textContent: title })));
  for (const [name, value, state] of rows.filter(Boolean)) {
    const cell = make("td", {}, value);
    if (state) cell.className = state;
    body.append(make("tr", {}, make("th", { scope: "row", textContent: name }), cell));
  }
  return body;
}

const good = (holds) => (holds ? "good" : "bad");

function validity(c) {
  const faults = [["bad_indices", "tetrahedra with corners out of range or repeated"], ["inverted_tets", "tetrahedra that are flat or inside out"],
    ["nonconforming_faces", "faces that do not fit"], ["nonmanifold_edges", "boundary edges without exactly two faces"],
    ["nonmanifold_vertices", "boundary vertices where several sheets meet"]];
  return section("Validity", [["valid", c.valid ? "yes" : "no", good(c.valid)],
    ...faults.map(([key, text]) => c[key] > 0 && [text, count(c[key]), "bad"]),
    c.unused_vertices > 0 && ["vertices in no tetrahedron", count(c.unused_vertices)],
    ["parts", count(c.components)], ["pieces of the boundary", count(c.boundary_components)], ["genus", count(c.genus)]]);
}

function counts(c) {
  return section("Size", [["tetrahedra", count(c.tets)], ["vertices", count(c.vertices)], ["boundary faces", count(c.faces)],
    ["exact tiles", `${count(c.exact_tets)} (${percent(c.exact_tets, c.tets)})`],
    c.bcc_tets > 0 && ["exact tiles of BCC", `${count(c.bcc_tets)} (${percent(c.bcc_tets, c.tets)})`],
    ["edge length", `${number(c.edge_min)} to ${number(c.edge_max)}, mean ${number(c.edge_mean)}`],
    c.size !== null && ["size asked for", number(c.size)], ["volume", number(c.volume, 9)],
    c.domain_volume !== null && ["volume of the surface", `${number(c.domain_volume, 9)} (mesh ${(100 * (c.volume / c.domain_volume - 1)).toFixed(3)} %)`],
    ["area of the boundary", number(c.area, 7)]]);
}

function quality(c) {
  const s = c.statistics;
  return section("Quality", [["smallest dihedral angle", `${degrees(s.min_dihedral.min)}, mean ${degrees(s.min_dihedral.mean)}`],
    ["largest dihedral angle", `${degrees(s.max_dihedral.max)}, mean ${degrees(s.max_dihedral.mean)}`],
    ["all angles surely within", `${degrees(c.attained[0])} to ${degrees(c.attained[1])}`],
    c.has_promise && ["promised", `${degrees(c.promised[0])} to ${degrees(c.promised[1])}: ${c.promise_holds ? "holds" : "does not hold everywhere"}`, good(c.promise_holds)],
    ["radius ratio", `least ${s.radius_ratio.min.toFixed(3)}, mean ${s.radius_ratio.mean.toFixed(3)}`],
    ["radius-edge ratio", `largest ${s.radius_edge.max.toFixed(3)}, mean ${s.radius_edge.mean.toFixed(3)}`],
    ["volume-length ratio", `least ${s.volume_length.min.toFixed(3)}, mean ${s.volume_length.mean.toFixed(3)}`]]);
}

function distance(c) {
  if (!c.distance) return null;
  const way = (key, at_most) => {
    const max = c.distance[`${key}_max`], bound = at_most === null ? "" : `, surely below ${number(at_most)}`;
    return `largest ${number(max)} (${(max / c.edge_mean).toFixed(3)} edges)${bound}, mean ${number(c.distance[`${key}_mean`])}`;
  };
  return section("Distance", [["mesh to surface", way("to_surface", c.to_surface_at_most)],
    ["surface to mesh", way("from_surface", c.from_surface_at_most)]]);
}

function features(c) {
  const f = c.features;
  if (!f) return null;
  return section("Sharp edges", [["creases", count(f.creases)], ["of their length kept", `${(100 * f.kept_share).toFixed(2)} %`],
    ["corners kept", `${count(f.corners_kept)} of ${count(f.corners - f.short_corners)}`]]);
}

function exceptions(c) {
  const texts = new Map(c.places.map((p) => [p.kind, p.text])), rows = Object.entries(c.exceptions).filter(([, n]) => n > 0);
  if (rows.length === 0) return section("Exceptions", [["none", "", "good"]]);
  return section("Exceptions", rows.map(([key, n]) => [texts.get(key) ?? key.replaceAll("_", " "), count(n), "warn"]));
}

export function certificateTable(c) {
  const hash = make("p", { className: "note hash", textContent: `sha256 ${c.sha256}` });
  const table = make("table", { className: "certificate" }, ...[validity(c), counts(c), quality(c), distance(c), features(c), exceptions(c)].filter(Boolean));
  return [table, hash];
}
