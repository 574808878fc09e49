/* In: domain, mesh.  Out: whether the boundary of the mesh has the pieces and handles of the domain's, and where not.
 *
 * Euler's formula on both sides: points - edges + faces = 2 pieces - 2 genus, and a closed surface has three edges for two
 * faces. A wall that was lost, a gap or hole that was filled and a part that was dropped leave samples of the surface far from
 * the mesh's boundary; those of them at which a chord through the solid or through a gap is short are named. */
#include "losses.h"

#include <stdio.h>
#include <stdlib.h>

#include "snap/snap.h"

/* Sizes: how far mesh and surface are apart where something is lost. Half of the narrowest hole worth a name; on smooth parts
 * the distance stays below 0.1. */
static const double far_apart = 0.2;
static const double apart = 1;         /* sizes between places that are named */
static const double reach = 1.5;       /* sizes from a place to the surface's nearest point */
enum { PLACES = 1024, SUSPECTS = 64 }; /* looked for; of those, looked at in the mesh */

static int32_t find_root(int32_t *parent, int32_t v) {
  while (parent[v] != v) v = parent[v] = parent[parent[v]];
  return v;
}

/* Small numbers for the vertices of the boundary: bits, and how many are set before each word. */
typedef struct ranks {
  uint64_t *word;
  int32_t *before;
  size_t words;
  int32_t count;
} ranks;

static bool make_ranks(const laves_mesh *mesh, ranks *r) {
  r->words = mesh->vertex_count / 64 + 1;
  r->word = laves__alloc_zeroed(mesh->context, r->words, sizeof *r->word);
  r->before = laves__alloc(mesh->context, r->words, sizeof *r->before);
  if (!r->word || !r->before) return false;
  for (size_t f = 0; f < mesh->face_count; f++)
    for (int k = 0; k < 3; k++) r->word[mesh->faces[f][k] / 64] |= UINT64_C(1) << (mesh->faces[f][k] % 64);
  r->count = 0;
  for (size_t i = 0; i < r->words; i++) {
    r->before[i] = r->count;
    r->count += __builtin_popcountll(r->word[i]);
  }
  return true;
}

static int32_t rank_of(const ranks *r, int32_t vertex) {
  return r->before[vertex / 64] + __builtin_popcountll(r->word[vertex / 64] & ((UINT64_C(1) << (vertex % 64)) - 1));
}

/* How many pieces the boundary has; `parent` [count] is the forest. */
static int64_t count_pieces(const laves_mesh *mesh, const ranks *r, int32_t *parent) {
  for (int32_t v = 0; v < r->count; v++) parent[v] = v;
  int64_t pieces = r->count;
  for (size_t f = 0; f < mesh->face_count; f++) {
    const int32_t first = rank_of(r, mesh->faces[f][0]);
    for (int k = 1; k < 3; k++) {
      const int32_t a = find_root(parent, first), b = find_root(parent, rank_of(r, mesh->faces[f][k]));
      parent[a > b ? a : b] = a < b ? a : b;
      pieces -= a != b;
    }
  }
  return pieces;
}

bool laves__boundary_topology(const laves_mesh *mesh, size_t *pieces, int64_t *genus) {
  ranks r = {0};
  bool memory = make_ranks(mesh, &r);
  int32_t *parent = memory ? laves__alloc(mesh->context, (size_t)r.count, sizeof *parent) : NULL;
  memory = parent != NULL;
  if (memory) {
    const int64_t found = count_pieces(mesh, &r, parent);
    *pieces = (size_t)found;
    *genus = found - (r.count - (int64_t)mesh->face_count / 2) / 2;
  }
  laves__free(mesh->context, parent, (size_t)r.count, sizeof *parent);
  laves__free(mesh->context, r.before, r.words, sizeof *r.before);
  laves__free(mesh->context, r.word, r.words, sizeof *r.word);
  return memory;
}

/* What may be lost. */
typedef struct suspect {
  laves_thin_place place;
  bool filled; /* the mesh covers the place */
} suspect;

static laves__vec3 vector(const double p[3]) { return v3(p[0], p[1], p[2]); }

/* The wall or gap near a place; false when there is none. */
static bool find_cause(const laves__frame *frame, const double place[3], suspect *found) {
  const laves__vec3 at = laves__frame_from_local(frame, v3_sub(vector(place), frame->oracle->origin));
  uint32_t hint = LAVES__NO_HINT;
  laves__vec3 foot, normal;
  if (!laves__frame_project(frame, at, reach, &hint, &foot, &normal)) return false;
  *found = (suspect){.place = laves__thin_place(frame, foot, normal, 1)};
  return isfinite(found->place.thickness);
}

static int by_thickness(const void *left, const void *right) {
  const laves_thin_place *a = &((const suspect *)left)->place, *b = &((const suspect *)right)->place;
  if (a->thickness != b->thickness) return a->thickness < b->thickness ? -1 : 1;
  for (int k = 0; k < 3; k++)
    if (a->place[k] != b->place[k]) return a->place[k] < b->place[k] ? -1 : 1;
  return 0;
}

static bool tet_holds(const laves__vec3 p[4], laves__vec3 q) {
  return v3_det(q, p[1], p[2], p[3]) >= 0 && v3_det(p[0], q, p[2], p[3]) >= 0 && v3_det(p[0], p[1], q, p[3]) >= 0 &&
         v3_det(p[0], p[1], p[2], q) >= 0;
}

static void find_filled(const laves_mesh *mesh, suspect *list, size_t count) {
  for (size_t t = 0; t < mesh->tet_count; t++) {
    laves__vec3 p[4];
    laves__box3 box = box3_empty();
    for (int k = 0; k < 4; k++) box = box3_add(box, p[k] = mesh->points[mesh->tets[t][k]]);
    for (size_t i = 0; i < count; i++) {
      const double *at = list[i].place.place;
      if (at[0] < box.lower.x || at[0] > box.upper.x || at[1] < box.lower.y || at[1] > box.upper.y || at[2] < box.lower.z ||
          at[2] > box.upper.z)
        continue;
      list[i].filled |= tet_holds(p, vector(at));
    }
  }
}

/* Adds to the report: walls that are not filled, gaps that are. When there is none such, whatever is thinnest. */
static void name_lost(const laves__frame *frame, const suspect *list, size_t count, laves_report *report) {
  const size_t before = report->lost_count;
  for (int any = 0; any < 2 && report->lost_count == before; any++)
    for (size_t i = 0; i < count; i++) {
      const laves_thin_place *place = &list[i].place;
      if (!any && list[i].filled != (place->kind == LAVES_THIN_GAP)) continue;
      if (laves__lost_is_new(report->lost, report->lost_count, place, apart * frame->size))
        report->lost[report->lost_count++] = *place;
    }
}

static laves_result name_distant(const laves__frame *frame, const laves_domain *domain, const laves_mesh *mesh,
                                 laves_report *report, laves_error *error) {
  laves_context *context = mesh->context;
  laves_result result = LAVES_OK;
  size_t count = 0, suspects = 0;
  laves_place *place = laves__alloc(context, PLACES, sizeof *place);
  suspect *list = laves__alloc(context, PLACES, sizeof *list);
  if (!place || !list) result = laves__fail_memory(context, error);
  if (result == LAVES_OK)
    result = laves_check_distance(context, mesh, domain, far_apart * frame->size, place, PLACES, &count, error);
  if (result == LAVES_OK) {
    for (size_t i = 0; i < count && i < PLACES; i++) suspects += find_cause(frame, place[i].place, &list[suspects]);
    if (suspects) qsort(list, suspects, sizeof *list, by_thickness);
    if (suspects > SUSPECTS) suspects = SUSPECTS;
    find_filled(mesh, list, suspects);
    name_lost(frame, list, suspects, report);
  }
  laves__free(context, list, PLACES, sizeof *list);
  laves__free(context, place, PLACES, sizeof *place);
  return result;
}

/* The place that tells most: a gap where holes were closed, else the first. `first`: of the places found for this difference; the
 * pinches before them may have had no part in it. */
static const laves_thin_place *telling_place(const laves_report *report, size_t first) {
  for (size_t i = first; i < report->lost_count && report->genus < report->domain_genus; i++)
    if (report->lost[i].kind == LAVES_THIN_GAP && isfinite(report->lost[i].thickness)) return &report->lost[i];
  return &report->lost[first < report->lost_count ? first : 0];
}

static void say_difference(const laves__frame *frame, const laves_report *report, size_t first, char *text, size_t capacity) {
  int used = snprintf(text, capacity, "the boundary of the solid has %zu piece%s and genus %lld, that of the mesh %zu and %lld",
                      report->domain_pieces, report->domain_pieces == 1 ? "" : "s", (long long)report->domain_genus,
                      report->pieces, (long long)report->genus);
  if (report->pieces == report->domain_pieces && report->genus < report->domain_genus && used >= 0 && (size_t)used < capacity)
    used += snprintf(text + used, capacity - (size_t)used, ": %lld of %lld holes were closed, which a smaller size keeps",
                     (long long)(report->domain_genus - report->genus), (long long)report->domain_genus);
  if (report->lost_count == 0 || used < 0 || (size_t)used >= capacity) return;
  const laves_thin_place *p = telling_place(report, first);
  const bool chord = isfinite(p->thickness);
  used += snprintf(text + used, capacity - (size_t)used, "; something is lost at (%.6g, %.6g, %.6g)", p->place[0], p->place[1],
                   p->place[2]);
  if (!chord || (size_t)used >= capacity) return;
  snprintf(text + used, capacity - (size_t)used, ", a %s of %.3g (%.2f sizes)", p->kind == LAVES_THIN_GAP ? "gap" : "wall",
           p->thickness, p->thickness / frame->size);
}

laves_result laves__find_losses(const laves__frame *frame, const laves_domain *domain, const laves_mesh *mesh,
                                laves_report *report, char *text, size_t capacity, laves_error *error) {
  text[0] = '\0';
  report->topology_known = domain->info.topology_known;
  report->domain_pieces = report->topology_known ? domain->info.component_count : 0;
  report->domain_genus = domain->info.genus;
  if (!laves__boundary_topology(mesh, &report->pieces, &report->genus)) return laves__fail_memory(mesh->context, error);
  if (!report->topology_known || (report->pieces == report->domain_pieces && report->genus == report->domain_genus))
    return LAVES_OK;
  const size_t pinches = report->lost_count;
  /* the places are looked for in the mesh, which a streamed one does not hold */
  const laves_result result = mesh->maker.self ? LAVES_OK : name_distant(frame, domain, mesh, report, error);
  if (result == LAVES_OK) say_difference(frame, report, pinches, text, capacity);
  return result;
}
