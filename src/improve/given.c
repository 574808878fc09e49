/* Patches grow from the largest faces over edges to what is in the same plane; then each vertex counts the creases that end at
 * it. Everything is decided from the mesh alone, in a fixed order.
 *
 * Within a tolerance: all faces of a patch are within half of it of the patch's plane, in which its inner vertices move; its
 * border stays. So no face that comes to the patch is further from one of the old ones than the tolerance. Borders count as
 * straight only where they are, to rounding: there nothing bounds how much several such steps would add up to. */
#include "improve/given.h"

#include <stdlib.h>
#include <string.h>

#include "base/sort.h"
#include "mesh/face_match.h"

/* Provisional patches: of the boundary's faces; and, less the tet beyond, of those between regions. */
enum { OUTER = -2, BORDER = -3 };

/* A face of the boundary, or of the border between two regions (once, from the side of the lower slot). */
typedef struct given_face {
  int32_t corner[3];
  int32_t tag, patch;
  int32_t region[2]; /* on both sides, ascending; outside: INT32_MIN */
  int32_t tet[2];    /* on both sides, ascending; outside: -1, and it comes second */
} given_face;

typedef struct given_edge {
  int32_t low, high;
  uint32_t face;
} given_edge;

/* What creases a vertex has seen. */
typedef struct meeting {
  int32_t creases, other[2]; /* their further ends */
  int32_t patch[2];          /* on both sides of the first, ascending */
  bool forked;               /* they are not the sides of one crease */
} meeting;

/* Of the diagonal of the mesh's box: what the rounding of points that other programs put in a plane comes to, and more. */
static const double rounding_share = 1e-10;

typedef struct work {
  laves_context *context;
  const laves_mesh *mesh;
  laves__given *given;
  laves__layer *layer;
  given_face *face;
  size_t face_count, face_capacity;
  given_edge *edge;
  size_t edge_count;
  meeting *meeting;
  double flatness;    /* how far from its plane a patch may be, units of the layer */
  double rounding;    /* the same of straight lines, whatever is tolerated */
  laves__vec3 *plane; /* [patch_count] normals */
} work;

/* ---- which faces are given ---- */

static void mark_group(void *user, uint32_t low, const laves__face_use *uses, size_t count, int worker) {
  (void)low;
  (void)worker;
  laves__layer *layer = ((work *)user)->layer;
  if (count == 1) layer->patch[uses->slot / 4][uses->slot % 4] = OUTER;
  if (count != 2 || !layer->region || layer->region[uses[0].slot / 4] == layer->region[uses[1].slot / 4]) return;
  for (int i = 0; i < 2; i++) layer->patch[uses[i].slot / 4][uses[i].slot % 4] = BORDER - (int32_t)(uses[1 - i].slot / 4);
}

static int32_t region_of(const laves__layer *layer, int32_t tet) { return layer->region ? layer->region[tet] : 1; }

static bool add_face(work *w, size_t t, int k, int32_t tag) {
  if (!laves__grow(w->context, &w->face, &w->face_capacity, w->face_count + 1, sizeof *w->face)) return false;
  const laves__layer *layer = w->layer;
  given_face *f = &w->face[w->face_count++];
  const int32_t beyond = layer->patch[t][k] == OUTER ? -1 : BORDER - layer->patch[t][k];
  const int32_t near = region_of(layer, (int32_t)t), far = beyond < 0 ? INT32_MIN : region_of(layer, beyond);
  *f = (given_face){.tag = tag,
                    .patch = LAVES__NO_PATCH,
                    .tet = {(int32_t)t, beyond},
                    .region = {near < far ? near : far, near < far ? far : near}};
  for (int i = 0; i < 3; i++) f->corner[i] = layer->tet[t][laves__tet_face[k][i]];
  return true;
}

/* Faces in the order of their lower tets, in which the mesh has those of its boundary, too. */
static bool list_faces(work *w) {
  const laves__layer *layer = w->layer;
  size_t outer = 0;
  for (size_t t = 0; t < layer->tet_count; t++)
    for (int k = 0; k < 4; k++) {
      const int32_t patch = layer->patch[t][k];
      if (patch == LAVES__NO_PATCH || (patch <= BORDER && (size_t)(BORDER - patch) < t)) continue;
      const int32_t tag = patch == OUTER && w->mesh->face_tags ? w->mesh->face_tags[outer] : 1;
      outer += patch == OUTER;
      if (!add_face(w, t, k, tag)) return false;
    }
  return true;
}

/* ---- patches ---- */

static int by_vertices(const void *a, const void *b) {
  const given_edge *x = a, *y = b;
  if (x->low != y->low) return x->low < y->low ? -1 : 1;
  if (x->high != y->high) return x->high < y->high ? -1 : 1;
  return x->face < y->face ? -1 : x->face > y->face;
}

static bool list_edges(work *w) {
  w->edge_count = 3 * w->face_count;
  w->edge = laves__alloc(w->context, w->edge_count, sizeof *w->edge);
  if (!w->edge) return false;
  for (size_t f = 0; f < w->face_count; f++)
    for (int i = 0; i < 3; i++) {
      const int32_t a = w->face[f].corner[i], b = w->face[f].corner[(i + 1) % 3];
      w->edge[3 * f + (size_t)i] = (given_edge){a < b ? a : b, a < b ? b : a, (uint32_t)f};
    }
  if (w->edge_count) qsort(w->edge, w->edge_count, sizeof *w->edge, by_vertices);
  return true;
}

/* One past the last entry of the edge that begins at `first`. */
static size_t edge_end(const work *w, size_t first) {
  size_t end = first + 1;
  while (end < w->edge_count && w->edge[end].low == w->edge[first].low && w->edge[end].high == w->edge[first].high) end++;
  return end;
}

static laves__vec3 face_normal(const work *w, const given_face *f) {
  const laves__vec3 *p = w->layer->position;
  return v3_unit(v3_cross(v3_sub(p[f->corner[1]], p[f->corner[0]]), v3_sub(p[f->corner[2]], p[f->corner[0]])));
}

typedef struct growth {
  uint64_t *order, *scratch; /* faces, the largest first */
  uint32_t (*across)[3];     /* the face that a patch may go on to, at each edge of a face; UINT32_MAX: none */
  uint32_t *front;
} growth;

static bool corners_in_plane(const work *w, const given_face *f, laves__vec3 normal, laves__vec3 through) {
  for (int i = 0; i < 3; i++)
    if (!(fabs(v3_dot(normal, v3_sub(w->layer->position[f->corner[i]], through))) <= w->flatness)) return false;
  return true;
}

/* Whether two neighbours have the same on both sides, and one tag. */
static bool same_kind(const given_face *f, const given_face *g) {
  return f->tag == g->tag && f->region[0] == g->region[0] && f->region[1] == g->region[1];
}

static void find_across(const work *w, growth *g) {
  for (size_t f = 0; f < w->face_count; f++) g->across[f][0] = g->across[f][1] = g->across[f][2] = UINT32_MAX;
  for (size_t first = 0, end; first < w->edge_count; first = end) {
    end = edge_end(w, first);
    if (end - first != 2) continue;
    for (size_t i = 0; i < 2; i++) {
      const uint32_t f = w->edge[first + i].face, beyond = w->edge[first + 1 - i].face;
      const int32_t *c = w->face[f].corner;
      for (int k = 0; k < 3; k++)
        if (c[k] != w->edge[first].low && c[k] != w->edge[first].high) g->across[f][k] = beyond;
    }
  }
}

/* Doubled areas, falling; equal ones by index. */
static void order_faces(const work *w, growth *g) {
  const laves__vec3 *p = w->layer->position;
  for (size_t f = 0; f < w->face_count; f++) {
    const int32_t *c = w->face[f].corner;
    const double area = v3_norm(v3_cross(v3_sub(p[c[1]], p[c[0]]), v3_sub(p[c[2]], p[c[0]])));
    g->order[f] = laves__sort_key(1 / (area + 1e-30), (uint32_t)f);
  }
  laves__sort_u64(g->order, g->scratch, w->face_count);
}

/* All that can be reached from a face in its plane. */
static void grow_patch(work *w, growth *g, uint32_t seed, int32_t patch) {
  static const double most_turned = 0.5; /* cosine: folds are no plane */
  const laves__vec3 normal = face_normal(w, &w->face[seed]), through = w->layer->position[w->face[seed].corner[0]];
  w->face[seed].patch = patch;
  w->plane[patch] = normal;
  size_t count = 0;
  g->front[count++] = seed;
  while (count > 0) {
    const uint32_t f = g->front[--count];
    for (int k = 0; k < 3; k++) {
      const uint32_t next = g->across[f][k];
      if (next == UINT32_MAX) continue;
      given_face *n = &w->face[next];
      if (n->patch != LAVES__NO_PATCH || !same_kind(&w->face[f], n) || !corners_in_plane(w, n, normal, through)) continue;
      if (!(v3_dot(face_normal(w, n), normal) > most_turned)) continue;
      n->patch = patch;
      g->front[count++] = next;
    }
  }
}

static bool allocate_growth(const work *w, growth *g) {
  const size_t n = w->face_count;
  *g = (growth){.order = laves__alloc(w->context, n, sizeof *g->order),
                .scratch = laves__alloc(w->context, n, sizeof *g->scratch),
                .across = laves__alloc(w->context, n, sizeof *g->across),
                .front = laves__alloc(w->context, n, sizeof *g->front)};
  return g->order && g->scratch && g->across && g->front;
}

/* `fixed`: each face is a patch by itself. */
static bool find_patches(work *w, bool fixed) {
  growth g;
  laves__given *given = w->given;
  const size_t n = w->face_count;
  w->plane = laves__alloc(w->context, n, sizeof *w->plane);
  const bool memory = allocate_growth(w, &g) && w->plane;
  if (memory) {
    find_across(w, &g);
    order_faces(w, &g);
    for (size_t f = 0; f < n && fixed; f++) g.across[f][0] = g.across[f][1] = g.across[f][2] = UINT32_MAX;
    for (size_t i = 0; i < n; i++) {
      const uint32_t seed = (uint32_t)g.order[i];
      if (w->face[seed].patch == LAVES__NO_PATCH) grow_patch(w, &g, seed, (int32_t)given->patch_count++);
    }
  }
  laves__free(w->context, g.order, n, sizeof *g.order);
  laves__free(w->context, g.scratch, n, sizeof *g.scratch);
  laves__free(w->context, g.across, n, sizeof *g.across);
  laves__free(w->context, g.front, n, sizeof *g.front);
  if (!memory) return false;
  given->patch_tag = laves__alloc(w->context, given->patch_count, sizeof *given->patch_tag);
  if (!given->patch_tag) return false;
  for (size_t f = 0; f < n; f++) given->patch_tag[w->face[f].patch] = w->face[f].tag;
  return true;
}

static void note_patches(work *w) {
  for (size_t i = 0; i < w->face_count; i++) {
    const given_face *f = &w->face[i];
    for (int side = 0; side < 2 && f->tet[side] >= 0; side++)
      for (int k = 0; k < 4; k++) {
        const int32_t v = w->layer->tet[f->tet[side]][k];
        if (v != f->corner[0] && v != f->corner[1] && v != f->corner[2]) w->layer->patch[f->tet[side]][k] = f->patch;
      }
  }
}

/* ---- what vertices are held to ---- */

static void meet_crease(meeting *m, int32_t other, int32_t low, int32_t high, bool plain) {
  if (m->creases == 0) {
    m->patch[0] = low;
    m->patch[1] = high;
  }
  m->forked |= !plain || m->creases == 2 || m->patch[0] != low || m->patch[1] != high;
  if (m->creases < 2) m->other[m->creases] = other;
  m->creases++;
}

/* The angle between two faces through the inside, where one region is on one side of both; degrees. */
static double angle_between(const work *w, const given_face *f, const given_face *g) {
  static const double degrees = 180 / 3.14159265358979323846;
  const laves__vec3 nf = face_normal(w, f), ng = face_normal(w, g);
  double above = 0; /* of g's corner beyond the edge, over f */
  for (int i = 0; i < 3; i++) {
    const double h = v3_dot(nf, v3_sub(w->layer->position[g->corner[i]], w->layer->position[f->corner[0]]));
    if (fabs(h) > fabs(above)) above = h;
  }
  const double turn = atan2(v3_norm(v3_cross(nf, ng)), v3_dot(nf, ng)) * degrees;
  return above > 0 ? 180 + turn : 180 - turn;
}

static void find_creases(work *w) {
  w->given->sharpest = 180;
  for (size_t first = 0, end; first < w->edge_count; first = end) {
    end = edge_end(w, first);
    const given_face *f = &w->face[w->edge[first].face], *g = &w->face[w->edge[end - 1].face];
    if (end - first == 2 && f->patch == g->patch) continue;
    const int32_t low = f->patch < g->patch ? f->patch : g->patch, high = f->patch < g->patch ? g->patch : f->patch;
    const bool plain = end - first == 2;
    meet_crease(&w->meeting[w->edge[first].low], w->edge[first].high, low, high, plain);
    meet_crease(&w->meeting[w->edge[first].high], w->edge[first].low, low, high, plain);
    if (plain && f->tet[1] < 0 && g->tet[1] < 0) w->given->sharpest = fmin(w->given->sharpest, angle_between(w, f, g));
  }
}

/* Whether a vertex lies on the way between the further ends of its two creases. */
static bool is_straight(const work *w, int32_t v, laves__vec3 *tangent) {
  const laves__vec3 *p = w->layer->position;
  const laves__vec3 a = p[w->meeting[v].other[0]], b = p[w->meeting[v].other[1]];
  *tangent = v3_unit(v3_sub(b, a));
  const laves__vec3 from = v3_sub(p[v], a), aside = v3_mad(from, *tangent, -v3_dot(from, *tangent));
  return v3_norm(aside) <= w->rounding && v3_dot(v3_sub(p[v], a), v3_sub(b, p[v])) > 0;
}

/* First what creases say; then faces have a last word, for a vertex may have a fan of faces without a crease beside. */
static void hold_vertices(work *w, bool fixed) {
  laves__layer *layer = w->layer;
  for (size_t i = 0; i < w->face_count; i++)
    for (int c = 0; c < 3; c++) {
      const int32_t v = w->face[i].corner[c], patch = w->face[i].patch;
      laves__hold *hold = &layer->hold[v];
      meeting *m = &w->meeting[v];
      if (layer->depth[v] != 0) { /* its first face */
        layer->depth[v] = 0;
        hold->kind = LAVES__HOLD_CORNER;
        if (fixed || m->forked) continue;
        if (m->creases == 0) {
          m->patch[0] = m->patch[1] = patch;
          hold->kind = LAVES__HOLD_PATCH;
          layer->normal[v] = w->plane[patch];
        } else if (m->creases == 2 && is_straight(w, v, &layer->normal[v])) {
          hold->kind = LAVES__HOLD_CREASE;
        }
      }
      if (patch != m->patch[0] && patch != m->patch[1]) hold->kind = LAVES__HOLD_CORNER;
    }
  for (size_t v = 0; v < layer->vertex_count; v++) {
    if (layer->depth[v] != 0) continue;
    const uint8_t kind = layer->hold[v].kind;
    w->given->flat_vertices += kind == LAVES__HOLD_PATCH;
    w->given->crease_vertices += kind == LAVES__HOLD_CREASE;
    w->given->held_vertices += kind == LAVES__HOLD_CORNER;
  }
}

/* ---- the layer ---- */

/* Sizes: the mean edge of the mesh is the unit, the mean length of its edges, once for each tet, the local size of a vertex. */
static void find_sizes(work *w) {
  laves__layer *layer = w->layer;
  const laves__vec3 *p = w->mesh->points;
  double sum = 0;
  for (size_t t = 0; t < layer->tet_count; t++)
    for (int e = 0; e < 6; e++)
      sum += v3_distance(p[layer->tet[t][laves__tet_edge[e][0]]], p[layer->tet[t][laves__tet_edge[e][1]]]);
  w->given->size = sum / (6 * (double)layer->tet_count);
}

static bool find_scales(const work *w) {
  laves__layer *layer = w->layer;
  int32_t *count = laves__alloc_zeroed(w->context, layer->vertex_count, sizeof *count);
  double *sum = laves__alloc_zeroed(w->context, layer->vertex_count, sizeof *sum);
  for (size_t t = 0; count && sum && t < layer->tet_count; t++)
    for (int e = 0; e < 6; e++) {
      const int32_t a = layer->tet[t][laves__tet_edge[e][0]], b = layer->tet[t][laves__tet_edge[e][1]];
      const double length = v3_distance(layer->position[a], layer->position[b]);
      sum[a] += length;
      sum[b] += length;
      count[a]++;
      count[b]++;
    }
  for (size_t v = 0; count && sum && v < layer->vertex_count; v++) layer->scale[v] = count[v] ? (float)(sum[v] / count[v]) : 1;
  const bool memory = count && sum;
  laves__free(w->context, count, layer->vertex_count, sizeof *count);
  laves__free(w->context, sum, layer->vertex_count, sizeof *sum);
  return memory;
}

static laves__vec3 layer_position(const laves__given *given, size_t v) {
  return v3_scale(v3_sub(given->mesh->points[v], given->centre), 1 / given->size);
}

static laves__box3 box_of(const laves_mesh *mesh) {
  laves__box3 box = box3_empty();
  for (size_t v = 0; v < mesh->vertex_count; v++) box = box3_add(box, mesh->points[v]);
  return box;
}

static laves_result fill_layer(work *w, bool fixed, laves_error *error) {
  const laves_mesh *mesh = w->mesh;
  laves__layer *layer = w->layer;
  laves_result result = laves__layer_create(w->context, mesh->vertex_count, mesh->tet_count, layer, error);
  if (result != LAVES_OK) return result;
  layer->scale = laves__alloc(w->context, mesh->vertex_count, sizeof *layer->scale);
  layer->hold = laves__alloc_zeroed(w->context, mesh->vertex_count, sizeof *layer->hold);
  layer->patch = laves__alloc(w->context, mesh->tet_count, sizeof *layer->patch);
  if (mesh->regions) layer->region = laves__alloc(w->context, mesh->tet_count, sizeof *layer->region);
  if (!layer->scale || !layer->hold || !layer->patch || (mesh->regions && !layer->region))
    return laves__fail_memory(w->context, error);
  layer->fixed_boundary = fixed;
  memcpy(layer->tet, mesh->tets, mesh->tet_count * sizeof *layer->tet);
  if (mesh->regions) memcpy(layer->region, mesh->regions, mesh->tet_count * sizeof *layer->region);
  for (size_t t = 0; t < mesh->tet_count; t++) {
    layer->quality[t] = 0;
    for (int k = 0; k < 4; k++) layer->patch[t][k] = LAVES__NO_PATCH;
  }
  w->given->centre = box3_centre(box_of(mesh));
  find_sizes(w);
  for (size_t v = 0; v < mesh->vertex_count; v++) {
    layer->position[v] = layer_position(w->given, v);
    layer->hint[v] = UINT32_MAX;
    layer->depth[v] = 1;
    layer->origin[v] = (uint32_t)v;
  }
  return find_scales(w) ? LAVES_OK : laves__fail_memory(w->context, error);
}

static bool find_holds(work *w, bool fixed) {
  if (!list_faces(w) || !list_edges(w) || !find_patches(w, fixed)) return false;
  note_patches(w);
  w->meeting = laves__alloc_zeroed(w->context, w->layer->vertex_count, sizeof *w->meeting);
  if (!w->meeting) return false;
  find_creases(w);
  hold_vertices(w, fixed);
  return true;
}

laves_result laves__given_layer(laves_context *context, const laves_mesh *mesh, double tolerance, bool fixed, laves__given *given,
                                laves__layer *layer, laves_error *error) {
  work w = {.context = context, .mesh = mesh, .given = given, .layer = layer};
  memset(layer, 0, sizeof *layer);
  *given = (laves__given){.context = context, .mesh = mesh};
  laves_result result = fill_layer(&w, fixed, error);
  w.rounding = rounding_share * box3_diagonal(box_of(mesh)) / given->size;
  w.flatness = fmax(0.5 * tolerance / given->size, w.rounding);
  if (result == LAVES_OK)
    result = laves__match_faces(context, "boundary", (const int32_t(*)[4])layer->tet, layer->tet_count, layer->vertex_count,
                                mark_group, &w, error);
  if (result == LAVES_OK && !find_holds(&w, fixed)) result = laves__fail_memory(context, error);
  if (result == LAVES_OK) result = laves__layer_link(layer, error);
  if (result == LAVES_OK && laves__is_cancelled(context)) result = laves__fail_cancelled(error);
  laves__free(context, w.face, w.face_capacity, sizeof *w.face);
  laves__free(context, w.edge, w.edge_count, sizeof *w.edge);
  laves__free(context, w.plane, w.face_count, sizeof *w.plane);
  laves__free(context, w.meeting, layer->vertex_count, sizeof *w.meeting);
  return result;
}

void laves__given_free(laves__given *given) {
  if (given->context) laves__free(given->context, given->patch_tag, given->patch_count, sizeof *given->patch_tag);
  memset(given, 0, sizeof *given);
}

/* ---- and back ---- */

typedef struct arrays {
  laves__vec3 *point;
  int32_t (*tet)[4], *region, *number, *old; /* number: of a layer's vertex, or -1; old: the layer's tet of a tet */
  size_t vertex_count, tet_count;
} arrays;

static void number_vertices(const laves__given *given, const laves__layer *layer, arrays *a) {
  for (size_t v = 0; v < layer->vertex_count; v++) a->number[v] = -1;
  for (size_t t = 0; t < layer->tet_count; t++)
    for (int k = 0; k < 4 && layer->tet[t][0] >= 0; k++) a->number[layer->tet[t][k]] = 0;
  for (size_t v = 0; v < layer->vertex_count; v++) {
    if (a->number[v] < 0) continue;
    const laves__vec3 p = layer->position[v];
    laves__vec3 *out = &a->point[a->vertex_count];
    *out = v3_mad(given->centre, p, given->size);
    if (layer->origin[v] != LAVES__NO_ORIGIN) {
      const laves__vec3 before = layer_position(given, layer->origin[v]);
      if (before.x == p.x && before.y == p.y && before.z == p.z) *out = given->mesh->points[layer->origin[v]];
    }
    a->number[v] = (int32_t)a->vertex_count++;
  }
}

static void fill_tets(const laves__layer *layer, arrays *a) {
  for (size_t t = 0; t < layer->tet_count; t++) {
    if (layer->tet[t][0] < 0) continue;
    for (int k = 0; k < 4; k++) a->tet[a->tet_count][k] = a->number[layer->tet[t][k]];
    if (a->region) a->region[a->tet_count] = layer->region[t];
    a->old[a->tet_count++] = (int32_t)t;
  }
}

/* The boundary's faces come in the order of their slots. */
static laves_result find_tags(const laves__given *given, const laves__layer *layer, const arrays *a, laves_mesh *mesh,
                              laves_error *error) {
  laves_context *context = given->context;
  uint64_t *slots;
  size_t count;
  const laves_result result = laves__boundary_slots(context, "boundary", (const int32_t(*)[4])mesh->tets, mesh->tet_count,
                                                    mesh->vertex_count, &slots, &count, error);
  if (result != LAVES_OK) return result;
  mesh->face_tags = laves__alloc(context, mesh->face_count, sizeof *mesh->face_tags);
  LAVES_ASSERT(count == mesh->face_count);
  for (size_t i = 0; mesh->face_tags && i < count; i++)
    mesh->face_tags[i] = given->patch_tag[layer->patch[a->old[slots[i] / 4]][slots[i] % 4]];
  laves__free(context, slots, count, sizeof *slots);
  return mesh->face_tags ? LAVES_OK : laves__fail_memory(context, error);
}

static laves_result make_mesh(const laves__given *given, const laves__layer *layer, arrays *a, laves_mesh **mesh,
                              laves_error *error) {
  const laves_mesh *before = given->mesh;
  number_vertices(given, layer, a);
  fill_tets(layer, a);
  laves_result result =
      laves_mesh_from_arrays(given->context, &a->point->x, a->vertex_count, *a->tet, a->tet_count, a->region, mesh, error);
  if (result == LAVES_OK && before->face_tags) result = find_tags(given, layer, a, *mesh, error);
  for (size_t i = 0; result == LAVES_OK && i < before->group_count; i++) {
    const laves__group *group = &before->groups[i];
    if (!laves__mesh_add_group(*mesh, group->dimension, group->tag, group->name))
      result = laves__fail_memory(given->context, error);
  }
  if (result == LAVES_OK) return result;
  laves_mesh_free(*mesh);
  *mesh = NULL;
  return result;
}

laves_result laves__given_mesh(const laves__given *given, const laves__layer *layer, laves_mesh **mesh, laves_error *error) {
  laves_context *context = given->context;
  const size_t vertices = layer->vertex_count, tets = layer->tet_count;
  arrays a = {.point = laves__alloc(context, vertices, sizeof *a.point),
              .tet = laves__alloc(context, tets, sizeof *a.tet),
              .number = laves__alloc(context, vertices, sizeof *a.number),
              .old = laves__alloc(context, tets, sizeof *a.old)};
  *mesh = NULL;
  if (layer->region) a.region = laves__alloc(context, tets, sizeof *a.region);
  laves_result result = LAVES_OK;
  if (a.point && a.tet && a.number && a.old && (a.region || !layer->region))
    result = make_mesh(given, layer, &a, mesh, error);
  else
    result = laves__fail_memory(context, error);
  laves__free(context, a.point, vertices, sizeof *a.point);
  laves__free(context, a.tet, tets, sizeof *a.tet);
  laves__free(context, a.number, vertices, sizeof *a.number);
  laves__free(context, a.old, tets, sizeof *a.old);
  laves__free(context, a.region, a.region ? tets : 0, sizeof *a.region);
  return result;
}
