/* Gmsh's MSH files, version 2.2 and 4.1, text and binary.
 *
 * A file is a row of sections "$Name ... $EndName"; unknown ones are skipped. Text and binary have the same fields in the same
 * order (but for elements in 2.2), so one function reads each section through next_int, next_size and next_double. Nodes
 * have numbers of their own, which are mapped to indices at the end: directly when they are consecutive, else by a sorted
 * table. Tets take their physical group as region and triangles as tag, or the number of their entity where they have none.
 * Point and line elements are kept where the caller asks for them; a curved line goes by its nodes.
 * Where the caller asks for values, the places of all views of scalars are noted and the wanted one is read at the end.
 * Source: Gmsh reference manual, "MSH file format" and "MSH file format version 2 (Legacy)". */
#include <stdlib.h>
#include <string.h>

#include "io/binary.h"
#include "io/line_list.h"
#include "io/mesh_input.h"
#include "io/scan.h"

enum { POINT_TYPE = 15, TYPE_MAX = 93, NODES_MAX = 125, TAGS_MAX = 1000 };

/* Nodes of each element type, 0: not known. */
static const uint8_t type_nodes[TYPE_MAX + 1] = {
    0,  2,  3,  4, 4,  8,  6,  5,  3,  6, 9, 10, 27, 18, 14, 1,         8,
    20, 15, 13, 9, 10, 12, 15, 15, 21, 4, 5, 6,  20, 35, 56, [92] = 64, [93] = 125,
};

static bool is_tet(int64_t type) { return type == 4 || type == 11 || (type >= 29 && type <= 31); }
static bool is_quad(int64_t type) { return type == 3 || type == 10 || type == 16; }
static bool is_line(int64_t type) { return type == 1 || type == 8 || (type >= 26 && type <= 28); }
static bool is_triangle(int64_t type) { return type == 2 || type == 9 || (type >= 20 && type <= 25); }

typedef struct numbered {
  int64_t number;
  int32_t value;
} numbered;

typedef struct table {
  numbered *items;
  size_t count, capacity;
} table;

/* Sections with values: one for each node; one for each element; one for each node of each element. */
typedef enum view_kind { NODE_DATA, ELEMENT_DATA, ELEMENT_NODE_DATA } view_kind;

typedef struct view {
  view_kind kind;
  const char *at; /* the first number and value */
  int64_t count;
} view;

typedef struct reader {
  laves__mesh_input *input;
  laves__scan scan; /* its place serves binary parts too */
  bool binary, swapped;
  int version;       /* 2 or 4 */
  table nodes;       /* number -> index */
  table entities[2]; /* of surfaces and volumes: number -> physical group */
  /* Corners by node number until all nodes are known. */
  int64_t *tet_nodes, *face_nodes;
  size_t tet_node_count, tet_node_capacity, face_node_count, face_node_capacity;
  size_t surface_element_count; /* where polygons are wanted */
  /* The same where points and lines are wanted, beside input->lines. */
  int64_t *single_nodes, *line_nodes;
  size_t single_node_count, single_node_capacity, line_node_count, line_node_capacity;
  /* Where values are wanted: the views of scalars, and number -> index of tets. */
  view *views;
  laves__word *view_names;
  size_t view_count, view_capacity, view_name_capacity;
  table tets;
} reader;

/* ---- tables ---- */

static bool table_add(reader *r, table *t, int64_t number, int32_t value) {
  if (!laves__grow(r->input->context, &t->items, &t->capacity, t->count + 1, sizeof *t->items)) return false;
  t->items[t->count++] = (numbered){number, value};
  return true;
}

static int compare_numbered(const void *a, const void *b) {
  const numbered *x = a, *y = b;
  if (x->number != y->number) return x->number < y->number ? -1 : 1;
  return (x->value > y->value) - (x->value < y->value);
}

static void table_sort(table *t) {
  for (size_t i = 1; i < t->count; i++)
    if (t->items[i].number <= t->items[i - 1].number) {
      qsort(t->items, t->count, sizeof *t->items, compare_numbered);
      return;
    }
}

/* Of a sorted table; NULL when there is none. */
static const numbered *table_find(const table *t, int64_t number) {
  if (t->count == 0 || number < t->items[0].number) return NULL;
  const uint64_t guess = (uint64_t)number - (uint64_t)t->items[0].number; /* where it is when numbers are consecutive */
  if (guess < t->count && t->items[guess].number == number) return &t->items[guess];
  const numbered wanted = {number, 0};
  size_t low = 0, high = t->count;
  while (low < high) {
    const size_t middle = low + (high - low) / 2;
    if (t->items[middle].number < wanted.number)
      low = middle + 1;
    else
      high = middle;
  }
  return low < t->count && t->items[low].number == number ? &t->items[low] : NULL;
}

/* ---- fields ---- */

static laves__binary binary_view(const reader *r) { return (laves__binary){r->scan.at, r->scan.end, r->swapped}; }

static laves_result fail_short(reader *r, laves_error *error, const char *what) {
  if (!r->binary) return laves__scan_fail_expected(&r->scan, error, what);
  return laves__mesh_input_fail(r->input, error, "the file ends at byte %zu where %s should be",
                                (size_t)(r->scan.end - r->scan.begin), what);
}

static bool next_int(reader *r, int64_t *value) {
  if (!r->binary) return laves__scan_space(&r->scan) && laves__scan_int(&r->scan, value);
  laves__binary b = binary_view(r);
  int32_t narrow;
  if (!laves__binary_i32(&b, &narrow)) return false;
  *value = narrow;
  r->scan.at = b.at;
  return true;
}

static bool next_size(reader *r, int64_t *value) {
  if (!r->binary) return laves__scan_space(&r->scan) && laves__scan_int(&r->scan, value);
  laves__binary b = binary_view(r);
  uint64_t wide;
  if (!laves__binary_u64(&b, &wide)) return false;
  *value = (int64_t)wide;
  r->scan.at = b.at;
  return true;
}

static bool next_double(reader *r, double *value) {
  if (!r->binary) return laves__scan_space(&r->scan) && laves__scan_double(&r->scan, value);
  laves__binary b = binary_view(r);
  if (!laves__binary_double(&b, value)) return false;
  r->scan.at = b.at;
  return true;
}

static bool next_point(reader *r, laves__vec3 *p) {
  return next_double(r, &p->x) && next_double(r, &p->y) && next_double(r, &p->z);
}

static bool skip_doubles(reader *r, int64_t count) {
  double value;
  for (int64_t i = 0; i < count; i++)
    if (!next_double(r, &value)) return false;
  return true;
}

static bool skip_ints(reader *r, int64_t count) {
  int64_t value;
  for (int64_t i = 0; i < count; i++)
    if (!next_int(r, &value)) return false;
  return true;
}

/* A count in text form, as sections of version 2 start with even in binary files; ends behind the line. */
static laves_result text_count(reader *r, int64_t *count, laves_error *error) {
  if (!laves__scan_space(&r->scan) || !laves__scan_int(&r->scan, count) || *count < 0)
    return laves__scan_fail_expected(&r->scan, error, "a count");
  laves__scan_next_line(&r->scan);
  return LAVES_OK;
}

/* ---- sections ---- */

static laves_result read_format(reader *r, laves_error *error) {
  double version;
  int64_t binary, size;
  if (!next_double(r, &version) || !next_int(r, &binary) || !next_int(r, &size))
    return laves__scan_fail_expected(&r->scan, error, "the version of the format");
  if (version != 4.1 && !(version >= 2 && version < 3))
    return laves__scan_fail(&r->scan, error, "version %g of the Gmsh format is not known; save the mesh as 4.1 or 2.2", version);
  r->version = version < 3 ? 2 : 4;
  if (binary != 0 && binary != 1) return laves__scan_fail(&r->scan, error, "the file type must be 0 (text) or 1 (binary)");
  if (size != 8) return laves__scan_fail(&r->scan, error, "the size of numbers is %lld bytes; only 8 is known", (long long)size);
  if (binary == 0) return LAVES_OK;
  laves__scan_next_line(&r->scan);
  r->binary = true;
  int64_t one;
  if (!next_int(r, &one)) return fail_short(r, error, "the mark of the byte order");
  r->swapped = one != 1;
  if (one != 1 && one != 0x01000000) return laves__mesh_input_fail(r->input, error, "the mark of the byte order is not 1");
  return LAVES_OK;
}

static laves_result read_names(reader *r, laves_error *error) {
  int64_t count;
  const laves_result result = text_count(r, &count, error);
  for (int64_t i = 0; i < count && result == LAVES_OK; i++) {
    int64_t dimension, tag;
    if (!laves__scan_space(&r->scan) || !laves__scan_int(&r->scan, &dimension) || !laves__scan_int(&r->scan, &tag))
      return laves__scan_fail_expected(&r->scan, error, "the dimension and number of a physical group");
    laves__word name = laves__scan_rest(&r->scan);
    if (name.length >= 2 && name.at[0] == '"' && name.at[name.length - 1] == '"') {
      name.at++;
      name.length -= 2;
    }
    laves__scan_next_line(&r->scan);
    if ((dimension != 2 && dimension != 3) || tag < INT32_MIN || tag > INT32_MAX) continue;
    if (!laves__mesh_input_add_group(r->input, (int)dimension, (int32_t)tag, name.at, name.length))
      return laves__fail_memory(r->input->context, error);
  }
  return result;
}

/* One entity of version 4.1: number, box (for points only the point), physical groups, bounding entities. */
static laves_result read_entity(reader *r, int dimension, laves_error *error) {
  int64_t number, physical_count, physical = 0, bounding_count = 0;
  if (!next_int(r, &number) || !skip_doubles(r, dimension == 0 ? 3 : 6) || !next_size(r, &physical_count))
    return fail_short(r, error, "an entity");
  if (physical_count > 0 && !next_int(r, &physical)) return fail_short(r, error, "a physical group");
  if (physical_count > 0 && !skip_ints(r, physical_count - 1)) return fail_short(r, error, "a physical group");
  if (dimension > 0 && (!next_size(r, &bounding_count) || !skip_ints(r, bounding_count)))
    return fail_short(r, error, "a bounding entity");
  /* Negative numbers tell the direction of the group, not another group. */
  if (dimension < 2 || physical == 0) return LAVES_OK;
  if (physical > INT32_MAX || physical < -INT32_MAX)
    return laves__mesh_input_fail(r->input, error, "physical group %lld is too large", (long long)physical);
  const int64_t group = physical < 0 ? -physical : physical;
  if (!table_add(r, &r->entities[dimension - 2], number, (int32_t)group)) return laves__fail_memory(r->input->context, error);
  return LAVES_OK;
}

static laves_result read_entities(reader *r, laves_error *error) {
  int64_t counts[4];
  for (int d = 0; d < 4; d++)
    if (!next_size(r, &counts[d])) return fail_short(r, error, "the number of entities");
  for (int d = 0; d < 4; d++)
    for (int64_t i = 0; i < counts[d]; i++) {
      const laves_result result = read_entity(r, d, error);
      if (result != LAVES_OK) return result;
    }
  for (int d = 0; d < 2; d++) table_sort(&r->entities[d]);
  return LAVES_OK;
}

static laves_result add_node(reader *r, int64_t number, laves__vec3 point, laves_error *error) {
  if (r->input->point_count == INT32_MAX) return laves__mesh_input_fail(r->input, error, "there are more than 2147483647 nodes");
  if (!table_add(r, &r->nodes, number, (int32_t)r->input->point_count) || !laves__mesh_input_add_point(r->input, point))
    return laves__fail_memory(r->input->context, error);
  if (r->nodes.count % 65536 == 0 && laves__mesh_input_cancelled(r->input, r->scan.at)) return laves__fail_cancelled(error);
  return LAVES_OK;
}

static laves_result read_nodes2(reader *r, laves_error *error) {
  int64_t count, number;
  laves_result result = text_count(r, &count, error);
  for (int64_t i = 0; i < count && result == LAVES_OK; i++) {
    laves__vec3 point;
    if (!next_int(r, &number) || !next_point(r, &point)) return fail_short(r, error, "a node's number and coordinates");
    result = add_node(r, number, point, error);
  }
  return result;
}

/* A block holds all numbers, then all points; parametric coordinates follow each point. */
static laves_result read_node_block(reader *r, laves_error *error) {
  int64_t dimension, entity, parametric, count, number;
  if (!next_int(r, &dimension) || !next_int(r, &entity) || !next_int(r, &parametric) || !next_size(r, &count))
    return fail_short(r, error, "a block of nodes");
  if (dimension < 0 || dimension > 3) return laves__mesh_input_fail(r->input, error, "a block of nodes has no dimension 0 to 3");
  const size_t first = r->nodes.count;
  for (int64_t i = 0; i < count; i++) {
    if (!next_size(r, &number)) return fail_short(r, error, "a node's number");
    const laves_result result = add_node(r, number, v3(0, 0, 0), error);
    if (result != LAVES_OK) return result;
  }
  for (int64_t i = 0; i < count; i++)
    if (!next_point(r, &r->input->points[first + (size_t)i]) || !skip_doubles(r, parametric ? dimension : 0))
      return fail_short(r, error, "a node's coordinates");
  return LAVES_OK;
}

static laves_result read_nodes4(reader *r, laves_error *error) {
  int64_t head[4];
  for (int i = 0; i < 4; i++)
    if (!next_size(r, &head[i])) return fail_short(r, error, "the number of nodes");
  laves_result result = LAVES_OK;
  for (int64_t i = 0; i < head[0] && result == LAVES_OK; i++) result = read_node_block(r, error);
  return result;
}

static bool keep_nodes(reader *r, int64_t **kept, size_t *count, size_t *capacity, const int64_t *nodes, size_t corners) {
  if (!laves__grow(r->input->context, kept, capacity, *count + corners, sizeof **kept)) return false;
  memcpy(*kept + *count, nodes, corners * sizeof *nodes);
  *count += corners;
  return true;
}

/* A triangle; `element` is where it comes from. */
static bool add_face(reader *r, int32_t group, const int64_t nodes[3], size_t element) {
  const int32_t later[3] = {0};
  laves__mesh_input *input = r->input;
  if (input->polygons) {
    if (!laves__grow(input->context, &input->face_elements, &input->face_element_capacity, input->face_count + 1,
                     sizeof *input->face_elements))
      return false;
    input->face_elements[input->face_count] = (int32_t)element;
  }
  return laves__mesh_input_add_face(input, later, group) &&
         keep_nodes(r, &r->face_nodes, &r->face_node_count, &r->face_node_capacity, nodes, 3);
}

/* A triangle or quadrangle of a surface. */
static laves_result add_polygon(reader *r, int32_t group, const int64_t *nodes, bool quad, laves_error *error) {
  const size_t element = r->surface_element_count++;
  if (element >= INT32_MAX) return laves__mesh_input_fail(r->input, error, "there are more than 2147483647 surface elements");
  bool enough = add_face(r, group, nodes, element);
  if (enough && quad) enough = add_face(r, group, (int64_t[]){nodes[0], nodes[2], nodes[3]}, element);
  if (element % 65536 == 65535 && laves__mesh_input_cancelled(r->input, r->scan.at)) return laves__fail_cancelled(error);
  return enough ? LAVES_OK : laves__fail_memory(r->input->context, error);
}

static bool add_line_node(reader *r, const int64_t *node) {
  return keep_nodes(r, &r->line_nodes, &r->line_node_count, &r->line_node_capacity, node, 1) &&
         laves__line_list_add_node(r->input->lines, 0);
}

/* Pieces of two nodes each, which are joined like all others. The ends come first among the nodes of a line element, then what
 * lies between them in order. */
static bool add_line(reader *r, const int64_t *nodes, int count) {
  for (int i = 1; i < count; i++) {
    const int from = i == 1 ? 0 : i, to = i == count - 1 ? 1 : i + 1;
    if (!add_line_node(r, &nodes[from]) || !add_line_node(r, &nodes[to]) || !laves__line_list_end(r->input->lines)) return false;
  }
  return true;
}

static bool add_single(reader *r, const int64_t *nodes) {
  return keep_nodes(r, &r->single_nodes, &r->single_node_count, &r->single_node_capacity, nodes, 1) &&
         laves__line_list_add_single(r->input->lines, 0);
}

static laves_result add_element(reader *r, int64_t number, int64_t type, int32_t group, const int64_t *nodes,
                                laves_error *error) {
  const int32_t later[4] = {0};
  laves__mesh_input *input = r->input;
  bool enough = true;
  if (is_tet(type)) {
    if (input->values.wanted && input->tet_count == INT32_MAX)
      return laves__mesh_input_fail(input, error, "there are more than 2147483647 tetrahedra");
    enough = (!input->values.wanted || table_add(r, &r->tets, number, (int32_t)input->tet_count)) &&
             laves__mesh_input_add_tet(input, later, group) &&
             keep_nodes(r, &r->tet_nodes, &r->tet_node_count, &r->tet_node_capacity, nodes, 4);
    input->higher_order |= type != 4;
    if (input->tet_count % 65536 == 0 && laves__mesh_input_cancelled(input, r->scan.at)) return laves__fail_cancelled(error);
  } else if (is_triangle(type) || (is_quad(type) && input->polygons)) {
    return add_polygon(r, group, nodes, is_quad(type), error);
  } else if (input->lines && is_line(type)) {
    enough = add_line(r, nodes, type_nodes[type]);
  } else if (input->lines && type == POINT_TYPE) {
    enough = add_single(r, nodes);
  }
  return enough ? LAVES_OK : laves__fail_memory(input->context, error);
}

static laves_result check_type(reader *r, int64_t type, laves_error *error) {
  if (type >= 1 && type <= TYPE_MAX && type_nodes[type]) return LAVES_OK;
  return laves__mesh_input_fail(r->input, error, "element type %lld is not known", (long long)type);
}

/* In version 2 the tags of an element are its physical group and its entity, then partitions. */
static laves_result read_element2(reader *r, int64_t number, int64_t type, int64_t tag_count, laves_error *error) {
  int64_t tags[2] = {0, 0}, nodes[NODES_MAX], further;
  for (int64_t i = 0; i < tag_count; i++)
    if (!next_int(r, i < 2 ? &tags[i] : &further)) return fail_short(r, error, "a tag of an element");
  for (int i = 0; i < type_nodes[type]; i++)
    if (!next_int(r, &nodes[i])) return fail_short(r, error, "a node of an element");
  const int64_t group = tags[0] ? tags[0] : tags[1];
  if (group < INT32_MIN || group > INT32_MAX)
    return laves__mesh_input_fail(r->input, error, "physical group %lld is too large", (long long)group);
  return add_element(r, number, type, (int32_t)group, nodes, error);
}

/* Text gives type and number of tags with each element, binary once for a run of elements. */
static laves_result read_elements2(reader *r, laves_error *error) {
  int64_t count, number, type, tag_count;
  laves_result result = text_count(r, &count, error);
  while (count > 0 && result == LAVES_OK) {
    int64_t run = 1;
    const bool head = r->binary ? next_int(r, &type) && next_int(r, &run) && next_int(r, &tag_count)
                                : next_int(r, &number) && next_int(r, &type) && next_int(r, &tag_count);
    if (!head) return fail_short(r, error, "an element");
    if (run < 1 || tag_count < 0 || tag_count > TAGS_MAX)
      return laves__mesh_input_fail(r->input, error, "elements come in runs of %lld with %lld tags", (long long)run,
                                    (long long)tag_count);
    result = check_type(r, type, error);
    for (int64_t i = 0; i < run && result == LAVES_OK; i++) {
      if (r->binary && !next_int(r, &number)) return fail_short(r, error, "an element");
      result = read_element2(r, number, type, tag_count, error);
    }
    count -= run;
  }
  return result;
}

static laves_result read_element_block(reader *r, laves_error *error) {
  int64_t dimension, entity, type, count, number, nodes[NODES_MAX];
  if (!next_int(r, &dimension) || !next_int(r, &entity) || !next_int(r, &type) || !next_size(r, &count))
    return fail_short(r, error, "a block of elements");
  laves_result result = check_type(r, type, error);
  int64_t group = entity;
  if (dimension == 2 || dimension == 3) {
    const numbered *physical = table_find(&r->entities[dimension - 2], entity);
    if (physical) group = physical->value;
  }
  if (group < INT32_MIN || group > INT32_MAX)
    return laves__mesh_input_fail(r->input, error, "entity %lld is too large", (long long)group);
  for (int64_t i = 0; i < count && result == LAVES_OK; i++) {
    if (!next_size(r, &number)) return fail_short(r, error, "an element");
    for (int j = 0; j < type_nodes[type]; j++)
      if (!next_size(r, &nodes[j])) return fail_short(r, error, "a node of an element");
    result = add_element(r, number, type, (int32_t)group, nodes, error);
  }
  return result;
}

static laves_result read_elements4(reader *r, laves_error *error) {
  int64_t head[4];
  for (int i = 0; i < 4; i++)
    if (!next_size(r, &head[i])) return fail_short(r, error, "the number of elements");
  laves_result result = LAVES_OK;
  for (int64_t i = 0; i < head[0] && result == LAVES_OK; i++) result = read_element_block(r, error);
  return result;
}

/* The name of a view: the first of its texts, each on a line. */
static laves_result read_view_name(reader *r, laves__word *name, laves_error *error) {
  int64_t count;
  const laves_result result = text_count(r, &count, error);
  for (int64_t i = 0; i < count && result == LAVES_OK; i++) {
    if (!laves__scan_space(&r->scan)) return laves__scan_fail_expected(&r->scan, error, "the name of a view");
    laves__word text = laves__scan_rest(&r->scan);
    if (text.length >= 2 && text.at[0] == '"' && text.at[text.length - 1] == '"') {
      text.at++;
      text.length -= 2;
    }
    laves__scan_next_line(&r->scan);
    if (i == 0) *name = text;
  }
  return result;
}

/* The head of such a section is text in binary files too: texts, numbers, and integers: time step, components, items. */
static laves_result note_view(reader *r, view_kind kind, laves_error *error) {
  enum { STEP, COMPONENTS, ITEMS, KEPT };
  laves_context *context = r->input->context;
  laves__word name = {"", 0};
  int64_t count = 0, integers[KEPT] = {0}, integer = 0;
  laves_result result = read_view_name(r, &name, error);
  if (result == LAVES_OK) result = text_count(r, &count, error);
  for (int64_t i = 0; result == LAVES_OK && i < count; i++) {
    double number;
    if (!laves__scan_space(&r->scan) || !laves__scan_double(&r->scan, &number))
      return laves__scan_fail_expected(&r->scan, error, "a number in the head of a view");
  }
  if (result == LAVES_OK) result = text_count(r, &count, error);
  for (int64_t i = 0; result == LAVES_OK && i < count; i++) {
    if (!laves__scan_space(&r->scan) || !laves__scan_int(&r->scan, &integer))
      return laves__scan_fail_expected(&r->scan, error, "an integer in the head of a view");
    if (i < KEPT) integers[i] = integer;
  }
  if (result != LAVES_OK || integers[COMPONENTS] != 1) return result;
  laves__scan_next_line(&r->scan);
  const size_t needed = r->view_count + 1;
  if (!laves__grow(context, &r->views, &r->view_capacity, needed, sizeof *r->views) ||
      !laves__grow(context, &r->view_names, &r->view_name_capacity, needed, sizeof *r->view_names))
    return laves__fail_memory(context, error);
  r->views[r->view_count] = (view){kind, r->scan.at, integers[ITEMS]};
  r->view_names[r->view_count++] = name;
  return LAVES_OK;
}

/* Behind the line "$EndName"; sections with content that is not known are skipped by this alone. */
static laves_result end_section(reader *r, laves__word name, laves_error *error) {
  static const char end[] = "$End";
  const size_t prefix = sizeof end - 1;
  for (const char *at = r->scan.at; (size_t)(r->scan.end - at) >= prefix + name.length; at++) {
    at = memchr(at, '$', (size_t)(r->scan.end - at));
    if (!at || (size_t)(r->scan.end - at) < prefix + name.length) break;
    if (memcmp(at, end, prefix) == 0 && memcmp(at + prefix, name.at, name.length) == 0) {
      r->scan.at = at;
      laves__scan_next_line(&r->scan);
      return LAVES_OK;
    }
  }
  char quote[LAVES__QUOTE_SIZE];
  return laves__mesh_input_fail(r->input, error, "the section $%s has no end; the file is cut off", laves__quote(name, quote));
}

static laves_result read_section(reader *r, laves__word name, laves_error *error) {
  if (laves__word_is(name, "MeshFormat")) return read_format(r, error);
  if (r->version == 0) return laves__scan_fail(&r->scan, error, "the section $MeshFormat must come first");
  if (laves__word_is(name, "PhysicalNames")) return read_names(r, error);
  if (laves__word_is(name, "Entities")) return r->version == 4 ? read_entities(r, error) : LAVES_OK;
  if (laves__word_is(name, "Nodes")) return r->version == 4 ? read_nodes4(r, error) : read_nodes2(r, error);
  if (laves__word_is(name, "Elements")) return r->version == 4 ? read_elements4(r, error) : read_elements2(r, error);
  if (!r->input->values.wanted) return LAVES_OK;
  if (laves__word_is(name, "NodeData")) return note_view(r, NODE_DATA, error);
  if (laves__word_is(name, "ElementData")) return note_view(r, ELEMENT_DATA, error);
  if (laves__word_is(name, "ElementNodeData")) return note_view(r, ELEMENT_NODE_DATA, error);
  return LAVES_OK;
}

/* ---- the file ---- */

static laves_result resolve(reader *r, const int64_t *nodes, int32_t *corners, size_t count, laves_error *error) {
  for (size_t i = 0; i < count; i++) {
    if (laves__cancelled_at(r->input->context, "read", i, count)) return laves__fail_cancelled(error);
    const numbered *found = table_find(&r->nodes, nodes[i]);
    if (!found)
      return laves__mesh_input_fail(r->input, error, "an element uses node %lld, which the file does not have",
                                    (long long)nodes[i]);
    corners[i] = found->value;
  }
  return LAVES_OK;
}

static laves_result resolve_all(reader *r, laves_error *error) {
  table_sort(&r->nodes);
  laves_result result = LAVES_OK;
  if (r->tet_node_count > 0) result = resolve(r, r->tet_nodes, *r->input->tets, r->tet_node_count, error);
  if (r->face_node_count > 0 && result == LAVES_OK)
    result = resolve(r, r->face_nodes, *r->input->faces, r->face_node_count, error);
  if (r->single_node_count > 0 && result == LAVES_OK)
    result = resolve(r, r->single_nodes, r->input->lines->single, r->single_node_count, error);
  if (r->line_node_count > 0 && result == LAVES_OK)
    result = resolve(r, r->line_nodes, r->input->lines->node, r->line_node_count, error);
  return result;
}

/* Gives each tet points of its own, as its values need not agree with those of its neighbours; triangles are dropped. */
static laves_result part_tets(reader *r, laves_error *error) {
  laves__mesh_input *input = r->input;
  const size_t count = 4 * input->tet_count;
  if (count > INT32_MAX) return laves__mesh_input_fail(input, error, "there are more than 536870911 tetrahedra");
  laves__vec3 *points = laves__alloc(input->context, count, sizeof *points);
  if (!points) return laves__fail_memory(input->context, error);
  for (size_t i = 0; i < count; i++) {
    int32_t *corner = &input->tets[i / 4][i % 4];
    points[i] = input->points[*corner];
    *corner = (int32_t)i;
  }
  laves__free(input->context, input->points, input->point_capacity, sizeof *input->points);
  input->points = points;
  input->point_count = input->point_capacity = count;
  input->face_count = 0;
  return LAVES_OK;
}

static laves_result read_node_value(reader *r, laves_error *error) {
  int64_t number;
  double value;
  if (!next_int(r, &number) || !next_double(r, &value)) return fail_short(r, error, "a node's number and value");
  const numbered *node = table_find(&r->nodes, number);
  if (!node)
    return laves__mesh_input_fail(r->input, error, "a value is for node %lld, which the file does not have", (long long)number);
  r->input->values.items[node->value] = value;
  return LAVES_OK;
}

/* One value, or with a count in front one for each node, the corners first; elements that are no tets are passed over. */
static laves_result read_element_values(reader *r, view_kind kind, laves_error *error) {
  int64_t number, count = 1;
  if (!next_int(r, &number)) return fail_short(r, error, "an element's number and values");
  if (kind == ELEMENT_NODE_DATA && (!next_int(r, &count) || count < 0))
    return fail_short(r, error, "an element's number of nodes");
  const numbered *tet = table_find(&r->tets, number);
  const int64_t kept = kind == ELEMENT_DATA ? 1 : 4;
  for (int64_t i = 0; i < count; i++) {
    double value;
    if (!next_double(r, &value)) return fail_short(r, error, "a value of an element");
    if (tet && i < kept) r->input->values.items[tet->value * kept + i] = value;
  }
  return LAVES_OK;
}

static laves_result read_view(reader *r, const view *v, laves_error *error) {
  laves__mesh_input *input = r->input;
  laves_result result = v->kind == ELEMENT_NODE_DATA ? part_tets(r, error) : LAVES_OK;
  input->values.per_tet = v->kind == ELEMENT_DATA;
  const size_t needed = input->values.per_tet ? input->tet_count : input->point_count;
  for (size_t i = 0; i < needed && result == LAVES_OK; i++)
    if (!laves__mesh_input_add_value(input, NAN)) result = laves__fail_memory(input->context, error);
  table_sort(&r->tets);
  r->scan.at = v->at;
  for (int64_t i = 0; i < v->count && result == LAVES_OK; i++) {
    result = v->kind == NODE_DATA ? read_node_value(r, error) : read_element_values(r, v->kind, error);
    if (i % 65536 == 65535 && laves__mesh_input_cancelled(input, r->scan.at)) return laves__fail_cancelled(error);
  }
  return result;
}

/* Reads the wanted view; of several time steps of one name the first. */
static laves_result read_values(reader *r, laves_error *error) {
  if (!r->input->values.wanted) return LAVES_OK;
  size_t chosen = 0;
  if (r->view_count == 0)
    return laves__mesh_input_fail(r->input, error, "it has no view ($NodeData) with one number for each node or element");
  const laves_result result = laves__mesh_input_choose_array(r->input, r->view_names, r->view_count, &chosen, error);
  return result == LAVES_OK ? read_view(r, &r->views[chosen], error) : result;
}

laves_result laves__read_gmsh(laves__mesh_input *input, laves_error *error) {
  reader r = {.input = input, .scan = laves__scan_begin(input->name, input->begin, (size_t)(input->end - input->begin))};
  laves_result result = LAVES_OK;
  while (result == LAVES_OK && laves__scan_space(&r.scan)) {
    laves__word name;
    if (!laves__scan_word(&r.scan, &name) || name.at[0] != '$') {
      result = laves__scan_fail(&r.scan, error, "a section must start with '$'");
      break;
    }
    laves__scan_next_line(&r.scan);
    name.at++;
    name.length--;
    result = read_section(&r, name, error);
    if (result == LAVES_OK) result = end_section(&r, name, error);
  }
  if (result == LAVES_OK) result = resolve_all(&r, error);
  if (result == LAVES_OK) result = read_values(&r, error);
  laves_context *context = input->context;
  laves__free(context, r.nodes.items, r.nodes.capacity, sizeof *r.nodes.items);
  for (int d = 0; d < 2; d++) laves__free(context, r.entities[d].items, r.entities[d].capacity, sizeof *r.entities[d].items);
  laves__free(context, r.tet_nodes, r.tet_node_capacity, sizeof *r.tet_nodes);
  laves__free(context, r.face_nodes, r.face_node_capacity, sizeof *r.face_nodes);
  laves__free(context, r.single_nodes, r.single_node_capacity, sizeof *r.single_nodes);
  laves__free(context, r.line_nodes, r.line_node_capacity, sizeof *r.line_nodes);
  laves__free(context, r.views, r.view_capacity, sizeof *r.views);
  laves__free(context, r.view_names, r.view_name_capacity, sizeof *r.view_names);
  laves__free(context, r.tets.items, r.tets.capacity, sizeof *r.tets.items);
  return result;
}
