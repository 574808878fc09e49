/* NRRD, the images of Teem: three axes of scalars, raw, text or gzip, attached or in one other file of the same folder.
 *
 * The header is lines "field: value" up to an empty line; the data follow. Fields are collected first, as their order is
 * free, then turned into places: by 'space directions' and 'space origin', or by 'axis mins', 'axis maxs' and 'spacings' with
 * 'centerings'. Coordinates and units are taken as they are: 'space' and 'space units' change nothing.
 * Sizes are believed only as far as the bytes in the file can make them true: a compressed byte expands to at most 1032, the
 * limit of deflate.
 * Source: G. Kindlmann, "Definition of NRRD File Format", https://teem.sourceforge.net/nrrd/format.html */
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <zlib.h>

#include "io/file.h"
#include "io/image_input.h"
#include "io/scan.h"
#include "io/zlib_memory.h"

enum { AXES = 3, COMPRESSED_LIMIT = 1032 };

typedef enum kind { INT8, UINT8, INT16, UINT16, INT32, UINT32, INT64, UINT64, FLOAT32, FLOAT64 } kind;
static const size_t kind_bytes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};

static const struct {
  const char *name;
  kind kind;
} types[] = {
    {"signed char", INT8},
    {"int8", INT8},
    {"int8_t", INT8},
    {"uchar", UINT8},
    {"unsigned char", UINT8},
    {"uint8", UINT8},
    {"uint8_t", UINT8},
    {"short", INT16},
    {"short int", INT16},
    {"signed short", INT16},
    {"signed short int", INT16},
    {"int16", INT16},
    {"int16_t", INT16},
    {"ushort", UINT16},
    {"unsigned short", UINT16},
    {"unsigned short int", UINT16},
    {"uint16", UINT16},
    {"uint16_t", UINT16},
    {"int", INT32},
    {"signed int", INT32},
    {"int32", INT32},
    {"int32_t", INT32},
    {"uint", UINT32},
    {"unsigned int", UINT32},
    {"uint32", UINT32},
    {"uint32_t", UINT32},
    {"longlong", INT64},
    {"long long", INT64},
    {"long long int", INT64},
    {"signed long long", INT64},
    {"signed long long int", INT64},
    {"int64", INT64},
    {"int64_t", INT64},
    {"ulonglong", UINT64},
    {"unsigned long long", UINT64},
    {"unsigned long long int", UINT64},
    {"uint64", UINT64},
    {"uint64_t", UINT64},
    {"float", FLOAT32},
    {"double", FLOAT64},
};

typedef enum encoding { NO_ENCODING, RAW, TEXT, GZIP } encoding;

typedef struct reader {
  laves__image_input *image;
  laves__scan scan; /* of the header */
  bool has_type, has_sizes, has_origin, has_directions;
  kind kind;
  encoding encoding;
  bool has_endian, big_endian;
  size_t line_skip;
  int64_t byte_skip;                             /* -1: the data are the last bytes of the file */
  double spacings[AXES], mins[AXES], maxs[AXES]; /* NAN: not given */
  bool cells[AXES];                              /* samples stand in the middle of cells, not at nodes */
  laves__word data_file;                         /* empty: the data follow the header */
  const char *data, *data_end;
} reader;

static laves_result fail(const reader *r, laves_error *error, const char *sentence) {
  return laves__fail(error, LAVES_ERROR_INPUT, "%s: %s", r->image->name, sentence);
}

void laves__image_input_free(laves__image_input *image) {
  laves__free(image->context, image->narrow, image->sample_count, sizeof *image->narrow);
  laves__free(image->context, image->wide, image->sample_count, sizeof *image->wide);
  image->narrow = NULL;
  image->wide = NULL;
}

/* ---- the fields of the header: the scan stands on the value and ends on the line ---- */

static laves_result read_dimension(reader *r, laves_error *error) {
  int64_t dimension;
  if (!laves__scan_int(&r->scan, &dimension)) return laves__scan_fail_expected(&r->scan, error, "the number of axes");
  if (dimension == AXES) return LAVES_OK;
  return laves__scan_fail(&r->scan, error, "the image has %lld axes; one with 3 axes and one number for each sample is needed",
                          (long long)dimension);
}

static laves_result read_type(reader *r, laves_error *error) {
  const laves__word name = laves__scan_rest(&r->scan);
  char quote[LAVES__QUOTE_SIZE];
  for (size_t i = 0; i < LAVES__COUNT_OF(types); i++)
    if (laves__word_is(name, types[i].name)) {
      r->kind = types[i].kind;
      r->has_type = true;
      return LAVES_OK;
    }
  return laves__scan_fail(&r->scan, error, "the type '%s' is not read; save it as float or double", laves__quote(name, quote));
}

static laves_result read_encoding(reader *r, laves_error *error) {
  const laves__word name = laves__scan_rest(&r->scan);
  char quote[LAVES__QUOTE_SIZE];
  if (laves__word_is(name, "raw")) r->encoding = RAW;
  if (laves__word_is(name, "ascii") || laves__word_is(name, "text") || laves__word_is(name, "txt")) r->encoding = TEXT;
  if (laves__word_is(name, "gzip") || laves__word_is(name, "gz")) r->encoding = GZIP;
  if (r->encoding != NO_ENCODING) return LAVES_OK;
  return laves__scan_fail(&r->scan, error, "the encoding '%s' is not read; save it as raw, gzip or ascii",
                          laves__quote(name, quote));
}

static laves_result read_endian(reader *r, laves_error *error) {
  const laves__word name = laves__scan_rest(&r->scan);
  r->big_endian = laves__word_is(name, "big");
  r->has_endian = true;
  if (r->big_endian || laves__word_is(name, "little")) return LAVES_OK;
  return laves__scan_fail(&r->scan, error, "the byte order (endian) must be big or little");
}

static laves_result read_sizes(reader *r, laves_error *error) {
  for (int a = 0; a < AXES; a++) {
    size_t size;
    if (!laves__scan_count(&r->scan, SIZE_MAX / 64, &size) || size == 0)
      return laves__scan_fail_expected(&r->scan, error, "the number of samples along each of three axes (1 or more)");
    r->image->sizes[a] = size;
  }
  r->has_sizes = true;
  return LAVES_OK;
}

/* A number for each axis; "nan" says that there is none. */
static laves_result read_per_axis(reader *r, double values[AXES], laves_error *error) {
  for (int a = 0; a < AXES; a++) {
    if (laves__scan_keyword(&r->scan, "nan"))
      values[a] = NAN;
    else if (!laves__scan_double(&r->scan, &values[a]))
      return laves__scan_fail_expected(&r->scan, error, "a number for each of three axes");
  }
  return LAVES_OK;
}

static laves_result read_centerings(reader *r, laves_error *error) {
  laves__word word;
  for (int a = 0; a < AXES; a++) {
    if (!laves__scan_word(&r->scan, &word))
      return laves__scan_fail_expected(&r->scan, error, "node or cell for each of three axes");
    r->cells[a] = laves__word_is(word, "cell");
  }
  return LAVES_OK;
}

static bool take(laves__scan *scan, char c) {
  if (!laves__scan_blanks(scan) || *scan->at != c) return false;
  scan->at++;
  return true;
}

/* "(x,y,z)" */
static bool take_vector(laves__scan *scan, laves__vec3 *v) {
  double *coordinates[3] = {&v->x, &v->y, &v->z};
  for (int i = 0; i < 3; i++) {
    if (!take(scan, i == 0 ? '(' : ',') || !laves__scan_blanks(scan)) return false;
    const char *after = laves__parse_double(scan->at, scan->end, coordinates[i]);
    if (!after) return false;
    scan->at = after;
  }
  return take(scan, ')');
}

static laves_result read_directions(reader *r, laves_error *error) {
  for (int a = 0; a < AXES; a++)
    if (!take_vector(&r->scan, &r->image->axes[a]))
      return laves__scan_fail_expected(&r->scan, error, "a vector (x,y,z) for each of three axes");
  r->has_directions = true;
  return LAVES_OK;
}

static laves_result read_origin(reader *r, laves_error *error) {
  if (!take_vector(&r->scan, &r->image->origin)) return laves__scan_fail_expected(&r->scan, error, "a point (x,y,z)");
  r->has_origin = true;
  return LAVES_OK;
}

static laves_result read_line_skip(reader *r, laves_error *error) {
  if (laves__scan_count(&r->scan, SIZE_MAX / 2, &r->line_skip)) return LAVES_OK;
  return laves__scan_fail_expected(&r->scan, error, "a number of lines");
}

static laves_result read_byte_skip(reader *r, laves_error *error) {
  if (laves__scan_int(&r->scan, &r->byte_skip) && r->byte_skip >= -1) return LAVES_OK;
  return laves__scan_fail_expected(&r->scan, error, "a number of bytes, or -1");
}

/* Only a plain name: a header may not reach into other folders, and lists of files are not read. */
static laves_result read_data_file(reader *r, laves_error *error) {
  r->data_file = laves__scan_rest(&r->scan);
  const laves__word name = r->data_file;
  const bool plain = name.length > 0 && name.length < NAME_MAX && !memchr(name.at, '/', name.length) &&
                     !memchr(name.at, '\\', name.length) && !memchr(name.at, '%', name.length) &&
                     !memchr(name.at, 0, name.length) && !laves__word_is(name, "LIST") &&
                     !(name.length > 5 && memcmp(name.at, "LIST ", 5) == 0);
  if (plain) return LAVES_OK;
  return laves__scan_fail(&r->scan, error, "the data must be in one file in the same folder, given by its name alone");
}

typedef laves_result field_fn(reader *r, laves_error *error);

static laves_result read_spacings(reader *r, laves_error *error) { return read_per_axis(r, r->spacings, error); }
static laves_result read_mins(reader *r, laves_error *error) { return read_per_axis(r, r->mins, error); }
static laves_result read_maxs(reader *r, laves_error *error) { return read_per_axis(r, r->maxs, error); }

/* Fields that are not here say nothing about numbers and places. */
static const struct {
  const char *name;
  field_fn *read;
} fields[] = {
    {"dimension", read_dimension}, {"type", read_type},
    {"encoding", read_encoding},   {"endian", read_endian},
    {"sizes", read_sizes},         {"spacings", read_spacings},
    {"axis mins", read_mins},      {"axismins", read_mins},
    {"axis maxs", read_maxs},      {"axismaxs", read_maxs},
    {"centers", read_centerings},  {"centerings", read_centerings},
    {"space origin", read_origin}, {"space directions", read_directions},
    {"line skip", read_line_skip}, {"lineskip", read_line_skip},
    {"byte skip", read_byte_skip}, {"byteskip", read_byte_skip},
    {"data file", read_data_file}, {"datafile", read_data_file},
};

/* One line: a field, a key with its value (":="), or a comment. */
static laves_result read_line(reader *r, laves_error *error) {
  laves__scan look = r->scan;
  const laves__word line = laves__scan_rest(&look);
  const char *colon = line.length ? memchr(line.at, ':', line.length) : NULL;
  if (line.length == 0 || *line.at == '#') return LAVES_OK;
  if (!colon) return laves__scan_fail_expected(&r->scan, error, "a field such as 'sizes: 10 10 10', or an empty line");
  if (colon + 1 < line.at + line.length && colon[1] == '=') return LAVES_OK;
  const laves__word name = {line.at, (size_t)(colon - line.at)};
  for (size_t i = 0; i < LAVES__COUNT_OF(fields); i++)
    if (laves__word_is(name, fields[i].name)) {
      r->scan.at = colon + 1;
      return fields[i].read(r, error);
    }
  return LAVES_OK;
}

static bool at_empty_line(const laves__scan *scan) { return scan->at == scan->end || *scan->at == '\n' || *scan->at == '\r'; }

/* Behind the line end at or after the place; unlike laves__scan_next_line() it does not take "\r" and "\n" for one line
 * end where binary data may follow. */
static const char *behind_line(const char *at, const char *end) {
  const char *found = at < end ? memchr(at, '\n', (size_t)(end - at)) : NULL;
  return found ? found + 1 : end;
}

static laves_result read_header(reader *r, laves_error *error) {
  laves_result result = LAVES_OK;
  if (r->scan.end - r->scan.at < 8 || memcmp(r->scan.at, "NRRD000", 7) != 0)
    return fail(r, error, "it does not start with NRRD000 and the version");
  r->scan.at = behind_line(r->scan.at, r->scan.end);
  while (result == LAVES_OK && !at_empty_line(&r->scan)) {
    result = read_line(r, error);
    if (result == LAVES_OK) r->scan.at = behind_line(r->scan.at, r->scan.end);
  }
  if (result != LAVES_OK) return result;
  r->data = behind_line(r->scan.at, r->scan.end);
  r->data_end = r->scan.end;
  if (!r->has_type || !r->has_sizes || r->encoding == NO_ENCODING)
    return fail(r, error, "the header lacks one of the fields type, sizes and encoding");
  if (!r->has_endian && r->encoding != TEXT && kind_bytes[r->kind] > 1)
    return fail(r, error, "the header lacks the field endian (big or little)");
  return LAVES_OK;
}

/* ---- places ---- */

/* An axis without a direction in space lies along x, y or z. */
static laves_result place_axis(reader *r, int axis, double *origin, double *step, laves_error *error) {
  const double count = (double)r->image->sizes[axis], min = r->mins[axis], max = r->maxs[axis];
  const double steps = r->cells[axis] ? count : count - 1;
  *step = r->spacings[axis];
  if (isnan(*step) && steps > 0) *step = (max - min) / steps;
  if (!isfinite(*step) || *step == 0)
    return fail(r, error, "it does not say how far its samples are apart; give 'spacings' or 'space directions' in the header");
  const double first = !isnan(min) ? min : isnan(max) ? 0 : max - steps * *step;
  *origin = r->cells[axis] ? first + 0.5 * *step : first;
  return LAVES_OK;
}

static laves_result find_places(reader *r, laves_error *error) {
  laves__image_input *image = r->image;
  if (r->has_directions) {
    if (!r->has_origin) image->origin = v3(0, 0, 0);
    return LAVES_OK;
  }
  double origin[AXES] = {0}, step[AXES] = {0};
  for (int a = 0; a < AXES; a++) {
    const laves_result result = place_axis(r, a, &origin[a], &step[a], error);
    if (result != LAVES_OK) return result;
  }
  if (!r->has_origin) image->origin = v3(origin[0], origin[1], origin[2]);
  image->axes[0] = v3(step[0], 0, 0);
  image->axes[1] = v3(0, step[1], 0);
  image->axes[2] = v3(0, 0, step[2]);
  return LAVES_OK;
}

/* ---- samples ---- */

/* Finds the number of samples, unless the data, which are `available` bytes, cannot hold so many. */
static laves_result count_samples(reader *r, laves_error *error) {
  laves__image_input *image = r->image;
  const double available = (double)(r->data_end - r->data);
  const double count = (double)image->sizes[0] * (double)image->sizes[1] * (double)image->sizes[2];
  const double bytes = r->encoding == TEXT ? 2 * count - 1 : count * (double)kind_bytes[r->kind];
  if (bytes > available * (r->encoding == GZIP ? COMPRESSED_LIMIT : 1))
    return laves__fail(error, LAVES_ERROR_INPUT,
                       "%s: the data are shorter than announced: %zu x %zu x %zu samples do not fit in %.0f bytes", image->name,
                       image->sizes[0], image->sizes[1], image->sizes[2], available);
  image->sample_count = image->sizes[0] * image->sizes[1] * image->sizes[2];
  return LAVES_OK;
}

static bool fits_float(kind k) { return k <= UINT16 || k == FLOAT32; }

static laves_result make_samples(reader *r, laves_error *error) {
  laves__image_input *image = r->image;
  if (fits_float(r->kind))
    image->narrow = laves__alloc(image->context, image->sample_count, sizeof *image->narrow);
  else
    image->wide = laves__alloc(image->context, image->sample_count, sizeof *image->wide);
  return image->narrow || image->wide ? LAVES_OK : laves__fail_memory(image->context, error);
}

static void put_sample(laves__image_input *image, size_t i, double value) {
  if (image->narrow)
    image->narrow[i] = (float)value;
  else
    image->wide[i] = value;
}

/* The number at `at`. */
static double decode(kind k, const char *at, bool big_endian) {
  uint64_t bits = 0;
  const size_t size = kind_bytes[k];
  for (size_t i = 0; i < size; i++) bits |= (uint64_t)(uint8_t)at[big_endian ? size - 1 - i : i] << (8 * i);
  union {
    uint32_t bits;
    float value;
  } narrow = {.bits = (uint32_t)bits};
  union {
    uint64_t bits;
    double value;
  } wide = {.bits = bits};
  switch (k) {
    case INT8:
      return (int8_t)bits;
    case INT16:
      return (int16_t)bits;
    case INT32:
      return (int32_t)bits;
    case INT64:
      return (double)(int64_t)bits;
    case FLOAT32:
      return narrow.value;
    case FLOAT64:
      return wide.value;
    default:
      return (double)bits;
  }
}

static bool cancelled(const reader *r, size_t done) {
  return laves__cancelled(r->image->context, "read", (double)done / (double)r->image->sample_count);
}

enum { SAMPLES_PER_QUESTION = 1 << 18 }; /* between two questions whether to cancel */

static laves_result decode_all(reader *r, const char *bytes, laves_error *error) {
  const size_t size = kind_bytes[r->kind];
  for (size_t i = 0; i < r->image->sample_count; i++) {
    put_sample(r->image, i, decode(r->kind, bytes + i * size, r->big_endian));
    if (i % SAMPLES_PER_QUESTION == SAMPLES_PER_QUESTION - 1 && cancelled(r, i)) return laves__fail_cancelled(error);
  }
  return LAVES_OK;
}

static laves_result read_raw(reader *r, laves_error *error) {
  const size_t bytes = r->image->sample_count * kind_bytes[r->kind], available = (size_t)(r->data_end - r->data);
  const size_t skip = r->byte_skip < 0 ? available - bytes : (size_t)r->byte_skip;
  if (skip > available - bytes) return fail(r, error, "the data are shorter than announced");
  return decode_all(r, r->data + skip, error);
}

static laves_result read_text(reader *r, laves_error *error) {
  const size_t available = (size_t)(r->data_end - r->data);
  if (r->byte_skip < 0 || (size_t)r->byte_skip > available) return fail(r, error, "'byte skip' does not suit the data");
  laves__scan scan = {.begin = r->data, .at = r->data + r->byte_skip, .end = r->data_end, .name = r->image->name};
  if (r->data_file.length == 0) scan.begin = r->image->begin; /* so that lines are counted from the top of the file */
  for (size_t i = 0; i < r->image->sample_count; i++) {
    double value;
    if (!laves__scan_space(&scan) || !laves__scan_double(&scan, &value))
      return laves__scan_fail_expected(&scan, error, "a sample");
    put_sample(r->image, i, value);
    if (i % SAMPLES_PER_QUESTION == SAMPLES_PER_QUESTION - 1 && cancelled(r, i)) return laves__fail_cancelled(error);
  }
  return LAVES_OK;
}

/* Inflates the next `count` bytes; `out` NULL: into nothing. The data may be several gzip streams in a row. */
static laves_result inflate_bytes(reader *r, z_stream *z, char *out, size_t count, laves_error *error) {
  enum { CHUNK = 1 << 16 };
  Bytef waste[1024];
  while (count > 0) {
    if (z->avail_in == 0) {
      const size_t left = (size_t)(r->data_end - r->data), taken = left < CHUNK ? left : CHUNK;
      z->next_in = (Bytef *)r->data;
      z->avail_in = (uInt)taken;
      r->data += taken;
    }
    const size_t room = out ? CHUNK : sizeof waste, asked = count < room ? count : room;
    z->next_out = out ? (Bytef *)out : waste;
    z->avail_out = (uInt)asked;
    const int status = inflate(z, Z_NO_FLUSH);
    const size_t got = asked - z->avail_out;
    if (out) out += got;
    count -= got;
    if (status == Z_MEM_ERROR) return laves__fail_memory(r->image->context, error);
    const bool more =
        status == Z_STREAM_END && count > 0 && inflateReset(z) == Z_OK && (z->avail_in > 0 || r->data < r->data_end);
    if (status != Z_OK && !more && count > 0) return fail(r, error, "the compressed data are shorter than announced or damaged");
    if (laves__cancelled(r->image->context, "read", 0)) return laves__fail_cancelled(error);
  }
  return LAVES_OK;
}

static laves_result read_gzip(reader *r, laves_error *error) {
  laves_context *context = r->image->context;
  const size_t bytes = r->image->sample_count * kind_bytes[r->kind];
  const double limit = (double)COMPRESSED_LIMIT * (double)(r->data_end - r->data);
  if (r->byte_skip < 0 || (double)r->byte_skip > limit) return fail(r, error, "'byte skip' does not suit compressed data");
  enum { ANY_HEADER = 15 + 32 }; /* the largest window; gzip or zlib */
  z_stream z = {.zalloc = laves__zlib_allocate, .zfree = laves__zlib_free, .opaque = context};
  char *plain = laves__alloc(context, bytes, 1);
  if (!plain || inflateInit2(&z, ANY_HEADER) != Z_OK) {
    laves__free(context, plain, bytes, 1);
    return laves__fail_memory(context, error);
  }
  laves_result result = inflate_bytes(r, &z, NULL, (size_t)r->byte_skip, error);
  if (result == LAVES_OK) result = inflate_bytes(r, &z, plain, bytes, error);
  inflateEnd(&z);
  if (result == LAVES_OK) result = decode_all(r, plain, error);
  laves__free(context, plain, bytes, 1);
  return result;
}

static laves_result read_samples(reader *r, laves_error *error) {
  for (size_t i = 0; i < r->line_skip && r->data < r->data_end; i++) r->data = behind_line(r->data, r->data_end);
  laves_result result = count_samples(r, error);
  if (result == LAVES_OK) result = make_samples(r, error);
  if (result != LAVES_OK) return result;
  return r->encoding == RAW ? read_raw(r, error) : r->encoding == TEXT ? read_text(r, error) : read_gzip(r, error);
}

/* Samples in another file: its name stands for that of the header behind the last '/'. */
static laves_result read_detached(reader *r, laves_error *error) {
  laves_context *context = r->image->context;
  const char *slash = strrchr(r->image->name, '/');
  const int folder = slash ? (int)(slash + 1 - r->image->name) : 0;
  char path[PATH_MAX], *bytes;
  size_t length;
  if (snprintf(path, sizeof path, "%.*s%.*s", folder, r->image->name, (int)r->data_file.length, r->data_file.at) >=
      (int)sizeof path)
    return fail(r, error, "the name of the data file is too long");
  laves_result result = laves__file_read(context, path, &bytes, &length, error);
  if (result != LAVES_OK) return result;
  r->data = bytes;
  r->data_end = bytes + length;
  result = read_samples(r, error);
  laves__free(context, bytes, length + 1, 1);
  return result;
}

laves_result laves__read_nrrd(laves__image_input *image, laves_error *error) {
  reader r = {.image = image,
              .scan = {.begin = image->begin, .at = image->begin, .end = image->end, .name = image->name},
              .spacings = {NAN, NAN, NAN},
              .mins = {NAN, NAN, NAN},
              .maxs = {NAN, NAN, NAN}};
  laves_result result = read_header(&r, error);
  if (result == LAVES_OK) result = find_places(&r, error);
  if (result != LAVES_OK) return result;
  result = r.data_file.length ? read_detached(&r, error) : read_samples(&r, error);
  if (result != LAVES_OK) laves__image_input_free(image);
  return result;
}
