/* Which part of the layer is made anew, and how both parts become one layer; graft.h tells the idea. */
#include "stuff/graft.h"

#include <stdlib.h>
#include <string.h>

#include "base/predicates.h"
#include "mesh/mesh.h"

enum {
  NEAR_RINGS = 3, /* cells around a change that are near: with two, a site's depth beyond them is what it was */
  WIDE_RINGS = 6, /* cells within which the near part may grow at first, where it is cheap; then within the next, then anywhere */
  WIDER_RINGS = 20,
  FAR = UINT8_MAX, /* further than that */
  TRIES = 100,     /* how often it grows */
  HOLD_TRIES = 20, /* how often for the sake of what holds vertices: where features crowd, that may not end */
};

/* ---- what the lattice was ---- */

bool laves__known_take(const laves__lattice *lattice, laves__known_lattice *known) {
  laves__known_free(known);
  *known = (laves__known_lattice){.context = lattice->context, .count = lattice->record_count};
  known->record = laves__alloc(lattice->context, known->count, sizeof *known->record);
  for (size_t i = 0; known->record && i < known->count; i++) {
    const laves__record *r = &lattice->record[i];
    known->record[i].zone = r->zone;
    memcpy(known->record[i].label, r->label, sizeof r->label);
    memcpy(known->record[i].solid, r->solid, sizeof r->solid);
  }
  return known->record != NULL;
}

void laves__known_free(laves__known_lattice *known) {
  if (known->context) laves__free(known->context, known->record, known->count, sizeof *known->record);
  *known = (laves__known_lattice){0};
}

void laves__known_forget(laves__known_lattice *known, size_t record) {
  if (record < known->count) known->record[record].zone = UINT32_MAX; /* no zone has so many sites */
}

/* Records that were added since were wholly inside. */
static bool has_changed(const laves__known_lattice *known, const laves__record *r, size_t i) {
  if (i < known->count) {
    const laves__known_record *k = &known->record[i];
    return k->zone != r->zone || memcmp(k->label, r->label, sizeof r->label) != 0 ||
           memcmp(k->solid, r->solid, sizeof r->solid) != 0;
  }
  for (int site = 0; site < LAVES__C15_SITES; site++)
    if (r->label[site] != LAVES__LABEL_IN) return true;
  return r->zone != 0;
}

/* ---- near and far ---- */

/* One of the two layers. */
typedef struct side {
  const laves__layer *layer;
  int32_t *twin; /* [vertex_count] the vertex of the other side at the same site, or -1 */
  uint8_t *ring; /* [vertex_count] cells from the next change, or FAR */
  bool *near;    /* [vertex_count] */
  int32_t *tet;  /* [count] those with a vertex that may become near */
  size_t count;
} side;

/* A face with three far corners of a tet that has a near one: its corners as numbers that both sides share, ascending. */
typedef struct face {
  uint32_t key[3];
} face;

typedef struct graft {
  laves_context *context;
  const laves__known_lattice *known;
  laves__lattice *lattice;
  side old, made;
  uint8_t *ring; /* [record_count] */
  int rings;     /* a vertex further than this may not become near */
  int tries;     /* how often the near part has grown */
  bool grown;    /* a vertex became near */
  bool too_far;  /* one should that may not */
  face *face[2]; /* of either side, those that border on what is not taken */
  size_t face_count[2], face_capacity[2];
} graft;

static void free_side(laves_context *context, side *s) {
  if (!s->layer) return;
  const size_t vertices = s->layer->vertex_count;
  laves__free(context, s->twin, vertices, sizeof *s->twin);
  laves__free(context, s->ring, vertices, sizeof *s->ring);
  laves__free(context, s->near, vertices, sizeof *s->near);
  laves__free(context, s->tet, s->count, sizeof *s->tet);
  *s = (side){0};
}

static void free_graft(graft *g) {
  free_side(g->context, &g->old);
  free_side(g->context, &g->made);
  laves__free(g->context, g->ring, g->lattice->record_count, sizeof *g->ring);
  for (int i = 0; i < 2; i++) laves__free(g->context, g->face[i], g->face_capacity[i], sizeof *g->face[i]);
}

/* How many cells each record is from the next change. */
static bool find_rings(graft *g) {
  const laves__lattice *lattice = g->lattice;
  const size_t records = lattice->record_count;
  int32_t *list = laves__alloc(g->context, records, sizeof *list);
  g->ring = laves__alloc(g->context, records, sizeof *g->ring);
  const bool memory = list && g->ring;
  size_t count = 0;
  for (size_t i = 0; memory && i < records; i++) {
    const bool changed = has_changed(g->known, &lattice->record[i], i);
    g->ring[i] = changed ? 0 : FAR;
    if (changed) list[count++] = (int32_t)i;
  }
  for (size_t head = 0; head < count && g->ring[list[head]] < WIDER_RINGS; head++) {
    const laves__record *r = &lattice->record[list[head]];
    for (int k = 0; k < 27; k++) {
      if (r->around[k] < 0 || g->ring[r->around[k]] != FAR) continue;
      g->ring[r->around[k]] = g->ring[list[head]] + 1;
      list[count++] = r->around[k];
    }
  }
  laves__free(g->context, list, records, sizeof *list);
  return memory;
}

static bool lives(const laves__layer *layer, int32_t v) {
  return layer->depth[v] > LAVES__DEPTH_MOVES || layer->star[v].count > 0;
}

/* The record that a vertex belongs to: that of its site, or of the cell in which it stands. Negative: none. */
static int32_t record_of(const laves__lattice *lattice, const laves__layer *layer, size_t v) {
  const laves__vec3 p = v3_scale(layer->position[v], 1 / LAVES__CELL_SIDE);
  if (layer->origin[v] != LAVES__NO_ORIGIN) return (int32_t)(layer->origin[v] / LAVES__C15_SITES);
  return laves__lattice_cell(lattice, (int32_t)floor(p.x), (int32_t)floor(p.y), (int32_t)floor(p.z));
}

static bool start_side(const graft *g, side *s) {
  const laves__layer *layer = s->layer;
  const size_t vertices = layer->vertex_count;
  s->twin = laves__alloc(g->context, vertices, sizeof *s->twin);
  s->ring = laves__alloc(g->context, vertices, sizeof *s->ring);
  s->near = laves__alloc(g->context, vertices, sizeof *s->near);
  if (!s->twin || !s->ring || !s->near) return false;
  for (size_t v = 0; v < vertices; v++) {
    const int32_t record = record_of(g->lattice, layer, v);
    s->ring[v] = record >= 0 ? g->ring[record] : FAR;
    s->near[v] = s->ring[v] <= NEAR_RINGS;
    s->twin[v] = -1;
  }
  return true;
}

/* Vertices of one site know of one another. */
static bool find_twins(graft *g) {
  const size_t sites = g->lattice->record_count * LAVES__C15_SITES;
  const laves__layer *old = g->old.layer, *made = g->made.layer;
  int32_t *at = laves__alloc(g->context, sites, sizeof *at);
  if (!at) return false;
  memset(at, 0xff, sites * sizeof *at);
  for (size_t v = 0; v < old->vertex_count; v++)
    if (old->origin[v] != LAVES__NO_ORIGIN) at[old->origin[v]] = (int32_t)v;
  for (size_t v = 0; v < made->vertex_count; v++) {
    if (made->origin[v] == LAVES__NO_ORIGIN || at[made->origin[v]] < 0) continue;
    g->made.twin[v] = at[made->origin[v]];
    g->old.twin[g->made.twin[v]] = (int32_t)v;
  }
  laves__free(g->context, at, sites, sizeof *at);
  return true;
}

static bool may_become_near(const graft *g, const side *s, int32_t t) {
  const int32_t *tet = s->layer->tet[t];
  bool may = tet[0] >= 0 && g->rings == FAR;
  for (int k = 0; k < 4 && tet[0] >= 0 && !may; k++) may = s->ring[tet[k]] <= g->rings;
  return may;
}

/* Lists the tets of a side that matter. */
static bool list_tets(const graft *g, side *s) {
  size_t count = 0;
  laves__free(g->context, s->tet, s->count, sizeof *s->tet);
  for (size_t t = 0; t < s->layer->tet_count; t++) count += may_become_near(g, s, (int32_t)t);
  s->tet = laves__alloc(g->context, count, sizeof *s->tet);
  s->count = count;
  if (!s->tet) return false;
  count = 0;
  for (size_t t = 0; t < s->layer->tet_count; t++)
    if (may_become_near(g, s, (int32_t)t)) s->tet[count++] = (int32_t)t;
  return true;
}

/* A vertex becomes near, at both sides. */
static void draw_near(graft *g, side *s, int32_t v) {
  side *other = s == &g->old ? &g->made : &g->old;
  if (s->near[v]) return;
  if (s->ring[v] > g->rings) {
    g->too_far = true;
    return;
  }
  g->grown = s->near[v] = true;
  if (s->twin[v] >= 0) other->near[s->twin[v]] = true;
}

static int count_near(const side *s, int32_t t) {
  int count = 0;
  for (int k = 0; k < 4; k++) count += s->near[s->layer->tet[t][k]];
  return count;
}

/* ---- the border ---- */

static uint32_t key_of(const graft *g, const side *s, int32_t v) {
  if (s == &g->old) return (uint32_t)v;
  return s->twin[v] >= 0 ? (uint32_t)s->twin[v] : (uint32_t)g->old.layer->vertex_count + (uint32_t)v;
}

static face face_of(const graft *g, const side *s, int32_t t) {
  face f;
  int n = 0;
  for (int k = 0; k < 4; k++) {
    const int32_t v = s->layer->tet[t][k];
    if (s->near[v]) continue;
    const uint32_t key = key_of(g, s, v);
    int at = n++;
    for (; at > 0 && f.key[at - 1] > key; at--) f.key[at] = f.key[at - 1];
    f.key[at] = key;
  }
  return f;
}

static int by_key(const void *left, const void *right) {
  const face *a = left, *b = right;
  for (int k = 0; k < 3; k++)
    if (a->key[k] != b->key[k]) return a->key[k] < b->key[k] ? -1 : 1;
  return 0;
}

/* The faces between what is taken and what is not, and those of the layer's rim: no other tet with a near corner has them. */
static bool list_faces(graft *g, int which) {
  const side *s = which ? &g->made : &g->old;
  size_t count = 0, kept = 0;
  for (size_t i = 0; i < s->count; i++) {
    if (count_near(s, s->tet[i]) != 1) continue;
    if (!laves__grow(g->context, &g->face[which], &g->face_capacity[which], count + 1, sizeof *g->face[which])) return false;
    g->face[which][count++] = face_of(g, s, s->tet[i]);
  }
  face *f = g->face[which];
  if (count) qsort(f, count, sizeof *f, by_key);
  for (size_t i = 0; i < count; i++) {
    if (i + 1 < count && by_key(&f[i], &f[i + 1]) == 0)
      i++;
    else
      f[kept++] = f[i];
  }
  g->face_count[which] = kept;
  return true;
}

static void draw_face(graft *g, const face *f, int which) {
  const uint32_t olds = (uint32_t)g->old.layer->vertex_count;
  for (int k = 0; k < 3; k++) {
    const bool old = f->key[k] < olds;
    if (old && !which)
      draw_near(g, &g->old, (int32_t)f->key[k]);
    else
      draw_near(g, &g->made, old ? g->old.twin[f->key[k]] : (int32_t)(f->key[k] - olds));
  }
}

/* Corners of faces that only one side has become near. */
static void draw_differences(graft *g) {
  size_t i = 0, j = 0;
  while (i < g->face_count[0] || j < g->face_count[1]) {
    const int order = i == g->face_count[0] ? 1 : j == g->face_count[1] ? -1 : by_key(&g->face[0][i], &g->face[1][j]);
    if (order < 0) draw_face(g, &g->face[0][i], 0);
    if (order > 0) draw_face(g, &g->face[1][j], 1);
    i += order <= 0;
    j += order >= 0;
  }
}

/* ---- vertices on the border ---- */

/* Whether a vertex may be held by what the old layer says. What is held to nothing goes with all. */
static bool may_be_held(laves__hold made, laves__hold old) {
  return made.kind == LAVES__HOLD_SURFACE || (made.kind == old.kind && made.id == old.id);
}

/* Far vertices must be what they are in the lattice as it is now: so the layer's rim towards the interior is the lattice's. */
static void draw_misfits(graft *g) {
  const laves__layer *old = g->old.layer, *made = g->made.layer;
  for (size_t v = 0; v < made->vertex_count; v++)
    if (!g->made.near[v] && made->origin[v] != LAVES__NO_ORIGIN && g->made.twin[v] < 0) draw_near(g, &g->made, (int32_t)v);
  for (size_t v = 0; v < old->vertex_count; v++) {
    if (g->old.near[v] || old->origin[v] == LAVES__NO_ORIGIN) continue;
    if (g->old.twin[v] < 0 || old->depth[v] != made->depth[g->old.twin[v]]) draw_near(g, &g->old, (int32_t)v);
  }
}

/* Where a corner of a tet that is taken will stand. */
static laves__vec3 place_of(const graft *g, int32_t v) {
  return g->made.near[v] ? g->made.layer->position[v] : g->old.layer->position[g->made.twin[v]];
}

/* Far corners of the tets that are taken must live at the other side and be held by the same, or by nothing in what was made, and
 * the tets must be positive. */
static void draw_corners(graft *g) {
  const side *s = &g->made;
  for (size_t i = 0; i < s->count; i++) {
    const int32_t *tet = s->layer->tet[s->tet[i]];
    const int near = count_near(s, s->tet[i]);
    if (near == 0 || near == 4) continue;
    bool fits = true;
    for (int k = 0; k < 4; k++) {
      if (s->near[tet[k]]) continue;
      const int32_t v = s->twin[tet[k]];
      const bool same = v >= 0 && lives(g->old.layer, v) &&
                        (s->layer->depth[tet[k]] != 0 || g->tries >= HOLD_TRIES ||
                         may_be_held(laves__layer_hold(s->layer, tet[k]), laves__layer_hold(g->old.layer, v)));
      if (!same) draw_near(g, &g->made, tet[k]);
      fits &= same;
    }
    if (!fits) continue;
    const laves__vec3 p[4] = {place_of(g, tet[0]), place_of(g, tet[1]), place_of(g, tet[2]), place_of(g, tet[3])};
    for (int k = 0; k < 4 && laves__orient3d(p[0], p[1], p[2], p[3]) <= 0; k++) draw_near(g, &g->made, tet[k]);
  }
}

/* ---- links of vertices on the border ---- */

enum { LINK_MAX = 128 };

/* The triangles opposite a vertex, in shared numbers. */
typedef struct vertex_link {
  uint32_t corner[LINK_MAX][3];
  int count;
} vertex_link;

/* Adds those of one side's tets: of the old ones without a near corner, of the new ones with one. False: they are too many. */
static bool add_link(const graft *g, const side *s, int32_t v, vertex_link *l) {
  const laves__star *star = &s->layer->star[v];
  for (int i = 0; i < star->count; i++) {
    if ((count_near(s, star->tet[i]) > 0) != (s == &g->made)) continue;
    if (l->count == LINK_MAX) return false;
    const int32_t *tet = s->layer->tet[star->tet[i]];
    for (int k = 0, n = 0; k < 4; k++)
      if (tet[k] != v) l->corner[l->count][n++] = key_of(g, s, tet[k]);
    l->count++;
  }
  return true;
}

static bool has_corner(const uint32_t corner[3], uint32_t key) {
  return corner[0] == key || corner[1] == key || corner[2] == key;
}

/* How many other triangles share the edge opposite a corner; those that are connected are marked with the triangle's own mark. */
static int meet(const vertex_link *l, int t, int k, bool *reached, bool *more) {
  int others = 0;
  for (int i = 0; i < l->count; i++) {
    if (i == t || !has_corner(l->corner[i], l->corner[t][(k + 1) % 3]) || !has_corner(l->corner[i], l->corner[t][(k + 2) % 3]))
      continue;
    others++;
    *more |= reached[t] && !reached[i];
    reached[i] |= reached[t];
  }
  return others;
}

static int count_corners(const vertex_link *l) {
  int count = 0;
  for (int i = 0; i < l->count; i++)
    for (int k = 0; k < 3; k++) {
      bool known = false;
      for (int j = 0; j < i && !known; j++) known = has_corner(l->corner[j], l->corner[i][k]);
      count += !known;
    }
  return count;
}

/* Whether the link is a disc or a sphere: connected across edges, at most two triangles at each, and of their Euler number. */
static bool is_ball(const vertex_link *l) {
  bool reached[LINK_MAX] = {true};
  int twice = 0, once = 0;
  for (bool more = true; more;) {
    more = false;
    twice = once = 0;
    for (int t = 0; t < l->count; t++)
      for (int k = 0; k < 3; k++) {
        const int others = meet(l, t, k, reached, &more);
        if (others > 1) return false;
        twice += others == 1;
        once += others == 0;
      }
  }
  for (int t = 0; t < l->count; t++)
    if (!reached[t]) return false;
  return l->count > 0 && count_corners(l) - (once + twice / 2) + l->count == (once > 0 ? 1 : 2);
}

/* Vertices of the border around which the two parts would not make one piece become near. Deep ones lie inside. */
static void draw_pinches(graft *g) {
  for (size_t i = 0; i < g->face_count[1]; i++)
    for (int k = 0; k < 3; k++) {
      const int32_t old = (int32_t)g->face[1][i].key[k], v = g->old.twin[old];
      vertex_link l = {.count = 0};
      if (!laves__layer_moves(g->old.layer, old)) continue;
      if (!add_link(g, &g->old, old, &l) || !add_link(g, &g->made, v, &l) || !is_ball(&l)) draw_near(g, &g->made, v);
    }
}

/* ---- the search ---- */

/* The near part grows until it fits. */
static laves_result search(graft *g, bool *fits, laves_error *error) {
  *fits = false;
  for (; g->tries < TRIES; g->tries++) {
    if (laves__cancelled(g->context, "stuff", 1)) return laves__fail_cancelled(error);
    g->grown = g->too_far = false;
    if (!list_faces(g, 0) || !list_faces(g, 1)) return laves__fail_memory(g->context, error);
    draw_differences(g);
    if (!g->grown && !g->too_far) draw_misfits(g);
    if (!g->grown && !g->too_far) draw_corners(g);
    if (!g->grown && !g->too_far) draw_pinches(g);
    if (g->too_far) return LAVES_OK;
    if (!g->grown) {
      *fits = true;
      return LAVES_OK;
    }
  }
  return LAVES_OK;
}

/* First near by, where it is cheap. */
static laves_result search_wider(graft *g, bool *fits, laves_error *error) {
  static const int rings[] = {WIDE_RINGS, WIDER_RINGS, FAR};
  *fits = false;
  for (size_t i = 0; i < LAVES__COUNT_OF(rings) && !*fits; i++) {
    g->rings = rings[i];
    if (!list_tets(g, &g->old) || !list_tets(g, &g->made)) return laves__fail_memory(g->context, error);
    const laves_result result = search(g, fits, error);
    if (result != LAVES_OK) return result;
  }
  return LAVES_OK;
}

/* ---- the layer of both ---- */

static void copy_vertex(const laves__layer *from, size_t v, laves__layer *to, size_t w) {
  to->position[w] = from->position[v];
  to->normal[w] = from->normal[v];
  to->hint[w] = from->hint[v];
  to->depth[w] = from->depth[v];
  to->off_surface[w] = from->off_surface[v];
  to->origin[w] = from->origin[v];
  if (to->hold) to->hold[w] = laves__layer_hold(from, (int32_t)v);
}

static laves_result create_like(const laves__layer *like, size_t vertices, size_t tets, laves__layer *layer, laves_error *error) {
  laves_context *context = like->context;
  const laves_result result = laves__layer_create(context, vertices, tets, layer, error);
  if (result != LAVES_OK) return result;
  if (like->hold && !(layer->hold = laves__alloc(context, vertices, sizeof *layer->hold)))
    return laves__fail_memory(context, error);
  layer->fresh = laves__alloc_zeroed(context, vertices, sizeof *layer->fresh);
  return layer->fresh ? LAVES_OK : laves__fail_memory(context, error);
}

/* Vertices with a site are there though dead: the lattice asks for them. */
static bool is_taken(const side *s, size_t v) {
  return s->near[v] && (s->layer->origin[v] != LAVES__NO_ORIGIN || lives(s->layer, (int32_t)v));
}
static bool is_left(const side *s, size_t v) {
  return !s->near[v] && (s->layer->origin[v] != LAVES__NO_ORIGIN || lives(s->layer, (int32_t)v));
}

/* What is taken, by itself: its far corners are the complements of their numbers in the old layer. */
static laves_result take(const graft *g, laves__layer *taken, laves_error *error) {
  const side *s = &g->made;
  const laves__layer *made = s->layer;
  size_t vertices = 0, tets = 0;
  for (size_t v = 0; v < made->vertex_count; v++) vertices += is_taken(s, v);
  for (size_t i = 0; i < s->count; i++) tets += count_near(s, s->tet[i]) > 0;
  laves_result result = create_like(made, vertices, tets, taken, error);
  int32_t *number = laves__alloc(g->context, made->vertex_count, sizeof *number);
  if (result == LAVES_OK && !number) result = laves__fail_memory(g->context, error);
  if (result == LAVES_OK) {
    vertices = tets = 0;
    for (size_t v = 0; v < made->vertex_count; v++) {
      number[v] = is_taken(s, v) ? (int32_t)vertices : ~s->twin[v];
      if (is_taken(s, v)) copy_vertex(made, v, taken, vertices++);
    }
    for (size_t i = 0; i < s->count; i++) {
      if (count_near(s, s->tet[i]) == 0) continue;
      for (int k = 0; k < 4; k++) taken->tet[tets][k] = number[made->tet[s->tet[i]][k]];
      tets++;
    }
  }
  laves__free(g->context, number, made->vertex_count, sizeof *number);
  return result;
}

static bool stays(const side *s, size_t t) { return s->layer->tet[t][0] >= 0 && count_near(s, (int32_t)t) == 0; }

static size_t fill_vertices(const graft *g, const laves__layer *taken, laves__layer *both, int32_t *number) {
  const side *s = &g->old;
  size_t next = 0;
  for (size_t v = 0; v < s->layer->vertex_count; v++) {
    if (!is_left(s, v)) continue;
    copy_vertex(s->layer, v, both, next);
    number[v] = (int32_t)next++;
  }
  const size_t first = next;
  for (size_t v = 0; v < taken->vertex_count; v++) {
    copy_vertex(taken, v, both, next);
    both->fresh[next++] = true;
  }
  return first;
}

/* `number`: of the old vertices that are left; `first`: of those taken. */
static void fill_tets(const graft *g, const laves__layer *taken, const int32_t *number, size_t first, laves__layer *both) {
  const laves__layer *old = g->old.layer;
  size_t next = 0;
  for (size_t t = 0; t < old->tet_count; t++) {
    if (!stays(&g->old, t)) continue;
    both->quality[next] = old->quality[t];
    for (int k = 0; k < 4; k++) both->tet[next][k] = number[old->tet[t][k]];
    next++;
  }
  for (size_t t = 0; t < taken->tet_count; t++) {
    both->quality[next] = 0;
    for (int k = 0; k < 4; k++) {
      const int32_t v = taken->tet[t][k];
      both->tet[next][k] = v >= 0 ? (int32_t)first + v : number[~v];
    }
    next++;
  }
}

/* Sites find their vertices in the new layer. */
static void name_sites(const laves__layer *layer, laves__lattice *lattice) {
  for (size_t v = 0; v < layer->vertex_count; v++) {
    const uint32_t id = layer->origin[v];
    if (id != LAVES__NO_ORIGIN) lattice->record[id / LAVES__C15_SITES].vertex[id % LAVES__C15_SITES] = (int32_t)v;
  }
}

static laves_result join(const graft *g, const laves__layer *taken, laves__layer *both, laves_error *error) {
  const laves__layer *old = g->old.layer;
  size_t vertices = taken->vertex_count, tets = taken->tet_count;
  for (size_t v = 0; v < old->vertex_count; v++) vertices += is_left(&g->old, v);
  for (size_t t = 0; t < old->tet_count; t++) tets += stays(&g->old, t);
  laves_result result = create_like(taken, vertices, tets, both, error);
  int32_t *number = laves__alloc(g->context, old->vertex_count, sizeof *number);
  if (result == LAVES_OK && !number) result = laves__fail_memory(g->context, error);
  if (result == LAVES_OK) {
    const size_t first = fill_vertices(g, taken, both, number);
    fill_tets(g, taken, number, first, both);
    result = laves__layer_link(both, error);
  }
  laves__free(g->context, number, old->vertex_count, sizeof *number);
  return result;
}

laves_result laves__graft(const laves__known_lattice *known, laves__lattice *lattice, laves__layer *made, laves__layer *improved,
                          bool *done, laves_error *error) {
  graft g = {
      .context = lattice->context, .known = known, .lattice = lattice, .old = {.layer = improved}, .made = {.layer = made}};
  laves__layer taken = {0}, both = {0};
  laves_result result = LAVES_OK;
  *done = false;
  LAVES_ASSERT(!lattice->graph && !improved->scale && !made->scale);
  if (!find_rings(&g) || !start_side(&g, &g.old) || !start_side(&g, &g.made) || !find_twins(&g))
    result = laves__fail_memory(g.context, error);
  if (result == LAVES_OK) result = search_wider(&g, done, error);
  if (result == LAVES_OK && *done) result = take(&g, &taken, error);
  if (result == LAVES_OK && *done) {
    free_side(g.context, &g.made); /* three layers at once would need much memory */
    laves__layer_free(made);
    result = join(&g, &taken, &both, error);
  }
  free_graft(&g);
  laves__layer_free(&taken);
  if (result != LAVES_OK || !*done) {
    laves__layer_free(&both);
    return result;
  }
  name_sites(&both, lattice);
  laves__layer_free(improved);
  *improved = both;
  return LAVES_OK;
}
