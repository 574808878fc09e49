/* Walks over the boundary vertices that are held to creases and corners, and adds up the edges between them. An edge counts for
 * the crease that both its ends are on, as long as no shorter way joins them: its middle must lie near the crease. */
#include "features/tally.h"

#include "mesh/mesh.h"

static const double near = 0.25;       /* edge lengths: how far from the crease the middle of an edge may lie */
static const double nearly_all = 0.98; /* share of a crease's length: chords are shorter than curves */

typedef struct counting {
  const laves__frame *frame;
  const laves__layer *layer;
  double *kept;     /* [creases] sizes */
  bool *has_vertex; /* [corners] */
} counting;

/* Half of the edge from v to w goes to its crease; the other half when it is looked at from w. */
static void count_edge(const counting *c, int32_t v, int32_t w) {
  const laves__layer *layer = c->layer;
  const laves__vec3 a = layer->position[v], b = layer->position[w];
  const int32_t crease = laves__holds_crease(c->frame->features, layer->hold[v], layer->hold[w]);
  if (crease == LAVES__NO_FEATURE) return;
  laves__vec3 foot, tangent;
  uint32_t hint = LAVES__NO_HINT;
  const double length = v3_distance(a, b);
  const laves__hold hold = {crease, LAVES__HOLD_CREASE};
  if (laves__frame_project_held(c->frame, hold, v3_lerp(a, b, 0.5), near * length, &hint, &foot, &tangent))
    c->kept[crease] += 0.5 * length;
}

static void count_vertex(const counting *c, int32_t v) {
  const laves__layer *layer = c->layer;
  const laves__hold hold = layer->hold[v];
  if (layer->depth[v] != 0 || layer->off_surface[v] || hold.kind < LAVES__HOLD_CREASE) return;
  if (hold.kind == LAVES__HOLD_CORNER) c->has_vertex[hold.id] = true;
  const laves__star *star = &layer->star[v];
  for (int i = 0; i < star->count; i++)
    for (int k = 0; k < 4; k++) {
      const int32_t *tet = layer->tet[star->tet[i]];
      if (tet[k] == v || !laves__layer_is_boundary_face(layer, star->tet[i], k)) continue;
      const uint8_t *face = laves__tet_face[k]; /* each boundary edge at v starts one face that v is the first corner of */
      for (int j = 0; j < 3; j++) {
        const int32_t w = tet[face[(j + 1) % 3]];
        if (tet[face[j]] == v && !layer->off_surface[w]) count_edge(c, v, w);
      }
    }
}

static void note_lost(laves__feature_tally *tally, laves__vec3 place) {
  if (!tally->has_lost) tally->lost = place;
  tally->has_lost = true;
}

static void sum_up(const counting *c, laves__feature_tally *tally) {
  const laves__features *f = c->frame->features;
  for (size_t i = 0; i < f->crease_count; i++) {
    const double length = f->crease[i].length / c->frame->size;
    tally->length += length;
    tally->kept_length += fmin(c->kept[i], length);
    if (c->kept[i] < nearly_all * length)
      note_lost(tally, laves__frame_from_local(c->frame, laves__crease_point_at(f, (int32_t)i, 0, 0.5 * f->crease[i].length)));
  }
  tally->corners = f->corner_count;
  for (size_t i = 0; i < f->corner_count; i++) {
    tally->kept_corners += c->has_vertex[i];
    if (!c->has_vertex[i]) note_lost(tally, laves__frame_from_local(c->frame, f->corner[i].position));
  }
}

laves_result laves__tally_features(const laves__frame *frame, const laves__layer *layer, laves__feature_tally *tally,
                                   laves_error *error) {
  const laves__features *f = frame->features;
  laves_context *context = layer->context;
  *tally = (laves__feature_tally){0};
  counting c = {frame, layer, laves__alloc_zeroed(context, f->crease_count, sizeof *c.kept),
                laves__alloc_zeroed(context, f->corner_count, sizeof *c.has_vertex)};
  const bool done = c.kept && c.has_vertex;
  for (size_t v = 0; done && layer->hold && v < layer->vertex_count; v++)
    if (layer->star[v].count > 0) count_vertex(&c, (int32_t)v);
  if (done) sum_up(&c, tally);
  laves__free(context, c.kept, f->crease_count, sizeof *c.kept);
  laves__free(context, c.has_vertex, f->corner_count, sizeof *c.has_vertex);
  return done ? LAVES_OK : laves__fail_memory(context, error);
}
