/* PLY, the polygon format of Greg Turk (Stanford, 1994), in text and both binary forms.
 *
 * The header lists elements ("vertex", "face", others), each with a count and properties, which are numbers or lists of
 * numbers of eight types; the data follow in that order. All of them are walked through; used are x, y, z of "vertex",
 * the list vertex_indices (or vertex_index) of "face", or of "tristrips" with -1 between strips, and as tags an integer
 * property of "face", as choose_label() tells. Elements may stand in any order. Comments such as "comment label 3 inlet" name the
 * values of a property called "label", as write_surface.c writes them.
 *
 * Every value is handled as a double, which holds all eight types exactly. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/surface_build.h"

typedef enum ply_type { INT8, UINT8, INT16, UINT16, INT32, UINT32, FLOAT32, FLOAT64, TYPE_COUNT } ply_type;

static const struct {
  const char *name, *other_name;
  size_t size;
} TYPES[TYPE_COUNT] = {{"char", "int8", 1}, {"uchar", "uint8", 1}, {"short", "int16", 2},   {"ushort", "uint16", 2},
                       {"int", "int32", 4}, {"uint", "uint32", 4}, {"float", "float32", 4}, {"double", "float64", 8}};

/* What a property is to us. */
typedef enum ply_role { ROLE_NONE, ROLE_X, ROLE_Y, ROLE_Z, ROLE_CORNERS, ROLE_STRIP, ROLE_LABEL } ply_role;

typedef struct ply_property {
  laves__word name;
  ply_type type;
  bool is_list;
  ply_type count_type; /* of a list */
  ply_role role;
} ply_property;

typedef struct ply_element {
  laves__word name;
  size_t count;
  size_t first_property, property_count;
  unsigned roles; /* bit 1 << role for each that a property has */
} ply_element;

/* What a comment calls a label. */
typedef struct ply_name {
  int64_t label;
  laves__word name;
} ply_name;

typedef enum ply_encoding { ENCODING_NONE, ASCII, LITTLE_ENDIAN_BINARY, BIG_ENDIAN_BINARY } ply_encoding;

typedef struct ply_file {
  laves__surface_build *build;
  ply_encoding encoding;
  ply_element *elements;
  size_t element_count, element_capacity;
  ply_property *properties;
  size_t property_count, property_capacity;
  double label;    /* that triangles have now; NAN before the first */
  ply_name *names; /* ascending once the header is read */
  size_t name_count, name_capacity;
} ply_file;

bool laves__is_ply(laves__scan scan) {
  laves__word word;
  return laves__scan_word(&scan, &word) && laves__word_is(word, "ply") && !laves__scan_blanks(&scan) && scan.at < scan.end;
}

/* ---- header ---- */

static bool scan_type(laves__scan *scan, ply_type *type) {
  for (int i = 0; i < TYPE_COUNT; ++i) {
    if (laves__scan_keyword(scan, TYPES[i].name) || laves__scan_keyword(scan, TYPES[i].other_name)) {
      *type = (ply_type)i;
      return true;
    }
  }
  return false;
}

static laves_result read_format(ply_file *file) {
  static const char *const NAMES[] = {
      [ASCII] = "ascii", [LITTLE_ENDIAN_BINARY] = "binary_little_endian", [BIG_ENDIAN_BINARY] = "binary_big_endian"};
  static const char *const TEXTS[] = {[ASCII] = "PLY (ASCII)",
                                      [LITTLE_ENDIAN_BINARY] = "PLY (binary, little endian)",
                                      [BIG_ENDIAN_BINARY] = "PLY (binary, big endian)"};
  laves__scan *scan = &file->build->scan;
  for (ply_encoding i = ASCII; i <= BIG_ENDIAN_BINARY; ++i) {
    if (laves__scan_keyword(scan, NAMES[i])) {
      file->encoding = i;
      snprintf(file->build->input->format, sizeof file->build->input->format, "%s", TEXTS[i]);
      return LAVES_OK;
    }
  }
  return laves__scan_fail_expected(scan, file->build->error, "ascii, binary_little_endian or binary_big_endian");
}

static laves_result read_element(ply_file *file) {
  laves__surface_build *build = file->build;
  ply_element element = {.first_property = file->property_count};
  if (!laves__scan_word(&build->scan, &element.name)) {
    return laves__scan_fail_expected(&build->scan, build->error, "the name of an element");
  }
  if (!laves__scan_count(&build->scan, SIZE_MAX / 2, &element.count)) {
    return laves__scan_fail_expected(&build->scan, build->error, "how many of the element there are");
  }
  if (!laves__grow(build->context, &file->elements, &file->element_capacity, file->element_count + 1, sizeof element)) {
    return laves__fail_memory(build->context, build->error);
  }
  file->elements[file->element_count++] = element;
  return LAVES_OK;
}

static ply_role role_of(const ply_property *property, laves__word element) {
  const laves__word name = property->name;
  if (laves__word_is(element, "vertex") && !property->is_list && name.length == 1 && *name.at >= 'x' && *name.at <= 'z') {
    return (ply_role)(ROLE_X + (*name.at - 'x'));
  }
  const bool corners = property->is_list && (laves__word_is(name, "vertex_indices") || laves__word_is(name, "vertex_index"));
  if (corners && laves__word_is(element, "face")) return ROLE_CORNERS;
  if (corners && laves__word_is(element, "tristrips")) return ROLE_STRIP;
  return ROLE_NONE;
}

static laves_result read_property(ply_file *file) {
  laves__surface_build *build = file->build;
  ply_property property = {0};
  if (file->element_count == 0) {
    return laves__build_fail(build, "a property stands before the first element");
  }
  property.is_list = laves__scan_keyword(&build->scan, "list");
  if ((property.is_list && !scan_type(&build->scan, &property.count_type)) || !scan_type(&build->scan, &property.type)) {
    return laves__scan_fail_expected(&build->scan, build->error, "a type (char, uchar, short, ushort, int, uint, float, double)");
  }
  if (!laves__scan_word(&build->scan, &property.name)) {
    return laves__scan_fail_expected(&build->scan, build->error, "the name of a property");
  }
  if (!laves__grow(build->context, &file->properties, &file->property_capacity, file->property_count + 1, sizeof property)) {
    return laves__fail_memory(build->context, build->error);
  }
  ply_element *element = &file->elements[file->element_count - 1];
  property.role = role_of(&property, element->name);
  if ((element->roles >> property.role & 1) != 0) property.role = ROLE_NONE;  // the first one counts
  element->roles |= 1u << property.role;
  file->properties[file->property_count++] = property;
  ++element->property_count;
  return LAVES_OK;
}

/* A comment, of which the scan is behind the first word. */
static laves_result read_comment(ply_file *file) {
  laves__scan *scan = &file->build->scan;
  ply_name named;
  if (!laves__scan_keyword(scan, "label") || !laves__scan_int(scan, &named.label)) return LAVES_OK;
  named.name = laves__scan_rest(scan);
  if (named.name.length == 0) return LAVES_OK;
  if (!laves__grow(file->build->context, &file->names, &file->name_capacity, file->name_count + 1, sizeof named))
    return laves__fail_memory(file->build->context, file->build->error);
  file->names[file->name_count++] = named;
  return LAVES_OK;
}

/* By label, then by place in the file. */
static int compare_names(const void *a, const void *b) {
  const ply_name *x = a, *y = b;
  if (x->label != y->label) return x->label < y->label ? -1 : 1;
  return (x->name.at > y->name.at) - (x->name.at < y->name.at);
}

/* The first name of a label, or NULL. */
static const ply_name *find_name(const ply_file *file, double label) {
  size_t low = 0, high = file->name_count;
  while (low < high) {
    const size_t middle = low + (high - low) / 2;
    if ((double)file->names[middle].label < label)
      low = middle + 1;
    else
      high = middle;
  }
  return low < file->name_count && (double)file->names[low].label == label ? &file->names[low] : NULL;
}

/* Whether a property of faces may be a label, going by its type: a colour or a flag is none. */
static bool can_be_label(const ply_property *property) {
  static const char *const OTHERS[] = {"red", "green", "blue", "alpha", "r", "g", "b", "a", "flags", "flag", "quality"};
  for (size_t i = 0; i < LAVES__COUNT_OF(OTHERS); ++i) {
    if (laves__word_is(property->name, OTHERS[i])) return false;
  }
  return !property->is_list && property->type < FLOAT32;
}

/* The label of faces: the integer property whose name stands first in this list; else the only integer that is neither
 * colour nor flag. */
static void choose_label(ply_file *file, ply_element *element) {
  static const char *const NAMES[] = {"label",          "tag",       "group", "material", "region", "object",
                                      "material_index", "region_id", "part",  "segment",  "patch",  "group_id"};
  ply_property *first = file->properties + element->first_property, *label = NULL;
  for (size_t n = 0; n < LAVES__COUNT_OF(NAMES) && label == NULL; ++n) {
    for (size_t i = 0; i < element->property_count && label == NULL; ++i) {
      if (can_be_label(&first[i]) && laves__word_is(first[i].name, NAMES[n])) label = &first[i];
    }
  }
  size_t candidates = 0;
  for (size_t i = 0; i < element->property_count && label == NULL; ++i) candidates += can_be_label(&first[i]);
  for (size_t i = 0; i < element->property_count && candidates == 1; ++i) {
    if (can_be_label(&first[i])) label = &first[i];
  }
  if (label == NULL) return;
  label->role = ROLE_LABEL;
  element->roles |= 1u << ROLE_LABEL;
}

/* Goes behind the line "end_header". Where lines end with a lone CR, an LF behind it is data already. */
static laves_result end_header(ply_file *file) {
  laves__scan *scan = &file->build->scan;
  const char *first_end = memchr(scan->begin, '\r', (size_t)(scan->at - scan->begin));
  const bool lone_cr = first_end != NULL && first_end[1] != '\n';
  if (laves__scan_blanks(scan)) {
    return laves__scan_fail_expected(scan, file->build->error, "the end of the line behind end_header");
  }
  if (lone_cr && scan->at < scan->end) {
    ++scan->at;
  } else {
    laves__scan_next_line(scan);
  }
  if (file->encoding == ENCODING_NONE) {
    return laves__build_fail(file->build, "the header has no line 'format'");
  }
  file->build->binary = file->encoding != ASCII;
  if (file->name_count > 0) qsort(file->names, file->name_count, sizeof *file->names, compare_names);
  for (size_t i = 0; i < file->element_count; ++i) {
    ply_element *element = &file->elements[i];
    if (element->property_count > 0 && laves__word_is(element->name, "face")) choose_label(file, element);
  }
  return LAVES_OK;
}

static laves_result read_header(ply_file *file) {
  laves__scan *scan = &file->build->scan;
  laves_result result = LAVES_OK;
  while (result == LAVES_OK && laves__scan_next_line(scan)) {
    if (laves__scan_keyword(scan, "end_header")) return end_header(file);
    if (laves__scan_keyword(scan, "format")) {
      result = read_format(file);
    } else if (laves__scan_keyword(scan, "element")) {
      result = read_element(file);
    } else if (laves__scan_keyword(scan, "property")) {
      result = read_property(file);
    } else if (laves__scan_keyword(scan, "comment")) {
      result = read_comment(file);
    } else if (!laves__scan_keyword(scan, "obj_info") && laves__scan_blanks(scan)) {
      result = laves__scan_fail_expected(scan, file->build->error, "element, property, comment or end_header");
    }
  }
  return result == LAVES_OK ? laves__build_fail(file->build, "the file ends inside the header") : result;
}

/* ---- data ---- */

/* Integers byte by byte, whatever the order of this machine; compilers make one load of each. */
static uint16_t load16(const unsigned char *b, bool big) { return (uint16_t)(big ? b[0] << 8 | b[1] : b[1] << 8 | b[0]); }

static uint32_t load32(const unsigned char *b, bool big) {
  return big ? (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3]
             : (uint32_t)b[3] << 24 | (uint32_t)b[2] << 16 | (uint32_t)b[1] << 8 | b[0];
}

static float load_float(const unsigned char *b, bool big) {
  const uint32_t bits = load32(b, big);
  float value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

static double load_double(const unsigned char *b, bool big) {
  const uint64_t bits = (uint64_t)load32(b + (big ? 0 : 4), big) << 32 | load32(b + (big ? 4 : 0), big);
  double value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

static double load_value(const char *at, ply_type type, bool big) {
  const unsigned char *bytes = (const unsigned char *)at;
  switch (type) {
    case INT8:
      return (int8_t)*bytes;
    case UINT8:
      return *bytes;
    case INT16:
      return (int16_t)load16(bytes, big);
    case UINT16:
      return load16(bytes, big);
    case INT32:
      return (int32_t)load32(bytes, big);
    case UINT32:
      return load32(bytes, big);
    case FLOAT32:
      return load_float(bytes, big);
    default:
      return load_double(bytes, big);
  }
}

static laves_result fail_value(const ply_file *file, const ply_element *element, size_t index, const ply_property *property,
                               const char *what) {
  char element_name[LAVES__QUOTE_SIZE], property_name[LAVES__QUOTE_SIZE];
  return laves__build_fail(file->build, "%s %zu of %zu, %s: %s", laves__quote(element->name, element_name), index + 1,
                           element->count, laves__quote(property->name, property_name), what);
}

/* Takes one number; false when there is none or the file ends. */
static bool take_value(ply_file *file, ply_type type, double *value) {
  laves__scan *scan = &file->build->scan;
  if (file->encoding == ASCII) {
    laves__scan_space(scan);
    return laves__scan_double(scan, value);
  }
  if (laves__build_left(file->build) < TYPES[type].size) return false;
  *value = load_value(scan->at, type, file->encoding == BIG_ENDIAN_BINARY);
  scan->at += TYPES[type].size;
  return true;
}

/* Passes over `count` numbers, which may be nan; false when the file ends first. */
static bool skip_values(ply_file *file, ply_type type, uint64_t count) {
  laves__scan *scan = &file->build->scan;
  laves__word word;
  if (file->encoding != ASCII) {
    if (count > laves__build_left(file->build) / TYPES[type].size) return false;
    scan->at += count * TYPES[type].size;
    return true;
  }
  for (uint64_t i = 0; i < count; ++i) {
    if (!laves__scan_space(scan) || !laves__scan_word(scan, &word)) return false;
  }
  return true;
}

/* Takes the length of a list: a whole number that what is left of the file can hold. */
static bool take_list_length(ply_file *file, const ply_property *property, uint64_t *length) {
  double value;
  if (!take_value(file, property->count_type, &value) || !(value >= 0 && value <= UINT32_MAX)) return false;
  const size_t item_size = file->encoding == ASCII ? 1 : TYPES[property->type].size;
  *length = (uint64_t)value;
  return (double)*length == value && *length <= laves__build_left(file->build) / item_size;
}

/* Takes an index; -1 is allowed too, for strips. */
static bool take_index(ply_file *file, ply_type type, int64_t *index) {
  double value;
  if (!take_value(file, type, &value) || !(value >= -1 && value <= UINT32_MAX)) return false;
  *index = (int64_t)value;
  return (double)*index == value;
}

/* Reads a polygon of `length` corners as a fan. */
static laves_result take_polygon(ply_file *file, const ply_element *element, size_t item, const ply_property *property,
                                 uint64_t length) {
  laves_result result = LAVES_OK;
  laves__build_face(file->build);
  for (uint64_t i = 0; i < length && result == LAVES_OK; ++i) {
    int64_t index;
    if (!take_index(file, property->type, &index)) {
      return fail_value(file, element, item, property, "this is not the index of a vertex, or the file ends");
    }
    result = laves__build_corner(file->build, index);
  }
  return result == LAVES_OK ? laves__build_face_end(file->build) : result;
}

/* Reads strips of triangles: every index from the third of a strip makes a triangle with the two before it, in turn
 * forwards and backwards. */
static laves_result take_strips(ply_file *file, const ply_element *element, size_t item, const ply_property *property,
                                uint64_t length) {
  laves_result result = LAVES_OK;
  int64_t latest[2] = {0, 0};
  uint64_t run = 0;
  for (uint64_t i = 0; i < length && result == LAVES_OK; ++i) {
    int64_t index;
    if (!take_index(file, property->type, &index)) {
      return fail_value(file, element, item, property, "this is not the index of a vertex, or the file ends");
    }
    run = index < 0 ? 0 : run + 1;
    if (run >= 3) {
      laves__build_face(file->build);
      result = laves__build_corner(file->build, latest[run % 2 == 0]);
      if (result == LAVES_OK) result = laves__build_corner(file->build, latest[run % 2 != 0]);
      if (result == LAVES_OK) result = laves__build_corner(file->build, index);
      if (result == LAVES_OK) result = laves__build_face_end(file->build);
    }
    latest[0] = latest[1];
    latest[1] = index;
  }
  return result;
}

static laves_result take_list(ply_file *file, const ply_element *element, size_t item, const ply_property *property) {
  uint64_t length;
  if (!take_list_length(file, property, &length)) {
    return fail_value(file, element, item, property, "the length of the list is no number, or more than the file holds");
  }
  if (property->role == ROLE_CORNERS) return take_polygon(file, element, item, property, length);
  if (property->role == ROLE_STRIP) return take_strips(file, element, item, property, length);
  const bool skipped = skip_values(file, property->type, length);
  return skipped ? LAVES_OK : fail_value(file, element, item, property, "the file ends here");
}

static laves_result take_scalar(ply_file *file, const ply_element *element, size_t item, const ply_property *property,
                                double values[ROLE_LABEL + 1]) {
  if (property->role == ROLE_NONE) {
    return skip_values(file, property->type, 1) ? LAVES_OK : fail_value(file, element, item, property, "the file ends here");
  }
  double value;
  if (!take_value(file, property->type, &value) || !isfinite(value)) {
    return fail_value(file, element, item, property, "there is no finite number here, or the file ends");
  }
  values[property->role] = value;
  return LAVES_OK;
}

/* Gives the triangles from `first_triangle` on the name "label 7". */
static laves_result change_label(ply_file *file, const ply_element *element, double label, size_t first_triangle) {
  laves__surface_build *build = file->build;
  laves__word kind = {"label", 5};
  for (size_t i = 0; i < element->property_count; ++i) {
    const ply_property *property = &file->properties[element->first_property + i];
    if (property->role == ROLE_LABEL) kind = property->name;
  }
  char text[64];
  const int length = snprintf(text, sizeof text, "%.*s %.0f", (int)kind.length, kind.at, label);
  file->label = label;
  const ply_name *known = laves__word_is(kind, "label") ? find_name(file, label) : NULL;
  const laves__word name = known ? known->name : (laves__word){text, (size_t)length};
  const bool started = laves__tag_list_start(build->context, &build->tags, name.at, name.length, first_triangle, "unlabelled");
  return started ? LAVES_OK : laves__fail_memory(build->context, build->error);
}

static laves_result take_item(ply_file *file, const ply_element *element, size_t item, bool is_vertex) {
  double values[ROLE_LABEL + 1] = {[ROLE_LABEL] = NAN};
  const size_t first_triangle = file->build->input->triangle_count;
  for (size_t i = 0; i < element->property_count; ++i) {
    const ply_property *property = &file->properties[element->first_property + i];
    const laves_result result =
        property->is_list ? take_list(file, element, item, property) : take_scalar(file, element, item, property, values);
    if (result != LAVES_OK) return result;
  }
  if (is_vertex) return laves__build_point(file->build, values[ROLE_X], values[ROLE_Y], values[ROLE_Z]);
  const bool changed = !isnan(values[ROLE_LABEL]) && values[ROLE_LABEL] != file->label;
  return changed ? change_label(file, element, values[ROLE_LABEL], first_triangle) : LAVES_OK;
}

/* Fewest bytes that one item takes; each number in text is at least a digit and a space. */
static size_t least_item_size(const ply_file *file, const ply_element *element) {
  size_t size = 0;
  for (size_t i = 0; i < element->property_count; ++i) {
    const ply_property *property = &file->properties[element->first_property + i];
    size += file->encoding == ASCII ? 2 : TYPES[property->is_list ? property->count_type : property->type].size;
  }
  return size;
}

static laves_result take_element(ply_file *file, const ply_element *element) {
  laves__surface_build *build = file->build;
  const unsigned point_roles = 1u << ROLE_X | 1u << ROLE_Y | 1u << ROLE_Z;
  const bool is_vertex = laves__word_is(element->name, "vertex");
  char name[LAVES__QUOTE_SIZE];
  if (is_vertex && (element->roles & point_roles) != point_roles) {
    return laves__build_fail(build, "the vertices have no properties x, y and z");
  }
  const size_t item_size = least_item_size(file, element);
  if (item_size == 0) return LAVES_OK;  // without properties nothing is stored
  // The last number of a text needs no space behind it.
  if (element->count > (laves__build_left(build) + 1) / item_size) {
    return laves__build_fail(build, "%zu of element %s are promised, but the file ends before; it was cut or its header is wrong",
                             element->count, laves__quote(element->name, name));
  }
  const bool is_face = (element->roles & 1u << ROLE_CORNERS) != 0;
  laves_result result =
      laves__build_reserve(build, is_vertex ? element->count : 0, item_size, is_face ? element->count : 0, item_size);
  for (size_t i = 0; i < element->count && result == LAVES_OK; ++i) {
    result = take_item(file, element, i, is_vertex);
    if ((i & 0xFFFF) == 0xFFFF && laves__cancelled(build->context, "read", (double)i / (double)element->count)) {
      result = laves__fail_cancelled(build->error);
    }
  }
  return result;
}

laves_result laves__read_ply(laves__surface_build *build) {
  ply_file file = {.build = build, .label = NAN};
  strcpy(build->input->format, "PLY");
  laves_result result = read_header(&file);
  for (size_t i = 0; i < file.element_count && result == LAVES_OK; ++i) {
    result = take_element(&file, &file.elements[i]);
  }
  laves__free(build->context, file.elements, file.element_capacity, sizeof *file.elements);
  laves__free(build->context, file.properties, file.property_capacity, sizeof *file.properties);
  laves__free(build->context, file.names, file.name_capacity, sizeof *file.names);
  return result;
}
