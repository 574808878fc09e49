/* The boundary as solvers want it.
 *
 * Faces are hung up at their lowest vertex; one pass over the tetrahedra then finds for each of their faces whether it is hung up
 * there. Vertices of a tag are stamped with it when its faces use them first, so nothing is sorted. */
#include "io/boundary_sets.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

static const char phase[] = "write";

/* ---- sides ---- */

typedef struct hooks {
  size_t *start;   /* [vertex_count + 1] */
  uint32_t *faces; /* [face_count] in the order of their lowest vertex */
} hooks;

static int32_t lowest(const int32_t face[3]) {
  const int32_t low = face[0] < face[1] ? face[0] : face[1];
  return low < face[2] ? low : face[2];
}

static bool has(const int32_t face[3], int32_t vertex) { return face[0] == vertex || face[1] == vertex || face[2] == vertex; }

static void hang_up(const laves_mesh *mesh, hooks *h) {
  for (size_t i = 0; i < mesh->face_count; i++) h->start[lowest(mesh->faces[i]) + 1]++;
  for (size_t v = 0; v < mesh->vertex_count; v++) h->start[v + 1] += h->start[v];
  for (size_t i = 0; i < mesh->face_count; i++)
    h->faces[h->start[lowest(mesh->faces[i])]++] = (uint32_t)i;           /* start[v] runs on ... */
  memmove(h->start + 1, h->start, mesh->vertex_count * sizeof *h->start); /* ... and is put back */
  h->start[0] = 0;
}

static void find_side(const laves_mesh *mesh, const hooks *h, size_t tet, int corner, uint64_t *sides) {
  const int32_t *t = mesh->tets[tet];
  const uint8_t *f = laves__tet_face[corner];
  const int32_t face[3] = {t[f[0]], t[f[1]], t[f[2]]};
  const int32_t low = lowest(face);
  for (size_t k = h->start[low]; k < h->start[low + 1]; k++) {
    const int32_t *other = mesh->faces[h->faces[k]];
    if (has(other, face[0]) && has(other, face[1]) && has(other, face[2]))
      sides[h->faces[k]] = 4 * (uint64_t)tet + (uint64_t)corner;
  }
}

static void find_sides(laves__output *out, const laves_mesh *mesh, uint64_t *sides) {
  const size_t face_count = mesh->face_count;
  hooks h = {laves__alloc_zeroed(out->context, mesh->vertex_count + 1, sizeof *h.start),
             laves__alloc(out->context, face_count, sizeof *h.faces)};
  if (!h.start || !h.faces) {
    laves__output_fail_memory(out);
    goto clean_up;
  }
  hang_up(mesh, &h);
  for (size_t i = 0; i < face_count; i++) sides[i] = UINT64_MAX;
  for (size_t i = 0; i < mesh->tet_count; i++) {
    if (laves__cancelled_at(out->context, phase, i, 2 * mesh->tet_count)) {
      laves__fail_cancelled(&out->error);
      break;
    }
    for (int corner = 0; corner < 4; corner++) find_side(mesh, &h, i, corner, sides);
  }
clean_up:
  laves__free(out->context, h.start, mesh->vertex_count + 1, sizeof *h.start);
  laves__free(out->context, h.faces, face_count, sizeof *h.faces);
}

/* ---- vertices ---- */

/* Counts, or lists where `list` is given, the vertices of all tags; stamps are 0 where a vertex has been in none. */
static void stamp(const laves_mesh *mesh, laves__boundary_sets *sets, uint32_t *stamps, int32_t *list) {
  size_t count = 0;
  for (size_t tag = 0; tag < sets->tags.count; tag++) {
    sets->first[tag] = count;
    for (size_t i = sets->tags.first[tag]; i < sets->tags.first[tag + 1]; i++) {
      const int32_t *face = laves__face_nodes(mesh, laves__tag_order_item(&sets->tags, i));
      for (int j = 0; j < laves__face_width(mesh); j++) {
        if (stamps[face[j]] == tag + 1) continue;
        stamps[face[j]] = (uint32_t)tag + 1;
        if (list) list[count] = face[j];
        count++;
      }
    }
  }
  sets->first[sets->tags.count] = count;
}

static void find_vertices(laves__output *out, const laves_mesh *mesh, laves__boundary_sets *sets) {
  uint32_t *stamps = laves__alloc_zeroed(out->context, mesh->vertex_count, sizeof *stamps);
  if (!stamps) {
    laves__output_fail_memory(out);
    return;
  }
  stamp(mesh, sets, stamps, NULL);
  sets->vertices = laves__alloc(out->context, sets->first[sets->tags.count], sizeof *sets->vertices);
  if (sets->vertices) {
    memset(stamps, 0, mesh->vertex_count * sizeof *stamps);
    stamp(mesh, sets, stamps, sets->vertices);
  } else {
    laves__output_fail_memory(out);
  }
  laves__free(out->context, stamps, mesh->vertex_count, sizeof *stamps);
}

bool laves__boundary_sets_make(laves__output *out, const laves_mesh *mesh, laves__boundary_sets *sets) {
  memset(sets, 0, sizeof *sets);
  if (out->error.result != LAVES_OK) return false;
  if (!laves__tag_order_make(out->context, mesh->face_tags, mesh->face_count, &sets->tags)) {
    laves__output_fail_memory(out);
    return false;
  }
  sets->sides = laves__alloc(out->context, mesh->face_count, sizeof *sets->sides);
  sets->first = laves__alloc_zeroed(out->context, sets->tags.count + 1, sizeof *sets->first);
  if (!sets->sides || !sets->first) laves__output_fail_memory(out);
  if (out->error.result == LAVES_OK) find_sides(out, mesh, sets->sides);
  for (size_t i = 0; i < mesh->face_count && out->error.result == LAVES_OK; i++)
    if (sets->sides[i] == UINT64_MAX)
      laves__output_fail(out, LAVES_ERROR_WRITE, "boundary triangle %zu is a face of no tetrahedron, which this format wants", i);
  if (out->error.result == LAVES_OK) find_vertices(out, mesh, sets);
  if (out->error.result == LAVES_OK) return true;
  laves__boundary_sets_free(out->context, mesh, sets);
  return false;
}

void laves__boundary_sets_free(laves_context *context, const laves_mesh *mesh, laves__boundary_sets *sets) {
  if (sets->vertices && sets->first) laves__free(context, sets->vertices, sets->first[sets->tags.count], sizeof *sets->vertices);
  laves__free(context, sets->first, sets->tags.count + 1, sizeof *sets->first);
  laves__free(context, sets->sides, mesh->face_count, sizeof *sets->sides);
  laves__tag_order_free(context, &sets->tags);
  memset(sets, 0, sizeof *sets);
}

/* ---- labels ---- */

/* Of ASCII, whatever the locale says. */
static bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
static bool is_label_character(char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '-' || c == '_'; }

/* Room is left for what is appended. */
static void make_label(const char *name, const char *general, laves__label label) {
  size_t length = 0;
  if (!is_letter(name[0])) length = (size_t)snprintf(label, LAVES__LABEL_MAX, "%s_", general);
  for (; *name && length < LAVES__LABEL_MAX - 24; name++) label[length++] = is_label_character(*name) ? *name : '_';
  label[length] = 0;
}

static bool is_taken(laves__label *labels, size_t count, const char *label) {
  for (size_t i = 0; i < count; i++)
    if (strcasecmp(labels[i], label) == 0) return true;
  return false;
}

laves__label *laves__labels_make(laves_context *context, const laves_mesh *mesh, int dimension, const laves__tag_order *order) {
  enum { NAMES_MAX = 3000 }; /* looking for equal names is quadratic; nobody reads so many, so they are numbered */
  const char *general = dimension == 3 ? "solid" : "boundary";
  laves__label *labels = laves__alloc(context, order->count, sizeof *labels);
  if (!labels) return NULL;
  for (size_t i = 0; i < order->count; i++) {
    if (order->count > NAMES_MAX) {
      snprintf(labels[i], sizeof labels[i], "%s_%zu", general, i + 1);
      continue;
    }
    char name[LAVES__TAG_NAME_MAX];
    laves__tag_name(mesh, dimension, order, i, name);
    make_label(name, general, labels[i]);
    const size_t length = strlen(labels[i]);
    for (size_t k = i + 1; is_taken(labels, i, labels[i]); k++)
      snprintf(labels[i] + length, sizeof labels[i] - length, "_%zu", k);
  }
  return labels;
}
