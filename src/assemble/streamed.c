/* What is kept of a run: the lattice with its records, which grow with the surface, and the layer as plain arrays. The interior
 * is one number for each brick. */
#include "assemble/streamed.h"

#include <string.h>

typedef struct streamed {
  laves_context *context;
  laves__lattice lattice;
  laves__stamps stamps;
  laves__oracle origin;             /* all that is left of the domain: where its origin lies */
  size_t site_count, stamped_count; /* vertices and tets that are stamped */
  size_t layer_vertex_count;        /* of stamps.placed */
  int32_t (*tet)[4];                /* [tet_count] of the layer, behind those that are stamped */
  size_t tet_count;
  laves__vec3 *copy; /* [copy_count] further vertices of parted sites, likewise */
  size_t copy_count;
} streamed;

static size_t least(size_t a, size_t b) { return a < b ? a : b; }

static bool make_points(const void *self, size_t begin, size_t end, laves__vec3 *out) {
  const streamed *s = self;
  const size_t sites_end = least(end, s->site_count);
  for (size_t next = begin, brick = laves__stamps_vertex_brick(&s->stamps, begin); next < sites_end; brick++) {
    const size_t last = least((size_t)s->stamps.base[brick + 1].vertex, sites_end);
    if (last <= next) continue;
    laves__stamp_points(&s->stamps, brick, next, last, out + (next - begin));
    next = last;
  }
  const size_t first = begin > s->site_count ? begin : s->site_count;
  if (end > first) memcpy(out + (first - begin), s->copy + (first - s->site_count), (end - first) * sizeof *out);
  return true;
}

static bool make_tets(const void *self, size_t begin, size_t end, int32_t (*out)[4]) {
  const streamed *s = self;
  const size_t stamped_end = least(end, s->stamped_count);
  for (size_t next = begin, brick = laves__stamps_tet_brick(&s->stamps, begin); next < stamped_end; brick++) {
    const size_t last = least((size_t)s->stamps.base[brick + 1].tet, stamped_end);
    if (last <= next) continue;
    laves__stamp_tets(&s->stamps, brick, next, last, out + (next - begin));
    next = last;
  }
  const size_t first = begin > s->stamped_count ? begin : s->stamped_count;
  if (end > first) memcpy(out + (first - begin), s->tet + (first - s->stamped_count), (end - first) * sizeof *out);
  return true;
}

static void free_streamed(void *self) {
  streamed *s = self;
  laves_context *context = s->context;
  const size_t records = s->lattice.record_count;
  laves__free(context, s->stamps.base, s->lattice.directory_count + 1, sizeof *s->stamps.base);
  laves__free(context, (void *)s->stamps.mask, records, sizeof *s->stamps.mask);
  laves__free(context, s->stamps.first, records, sizeof *s->stamps.first);
  laves__free(context, (void *)s->stamps.placed, s->layer_vertex_count, sizeof *s->stamps.placed);
  laves__free(context, s->tet, s->tet_count, sizeof *s->tet);
  laves__free(context, s->copy, s->copy_count, sizeof *s->copy);
  laves__lattice_free(&s->lattice);
  laves__free(context, s, 1, sizeof *s);
}

laves_result laves__streamed_make(const laves__stamps *stamps, laves__layer_part *part, laves__lattice *lattice, laves_mesh *mesh,
                                  laves_error *error) {
  laves_context *context = lattice->context;
  const laves__brick_base all = stamps->base[lattice->directory_count];
  streamed *s = laves__alloc_zeroed(context, 1, sizeof *s);
  if (!s) return laves__fail_memory(context, error);
  s->context = context;
  s->site_count = (size_t)all.vertex;
  s->stamped_count = (size_t)all.tet;
  s->layer_vertex_count = part->layer->vertex_count;
  s->tet_count = part->tet_count;
  s->copy_count = mesh->vertex_count - s->site_count;
  s->tet = laves__alloc(context, s->tet_count, sizeof *s->tet);
  s->copy = laves__alloc(context, s->copy_count, sizeof *s->copy);
  if (!s->tet || !s->copy) {
    laves__free(context, s->copy, s->copy_count, sizeof *s->copy);
    laves__free(context, s->tet, s->tet_count, sizeof *s->tet);
    laves__free(context, s, 1, sizeof *s);
    return laves__fail_memory(context, error);
  }
  laves__layer_part_tets(part, s->tet);
  laves__layer_part_copies(part, s->copy);
  s->stamps = *stamps;
  part->mask = NULL;
  part->first = NULL;
  part->placed = NULL;
  s->lattice = *lattice;
  memset(lattice, 0, sizeof *lattice);
  s->stamps.lattice = &s->lattice;
  s->origin.origin = stamps->frame.oracle->origin;
  s->stamps.frame.oracle = &s->origin;
  s->stamps.frame.features = NULL;
  mesh->maker = (laves__maker){s, make_points, make_tets, free_streamed};
  return LAVES_OK;
}
