/* From the triangles of a file to an oracle.
 *
 * In: triangles as read, which are consumed.  Out: a domain: oracle, facts, tags.
 *
 *   weld -> tree -> topology -> (mend) -> direction -> crossings -> walls or open -> normals -> oracle
 *
 * Local coordinates are input minus origin. The origin is the box's centre on those axes where the centre lies further out
 * than the box is wide, where the subtraction is exact; elsewhere zero, where there is nothing to subtract. */
#include <string.h>

#include "domain/surface.h"

/* Squares, cubes and products of coordinates must stay within the range of double with room. */
static const double diagonal_min = 1e-60, diagonal_max = 1e60;

/* The caps of an open surface are as smooth as its winding number is right. */
static const double far_factor_of_caps = 3;

/* Walls that are less than one in so many faces are few. */
static const size_t few_walls = 1000;

/* Share of the box that an open surface must enclose to be taken for that of a solid. */
static const double enclosed_min = 1e-3;

static laves__box3 box_of(const laves__vec3 *points, size_t count) {
  laves__box3 b = box3_empty();
  for (size_t i = 0; i < count; i++) b = box3_add(b, points[i]);
  return b;
}

static laves__box3 used_box(laves_context *context, const laves__surface_input *input) {
  laves__box3 b = box3_empty();
  for (size_t f = 0; f < input->triangle_count && !laves__cancelled_at(context, "surface", f, input->triangle_count); f++)
    for (int i = 0; i < 3; i++) b = box3_add(b, input->points[input->triangles[f][i]]);
  return b;
}

static laves__vec3 choose_origin(laves__box3 b) {
  const laves__vec3 c = box3_centre(b);
  const double diagonal = box3_diagonal(b);
  return v3(fabs(c.x) > diagonal ? c.x : 0, fabs(c.y) > diagonal ? c.y : 0, fabs(c.z) > diagonal ? c.z : 0);
}

/* Faces, tags and sources change to the order of the tree; across and normals are not made yet. */
static bool reorder(laves__surface *s, const uint32_t *order) {
  const size_t count = s->face_count;
  uint32_t(*faces)[3] = laves__alloc(s->context, s->face_capacity, sizeof *faces);
  int32_t *tags = s->tags ? laves__alloc(s->context, s->face_capacity, sizeof *tags) : NULL;
  uint32_t *sources = laves__alloc(s->context, s->face_capacity, sizeof *sources);
  if (!faces || (s->tags && !tags) || !sources) {
    laves__free(s->context, faces, s->face_capacity, sizeof *faces);
    laves__free(s->context, tags, s->face_capacity, sizeof *tags);
    laves__free(s->context, sources, s->face_capacity, sizeof *sources);
    return false;
  }
  for (size_t i = 0; i < count && !laves__cancelled_at(s->context, "surface", i, count); i++) {
    memcpy(faces[i], s->faces[order[i]], sizeof *faces);
    if (tags) tags[i] = s->tags[order[i]];
    sources[i] = s->sources[order[i]];
  }
  laves__free(s->context, s->faces, s->face_capacity, sizeof *s->faces);
  laves__free(s->context, s->tags, s->face_capacity, sizeof *s->tags);
  laves__free(s->context, s->sources, s->face_capacity, sizeof *s->sources);
  s->faces = faces;
  s->tags = tags;
  s->sources = sources;
  return !laves__is_cancelled(s->context);
}

/* Points change to the order in which faces first use them, so that what is near in space is near in memory. */
static bool reorder_points(laves__surface *s) {
  const size_t count = s->point_count;
  laves__vec3 *points = laves__alloc(s->context, s->point_capacity, sizeof *points);
  uint32_t *number = laves__alloc(s->context, count, sizeof *number);
  const bool done = points && number;
  if (done) {
    memset(number, 0xff, count * sizeof *number);
    uint32_t next = 0;
    for (size_t f = 0; f < s->face_count; f++)
      for (int i = 0; i < 3; i++) {
        uint32_t *p = &s->faces[f][i];
        if (number[*p] == LAVES__NONE) {
          points[next] = s->points[*p];
          number[*p] = next++;
        }
        *p = number[*p];
      }
    s->point_count = next;
    laves__free(s->context, s->points, s->point_capacity, sizeof *s->points);
    s->points = points;
  } else {
    laves__free(s->context, points, s->point_capacity, sizeof *points);
  }
  laves__free(s->context, number, count, sizeof *number);
  return done;
}

/* Builds the tree and brings everything into its order, `slots` (NULL: none) with it. */
static bool build_tree(laves__surface *s, uint32_t *slots) {
  const size_t count = s->face_count;
  uint32_t *order = laves__alloc(s->context, count, sizeof *order);
  const bool done = order && laves__bvh_build(s->context, s->points, (const uint32_t(*)[3])s->faces, count, order, &s->bvh) &&
                    reorder(s, order) && reorder_points(s);
  for (size_t i = 0; done && slots && i < count; i++) order[i] = slots[order[i]];
  if (done && slots) memcpy(slots, order, count * sizeof *slots);
  laves__free(s->context, order, count, sizeof *order);
  return done;
}

/* Turns a face over, and the triangle of the tree with it. */
static void turn_face(laves__surface *s, uint32_t f) {
  const uint32_t swap = s->faces[f][1];
  s->faces[f][1] = s->faces[f][2];
  s->faces[f][2] = swap;
  laves__triangle *t = &s->bvh.triangles[f];
  *t = (laves__triangle){t->a, t->c, t->b, t->dual_c, t->dual_b};
}

/* Topology again after faces were turned or left out; the facts in info are about the input and stay. */
static bool renew_topology(laves__surface *s, const laves_domain_info *info) {
  laves_domain_info scratch = *info;
  return laves__surface_topology(s, &scratch);
}

static bool any_doubt(const laves__surface *s) {
  for (size_t h = 0; h < 3 * s->face_count; h++)
    if (s->across[h] == LAVES__NONE) return true;
  for (size_t p = 0; p < s->point_count; p++)
    if (s->doubtful_points[p]) return true;
  return false;
}

static void mark_partial(laves__surface *s, const laves__crossings *c) {
  for (size_t i = 0; i < c->count; i++)
    for (int k = 0; k < 2; k++) s->face_flags[c->pairs[i][k]] = LAVES__PARTIAL;
}

static void mark_doubtful(laves__surface *s) {
  for (size_t f = 0; f < s->face_count; f++)
    for (int i = 0; i < 3; i++) {
      const bool doubtful = s->open ? !(s->face_flags[f] & LAVES__PLAIN) : (s->face_flags[f] & LAVES__PARTIAL) != 0;
      if (doubtful) s->doubtful_points[s->faces[f][i]] = true;
    }
}

/* Leaves the faces without keep out of the distance; the whole stays behind the winding number. */
static bool leave_out(laves__surface *s, const bool *keep, laves__crossings *c) {
  const size_t all_count = s->face_count;
  bool done = false;
  uint32_t *number = laves__alloc(s->context, all_count, sizeof *number);
  uint8_t *flags = laves__alloc_zeroed(s->context, s->face_capacity, sizeof *flags);
  s->winding_slot = laves__alloc(s->context, s->face_capacity, sizeof *s->winding_slot);
  if (!number || !flags || !s->winding_slot) goto clean_up;
  s->face_count = 0;
  for (uint32_t f = 0; f < all_count; f++) {
    if (!keep[f]) continue;
    memmove(s->faces[s->face_count], s->faces[f], sizeof *s->faces);
    if (s->tags) s->tags[s->face_count] = s->tags[f];
    s->sources[s->face_count] = s->sources[f];
    s->winding_slot[s->face_count++] = f;
  }
  s->all = s->bvh;
  s->winding.bvh = &s->all;
  s->bvh = (laves__bvh){0};
  if (!build_tree(s, s->winding_slot)) goto clean_up;
  for (uint32_t f = 0; f < s->face_count; f++) {
    flags[f] = s->face_flags[s->winding_slot[f]];
    number[s->winding_slot[f]] = f;
  }
  memcpy(s->face_flags, flags, s->face_capacity);
  for (size_t i = 0; i < c->count; i++)
    for (int k = 0; k < 2; k++) c->pairs[i][k] = number[c->pairs[i][k]];
  done = true;
clean_up:
  laves__free(s->context, number, all_count, sizeof *number);
  laves__free(s->context, flags, s->face_capacity, sizeof *flags);
  return done;
}

/* Many walls are worth a new tree; a few (or all, which leave nothing) stay where they are, as faces no part of which will be
 * found to count. */
static bool part_with_walls(laves__surface *s, const bool *keep, laves__crossings *c, const laves_domain_info *info) {
  size_t walls = 0;
  for (size_t f = 0; f < s->face_count; f++) walls += !keep[f];
  if (walls < s->face_count && walls * few_walls > s->face_count) return leave_out(s, keep, c) && renew_topology(s, info);
  for (size_t f = 0; f < s->face_count; f++)
    if (!keep[f]) s->face_flags[f] = LAVES__PARTIAL;
  return true;
}

/* Parts that stand inside out by themselves are turned; then the winding number is that of a new surface, and walls are
 * looked for again. */
static bool turn_inverted(laves__surface *s, bool *inverted, bool *keep, laves_domain_info *info) {
  bool any = false;
  for (uint32_t f = 0; f < s->face_count; f++) {
    if (!inverted[f]) continue;
    any = true;
    turn_face(s, f);
  }
  if (!any) return true;
  info->turned = true;
  laves__winding_free(s->context, &s->winding);
  return renew_topology(s, info) && laves__winding_build(s->context, &s->bvh, &s->winding) &&
         laves__surface_find_walls(s, keep, inverted);
}

/* Closed, but in several parts, crossing itself or not manifold: the union of what it encloses. */
static bool solve_union(laves__surface *s, laves__crossings *c, laves_domain_info *info) {
  bool done = false;
  const size_t count = s->face_count;
  bool *keep = laves__alloc(s->context, count, sizeof *keep);
  bool *inverted = laves__alloc(s->context, count, sizeof *inverted);
  s->needs_winding = true;
  mark_partial(s, c);
  if (!keep || !inverted || !laves__winding_build(s->context, &s->bvh, &s->winding)) goto clean_up;
  if (!laves__surface_find_walls(s, keep, inverted)) goto clean_up;
  if (!turn_inverted(s, inverted, keep, info)) goto clean_up;
  if (!part_with_walls(s, keep, c, info)) goto clean_up;
  mark_doubtful(s);
  if (!laves__surface_find_segments(s, c)) goto clean_up;
  laves__surface_measure(s, &info->volume, &info->area);
  if (c->count > 0) info->volume = laves__surface_union_volume(s);
  done = true;
clean_up:
  laves__free(s->context, keep, count, sizeof *keep);
  laves__free(s->context, inverted, count, sizeof *inverted);
  return done;
}

static void note_crossings(const laves__surface *s, const laves__crossings *c, laves_domain_info *info) {
  if (c->count == 0) return;
  const laves__triangle *t = &s->bvh.triangles[c->pairs[0][0]];
  laves__vec3 ends[2] = {t->a, t->b};
  laves__triangles_meet(t, &s->bvh.triangles[c->pairs[0][1]], ends);
  const laves__vec3 place = v3_lerp(ends[0], ends[1], 0.5);
  info->defects[LAVES_DEFECT_CROSSING] = c->count;
  info->defect_place[LAVES_DEFECT_CROSSING][0] = place.x;
  info->defect_place[LAVES_DEFECT_CROSSING][1] = place.y;
  info->defect_place[LAVES_DEFECT_CROSSING][2] = place.z;
}

/* Open: {winding number = 1/2}. */
static bool solve_open(laves__surface *s, laves__crossings *c, laves_domain_info *info) {
  bool done = false;
  const size_t count = s->face_count;
  bool *keep = laves__alloc(s->context, count, sizeof *keep);
  s->needs_winding = s->open = info->winding = true;
  s->all_face_count = count;
  info->volume = NAN;
  mark_partial(s, c);
  if (!keep || !laves__winding_build(s->context, &s->bvh, &s->winding) || !laves__surface_build_rim(s)) goto clean_up;
  if (!laves__surface_judge_open(s, keep)) goto clean_up;
  if (!part_with_walls(s, keep, c, info)) goto clean_up;
  mark_doubtful(s);
  s->winding.far_factor = far_factor_of_caps;
  done = laves__surface_find_segments(s, c);
clean_up:
  laves__free(s->context, keep, count, sizeof *keep);
  return done;
}

/* Volume about the middle of the surface, which tells in from out for open surfaces, too. */
static double central_volume(const laves__surface *s) {
  const laves__vec3 centre = box3_centre(box_of(s->points, s->point_count));
  double volume6 = 0;
  for (size_t f = 0; f < s->face_count; f++)
    volume6 += v3_det(centre, s->points[s->faces[f][0]], s->points[s->faces[f][1]], s->points[s->faces[f][2]]);
  return volume6 / 6;
}

/* Most edges unmatched: unconnected triangles, whose winding number means nothing. Or no inside at all: a sheet, or a closed
 * surface that is flat. */
static bool encloses_nothing(const laves__surface *s, const laves_domain_info *info) {
  if (!s->open) return !(info->volume > 0);
  return s->rim_tree.count > 3 * s->all_face_count / 2 ||
         laves__surface_inside_share(s, box_of(s->points, s->point_count)) < enclosed_min;
}

static bool mend(laves__surface *s, const laves_domain_info *info) {
  if (!laves__surface_mend(s, info->defects[LAVES_DEFECT_OPEN_EDGE])) return false;
  laves__bvh_free(s->context, &s->bvh);
  return build_tree(s, NULL) && renew_topology(s, info);
}

static bool solve(laves__surface *s, laves_domain_info *info) {
  laves__crossings crossings = {0};
  bool done = false;
  s->face_flags = laves__alloc_zeroed(s->context, s->face_capacity, sizeof *s->face_flags);
  if (!s->face_flags || !build_tree(s, NULL) || !laves__surface_topology(s, info)) goto clean_up;
  if (!laves__surface_crossings(s, &crossings)) goto clean_up;
  note_crossings(s, &crossings, info);
  const size_t judged = s->face_count;
  if (!info->closed) {
    laves__crossings_free(s->context, &crossings);
    if (!mend(s, info) || !laves__surface_crossings(s, &crossings)) goto clean_up;
  }
  if (central_volume(s) < 0) {
    for (uint32_t f = 0; f < s->face_count; f++) turn_face(s, f);
    info->turned = true;
    if (!renew_topology(s, info)) goto clean_up;
  }
  laves__surface_measure(s, &info->volume, &info->area);
  if ((s->rim_count > 0 || crossings.count > 0 || info->component_count > 1 || any_doubt(s)) && !laves__surface_find_parts(s))
    goto clean_up;
  if (s->rim_count > 0) {
    if (!solve_open(s, &crossings, info)) goto clean_up;
  } else if (crossings.count > 0 || info->component_count > 1 || any_doubt(s)) {
    if (!solve_union(s, &crossings, info)) goto clean_up;
  }
  done = laves__surface_normals(s);
  if (done && s->face_count == judged) done = laves__surface_genus(s, info);
clean_up:
  laves__crossings_free(s->context, &crossings);
  return done;
}

static void to_input(laves__vec3 p, laves__vec3 origin, double out[3]) {
  out[0] = p.x + origin.x;
  out[1] = p.y + origin.y;
  out[2] = p.z + origin.z;
}

static void fill_domain(laves__surface *s, laves__surface_input *input, laves__vec3 origin, laves_domain *domain) {
  laves_domain_info *info = &domain->info;
  laves__oracle *oracle = &domain->oracle;
  oracle->origin = origin;
  oracle->bounds = box_of(s->points, s->point_count);
  oracle->volume = info->volume;
  oracle->area = info->area;
  laves__surface_oracle(s, oracle);
  to_input(oracle->bounds.lower, origin, info->lower);
  to_input(oracle->bounds.upper, origin, info->upper);
  for (int d = 0; d < LAVES_DEFECT_COUNT; d++)
    if (info->defects[d])
      to_input(v3(info->defect_place[d][0], info->defect_place[d][1], info->defect_place[d][2]), origin, info->defect_place[d]);
  memcpy(domain->format, input->format, sizeof domain->format);
  info->kind = LAVES_DOMAIN_SURFACE;
  info->point_count = s->point_count;
  info->triangle_count = s->face_count;
  if (!input->tags) return;
  domain->tag_names = input->tag_names;
  info->tag_count = input->tag_names ? input->tag_count : 0;
  input->tag_names = NULL;
  input->tag_count = 0;
}

laves_result laves__surface_build(laves_context *context, laves__surface_input *input, laves_domain *domain, laves_error *error) {
  laves_result result = LAVES_OK;
  laves__surface *s = NULL;
  const laves__box3 box = used_box(context, input);
  const double diagonal = box3_diagonal(box);
  if (laves__is_cancelled(context)) {
    result = laves__fail_cancelled(error);
    goto clean_up;
  }
  if (input->triangle_count == 0) {
    result = laves__fail(error, LAVES_ERROR_INPUT, "the surface has no triangles");
    goto clean_up;
  }
  if (input->triangle_count >= LAVES__FACES_MAX || input->point_count >= LAVES__NONE) {
    result = laves__fail(error, LAVES_ERROR_INPUT, "the surface has %zu triangles; at most %d can be handled",
                         input->triangle_count, LAVES__FACES_MAX - 1);
    goto clean_up;
  }
  if (!(diagonal >= diagonal_min && diagonal <= diagonal_max)) {
    result = laves__fail(error, LAVES_ERROR_INPUT,
                         "the surface is %g wide, which arithmetic cannot handle; scale it to between %g and %g", diagonal,
                         diagonal_min, diagonal_max);
    goto clean_up;
  }
  s = laves__alloc_zeroed(context, 1, sizeof *s);
  if (!s) {
    result = laves__fail_memory(context, error);
    goto clean_up;
  }
  s->context = context;
  s->diagonal = diagonal;
  const laves__vec3 origin = choose_origin(box);
  if (!laves__surface_weld(s, input, origin, &domain->info)) {
    result = laves__fail_memory(context, error);
    goto clean_up;
  }
  if (s->face_count == 0) {
    result = laves__fail(error, LAVES_ERROR_INPUT, "all %zu triangles of the surface are without area", input->triangle_count);
    goto clean_up;
  }
  if (!solve(s, &domain->info)) {
    result = laves__fail_memory(context, error);
    goto clean_up;
  }
  if (encloses_nothing(s, &domain->info)) {
    const laves_domain_info *info = &domain->info;
    result =
        laves__fail(error, LAVES_ERROR_INPUT,
                    "the surface encloses no volume: %zu triangles in %zu unconnected parts, with %zu open edges; close it, or "
                    "check that it is a solid's surface",
                    input->triangle_count, info->component_count, info->defects[LAVES_DEFECT_OPEN_EDGE]);
    goto clean_up;
  }
  fill_domain(s, input, origin, domain);
  s = NULL;
clean_up:
  laves__surface_free(context, s);
  laves__surface_input_free(context, input);
  return result;
}
