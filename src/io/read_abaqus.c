/* Tetrahedra of Abaqus input files (.inp), as CalculiX reads them, too: *NODE, *ELEMENT of the kinds C3D4 and C3D10 (with their
 * variants) and of triangles, *ELSET and *SURFACE.
 *
 * A set of tetrahedra named by *ELEMENT or *ELSET is a region, by the first of the sets that holds it; a set of triangles, or a
 * *SURFACE of faces of tetrahedra, is a tag. Both count from 1 in the order of the file and keep their names. What else there is
 * (materials, steps, loads) is passed over. A file with several parts has to number their nodes differently. Lines are fields
 * with commas between; one that ends with a comma goes on in the next. Source: "Abaqus Keywords Reference Manual", Dassault
 * Systemes. */
#include <stdlib.h>
#include <string.h>

#include "io/mesh_input.h"
#include "io/scan.h"

enum { SETS_MAX = 4096, FIELDS_MAX = 32, NODES_MAX = 10 };
/* Elements that sets may be found to hold, for each element and each byte of the file: sets that overlap more are no mesh's. */
static const size_t work_share = 8;

typedef enum card { CARD_OTHER, CARD_NODE, CARD_ELEMENT, CARD_ELSET, CARD_SURFACE } card;

/* An element by its number, and what it has become: a tet, or a face behind the tets. */
typedef struct element {
  int64_t number;
  int32_t place;
  bool is_face;
} element;

typedef struct node {
  int64_t number;
  int32_t place;
} node;

/* What a set or surface has: the elements first, first + step, ... last; or another set. */
typedef struct member {
  int32_t owner; /* the set, by its place */
  int32_t set;   /* of which it has all; -1: numbers */
  int32_t side;  /* of tets, 1 to 4, for surfaces; 0: the element itself */
  int64_t first, last, step;
  int64_t next; /* member of the same set, -1: none */
} member;

typedef struct named_set {
  laves__word name;
  bool is_surface;
  int32_t region, tag;               /* 0: none yet */
  int64_t first_member, last_member; /* -1: none */
} named_set;

typedef struct abaqus {
  laves__mesh_input *input;
  const char *at;   /* behind the line in hand */
  const char *line; /* its begin */
  laves__word field[FIELDS_MAX];
  int field_count;
  card card;
  int corners, nodes; /* of the elements of the card; 0: passed over */
  int32_t set;        /* into which the card puts them, or that it fills; -1: none */
  bool generates;
  node *node;
  size_t node_count, node_capacity;
  element *element;
  size_t element_count, element_capacity;
  int64_t (*row)[NODES_MAX]; /* [element_count] node numbers of each element */
  size_t row_capacity;
  named_set *sets;
  size_t set_count, set_capacity;
  member *members;
  size_t member_count, member_capacity;
  size_t work; /* that sets may still cost */
} abaqus;

/* ---- lines ---- */

static laves_result fail_line(const abaqus *a, laves_error *error, const char *sentence, laves__word word) {
  laves__scan scan = laves__scan_begin(a->input->name, a->input->begin, (size_t)(a->input->end - a->input->begin));
  char quote[LAVES__QUOTE_SIZE];
  scan.at = a->line;
  return laves__scan_fail(&scan, error, "%s, not '%s'", sentence, laves__quote(word, quote));
}

static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

static laves__word trimmed(const char *begin, const char *end) {
  while (begin < end && is_blank(*begin)) begin++;
  while (end > begin && is_blank(end[-1])) end--;
  return (laves__word){begin, (size_t)(end - begin)};
}

/* Cuts the next line that is no comment into fields; false at the end of the file. */
static bool next_line(abaqus *a) {
  const char *end = a->input->end;
  while (a->at < end) {
    const char *begin = a->line = a->at, *stop = memchr(begin, '\n', (size_t)(end - begin));
    if (!stop) stop = end;
    a->at = stop < end ? stop + 1 : end;
    const laves__word all = trimmed(begin, stop);
    if (all.length == 0 || (all.length >= 2 && all.at[0] == '*' && all.at[1] == '*')) continue;
    a->field_count = 0;
    for (const char *from = all.at, *last = all.at + all.length; from <= last && a->field_count < FIELDS_MAX;) {
      const char *comma = memchr(from, ',', (size_t)(last - from));
      if (!comma) comma = last;
      a->field[a->field_count++] = trimmed(from, comma);
      from = comma + 1;
    }
    return true;
  }
  return false;
}

static bool field_integer(laves__word field, int64_t *value) {
  const char *end = field.at + field.length;
  return field.length > 0 && laves__parse_int(field.at, end, value) == end;
}

/* A real, of which Fortran's way with d for e is one. */
static bool field_real(laves__word field, double *value) {
  char text[64];
  if (field.length == 0 || field.length >= sizeof text) return false;
  for (size_t i = 0; i < field.length; i++) text[i] = field.at[i] == 'd' || field.at[i] == 'D' ? 'e' : field.at[i];
  return laves__parse_double(text, text + field.length, value) == text + field.length;
}

/* The value of "name=value" among the fields of a card. */
static bool parameter(const abaqus *a, const char *name, laves__word *value) {
  for (int i = 1; i < a->field_count; i++) {
    const laves__word f = a->field[i];
    const char *equals = memchr(f.at, '=', f.length);
    if (!laves__word_is(trimmed(f.at, equals ? equals : f.at + f.length), name)) continue;
    *value = equals ? trimmed(equals + 1, f.at + f.length) : (laves__word){f.at, 0};
    return true;
  }
  return false;
}

/* ---- sets ---- */

static bool same_name(laves__word a, laves__word b) {
  if (a.length != b.length) return false;
  for (size_t i = 0; i < a.length; i++) {
    const char x = a.at[i], y = b.at[i];
    if (x != y && !((x ^ y) == 32 && (x | 32) >= 'a' && (x | 32) <= 'z')) return false;
  }
  return true;
}

/* The set of a name; made where there is none, -1 where there are too many. False when memory is short. */
static bool find_set(abaqus *a, laves__word name, bool is_surface, int32_t *set) {
  *set = -1;
  for (size_t i = 0; i < a->set_count; i++)
    if (a->sets[i].is_surface == is_surface && same_name(a->sets[i].name, name)) {
      *set = (int32_t)i;
      return true;
    }
  if (a->set_count == SETS_MAX) return true;
  if (!laves__grow(a->input->context, &a->sets, &a->set_capacity, a->set_count + 1, sizeof *a->sets)) return false;
  a->sets[a->set_count] = (named_set){.name = name, .is_surface = is_surface, .first_member = -1, .last_member = -1};
  *set = (int32_t)a->set_count++;
  return true;
}

static laves_result add_member(abaqus *a, const member *m, laves_error *error) {
  if (!laves__grow(a->input->context, &a->members, &a->member_capacity, a->member_count + 1, sizeof *a->members))
    return laves__fail_memory(a->input->context, error);
  named_set *owner = &a->sets[m->owner];
  const int64_t place = (int64_t)a->member_count++;
  a->members[place] = *m;
  a->members[place].next = -1;
  if (owner->first_member < 0)
    owner->first_member = place;
  else
    a->members[owner->last_member].next = place;
  owner->last_member = place;
  return LAVES_OK;
}

/* The element of a card goes into the card's set; runs of numbers are one member. */
static laves_result add_to_set(abaqus *a, int64_t number, laves_error *error) {
  if (a->set < 0) return LAVES_OK;
  const int64_t last = a->sets[a->set].last_member;
  member *m = last >= 0 ? &a->members[last] : NULL;
  if (m && m->set < 0 && m->step == 1 && m->last < INT64_MAX && m->last + 1 == number) {
    m->last = number;
    return LAVES_OK;
  }
  return add_member(a, &(member){.owner = a->set, .set = -1, .first = number, .last = number, .step = 1}, error);
}

/* A line of *ELSET: numbers or names of sets; or first, last, step. */
static laves_result read_elset(abaqus *a, laves_error *error) {
  if (a->set < 0) return LAVES_OK;
  member m = {.owner = a->set, .set = -1, .step = 1};
  if (a->generates) {
    if (a->field_count < 2 || !field_integer(a->field[0], &m.first) || !field_integer(a->field[1], &m.last))
      return fail_line(a, error, "expected the first and the last number of a set", a->field[0]);
    if (a->field_count > 2 && a->field[2].length > 0 && (!field_integer(a->field[2], &m.step) || m.step < 1))
      return fail_line(a, error, "the step of a set must be 1 or more", a->field[2]);
    return add_member(a, &m, error);
  }
  laves_result result = LAVES_OK;
  for (int i = 0; i < a->field_count && result == LAVES_OK; i++) {
    if (a->field[i].length == 0) continue;
    m.set = -1;
    if (field_integer(a->field[i], &m.first))
      m.last = m.first;
    else if (!find_set(a, a->field[i], false, &m.set))
      return laves__fail_memory(a->input->context, error);
    if (m.set != a->set) result = add_member(a, &m, error);
  }
  return result;
}

/* A line of *SURFACE: an element or a set, and a side of it. Other sides than those of tets are passed over. */
static laves_result read_surface(abaqus *a, laves_error *error) {
  if (a->set < 0 || a->field_count == 0) return LAVES_OK;
  member m = {.owner = a->set, .set = -1, .step = 1};
  if (field_integer(a->field[0], &m.first))
    m.last = m.first;
  else if (!find_set(a, a->field[0], false, &m.set))
    return laves__fail_memory(a->input->context, error);
  const laves__word side = a->field_count > 1 ? a->field[1] : (laves__word){"", 0};
  if (side.length == 2 && (side.at[0] | 32) == 's' && side.at[1] >= '1' && side.at[1] <= '4') m.side = side.at[1] - '0';
  return side.length == 0 || m.side > 0 ? add_member(a, &m, error) : LAVES_OK;
}

/* ---- nodes and elements ---- */

static laves_result read_node(abaqus *a, laves_error *error) {
  laves__mesh_input *input = a->input;
  node n = {.place = (int32_t)input->point_count};
  laves__vec3 p = {0, 0, 0};
  if (!field_integer(a->field[0], &n.number)) return fail_line(a, error, "expected the number of a node", a->field[0]);
  double *coordinates[3] = {&p.x, &p.y, &p.z};
  for (int i = 0; i < 3; i++)
    if (i + 1 < a->field_count && a->field[i + 1].length > 0 && !field_real(a->field[i + 1], coordinates[i]))
      return fail_line(a, error, "expected a coordinate", a->field[i + 1]);
  if (input->point_count == INT32_MAX) return laves__mesh_input_fail(input, error, "it has more than 2147483647 nodes");
  if (!laves__mesh_input_add_point(input, p) ||
      !laves__grow(input->context, &a->node, &a->node_capacity, a->node_count + 1, sizeof *a->node))
    return laves__fail_memory(input->context, error);
  a->node[a->node_count++] = n;
  return LAVES_OK;
}

/* An element's nodes may go over several lines. */
static laves_result read_element(abaqus *a, laves_error *error) {
  laves_context *context = a->input->context;
  element e = {.is_face = a->corners == 3};
  int64_t row[NODES_MAX] = {0};
  if (a->corners == 0) return LAVES_OK;
  if (!field_integer(a->field[0], &e.number)) return fail_line(a, error, "expected the number of an element", a->field[0]);
  for (int i = 0, at = 1; i < a->nodes; i++, at++) {
    if (at == a->field_count || (at == a->field_count - 1 && a->field[at].length == 0)) {
      if (!next_line(a)) return fail_line(a, error, "the file ends within an element", (laves__word){"", 0});
      at = 0;
    }
    if (!field_integer(a->field[at], &row[i])) return fail_line(a, error, "expected the number of a node", a->field[at]);
  }
  const size_t needed = a->element_count + 1;
  if (!laves__grow(context, &a->element, &a->element_capacity, needed, sizeof *a->element) ||
      !laves__grow(context, &a->row, &a->row_capacity, needed, sizeof *a->row))
    return laves__fail_memory(context, error);
  memcpy(a->row[a->element_count], row, sizeof row);
  e.place = (int32_t)a->element_count; /* until all nodes are known */
  a->element[a->element_count++] = e;
  if (a->element_count == INT32_MAX) return laves__mesh_input_fail(a->input, error, "it has too many elements");
  return add_to_set(a, e.number, error);
}

/* Kinds of elements, with what may follow their name, such as C3D10MH. */
static void choose_kind(abaqus *a, laves__word type) {
  static const struct {
    const char *name;
    int corners, nodes;
  } kinds[] = {{"C3D10", 4, 10}, {"C3D4", 4, 4}, {"DC3D10", 4, 10}, {"DC3D4", 4, 4},  {"STRI65", 3, 6}, {"STRI3", 3, 3},
               {"S3", 3, 3},     {"S6", 3, 6},   {"CPS3", 3, 3},    {"CPE3", 3, 3},   {"CPS6", 3, 6},   {"CPE6", 3, 6},
               {"M3D3", 3, 3},   {"M3D6", 3, 6}, {"R3D3", 3, 3},    {"SFM3D3", 3, 3}, {"SFM3D6", 3, 6}};
  a->corners = a->nodes = 0;
  for (size_t i = 0; i < LAVES__COUNT_OF(kinds); i++) {
    const size_t length = strlen(kinds[i].name);
    const bool more = type.length > length && type.at[length] >= '0' && type.at[length] <= '9';
    if (type.length < length || more || !laves__word_is((laves__word){type.at, length}, kinds[i].name)) continue;
    a->corners = kinds[i].corners;
    a->nodes = kinds[i].nodes;
    return;
  }
}

/* ---- cards ---- */

static laves_result begin_card(abaqus *a, laves_error *error) {
  const laves__word name = a->field[0];
  laves__word value;
  a->card = CARD_OTHER;
  a->set = -1;
  bool enough = true;
  if (laves__word_is(name, "*NODE")) {
    a->card = CARD_NODE;
  } else if (laves__word_is(name, "*ELEMENT")) {
    if (!parameter(a, "TYPE", &value)) return fail_line(a, error, "*ELEMENT needs a TYPE", name);
    a->card = CARD_ELEMENT;
    choose_kind(a, value);
    if (parameter(a, "ELSET", &value)) enough = find_set(a, value, false, &a->set);
  } else if (laves__word_is(name, "*ELSET") && parameter(a, "ELSET", &value)) {
    a->card = CARD_ELSET;
    enough = find_set(a, value, false, &a->set);
    a->generates = parameter(a, "GENERATE", &value);
  } else if (laves__word_is(name, "*SURFACE") && parameter(a, "NAME", &value)) {
    laves__word type;
    a->card = !parameter(a, "TYPE", &type) || laves__word_is(type, "ELEMENT") ? CARD_SURFACE : CARD_OTHER;
    if (a->card == CARD_SURFACE) enough = find_set(a, value, true, &a->set);
  } else if (laves__word_is(name, "*INCLUDE")) {
    return fail_line(a, error, "files that include others are not read", name);
  }
  return enough ? LAVES_OK : laves__fail_memory(a->input->context, error);
}

static laves_result read_line(abaqus *a, laves_error *error) {
  if (a->field[0].length > 0 && a->field[0].at[0] == '*') return begin_card(a, error);
  switch (a->card) {
    case CARD_NODE:
      return read_node(a, error);
    case CARD_ELEMENT:
      return read_element(a, error);
    case CARD_ELSET:
      return read_elset(a, error);
    case CARD_SURFACE:
      return read_surface(a, error);
    default:
      return LAVES_OK;
  }
}

/* ---- numbers become places ---- */

static int by_node_number(const void *a, const void *b) {
  const node *x = a, *y = b;
  if (x->number != y->number) return x->number < y->number ? -1 : 1;
  return x->place < y->place ? -1 : x->place > y->place;
}

static int by_element_number(const void *a, const void *b) {
  const element *x = a, *y = b;
  if (x->number != y->number) return x->number < y->number ? -1 : 1;
  return x->place < y->place ? -1 : x->place > y->place;
}

static laves_result sort_nodes(abaqus *a, laves_error *error) {
  if (a->node_count) qsort(a->node, a->node_count, sizeof *a->node, by_node_number);
  for (size_t i = 1; i < a->node_count; i++)
    if (a->node[i].number == a->node[i - 1].number)
      return laves__mesh_input_fail(a->input, error, "node %lld is given twice; parts with numbers of their own are not read",
                                    (long long)a->node[i].number);
  return LAVES_OK;
}

static int32_t find_node(const abaqus *a, int64_t number) {
  size_t low = 0, high = a->node_count;
  while (low < high) {
    const size_t middle = low + (high - low) / 2;
    if (a->node[middle].number < number)
      low = middle + 1;
    else
      high = middle;
  }
  return low < a->node_count && a->node[low].number == number ? a->node[low].place : -1;
}

/* The first element whose number is not below. */
static size_t find_element(const abaqus *a, int64_t number) {
  size_t low = 0, high = a->element_count;
  while (low < high) {
    const size_t middle = low + (high - low) / 2;
    if (a->element[middle].number < number)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/* The number of a set as region or tag; its name is added with the first. False when memory is short. */
static bool number_set(abaqus *a, int32_t set, bool faces, int32_t *number) {
  named_set *s = &a->sets[set];
  int32_t *own = faces ? &s->tag : &s->region, most = 0;
  if (*own == 0) {
    for (size_t i = 0; i < a->set_count; i++) {
      const int32_t taken = faces ? a->sets[i].tag : a->sets[i].region;
      most = taken > most ? taken : most;
    }
    *own = most + 1;
    if (!laves__mesh_input_add_group(a->input, faces ? 2 : 3, *own, s->name.at, s->name.length)) return false;
  }
  *number = *own;
  return true;
}

static laves_result add_elements(abaqus *a, laves_error *error) {
  laves__mesh_input *input = a->input;
  for (size_t i = 0; i < a->element_count; i++) {
    element *e = &a->element[i];
    const int corners = e->is_face ? 3 : 4;
    int32_t corner[4];
    for (int k = 0; k < corners; k++) {
      corner[k] = find_node(a, a->row[i][k]);
      if (corner[k] < 0)
        return laves__mesh_input_fail(input, error, "element %lld uses node %lld, which there is not", (long long)e->number,
                                      (long long)a->row[i][k]);
    }
    e->place = (int32_t)(e->is_face ? input->face_count : input->tet_count);
    const bool enough = e->is_face ? laves__mesh_input_add_face(input, corner, 0) : laves__mesh_input_add_tet(input, corner, 0);
    if (!enough) return laves__fail_memory(input->context, error);
    if (i % 65536 == 65535 && laves__mesh_input_cancelled(input, input->end)) return laves__fail_cancelled(error);
  }
  return LAVES_OK;
}

/* One element of a set or surface takes the set's number, unless it has one. */
static bool take_element(abaqus *a, const element *e, int32_t owner, int32_t side) {
  static const uint8_t sides[4][3] = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
  laves__mesh_input *input = a->input;
  int32_t number;
  if (a->sets[owner].is_surface) {
    if (e->is_face && side > 0) return true;
    if (!number_set(a, owner, true, &number)) return false;
    if (e->is_face) {
      if (input->face_tags[e->place] == 0) input->face_tags[e->place] = number;
      return true;
    }
    int32_t corner[3];
    if (side == 0) return true;
    for (int k = 0; k < 3; k++) corner[k] = input->tets[e->place][sides[side - 1][k]];
    return laves__mesh_input_add_face(input, corner, number);
  }
  int32_t *own = e->is_face ? &input->face_tags[e->place] : &input->regions[e->place];
  if (*own != 0) return true;
  if (!number_set(a, owner, e->is_face, &number)) return false;
  *own = number;
  return true;
}

static laves_result take_members(abaqus *a, int32_t set, int32_t owner, int32_t side, int depth, laves_error *error);

static laves_result take_member(abaqus *a, const member *m, int32_t owner, int32_t side, int depth, laves_error *error) {
  if (m->set >= 0) return take_members(a, m->set, owner, side, depth + 1, error);
  for (size_t i = find_element(a, m->first); i < a->element_count && a->element[i].number <= m->last; i++) {
    if (a->work-- == 0) return laves__mesh_input_fail(a->input, error, "its sets of elements overlap too often");
    if (((uint64_t)a->element[i].number - (uint64_t)m->first) % (uint64_t)m->step != 0) continue;
    if (!take_element(a, &a->element[i], owner, side)) return laves__fail_memory(a->input->context, error);
  }
  return LAVES_OK;
}

/* All that a set has, for another one. */
static laves_result take_members(abaqus *a, int32_t set, int32_t owner, int32_t side, int depth, laves_error *error) {
  enum { DEPTH_MAX = 8 };
  laves_result result = LAVES_OK;
  if (depth > DEPTH_MAX) return laves__mesh_input_fail(a->input, error, "its sets are within one another too deeply");
  for (int64_t i = a->sets[set].first_member; i >= 0 && result == LAVES_OK; i = a->members[i].next) {
    if (a->work-- == 0) return laves__mesh_input_fail(a->input, error, "its sets of elements overlap too often");
    const member m = a->members[i];
    result = take_member(a, &m, owner, side, depth, error);
  }
  return result;
}

/* Sets in the order of their lines, surfaces after all sets. */
static laves_result take_sets(abaqus *a, laves_error *error) {
  laves_result result = LAVES_OK;
  for (int surfaces = 0; surfaces < 2; surfaces++)
    for (size_t i = 0; i < a->member_count && result == LAVES_OK; i++) {
      const member m = a->members[i];
      if (a->sets[m.owner].is_surface == (surfaces > 0)) result = take_member(a, &m, m.owner, m.side, 0, error);
    }
  return result;
}

/* What no set has is a region of its own where others are sets; it comes last. */
static void number_rest(abaqus *a) {
  int32_t most = 0;
  for (size_t i = 0; i < a->set_count; i++) most = a->sets[i].region > most ? a->sets[i].region : most;
  for (size_t i = 0; i < a->input->tet_count; i++)
    if (a->input->regions[i] == 0) a->input->regions[i] = most + 1;
}

laves_result laves__read_abaqus(laves__mesh_input *input, laves_error *error) {
  laves_context *context = input->context;
  abaqus a = {.input = input, .at = input->begin, .line = input->begin, .set = -1};
  laves_result result = LAVES_OK;
  for (size_t i = 0; result == LAVES_OK && next_line(&a); i++) {
    result = read_line(&a, error);
    if (i % 65536 == 65535 && laves__mesh_input_cancelled(input, a.at)) result = laves__fail_cancelled(error);
  }
  if (result == LAVES_OK) result = sort_nodes(&a, error);
  if (result == LAVES_OK) result = add_elements(&a, error);
  for (size_t i = 0; i < a.element_count; i++) input->higher_order |= result == LAVES_OK && a.row[i][4] != 0;
  if (a.element_count) qsort(a.element, a.element_count, sizeof *a.element, by_element_number);
  a.work = work_share * (a.element_count + (size_t)(input->end - input->begin));
  if (result == LAVES_OK) result = take_sets(&a, error);
  if (result == LAVES_OK) number_rest(&a);
  laves__free(context, a.node, a.node_capacity, sizeof *a.node);
  laves__free(context, a.element, a.element_capacity, sizeof *a.element);
  laves__free(context, a.row, a.row_capacity, sizeof *a.row);
  laves__free(context, a.sets, a.set_capacity, sizeof *a.sets);
  laves__free(context, a.members, a.member_capacity, sizeof *a.members);
  return result;
}
