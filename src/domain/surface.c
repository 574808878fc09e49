/* From the triangles of a file to an oracle.
 *
 * In: triangles as read, which are consumed.  Out: a domain: oracle, facts, tags.
 *
 *   weld -> tree -> topology -> crossings -> (mend) -> directions -> walls or open -> normals -> oracle
 *
 * Local coordinates are input minus origin. The origin is the box's centre on those axes where the centre lies further out
 * than the box is wide, where the subtraction is exact; elsewhere zero, where there is nothing to subtract. */
#include <string.h>

#include "domain/defects.h"
#include "domain/surface.h"

/* Squares, cubes and products of coordinates must stay within the range of double with room. */
static const double diagonal_min = 1e-60, diagonal_max = 1e60;

/* The caps of an open surface are as smooth as its winding number is right. */
static const double far_factor_of_caps = 3;

/* Walls that are less than one in so many faces are few. */
static const size_t few_walls = 1000;

/* Share of the box that an open surface must enclose to be taken for that of a solid. */
static const double enclosed_min = 1e-3;

/* Where a surface winds round a point more often than this, there is solid. */
static const double default_level = 0.5, level_min = 0.05, level_max = 100;
/* Closed surfaces yield whole numbers, to the error of the expansions of the winding number. */
static const double off_whole_numbers = 0.05;

static const uint32_t surface_cookie = 0x73757266;

laves_surface_options laves_surface_options_default(void) {
  return (laves_surface_options){.winding = default_level, .close_holes = true, .cookie = surface_cookie};
}

laves_result laves__surface_options_check(const laves_surface_options *options, laves_error *error) {
  const double level = options->winding;
  if (options->cookie != surface_cookie)
    return laves__fail(error, LAVES_ERROR_OPTION, "the surface options did not come from laves_surface_options_default()");
  if (!(level >= level_min && level <= level_max))
    return laves__fail(error, LAVES_ERROR_OPTION, "the winding number that is inside must be %g..%g, not %g", level_min,
                       level_max, level);
  if (!(fabs(level - round(level)) >= off_whole_numbers))
    return laves__fail(error, LAVES_ERROR_OPTION,
                       "the winding number that is inside must be at least %g off whole numbers, which closed surfaces yield, "
                       "not %g; %g or %g tells them apart",
                       off_whole_numbers, level, round(level) - 0.5 > 0 ? round(level) - 0.5 : 0.5, round(level) + 0.5);
  if ((unsigned)options->overlap > LAVES_OVERLAP_NESTED)
    return laves__fail(error, LAVES_ERROR_OPTION, "there is no meaning number %d of overlapping parts", (int)options->overlap);
  return LAVES_OK;
}

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

void laves__surface_turn_face(laves__surface *s, uint32_t f) {
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
    laves__surface_turn_face(s, f);
  }
  if (!any) return true;
  info->turned = true;
  laves__winding_free(s->context, &s->winding);
  return renew_topology(s, info) && laves__winding_build(s->context, &s->bvh, &s->winding) &&
         laves__surface_find_walls(s, keep, inverted);
}

/* Closed, but in several parts, crossing itself, not manifold, or asked for where it winds round more than once: the union of
 * what it encloses so often. */
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
  if (!laves__surface_cut(s, c)) goto clean_up;
  laves__surface_measure(s, &info->volume, &info->area);
  if (c->count > 0 || s->level > 1) info->volume = laves__surface_union_volume(s);
  done = true;
clean_up:
  laves__free(s->context, keep, count, sizeof *keep);
  laves__free(s->context, inverted, count, sizeof *inverted);
  return done;
}

/* Open: {winding number = level}. */
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
  done = laves__surface_cut(s, c);
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
         !laves__surface_encloses(s, box_of(s->points, s->point_count), enclosed_min);
}

/* What is wrong with the surface as it was given. */
static bool judge(laves__surface *s, laves__crossings *crossings, laves_domain_info *info) {
  const bool done = build_tree(s, NULL) && laves__surface_topology(s, info) && laves__surface_crossings(s, crossings) &&
                    laves__surface_note_crossings(s, crossings, info);
  s->defects = NULL; /* what follows changes the surface */
  return done;
}

static bool mend(laves__surface *s, laves__crossings *crossings, const laves_domain_info *info) {
  laves__crossings_free(s->context, crossings);
  if (!laves__surface_mend(s, info->defects[LAVES_DEFECT_OPEN_EDGE])) return false;
  laves__bvh_free(s->context, &s->bvh);
  return build_tree(s, NULL) && renew_topology(s, info) && laves__surface_crossings(s, crossings);
}

/* One closed manifold part that crosses nothing: the normals of its faces tell the solid. */
static bool is_simple(const laves__surface *s, const laves__crossings *crossings, const laves_domain_info *info) {
  return s->rim_count == 0 && crossings->count == 0 && info->component_count == 1 && s->level < 1 && !any_doubt(s);
}

/* The whole faces outwards, and parts as they are wanted to. */
static bool face_outwards(laves__surface *s, const laves__crossings *crossings, laves_domain_info *info) {
  if (central_volume(s) < 0) {
    for (uint32_t f = 0; f < s->face_count; f++) laves__surface_turn_face(s, f);
    info->turned = true;
    if (!renew_topology(s, info)) return false;
  }
  if (is_simple(s, crossings, info)) return true;
  bool any_turned;
  if (!laves__surface_find_parts(s) || !laves__surface_direct_parts(s, crossings, info, &any_turned)) return false;
  return !any_turned || renew_topology(s, info);
}

static laves_result refuse_holes(const laves__surface *s, laves_error *error) {
  const uint32_t half = s->rim[0], *face = s->faces[half / 3];
  const laves__vec3 p = v3_add(v3_lerp(s->points[face[half % 3]], s->points[face[(half % 3 + 1) % 3]], 0.5), s->origin);
  return laves__fail(error, LAVES_ERROR_INPUT,
                     "the surface is open: %zu edges stay open once cracks are mended, one near (%.6g, %.6g, %.6g); close it, or "
                     "let its holes be closed",
                     s->rim_count, p.x, p.y, p.z);
}

static laves_result solve(laves__surface *s, bool close_holes, laves_domain_info *info, laves_error *error) {
  laves__crossings crossings = {0};
  laves_result result = LAVES_OK;
  s->face_flags = laves__alloc_zeroed(s->context, s->face_capacity, sizeof *s->face_flags);
  bool done = s->face_flags && judge(s, &crossings, info);
  const size_t judged = s->face_count;
  if (done && !info->closed) done = mend(s, &crossings, info);
  if (done && s->rim_count > 0 && !close_holes) {
    result = refuse_holes(s, error);
    goto clean_up;
  }
  done = done && face_outwards(s, &crossings, info);
  if (done) {
    info->open_edges_left = s->rim_count;
    laves__surface_measure(s, &info->volume, &info->area);
    if (s->rim_count > 0)
      done = solve_open(s, &crossings, info);
    else if (!is_simple(s, &crossings, info))
      done = solve_union(s, &crossings, info);
  }
  done = done && laves__surface_normals(s);
  if (done && s->face_count == judged) done = laves__surface_genus(s, info);
  if (!done && s->crowded)
    result = laves__fail(
        error, LAVES_ERROR_INPUT,
        "too many pairs of the %zu faces lie upon or across one another to be compared; it is no solid's surface", s->face_count);
  else if (!done)
    result = laves__fail_memory(s->context, error);
clean_up:
  laves__crossings_free(s->context, &crossings);
  return result;
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
  if (!s->tags) return;
  domain->tag_names = input->tag_names;
  info->tag_count = input->tag_names ? input->tag_count : 0;
  input->tag_names = NULL;
  input->tag_count = 0;
}

static laves_result check_input(const laves__surface_input *input, double diagonal, laves_error *error) {
  if (input->triangle_count == 0) return laves__fail(error, LAVES_ERROR_INPUT, "the surface has no triangles");
  if (input->triangle_count >= LAVES__FACES_MAX || input->point_count >= LAVES__NONE)
    return laves__fail(error, LAVES_ERROR_INPUT, "the surface has %zu triangles; at most %d can be handled",
                       input->triangle_count, LAVES__FACES_MAX - 1);
  if (!(diagonal >= diagonal_min && diagonal <= diagonal_max))
    return laves__fail(error, LAVES_ERROR_INPUT,
                       "the surface is %g wide, which arithmetic cannot handle; scale it to between %g and %g", diagonal,
                       diagonal_min, diagonal_max);
  return LAVES_OK;
}

static laves_result refuse_emptiness(const laves__surface *s, size_t triangle_count, const laves_domain_info *info,
                                     laves_error *error) {
  if (s->level != default_level)
    return laves__fail(error, LAVES_ERROR_INPUT,
                       "nowhere does the surface wind round enough points more than %g times, which was asked for", s->level);
  return laves__fail(error, LAVES_ERROR_INPUT,
                     "the surface encloses no volume: %zu triangles in %zu unconnected parts, with %zu open edges; close it, or "
                     "check that it is a solid's surface",
                     triangle_count, info->component_count, info->defects[LAVES_DEFECT_OPEN_EDGE]);
}

/* Weld, solve, judge. */
static laves_result make_surface(laves__surface *s, laves__surface_input *input, bool close_holes, laves_domain_info *info,
                                 laves_error *error) {
  if (!laves__surface_weld(s, input, s->origin, info)) return laves__fail_memory(s->context, error);
  laves__surface_input_free_arrays(s->context, input);
  if (s->face_count == 0)
    return laves__fail(error, LAVES_ERROR_INPUT, "all %zu triangles of the surface are without area", input->triangle_count);
  const laves_result result = solve(s, close_holes, info, error);
  if (result != LAVES_OK) return result;
  const bool empty = encloses_nothing(s, info);
  if (laves__is_cancelled(s->context)) return laves__fail_cancelled(error);
  return empty ? refuse_emptiness(s, input->triangle_count, info, error) : LAVES_OK;
}

laves_result laves__surface_build(laves_context *context, laves__surface_input *input, const laves_surface_options *options,
                                  laves_domain *domain, laves_error *error) {
  const laves_surface_options given = options ? *options : laves_surface_options_default();
  const laves__box3 box = used_box(context, input);
  laves__surface *s = NULL;
  laves_result result = laves__surface_options_check(&given, error);
  if (given.defects) laves__defects_clear(given.defects);
  if (result == LAVES_OK && laves__is_cancelled(context)) result = laves__fail_cancelled(error);
  if (result == LAVES_OK) result = check_input(input, box3_diagonal(box), error);
  if (result != LAVES_OK) goto clean_up;
  s = laves__alloc_zeroed(context, 1, sizeof *s);
  if (!s) {
    result = laves__fail_memory(context, error);
    goto clean_up;
  }
  s->context = context;
  s->diagonal = box3_diagonal(box);
  s->origin = choose_origin(box);
  s->level = domain->info.winding_level = given.winding;
  s->defects = given.defects;
  domain->info.overlap = given.overlap;
  result = make_surface(s, input, given.close_holes, &domain->info, error);
  if (given.defects) {
    laves__defects_move(given.defects, s->origin);
    if (given.defects->short_of_memory && result == LAVES_OK) result = laves__fail_memory(context, error);
  }
  if (result != LAVES_OK) goto clean_up;
  fill_domain(s, input, s->origin, domain);
  s = NULL;
clean_up:
  laves__surface_free(context, s);
  laves__surface_input_free(context, input);
  return result;
}
