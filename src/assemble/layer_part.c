/* Which of the layer's vertices live, their numbers, and the boundary with its tags and sources. */
#include "assemble/layer_part.h"

#include "domain/held.h"

#include <string.h>

static bool is_alive(const laves__layer *layer, int32_t vertex) {
  return layer->depth[vertex] > LAVES__DEPTH_MOVES || layer->star[vertex].count > 0;
}

/* Kept sites: those of the layer that still live, and the IN sites deeper than the layer. */
static void mask_records(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const laves__layer_part *part = user;
  for (size_t i = begin; i < end; i++) {
    const laves__record *r = &part->lattice->record[i];
    uint32_t mask = 0;
    for (int site = 0; site < LAVES__C15_SITES; site++) {
      const bool in_layer = r->depth[site] <= LAVES__DEPTH_MAX;
      const bool kept =
          in_layer ? r->vertex[site] < -1 || is_alive(part->layer, r->vertex[site]) : r->label[site] == LAVES__LABEL_IN;
      if (kept) mask |= UINT32_C(1) << site;
    }
    part->mask[i] = mask;
  }
}

/* The first vertex of a parted site follows the same rule; only the layer knows which one it is: copies come right behind. */
static void unmask_dead_parted(const laves__layer_part *part) {
  const laves__layer *layer = part->layer;
  for (size_t v = 0; v + 1 < layer->vertex_count; v++) {
    const uint32_t id = layer->origin[v];
    if (id == LAVES__NO_ORIGIN || layer->origin[v + 1] != LAVES__NO_ORIGIN || is_alive(layer, (int32_t)v)) continue;
    part->mask[id / LAVES__C15_SITES] &= ~(UINT32_C(1) << id % LAVES__C15_SITES);
  }
}

static void find_faces(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const laves__layer_part *part = user;
  const laves__layer *layer = part->layer;
  for (size_t t = begin; t < end; t++) {
    part->faces[t] = 0;
    const int32_t *tet = layer->tet[t];
    if (tet[0] < 0) continue;
    int on = 0;
    for (int k = 0; k < 4; k++) on += layer->depth[tet[k]] == 0;
    if (on < 3) continue;
    for (int k = 0; k < 4; k++)
      if (laves__layer_is_boundary_face(layer, (int32_t)t, k)) part->faces[t] |= (uint8_t)(1 << k);
  }
}

/* Vertices that live, in the input's coordinates. */
static void place_vertices(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const laves__layer_part *part = user;
  for (size_t v = begin; v < end; v++)
    if (is_alive(part->layer, (int32_t)v)) part->placed[v] = laves__frame_to_input(part->frame, part->layer->position[v]);
}

/* Corners stand where the domain says, to the last bit. */
static void place_corners(const laves__layer_part *part) {
  const laves__layer *layer = part->layer;
  for (size_t v = 0; layer->hold && v < layer->vertex_count; v++) {
    if (layer->depth[v] != 0 || !is_alive(layer, (int32_t)v) || layer->off_surface[v] ||
        layer->hold[v].kind != LAVES__HOLD_CORNER)
      continue;
    const laves__frame *frame = part->frame;
    part->placed[v] = v3_add(frame->oracle->origin, frame->features->corner[layer->hold[v].id].position);
  }
}

/* The vertex of a parted site that has its number, for whoever starts from the site. */
static void name_parted(const laves__layer_part *part, laves__lattice *lattice) {
  for (size_t v = 0; v < part->layer->vertex_count; v++) {
    const uint32_t id = part->layer->origin[v];
    if (id != LAVES__NO_ORIGIN) lattice->record[id / LAVES__C15_SITES].vertex[id % LAVES__C15_SITES] = (int32_t)v;
  }
}

laves_result laves__layer_part_make(const laves__frame *frame, laves__lattice *lattice, const laves__layer *layer,
                                    laves__layer_part *part, laves_error *error) {
  laves_context *context = lattice->context;
  const size_t records = lattice->record_count;
  *part = (laves__layer_part){.frame = frame, .lattice = lattice, .layer = layer, .record_count = records};
  part->mask = laves__alloc(context, records, sizeof *part->mask);
  part->first = laves__alloc(context, records, sizeof *part->first);
  part->id = laves__alloc(context, layer->vertex_count, sizeof *part->id);
  part->placed = laves__alloc(context, layer->vertex_count, sizeof *part->placed);
  part->faces = laves__alloc(context, layer->tet_count, 1);
  if (!part->mask || !part->first || !part->id || !part->placed || !part->faces) return laves__fail_memory(context, error);
  if (!laves__parallel_for(context, "mesh", records, 64, mask_records, part) ||
      !laves__parallel_for(context, "mesh", layer->tet_count, 256, find_faces, part) ||
      !laves__parallel_for(context, "mesh", layer->vertex_count, 256, place_vertices, part))
    return laves__fail_cancelled(error);
  unmask_dead_parted(part);
  place_corners(part);
  name_parted(part, lattice);
  for (size_t t = 0; t < layer->tet_count; t++) {
    part->tet_count += layer->tet[t][0] >= 0;
    part->face_count += (size_t)__builtin_popcount(part->faces[t]);
  }
  return LAVES_OK;
}

/* Layer vertices at sites take their record's numbers, copies the numbers from `next` on; returns the total. */
static int64_t number_layer(laves__layer_part *part, int64_t next) {
  for (size_t v = 0; v < part->layer->vertex_count; v++) {
    const uint32_t id = part->layer->origin[v];
    if (!is_alive(part->layer, (int32_t)v))
      part->id[v] = -1;
    else if (id != LAVES__NO_ORIGIN)
      part->id[v] = laves__kept_vertex(part, (int32_t)(id / LAVES__C15_SITES), (int)(id % LAVES__C15_SITES));
    else
      part->id[v] = (int32_t)next++;
  }
  return next;
}

laves_result laves__layer_part_mesh(laves__layer_part *part, int64_t vertices, size_t stamped, bool hollow, laves_mesh **mesh,
                                    laves_error *error) {
  laves_context *context = part->lattice->context;
  if (vertices + (int64_t)part->layer->vertex_count > INT32_MAX)
    return laves__fail(error, LAVES_ERROR_OPTION, "the mesh would have %lld vertices, more than 2^31; choose a larger size",
                       (long long)vertices);
  const int64_t total = number_layer(part, vertices);
  const bool tagged = part->frame->oracle->tag != NULL;
  *mesh = (hollow ? laves__mesh_create_hollow : laves__mesh_create)(context, (size_t)total, stamped + part->tet_count,
                                                                    part->face_count, false, tagged);
  if (!*mesh) return laves__fail_memory(context, error);
  if (!part->frame->face_sources || !part->frame->oracle->source) return LAVES_OK;
  (*mesh)->face_sources = laves__alloc(context, part->face_count, sizeof *(*mesh)->face_sources);
  return (*mesh)->face_sources ? LAVES_OK : laves__fail_memory(context, error);
}

void laves__layer_part_tets(const laves__layer_part *part, int32_t (*tets)[4]) {
  for (size_t t = 0; t < part->layer->tet_count; t++) {
    const int32_t *tet = part->layer->tet[t];
    if (tet[0] < 0) continue;
    for (int k = 0; k < 4; k++) (*tets)[k] = part->id[tet[k]];
    tets++;
  }
}

void laves__layer_part_copies(const laves__layer_part *part, laves__vec3 *points) {
  for (size_t v = 0; v < part->layer->vertex_count; v++)
    if (part->layer->origin[v] == LAVES__NO_ORIGIN && part->id[v] >= 0) *points++ = part->placed[v];
}

typedef struct tagging {
  const laves__layer_part *part;
  laves_mesh *mesh;
  int32_t (*corner)[3]; /* [face_count] the layer's vertices of each face */
} tagging;

/* The layer's vertices of all boundary faces, outwards. */
static void list_corners(const laves__layer_part *part, int32_t (*corner)[3]) {
  for (size_t t = 0; t < part->layer->tet_count; t++)
    for (int k = 0; k < 4; k++) {
      if (!(part->faces[t] >> k & 1)) continue;
      for (int j = 0; j < 3; j++) (*corner)[j] = part->layer->tet[t][laves__tet_face[k][j]];
      corner++;
    }
}

/* The foot of a boundary face: the point of the surface nearest to its centroid. All that a face knows of the surface is
 * what is there. */
static bool find_foot(const tagging *g, size_t f, laves__vec3 *foot, uint32_t *hint) {
  const laves__frame *frame = g->part->frame;
  const laves__layer *layer = g->part->layer;
  const laves__oracle *oracle = frame->oracle;
  const int32_t *corner = g->corner[f];
  const laves__vec3 *placed = g->part->placed;
  const laves__vec3 sum = v3_add(v3_add(placed[corner[0]], placed[corner[1]]), placed[corner[2]]);
  const laves__vec3 centroid = v3_sub(v3_scale(sum, 1.0 / 3), oracle->origin);
  const double reach = 2 * frame->size * laves__layer_scale(layer, corner[0]);
  laves__vec3 normal;
  *hint = layer->hint[corner[0]];
  if (layer->hold && frame->features) {
    laves__hold hold[3];
    laves__vec3 p[3];
    for (int j = 0; j < 3; j++) {
      hold[j] = layer->hold[corner[j]];
      p[j] = layer->position[corner[j]];
    }
    const int32_t patch = laves__face_patch(frame, hold, p, *hint);
    const laves__features *features = frame->features;
    if (patch != LAVES__NO_FEATURE && features->project_patch(features->self, patch, centroid, reach, hint, foot, &normal))
      return true;
  }
  return oracle->project(oracle->self, centroid, reach, hint, foot, &normal);
}

/* Tag and source of each boundary face. */
static void tag_faces(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const tagging *g = user;
  const laves__oracle *oracle = g->part->frame->oracle;
  for (size_t f = begin; f < end; f++) {
    uint32_t hint;
    laves__vec3 foot;
    const bool found = find_foot(g, f, &foot, &hint);
    if (g->mesh->face_tags) g->mesh->face_tags[f] = found ? 1 + oracle->tag(oracle->self, foot, hint) : 1;
    if (g->mesh->face_sources) g->mesh->face_sources[f] = found ? oracle->source(oracle->self, foot, hint) : -1;
  }
}

laves_result laves__layer_part_faces(const laves__layer_part *part, laves_mesh *mesh, laves_error *error) {
  laves_context *context = part->lattice->context;
  tagging g = {part, mesh, laves__alloc(context, mesh->face_count, sizeof *g.corner)};
  if (!g.corner) return laves__fail_memory(context, error);
  list_corners(part, g.corner);
  for (size_t f = 0; f < mesh->face_count; f++)
    for (int j = 0; j < 3; j++) mesh->faces[f][j] = part->id[g.corner[f][j]];
  const bool tagged = mesh->face_tags || mesh->face_sources;
  const bool done = !tagged || laves__parallel_for(context, "mesh", mesh->face_count, 64, tag_faces, &g);
  laves__free(context, g.corner, mesh->face_count, sizeof *g.corner);
  return done ? LAVES_OK : laves__fail_cancelled(error);
}

void laves__layer_part_free(laves__layer_part *part) {
  if (!part->layer) return;
  laves_context *context = part->layer->context; /* the lattice may have been handed over */
  laves__free(context, part->faces, part->layer->tet_count, 1);
  laves__free(context, part->placed, part->layer->vertex_count, sizeof *part->placed);
  laves__free(context, part->id, part->layer->vertex_count, sizeof *part->id);
  laves__free(context, part->first, part->record_count, sizeof *part->first);
  laves__free(context, part->mask, part->record_count, sizeof *part->mask);
  memset(part, 0, sizeof *part);
}
