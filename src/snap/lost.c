/* Places where walls were trimmed or parts set apart, for people to see.
 *
 * In: the repair's list of sites.  Out: a few of them in input coordinates, with the length of the chord that is the cause.
 *
 * A chord is walked from the foot in short steps of phi, inwards through a wall and outwards through a gap; the shorter of the
 * two is named. */
#include "snap/snap.h"

enum { STEPS = 24, HALVINGS = 8 };
static const double chord_max = 1.5; /* local sizes: what is longer is not the cause */
static const double apart = 1;       /* local sizes between places that are listed */

static double phi_at(const laves__frame *frame, laves__vec3 p) {
  double phi;
  laves__frame_evaluate(frame, 1, &p, &phi, NULL);
  return phi;
}

double laves__chord(const laves__frame *frame, laves__vec3 foot, laves__vec3 normal, int side, double longest) {
  /* The first step is beyond rounding of the foot; a chord shorter than it is not seen, and as good as none. */
  double begin = longest / STEPS, end = begin;
  if (!(side * phi_at(frame, v3_mad(foot, normal, side * begin)) > 0)) return begin;
  for (int i = 2; i <= STEPS; i++) {
    end = longest * i / STEPS;
    if (!(side * phi_at(frame, v3_mad(foot, normal, side * end)) > 0)) break;
    begin = end;
  }
  if (begin == end) return INFINITY;
  for (int i = 0; i < HALVINGS; i++) {
    const double middle = 0.5 * (begin + end);
    if (side * phi_at(frame, v3_mad(foot, normal, side * middle)) > 0)
      begin = middle;
    else
      end = middle;
  }
  return end;
}

laves_thin_place laves__thin_place(const laves__frame *frame, laves__vec3 foot, laves__vec3 normal, double scale) {
  const double wall = laves__chord(frame, foot, normal, -1, chord_max * scale);
  const double gap = laves__chord(frame, foot, normal, 1, chord_max * scale);
  const int side = gap < wall ? 1 : -1;
  const double length = fmin(wall, gap);
  const laves__vec3 at = isfinite(length) ? v3_mad(foot, normal, 0.5 * side * length) : foot;
  const laves__vec3 place = laves__frame_to_input(frame, at);
  return (laves_thin_place){{place.x, place.y, place.z}, length * frame->size, side > 0 ? LAVES_THIN_GAP : LAVES_THIN_WALL};
}

bool laves__lost_is_new(const laves_thin_place *lost, size_t count, const laves_thin_place *place, double distance) {
  if (count == LAVES_LOST_CAPACITY) return false;
  const laves__vec3 p = v3(place->place[0], place->place[1], place->place[2]);
  for (size_t i = 0; i < count; i++)
    if (v3_distance(p, v3(lost[i].place[0], lost[i].place[1], lost[i].place[2])) < distance) return false;
  return true;
}

static void list_site(const laves__frame *frame, const laves__lattice *lattice, uint32_t id, laves__snap_counts *counts) {
  const laves__site s = laves__site_of(id);
  const double scale = laves__site_scale(lattice, s);
  uint32_t hint = LAVES__NO_HINT;
  laves__vec3 foot, normal;
  if (counts->lost_count == LAVES_LOST_CAPACITY) return;
  if (!laves__frame_project(frame, laves__site_place(lattice, s), chord_max * scale, &hint, &foot, &normal)) return;
  const laves_thin_place place = laves__thin_place(frame, foot, normal, scale);
  if (laves__lost_is_new(counts->lost, counts->lost_count, &place, apart * scale * frame->size))
    counts->lost[counts->lost_count++] = place;
}

void laves__list_lost(const laves__frame *frame, const laves__lattice *lattice, const laves__parted *parted,
                      laves__snap_counts *counts) {
  for (size_t i = 0; i < parted->trimmed_count; i++) list_site(frame, lattice, parted->trimmed[i], counts);
  for (size_t i = 0; i < parted->count; i++) list_site(frame, lattice, parted->item[i].site, counts);
}
