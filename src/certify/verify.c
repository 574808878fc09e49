/* Whether a certificate tells the truth of a mesh.
 *
 * The mesh is certified anew, with the windows that the certificate names; then every member is held against its counterpart as
 * the table of members says. Listed exceptions are compared one by one, those that need the surface only where it is given. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "certify/certify.h"
#include "io/certificate_table.h"

/* Relative. Figures are sums in a fixed order over the same doubles, so they are equal to the last bits on any machine that has
 * the same arithmetic; what is left is for C libraries whose acos differ. */
#define CLOSE 1e-9
/* For distances, which an iteration may have found. */
#define SURFACE_CLOSE 1e-6

typedef struct comparing {
  const laves_certificate *stated, *found;
  bool has_surface, has_input;
  laves_difference *differences;
  size_t capacity, count;
} comparing;

static void differ(comparing *c, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void differ(comparing *c, const char *format, ...) {
  if (c->count++ >= c->capacity) return;
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(c->differences[c->count - 1].text, sizeof c->differences[0].text, format, arguments);
  va_end(arguments);
}

/* Numbers that are unknown are equal to one another. */
static bool same_number(double a, double b, double tolerance, double scale) {
  if (!isfinite(a) || !isfinite(b)) return !isfinite(a) && !isfinite(b);
  return fabs(a - b) <= tolerance * fmax(scale, fmax(fabs(a), fabs(b)));
}

/* ---- members ---- */

static void compare_text(comparing *c, const laves__member *m, const char *stated, const char *found) {
  if (strcmp(stated, found) == 0 || (m->proof == LAVES__PROOF_INPUT && (!stated[0] || !found[0]))) return;
  differ(c, "%s.%s: the certificate says '%.70s', and it is '%.70s'", m->group, m->name, stated, found);
}

static void compare_count(comparing *c, const laves__member *m, size_t stated, size_t found) {
  if (stated != found) differ(c, "%s.%s: the certificate says %zu, and it is %zu", m->group, m->name, stated, found);
}

static void compare_numbers(comparing *c, const laves__member *m, const double *stated, const double *found) {
  const bool by_surface = m->proof == LAVES__PROOF_SURFACE || m->proof == LAVES__PROOF_FEATURE;
  const bool is_length = m->proof == LAVES__PROOF_LENGTH || by_surface;
  const double tolerance = by_surface ? SURFACE_CLOSE : CLOSE;
  for (size_t i = 0; i < m->count; i++) {
    if (same_number(stated[i], found[i], tolerance, is_length ? c->found->check.edge_mean : 0)) continue;
    differ(c, "%s.%s: the certificate says %.12g, and it is %.12g", m->group, m->name, stated[i], found[i]);
    return;
  }
}

static void compare_member(comparing *c, const laves__member *m) {
  const void *stated = (const char *)c->stated + m->offset, *found = (const char *)c->found + m->offset;
  switch (m->kind) {
    case LAVES__MEMBER_TEXT:
      compare_text(c, m, stated, found);
      break;
    case LAVES__MEMBER_LATER:
      if (*(const size_t *)stated != SIZE_MAX) compare_count(c, m, *(const size_t *)stated, *(const size_t *)found);
      break;
    case LAVES__MEMBER_COUNT:
      for (size_t i = 0; i < m->count; i++) compare_count(c, m, ((const size_t *)stated)[i], ((const size_t *)found)[i]);
      break;
    case LAVES__MEMBER_INTEGER:
      if (*(const int64_t *)stated != *(const int64_t *)found)
        differ(c, "%s.%s: the certificate says %lld, and it is %lld", m->group, m->name, (long long)*(const int64_t *)stated,
               (long long)*(const int64_t *)found);
      break;
    case LAVES__MEMBER_NUMBER:
      compare_numbers(c, m, stated, found);
      break;
    case LAVES__MEMBER_FLAG:
      if (*(const bool *)stated != *(const bool *)found)
        differ(c, "%s.%s: the certificate says %s, which is not so", m->group, m->name, *(const bool *)stated ? "true" : "false");
      break;
    default:
      break;
  }
}

/* Whether the same features can be looked for again. */
static bool has_features(const comparing *c) {
  return c->has_surface && c->stated->check.has_distance && c->stated->has_features && !c->stated->features_drawn;
}

/* Whether a member can be recomputed with what is at hand. */
static bool has_proof(const comparing *c, const laves__member *m) {
  switch (m->proof) {
    case LAVES__PROOF_NONE:
      return false;
    case LAVES__PROOF_SURFACE:
      return c->has_surface && c->stated->check.has_distance;
    case LAVES__PROOF_FEATURE:
      return has_features(c);
    case LAVES__PROOF_INPUT:
      return c->has_input && c->stated->has_input;
    default:
      return true;
  }
}

/* ---- exceptions ---- */

static bool needs_surface(laves_exception_kind kind) {
  return kind == LAVES_EXCEPTION_DISTANT || kind == LAVES_EXCEPTION_OFF_SURFACE || kind == LAVES_EXCEPTION_THIN;
}

static bool needs_features(laves_exception_kind kind) { return kind >= LAVES_EXCEPTION_CREASE_LOST; }

static bool can_compare(const comparing *c, laves_exception_kind kind) {
  if (needs_features(kind)) return has_features(c);
  return !needs_surface(kind) || (c->has_surface && c->stated->check.has_distance);
}

/* The next listed exception from number `i` on that can be compared; their count when there is none. */
static size_t next_listed(const comparing *c, const laves_certificate *of, size_t i) {
  while (i < of->exception_count && !can_compare(c, of->exceptions[i].kind)) i++;
  return i;
}

static bool same_exception(const comparing *c, const laves_exception *a, const laves_exception *b) {
  const double tolerance = needs_surface(a->kind) || needs_features(a->kind) ? SURFACE_CLOSE : CLOSE,
               edge = c->found->check.edge_mean;
  bool same = a->kind == b->kind && a->index == b->index && same_number(a->value, b->value, tolerance, edge);
  /* Where a crease was drawn that is not at hand, the cause that it is cannot be found again. */
  if (c->has_surface && c->stated->has_input && !c->stated->features_drawn) same = same && a->cause == b->cause;
  if (has_features(c)) same = same && same_number(a->crease_angle, b->crease_angle, SURFACE_CLOSE, 0);
  for (int i = 0; i < 3; i++) same = same && same_number(a->place[i], b->place[i], tolerance, edge);
  return same;
}

static void compare_exceptions(comparing *c) {
  const laves_certificate *stated = c->stated, *found = c->found;
  for (int kind = 0; kind < LAVES_EXCEPTION_COUNT; kind++) {
    if (!can_compare(c, (laves_exception_kind)kind)) continue;
    if (stated->exception_counts[kind] != found->exception_counts[kind])
      differ(c, "exceptions.counts.%s: the certificate says %zu, and it is %zu", laves_exception_key((laves_exception_kind)kind),
             stated->exception_counts[kind], found->exception_counts[kind]);
  }
  if (has_features(c) && !found->has_features)
    differ(c, "features: the certificate tells of creases or corners, and the surface has none");
  size_t i = next_listed(c, stated, 0), j = next_listed(c, found, 0);
  for (; i < stated->exception_count && j < found->exception_count;
       i = next_listed(c, stated, i + 1), j = next_listed(c, found, j + 1))
    if (!same_exception(c, &stated->exceptions[i], &found->exceptions[j]))
      differ(c, "exceptions.listed[%zu]: the certificate tells of another exception than is found there", i);
  if (i < stated->exception_count) differ(c, "exceptions.listed: the certificate lists more than there are");
  if (j < found->exception_count) differ(c, "exceptions.listed: the certificate lists fewer than there are");
}

/* ---- all ---- */

/* What asked and promised, as the certificate says it. */
static laves_certify_options options_of(const laves_certificate *stated, const laves_domain *domain, const char *input) {
  laves_certify_options options = laves_certify_options_default();
  options.domain = domain;
  options.input = input;
  options.distances = stated->check.has_distance;
  options.promised_min_dihedral = stated->promised_min_dihedral;
  options.promised_max_dihedral = stated->promised_max_dihedral;
  options.min_dihedral = stated->asked_min_dihedral;
  options.max_dihedral = stated->asked_max_dihedral;
  options.volume_length = stated->asked_volume_length;
  const laves_feature_check *features = &stated->features;
  if (stated->has_features && features->angle >= 1 && features->angle <= 179) options.feature_angle = features->angle;
  if (stated->has_features && features->size > 0 && isfinite(features->size)) options.feature_size = features->size;
  options.feature_tags = stated->has_features && stated->features_tags;
  return options;
}

laves_result laves_certificate_verify(laves_context *context, const laves_mesh *mesh, const laves_domain *domain,
                                      const char *input, const laves_certificate *certificate, laves_difference *differences,
                                      size_t capacity, size_t *count, laves_error *error) {
  const laves_result held = laves__mesh_require_arrays(mesh, "a certificate", error);
  if (held != LAVES_OK) return held;
  *count = 0;
  laves_certificate *found = laves__alloc(context, 1, sizeof *found);
  if (!found) return laves__fail_memory(context, error);
  const laves_certify_options options = options_of(certificate, domain, input);
  const laves_result result = laves_certify(context, mesh, &options, found, error);
  comparing c = {.stated = certificate,
                 .found = found,
                 .has_surface = domain != NULL,
                 .has_input = input != NULL,
                 .differences = differences,
                 .capacity = capacity};
  if (result == LAVES_OK) {
    for (size_t i = 0; i < laves__certificate_member_count; i++)
      if (has_proof(&c, &laves__certificate_members[i])) compare_member(&c, &laves__certificate_members[i]);
    compare_exceptions(&c);
    *count = c.count;
  }
  laves__free(context, found, 1, sizeof *found);
  return result;
}
