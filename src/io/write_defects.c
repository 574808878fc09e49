/* The places of defects as points, lines and faces, with a colour for each kind.
 *
 *   .ply  text: vertex (x y z red green blue), face and edge elements (MeshLab, CloudCompare, Blender, Open3D)
 *   .obj  a group for each kind, p, l and f elements, colours behind coordinates (Blender, MeshLab)
 *   .vtp  VTK's XML of polygons: cell arrays "defect" and "color", with a table of names in the file (ParaView, PyVista)
 *
 * Each place has corners of its own, since a corner has the colour of its kind. */
#include <string.h>
#include <strings.h>

#include "domain/defects.h"
#include "io/number_text.h"
#include "io/output.h"

typedef struct paint {
  unsigned char red, green, blue;
} paint;

/* Indexed by laves_defect; told in docs/dirty.md. */
static const paint paints[] = {
    [LAVES_DEFECT_OPEN_EDGE] = {214, 39, 40},            /* red */
    [LAVES_DEFECT_NONMANIFOLD_EDGE] = {148, 103, 189},   /* purple */
    [LAVES_DEFECT_DIRECTION] = {31, 119, 180},           /* blue */
    [LAVES_DEFECT_NONMANIFOLD_VERTEX] = {227, 119, 194}, /* pink */
    [LAVES_DEFECT_DUPLICATE_FACE] = {23, 190, 207},      /* cyan */
    [LAVES_DEFECT_DEGENERATE_FACE] = {140, 86, 75},      /* brown */
    [LAVES_DEFECT_CROSSING] = {255, 127, 14},            /* orange */
    [LAVES_DEFECT_REPEATED_POINT] = {188, 189, 34},      /* olive */
    [LAVES_DEFECT_UNUSED_POINT] = {127, 127, 127},       /* grey */
};

static paint paint_of(const laves__defect_item *item) { return paints[item->kind]; }

/* How many places have `corners` corners, 1 to 3. */
static size_t count_of(const laves_defects *defects, int corners) {
  size_t count = 0;
  for (size_t i = 0; i < defects->count; i++) count += defects->items[i].corner_count == corners;
  return count;
}

static size_t corner_total(const laves_defects *defects) {
  return count_of(defects, 1) + 2 * count_of(defects, 2) + 3 * count_of(defects, 3);
}

static void put_place(laves__output *out, laves__vec3 p) {
  char text[3 * (LAVES__DOUBLE_TEXT_MAX + 1)], *end = text;
  const double xyz[3] = {p.x, p.y, p.z};
  for (int k = 0; k < 3; k++) {
    if (k > 0) *end++ = ' ';
    end = laves__put_double(end, xyz[k]);
  }
  laves__output_bytes(out, text, (size_t)(end - text));
}

/* Calls for each item of so many corners, with the index of its first corner; items stand in the order of the list. */
typedef void item_fn(laves__output *out, const laves__defect_item *item, size_t first_corner);
static void each_item(laves__output *out, const laves_defects *defects, int corners, item_fn *fn) {
  size_t first = 0;
  for (size_t i = 0; i < defects->count; i++) {
    const laves__defect_item *item = &defects->items[i];
    if (item->corner_count == corners) fn(out, item, first);
    first += (size_t)item->corner_count;
  }
}

/* ---- PLY ---- */

static void ply_face(laves__output *out, const laves__defect_item *item, size_t first) {
  const paint c = paint_of(item);
  laves__output_printf(out, "3 %zu %zu %zu %d %d %d %d\n", first, first + 1, first + 2, c.red, c.green, c.blue, (int)item->kind);
}

static void ply_edge(laves__output *out, const laves__defect_item *item, size_t first) {
  const paint c = paint_of(item);
  laves__output_printf(out, "%zu %zu %d %d %d %d\n", first, first + 1, c.red, c.green, c.blue, (int)item->kind);
}

static void write_ply(laves__output *out, const laves_defects *defects) {
  static const char color[] = "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty int defect\n";
  laves__output_printf(out, "ply\nformat ascii 1.0\ncomment defects of a surface, by laves\n");
  for (int kind = 0; kind < LAVES_DEFECT_COUNT; kind++)
    laves__output_printf(out, "comment defect %d: %s\n", kind, laves_defect_text((laves_defect)kind));
  laves__output_printf(out, "element vertex %zu\nproperty double x\nproperty double y\nproperty double z\n%s",
                       corner_total(defects), color);
  laves__output_printf(out, "element face %zu\nproperty list uchar int vertex_indices\n%s", count_of(defects, 3), color);
  laves__output_printf(out, "element edge %zu\nproperty int vertex1\nproperty int vertex2\n%send_header\n", count_of(defects, 2),
                       color);
  for (size_t i = 0; i < defects->count; i++) {
    const laves__defect_item *item = &defects->items[i];
    const paint c = paint_of(item);
    for (int k = 0; k < item->corner_count; k++) {
      put_place(out, item->corners[k]);
      laves__output_printf(out, " %d %d %d %d\n", c.red, c.green, c.blue, (int)item->kind);
    }
  }
  each_item(out, defects, 3, ply_face);
  each_item(out, defects, 2, ply_edge);
}

/* ---- OBJ ---- */

/* "open edges" becomes "open_edges". */
static void obj_group(laves__output *out, laves_defect kind) {
  char name[80];
  size_t i = 0;
  for (const char *text = laves_defect_text(kind); text[i] && i + 1 < sizeof name; i++) name[i] = text[i] == ' ' ? '_' : text[i];
  name[i] = 0;
  laves__output_printf(out, "g %s\n", name);
}

static void obj_corners(laves__output *out, const laves__defect_item *item) {
  const paint c = paint_of(item);
  for (int k = 0; k < item->corner_count; k++) {
    laves__output_bytes(out, "v ", 2);
    put_place(out, item->corners[k]);
    laves__output_printf(out, " %.3f %.3f %.3f\n", c.red / 255.0, c.green / 255.0, c.blue / 255.0);
  }
}

static void write_obj(laves__output *out, const laves_defects *defects) {
  laves__output_printf(out, "# defects of a surface, by laves\n");
  for (int kind = 0; kind < LAVES_DEFECT_COUNT; kind++) {
    bool named = false;
    for (size_t i = 0; i < defects->count; i++) {
      const laves__defect_item *item = &defects->items[i];
      if (item->kind != kind) continue;
      if (!named) obj_group(out, (laves_defect)kind);
      named = true;
      obj_corners(out, item);
      /* Negative indices count back from the last point. */
      laves__output_printf(out, "%s",
                           item->corner_count == 1   ? "p -1\n"
                           : item->corner_count == 2 ? "l -2 -1\n"
                                                     : "f -3 -2 -1\n");
    }
  }
}

/* ---- VTP ---- */

static void vtp_kind(laves__output *out, const laves__defect_item *item, size_t first) {
  (void)first;
  laves__output_printf(out, "%d\n", (int)item->kind);
}

static void vtp_color(laves__output *out, const laves__defect_item *item, size_t first) {
  const paint c = paint_of(item);
  (void)first;
  laves__output_printf(out, "%d %d %d\n", c.red, c.green, c.blue);
}

static void vtp_corners(laves__output *out, const laves__defect_item *item, size_t first) {
  for (size_t k = 0; k < (size_t)item->corner_count; k++) laves__output_printf(out, "%zu ", first + k);
  laves__output_bytes(out, "\n", 1);
}

/* Cell data in the order of VTK: vertices, lines, polygons. */
static void vtp_cells(laves__output *out, const laves_defects *defects, item_fn *fn) {
  for (int corners = 1; corners <= 3; corners++) each_item(out, defects, corners, fn);
}

static void vtp_group(laves__output *out, const laves_defects *defects, const char *name, int corners) {
  const size_t count = count_of(defects, corners);
  laves__output_printf(out, "<%s>\n<DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">\n", name);
  each_item(out, defects, corners, vtp_corners);
  laves__output_printf(out, "</DataArray>\n<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">\n");
  for (size_t i = 1; i <= count; i++) laves__output_printf(out, "%zu\n", i * (size_t)corners);
  laves__output_printf(out, "</DataArray>\n</%s>\n", name);
}

static void write_vtp(laves__output *out, const laves_defects *defects) {
  laves__output_printf(out, "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\">\n");
  for (int kind = 0; kind < LAVES_DEFECT_COUNT; kind++)
    laves__output_printf(out, "<!-- defect %d: %s -->\n", kind, laves_defect_text((laves_defect)kind));
  laves__output_printf(out, "<PolyData>\n<Piece NumberOfPoints=\"%zu\" NumberOfVerts=\"%zu\" NumberOfLines=\"%zu\" ",
                       corner_total(defects), count_of(defects, 1), count_of(defects, 2));
  laves__output_printf(out, "NumberOfStrips=\"0\" NumberOfPolys=\"%zu\">\n<Points>\n", count_of(defects, 3));
  laves__output_printf(out, "<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\n");
  for (size_t i = 0; i < defects->count; i++)
    for (int k = 0; k < defects->items[i].corner_count; k++) {
      put_place(out, defects->items[i].corners[k]);
      laves__output_bytes(out, "\n", 1);
    }
  laves__output_printf(out, "</DataArray>\n</Points>\n");
  laves__output_printf(out, "<CellData Scalars=\"color\">\n<DataArray type=\"Int32\" Name=\"defect\" format=\"ascii\">\n");
  vtp_cells(out, defects, vtp_kind);
  laves__output_printf(out,
                       "</DataArray>\n<DataArray type=\"UInt8\" Name=\"color\" NumberOfComponents=\"3\" format=\"ascii\">\n");
  vtp_cells(out, defects, vtp_color);
  laves__output_printf(out, "</DataArray>\n</CellData>\n");
  vtp_group(out, defects, "Verts", 1);
  vtp_group(out, defects, "Lines", 2);
  vtp_group(out, defects, "Polys", 3);
  laves__output_printf(out, "</Piece>\n</PolyData>\n</VTKFile>\n");
}

/* ---- choosing ---- */

typedef void writer_fn(laves__output *out, const laves_defects *defects);

static writer_fn *writer_for(const char *path) {
  static const struct {
    const char *extension;
    writer_fn *write;
  } writers[] = {{".ply", write_ply}, {".obj", write_obj}, {".vtp", write_vtp}};
  const size_t length = strlen(path);
  for (size_t i = 0; i < LAVES__COUNT_OF(writers); i++)
    if (length >= 4 && strcasecmp(path + length - 4, writers[i].extension) == 0) return writers[i].write;
  return NULL;
}

laves_result laves_defects_write(laves_context *context, const laves_defects *defects, const char *path, laves_error *error) {
  writer_fn *write = writer_for(path);
  if (!write)
    return laves__fail(error, LAVES_ERROR_OPTION, "defects are written as .ply, .obj or .vtp, which '%.200s' is not", path);
  laves__progress_reset(context);
  laves__output out;
  if (laves__output_open(&out, context, path) == LAVES_OK) {
    write(&out, defects);
    if (laves__output_complete(&out) == LAVES_OK) laves__output_publish(&out);
  }
  const laves_result result = out.error.result;
  const laves_error first = out.error;
  laves__output_discard(&out);
  return result == LAVES_OK ? LAVES_OK : laves__fail(error, result, "%s", first.text);
}
