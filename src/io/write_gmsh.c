/* Gmsh's MSH files, version 2.2 and 4.1, text and binary.
 *
 * Boundary triangles and then tetrahedra, numbered from 1; each face tag is a surface and each region a volume with a named
 * physical group of the same number. Gmsh wants positive numbers: where a tag is zero or less, the tags of that dimension
 * are numbered 1, 2, ... in ascending order instead. Elements stand in blocks of equal tag; their numbers tell the mesh's order.
 * Of a mesh of second order, triangles have six nodes and tetrahedra ten, the last two in Gmsh's own order.
 * Source: Gmsh reference manual, "MSH file format" and "MSH file format version 2 (Legacy)". */
#include <string.h>

#include "io/tag_order.h"
#include "io/write_mesh.h"
#include "io/write_text.h"

enum { ELEMENT_TRIANGLE = 2, ELEMENT_TET = 4, ELEMENT_TRIANGLE_2 = 9, ELEMENT_TET_2 = 11 };
/* Numbers of an element at most. */
enum { NODES_MAX = 10 };

/* The elements of one dimension. */
typedef struct elements {
  const laves_mesh *mesh;
  int dimension;
  int corner_count;
  int type;
  size_t count;
  size_t first_number;
  laves__tag_order order;
  size_t group_count; /* groups that have elements; for volumes at least 1, since nodes need one to belong to */
} elements;

typedef struct file {
  laves__output *out;
  const laves_mesh *mesh;
  bool ascii;
  elements sets[2]; /* triangles, tets */
  laves__box3 box;
} file;

/* Items are had in pieces of so many. */
enum { PIECE = 512 };

static void find_box(file *f) {
  laves__vec3 point[PIECE];
  const size_t count = f->mesh->vertex_count;
  for (size_t i = 0; i < count; i++) {
    if (i % PIECE == 0) laves__mesh_points(f->mesh, i, count - i < PIECE ? count : i + PIECE, point);
    f->box = box3_add(f->box, point[i % PIECE]);
  }
}

static bool open_file(file *f, laves__output *out, const laves_mesh *mesh, bool ascii) {
  *f = (file){.out = out, .mesh = mesh, .ascii = ascii, .box = box3_empty()};
  const bool second = mesh->quadratic != NULL;
  f->sets[0] = (elements){.mesh = mesh,
                          .dimension = 2,
                          .corner_count = laves__face_width(mesh),
                          .type = second ? ELEMENT_TRIANGLE_2 : ELEMENT_TRIANGLE,
                          .count = mesh->face_count,
                          .first_number = 1};
  f->sets[1] = (elements){.mesh = mesh,
                          .dimension = 3,
                          .corner_count = laves__tet_width(mesh),
                          .type = second ? ELEMENT_TET_2 : ELEMENT_TET,
                          .count = mesh->tet_count,
                          .first_number = 1 + mesh->face_count};
  if (!laves__tag_order_make(out->context, mesh->face_tags, mesh->face_count, &f->sets[0].order) ||
      !laves__tag_order_make(out->context, mesh->regions, mesh->tet_count, &f->sets[1].order)) {
    laves__output_fail_memory(out);
    laves__tag_order_free(out->context, &f->sets[0].order);
    return false;
  }
  f->sets[0].group_count = mesh->face_count > 0 ? f->sets[0].order.count : 0;
  f->sets[1].group_count = f->sets[1].order.count;
  find_box(f);
  if (mesh->vertex_count == 0) f->box = (laves__box3){v3(0, 0, 0), v3(0, 0, 0)};
  const double elements_total = (double)mesh->face_count + (double)mesh->tet_count;
  out->expected = 45.0 * (double)mesh->vertex_count + 38.0 * elements_total;
  return true;
}

static void close_file(file *f) {
  for (int i = 0; i < 2; i++) laves__tag_order_free(f->out->context, &f->sets[i].order);
}

static int32_t physical_tag(const elements *e, size_t group) { return laves__tag_number(&e->order, group); }

/* Corners of some elements in turn. A streamed mesh has one region, and its tets follow each other. */
typedef struct corner_reader {
  const elements *elements;
  size_t first, end; /* the tets in `piece` */
  int32_t piece[PIECE][4];
  int32_t swapped[NODES_MAX];
} corner_reader;

/* Gmsh's last two nodes of ten stand on the other's edge. */
static const int32_t *swap_last(corner_reader *r, const int32_t *nodes) {
  memcpy(r->swapped, nodes, sizeof r->swapped);
  r->swapped[8] = nodes[9];
  r->swapped[9] = nodes[8];
  return r->swapped;
}

static const int32_t *corners(corner_reader *r, size_t i) {
  const laves_mesh *mesh = r->elements->mesh;
  if (r->elements->dimension == 2) return laves__face_nodes(mesh, i);
  if (mesh->quadratic) return swap_last(r, mesh->quadratic->tets[i]);
  if (mesh->tets) return mesh->tets[i];
  if (i < r->first || i >= r->end) {
    r->first = i;
    r->end = mesh->tet_count - i < PIECE ? mesh->tet_count : i + PIECE;
    laves__mesh_tets(mesh, r->first, r->end, r->piece);
  }
  return r->piece[i - r->first];
}

/* ---- parts that both versions share ---- */

static void write_int(file *f, int32_t value) { laves__output_bytes(f->out, &value, sizeof value); }
static void write_size(file *f, uint64_t value) { laves__output_bytes(f->out, &value, sizeof value); }

static void write_header(file *f, const char *version) {
  laves__output_printf(f->out, "$MeshFormat\n%s %d 8\n", version, f->ascii ? 0 : 1);
  if (!f->ascii) {
    write_int(f, 1); /* tells the byte order */
    laves__output_printf(f->out, "\n");
  }
  laves__output_printf(f->out, "$EndMeshFormat\n");
  laves__output_printf(f->out, "$PhysicalNames\n%zu\n", f->sets[0].group_count + f->sets[1].group_count);
  for (int d = 0; d < 2; d++)
    for (size_t i = 0; i < f->sets[d].group_count; i++) {
      const elements *e = &f->sets[d];
      char name[LAVES__TAG_NAME_MAX];
      laves__tag_name(f->mesh, e->dimension, &e->order, i, name);
      laves__output_printf(f->out, "%d %d \"%s\"\n", e->dimension, (int)physical_tag(e, i), name);
    }
  laves__output_printf(f->out, "$EndPhysicalNames\n");
}

/* The elements of one group, [first, order.first[group + 1]) in the order of tags. */
typedef struct block {
  const elements *elements;
  size_t group, first, count;
} block;

static block get_block(const elements *e, size_t group) {
  const size_t first = e->order.first[group];
  return (block){e, group, first, e->order.first[group + 1] - first};
}

static size_t block_item(const block *b, size_t i) { return laves__tag_order_item(&b->elements->order, b->first + i); }

static size_t put_points(const void *user, size_t begin, size_t end, char *bytes) {
  const laves_mesh *mesh = user;
  char *text = bytes;
  laves__vec3 piece[PIECE];
  for (size_t i = begin; i < end; i++) {
    const size_t at = (i - begin) % PIECE;
    if (at == 0) laves__mesh_points(mesh, i, end - i < PIECE ? end : i + PIECE, piece);
    text = laves__put_point(text, piece[at]);
    *text++ = '\n';
  }
  return (size_t)(text - bytes);
}

/* ---- version 2.2 ---- */

static size_t put_nodes22(const void *user, size_t begin, size_t end, char *bytes) {
  const laves_mesh *mesh = user;
  char *text = bytes;
  laves__vec3 piece[PIECE];
  for (size_t i = begin; i < end; i++) {
    const size_t at = (i - begin) % PIECE;
    if (at == 0) laves__mesh_points(mesh, i, end - i < PIECE ? end : i + PIECE, piece);
    text = laves__put_integer(text, (int64_t)i + 1);
    *text++ = ' ';
    text = laves__put_point(text, piece[at]);
    *text++ = '\n';
  }
  return (size_t)(text - bytes);
}

enum { NODE22_BYTES = 28 };

static size_t pack_nodes22(const void *user, size_t begin, size_t end, char *bytes) {
  const laves_mesh *mesh = user;
  laves__vec3 piece[PIECE];
  for (size_t i = begin; i < end; i++, bytes += NODE22_BYTES) {
    const size_t at = (i - begin) % PIECE;
    if (at == 0) laves__mesh_points(mesh, i, end - i < PIECE ? end : i + PIECE, piece);
    const int32_t number = (int32_t)(i + 1);
    memcpy(bytes, &number, 4);
    memcpy(bytes + 4, &piece[at], 24);
  }
  return (end - begin) * NODE22_BYTES;
}

/* "number type 2 physical entity corners" */
static size_t put_elements22(const void *user, size_t begin, size_t end, char *bytes) {
  const block *b = user;
  const elements *e = b->elements;
  corner_reader reader = {.elements = e};
  char *text = bytes;
  for (size_t i = begin; i < end; i++) {
    const size_t item = block_item(b, i);
    const int32_t head[] = {(int32_t)(e->first_number + item), e->type, 2, physical_tag(e, b->group), (int32_t)b->group + 1};
    text = laves__put_indices(text, head, 5, 0);
    *text++ = ' ';
    text = laves__put_indices(text, corners(&reader, item), e->corner_count, 1);
    *text++ = '\n';
  }
  return (size_t)(text - bytes);
}

static size_t pack_elements22(const void *user, size_t begin, size_t end, char *bytes) {
  const block *b = user;
  const elements *e = b->elements;
  corner_reader reader = {.elements = e};
  const size_t size = (size_t)(3 + e->corner_count) * 4;
  for (size_t i = begin; i < end; i++, bytes += size) {
    const size_t item = block_item(b, i);
    const int32_t *corner = corners(&reader, item);
    int32_t row[3 + NODES_MAX] = {(int32_t)(e->first_number + item), physical_tag(e, b->group), (int32_t)b->group + 1};
    for (int j = 0; j < e->corner_count; j++) row[3 + j] = corner[j] + 1;
    memcpy(bytes, row, size);
  }
  return (end - begin) * size;
}

static void write_block22(file *f, const block *b) {
  if (f->ascii) {
    laves__output_items(f->out, b->count, (5 + NODES_MAX) * (LAVES__INTEGER_TEXT_MAX + 1), put_elements22, b);
    return;
  }
  write_int(f, b->elements->type);
  write_int(f, (int32_t)b->count);
  write_int(f, 2);
  laves__output_rows(f->out, b->count, (size_t)(3 + b->elements->corner_count) * 4, pack_elements22, b);
}

void laves__write_gmsh22(laves__output *out, const laves_mesh *mesh, bool ascii) {
  const size_t element_count = mesh->face_count + mesh->tet_count;
  if (element_count > INT32_MAX) {
    laves__output_fail(out, LAVES_ERROR_WRITE, "Gmsh 2.2 holds at most 2147483647 elements; choose Gmsh 4.1 or VTU");
    return;
  }
  file f;
  if (!open_file(&f, out, mesh, ascii)) return;
  write_header(&f, "2.2");
  laves__output_printf(out, "$Nodes\n%zu\n", mesh->vertex_count);
  if (ascii)
    laves__output_items(out, mesh->vertex_count, LAVES__POINT_TEXT_MAX + LAVES__INTEGER_TEXT_MAX + 2, put_nodes22, mesh);
  else
    laves__output_rows(out, mesh->vertex_count, NODE22_BYTES, pack_nodes22, mesh);
  laves__output_printf(out, "%s$EndNodes\n$Elements\n%zu\n", ascii ? "" : "\n", element_count);
  for (int d = 0; d < 2; d++)
    for (size_t i = 0; i < f.sets[d].group_count && f.sets[d].count > 0; i++) {
      const block b = get_block(&f.sets[d], i);
      write_block22(&f, &b);
    }
  laves__output_printf(out, "%s$EndElements\n", ascii ? "" : "\n");
  close_file(&f);
}

/* ---- version 4.1 ---- */

/* A row of int ('i') and size_t ('s') fields, as the format mixes them: text has a blank behind each and ends the line at
 * ';', binary has 4 and 8 bytes. Gmsh reads an entity's text from one line. */
static void write_fields(file *f, const char *kinds, const uint64_t *values) {
  for (; *kinds; kinds++) {
    if (f->ascii && *kinds == ';')
      laves__output_bytes(f->out, "\n", 1);
    else if (f->ascii)
      laves__output_printf(f->out, "%lld ", (long long)*values++);
    else if (*kinds == 'i')
      write_int(f, (int32_t)*values++);
    else if (*kinds == 's')
      write_size(f, *values++);
  }
}

static void write_box(file *f) {
  const double box[6] = {f->box.lower.x, f->box.lower.y, f->box.lower.z, f->box.upper.x, f->box.upper.y, f->box.upper.z};
  if (!f->ascii) {
    laves__output_bytes(f->out, box, sizeof box);
    return;
  }
  char text[2 * LAVES__POINT_TEXT_MAX + 2];
  char *end = laves__put_point(text, f->box.lower);
  *end++ = ' ';
  end = laves__put_point(end, f->box.upper);
  *end++ = ' ';
  laves__output_bytes(f->out, text, (size_t)(end - text));
}

/* Surfaces and volumes, each with its physical group. A single volume is bounded by all surfaces; which of several volumes
 * a surface bounds is left out, as the format allows. All have the box of the whole mesh. */
static void write_entities(file *f) {
  const size_t surfaces = f->sets[0].group_count, volumes = f->sets[1].group_count;
  laves__output_printf(f->out, "$Entities\n");
  write_fields(f, "ssss;", (uint64_t[]){0, 0, surfaces, volumes});
  for (int d = 0; d < 2; d++)
    for (size_t i = 0; i < f->sets[d].group_count; i++) {
      write_fields(f, "i", (uint64_t[]){i + 1});
      write_box(f);
      const size_t bounding = d == 1 && volumes == 1 ? surfaces : 0;
      write_fields(f, "sis", (uint64_t[]){1, (uint64_t)physical_tag(&f->sets[d], i), bounding});
      for (size_t j = 0; j < bounding; j++) write_fields(f, "i", (uint64_t[]){j + 1});
      write_fields(f, ";", NULL);
    }
  laves__output_printf(f->out, "%s$EndEntities\n", f->ascii ? "" : "\n");
}

static size_t put_numbers(const void *user, size_t begin, size_t end, char *bytes) {
  (void)user;
  char *text = bytes;
  for (size_t i = begin; i < end; i++) {
    text = laves__put_integer(text, (int64_t)i + 1);
    *text++ = '\n';
  }
  return (size_t)(text - bytes);
}

static size_t pack_numbers(const void *user, size_t begin, size_t end, char *bytes) {
  (void)user;
  for (size_t i = begin; i < end; i++, bytes += 8) {
    const uint64_t number = i + 1;
    memcpy(bytes, &number, 8);
  }
  return (end - begin) * 8;
}

static size_t pack_points(const void *user, size_t begin, size_t end, char *bytes) {
  laves__mesh_points(user, begin, end, (laves__vec3 *)(void *)bytes);
  return (end - begin) * sizeof(laves__vec3);
}

/* All nodes belong to the first volume. */
static void write_nodes41(file *f) {
  const size_t count = f->mesh->vertex_count;
  laves__output_printf(f->out, "$Nodes\n");
  write_fields(f, "ssss;", (uint64_t[]){count > 0, count, count > 0, count});
  if (count > 0) {
    write_fields(f, "iiis;", (uint64_t[]){3, 1, 0, count});
    if (f->ascii)
      laves__output_items(f->out, count, LAVES__INTEGER_TEXT_MAX + 1, put_numbers, NULL);
    else
      laves__output_rows(f->out, count, sizeof(uint64_t), pack_numbers, NULL);
    if (f->ascii)
      laves__output_items(f->out, count, LAVES__POINT_TEXT_MAX + 1, put_points, f->mesh);
    else
      laves__output_rows(f->out, count, sizeof(laves__vec3), pack_points, f->mesh);
  }
  laves__output_printf(f->out, "%s$EndNodes\n", f->ascii ? "" : "\n");
}

static size_t put_elements41(const void *user, size_t begin, size_t end, char *bytes) {
  const block *b = user;
  const elements *e = b->elements;
  corner_reader reader = {.elements = e};
  char *text = bytes;
  for (size_t i = begin; i < end; i++) {
    const size_t item = block_item(b, i);
    text = laves__put_integer(text, (int64_t)(e->first_number + item));
    *text++ = ' ';
    text = laves__put_indices(text, corners(&reader, item), e->corner_count, 1);
    *text++ = '\n';
  }
  return (size_t)(text - bytes);
}

static size_t pack_elements41(const void *user, size_t begin, size_t end, char *bytes) {
  const block *b = user;
  const elements *e = b->elements;
  corner_reader reader = {.elements = e};
  const size_t size = (size_t)(1 + e->corner_count) * 8;
  for (size_t i = begin; i < end; i++, bytes += size) {
    const size_t item = block_item(b, i);
    const int32_t *corner = corners(&reader, item);
    uint64_t row[1 + NODES_MAX] = {e->first_number + item};
    for (int j = 0; j < e->corner_count; j++) row[1 + j] = (uint64_t)corner[j] + 1;
    memcpy(bytes, row, size);
  }
  return (end - begin) * size;
}

static void write_elements41(file *f) {
  const uint64_t count = (uint64_t)f->mesh->face_count + f->mesh->tet_count;
  uint64_t blocks = 0;
  for (int d = 0; d < 2; d++) blocks += f->sets[d].count > 0 ? f->sets[d].group_count : 0;
  laves__output_printf(f->out, "$Elements\n");
  write_fields(f, "ssss;", (uint64_t[]){blocks, count, count > 0, count});
  for (int d = 0; d < 2; d++)
    for (size_t i = 0; i < f->sets[d].group_count && f->sets[d].count > 0; i++) {
      const elements *e = &f->sets[d];
      const block b = get_block(e, i);
      write_fields(f, "iiis;", (uint64_t[]){(uint64_t)e->dimension, i + 1, (uint64_t)e->type, b.count});
      if (f->ascii)
        laves__output_items(f->out, b.count, (1 + NODES_MAX) * (LAVES__INTEGER_TEXT_MAX + 1), put_elements41, &b);
      else
        laves__output_rows(f->out, b.count, (size_t)(1 + e->corner_count) * 8, pack_elements41, &b);
    }
  laves__output_printf(f->out, "%s$EndElements\n", f->ascii ? "" : "\n");
}

void laves__write_gmsh41(laves__output *out, const laves_mesh *mesh, bool ascii) {
  file f;
  if (!open_file(&f, out, mesh, ascii)) return;
  write_header(&f, "4.1");
  write_entities(&f);
  write_nodes41(&f);
  write_elements41(&f);
  close_file(&f);
}
