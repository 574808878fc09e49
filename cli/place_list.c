/* A list of the worst places of a mesh. */
#include "place_list.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "text.h"

bool place_list_make(place_list *list, int64_t capacity) {
  list->capacity = (size_t)capacity;
  list->places = calloc(list->capacity + 1, sizeof *list->places);
  for (size_t i = 0; i < LAVES_PLACE_CAPACITY; ++i) list->crease_angles[i] = NAN;
  return list->places != NULL;
}

void place_list_free(place_list *list) {
  free(list->places);
  list->places = NULL;
}

size_t place_list_listed(const place_list *list) { return list->found < list->capacity ? list->found : list->capacity; }

/* Known of the first places, which the certificate lists. */
static double crease_angle(const place_list *list, size_t i) { return i < LAVES_PLACE_CAPACITY ? list->crease_angles[i] : NAN; }

static void say_place(const place_list *list, size_t i) {
  const laves_place *at = &list->places[i];
  text_buffer place;
  char curvature[60] = "";
  if (isfinite(at->curvature_radius)) snprintf(curvature, sizeof curvature, ", curvature radius %.3g", at->curvature_radius);
  if (isfinite(crease_angle(list, i)))
    snprintf(curvature, sizeof curvature, ", on a crease of %.2f%s", crease_angle(list, i), text_degree());
  if (at->value < 1) {
    text_say("    tet %lld: volume-length %.3f at %s%s", (long long)at->tet, at->value, text_place(&place, at->place), curvature);
  } else {
    text_say("    tet %lld: %.2f%s at %s%s", (long long)at->tet, at->value, text_degree(), text_place(&place, at->place),
             curvature);
  }
}

void place_list_say_window(const place_list *list, const laves_options *window) {
  text_buffer count;
  if (list->found == 0) {
    text_say("  every tet within %g .. %g%s, volume-length at least %g", window->min_dihedral, window->max_dihedral,
             text_degree(), window->volume_length);
    return;
  }
  text_say("  %s outside %g .. %g%s or below volume-length %g%s", text_plural(&count, list->found, "tet"), window->min_dihedral,
           window->max_dihedral, text_degree(), window->volume_length, list->capacity ? "; the worst:" : "");
  for (size_t i = 0; i < place_list_listed(list); ++i) say_place(list, i);
}

void place_list_write_json(json *out, const char *key, const place_list *list) {
  json_open_array(out, key);
  for (size_t i = 0; i < place_list_listed(list); ++i) {
    json_open_object(out, NULL);
    json_numbers(out, "place", list->places[i].place, 3);
    json_number(out, "value", list->places[i].value);
    json_integer(out, "tet", list->places[i].tet);
    json_number(out, "curvature_radius", list->places[i].curvature_radius);
    json_number(out, "crease_angle", crease_angle(list, i));
    json_close(out);
  }
  json_close(out);
}

laves_options check_window(const settings *given) {
  laves_options window = laves_options_default();
  if (given->window.given) {
    window.min_dihedral = given->window.values[0];
    window.max_dihedral = given->window.values[1];
  }
  if (given->volume_length >= 0) window.volume_length = given->volume_length;
  return window;
}
