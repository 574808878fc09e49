/* Histograms as SVG.
 *
 * Bars are shares of all values, on a plain scale as in the paper; a bin that holds anything at all is drawn at least a hair
 * high, and the extremes are marked on the axis, for it is they that count.  A dashed line stands where the regular tetrahedron
 * is. */
#include "plot.h"

#include <math.h>
#include <stdio.h>

#include "interrupt.h"
#include "tet_shape.h"
#include "text.h"
#include "whole_file.h"

/* What a measure is called, and its axis: radius-edge ratios have no end, but hardly any are beyond 2.5. */
static const struct {
  const char *title, *what;
  double low, high, tick, regular;
  int digits;
} measures[PLOT_MEASURES] = {
    [PLOT_DIHEDRAL] = {"dihedral angles, degrees", "angles", 0, 180, 30, 70.528779, 1},
    [PLOT_RADIUS_RATIO] = {"radius ratio, 3 r / R", "tets", 0, 1, 0.2, 1, 3},
    [PLOT_RADIUS_EDGE] = {"radius-edge ratio, R / shortest edge (regular: 1)", "tets", 1, 2.5, 0.5, 1, 3},
};

/* ---- counting ---- */

static void add_value(histogram *out, double value) {
  static const double rounding = 1e-9; /* of a bin: the tiling's 60 degrees, an edge of bins, don't fall on both of its sides */
  if (isnan(value)) return;
  const double place = floor((value - out->low) / (out->high - out->low) * PLOT_BINS + rounding);
  const int bin = (int)fmax(0, fmin(PLOT_BINS - 1, place));
  out->bins[bin]++;
  out->min = fmin(out->min, value);
  out->max = fmax(out->max, value);
  out->mean += (value - out->mean) / (double)++out->count;
}

static void add_tet(histogram *out, double p[4][3]) {
  double angles[6];
  switch (out->measure) {
    case PLOT_DIHEDRAL:
      tet_dihedral_angles(p, angles);
      for (int i = 0; i < 6; ++i) add_value(out, angles[i]);
      break;
    case PLOT_RADIUS_RATIO:
      add_value(out, tet_radius_ratio(p));
      break;
    default:
      add_value(out, tet_radius_edge(p));
  }
}

histogram histogram_count(const laves_mesh *mesh, plot_measure measure) {
  histogram out = {.measure = measure, .min = INFINITY, .max = -INFINITY, .tets = laves_mesh_tet_count(mesh)};
  out.low = measures[measure].low;
  out.high = measures[measure].high;
  double p[4][3];
  for (size_t i = 0; i < out.tets && !interrupt_asked(); ++i) {
    tet_corners(mesh, (int64_t)i, p);
    add_tet(&out, p);
  }
  return out;
}

/* ---- drawing ---- */

/* Colours of paper, ink, pale lines and bars. */
typedef struct palette {
  const char *paper, *ink, *pale, *bar, *mark;
} palette;

static const palette light_palette = {"#ffffff", "#333333", "#e4e4e4", "#3d7ea6", "#b3461f"};
static const palette dark_palette = {"#1c1c1c", "#dddddd", "#3a3a3a", "#7fb5d6", "#f2a541"};

/* Where one histogram lies in the drawing: its axes span [left, right] x [top, bottom], pixels. */
typedef struct frame {
  double left, right, top, bottom, scale; /* pixels a per cent */
} frame;

static double place_x(const frame *box, const histogram *shown, double value) {
  const double share = (value - shown->low) / (shown->high - shown->low);
  return box->left + (box->right - box->left) * fmax(0, fmin(1, share));
}

/* 1, 2 or 5 times a power of ten, about a quarter of `high`. */
static double tick_step(double high) {
  const double power = pow(10, floor(log10(high / 4)));
  const double steps = high / 4 / power;
  return power * (steps > 5 ? 10 : steps > 2 ? 5 : steps > 1 ? 2 : 1);
}

static void draw_grid(FILE *file, const histogram *shown, frame *box, const palette *ink) {
  size_t most = 1;
  for (int i = 0; i < PLOT_BINS; ++i) most = shown->bins[i] > most ? shown->bins[i] : most;
  const double per_cent = 100.0 * (double)most / (double)(shown->count ? shown->count : 1), step = tick_step(per_cent);
  const int ticks = (int)ceil(per_cent / step - 1e-9);
  box->scale = (box->bottom - box->top) / (ticks * step);
  for (int i = 0; i <= ticks; ++i) {
    const double y = box->bottom - i * step * box->scale;
    fprintf(file, "<path d=\"M%.1f %.1fH%.1f\" stroke=\"%s\"/>\n", box->left, y, box->right, ink->pale);
    fprintf(file, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"end\">%g %%</text>\n", box->left - 6, y + 4, i * step);
  }
  for (double value = shown->low; value <= shown->high + 1e-9; value += measures[shown->measure].tick) {
    const double x = place_x(box, shown, value);
    fprintf(file, "<path d=\"M%.1f %.1fv4\" stroke=\"%s\"/>\n", x, box->bottom, ink->ink);
    fprintf(file, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">%g</text>\n", x, box->bottom + 22, value);
  }
}

static void draw_bars(FILE *file, const histogram *shown, const frame *box, const palette *ink) {
  static const double least_height = 0.8; /* pixels */
  const double width = (box->right - box->left) / PLOT_BINS;
  fprintf(file, "<g fill=\"%s\">\n", ink->bar);
  for (int i = 0; i < PLOT_BINS; ++i) {
    if (shown->bins[i] == 0) continue;
    const double share = 100.0 * (double)shown->bins[i] / (double)shown->count;
    const double height = fmax(least_height, share * box->scale);
    fprintf(file, "<rect x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\"/>\n", box->left + i * width, box->bottom - height,
            width * 0.94, height);
  }
  fputs("</g>\n", file);
}

/* A small triangle below the axis. */
static void draw_mark(FILE *file, double x, const frame *box, const palette *ink) {
  fprintf(file, "<path d=\"M%.1f %.1fl-4 8h8z\" fill=\"%s\"/>\n", x, box->bottom + 1, ink->mark);
}

static void draw_words(FILE *file, const histogram *shown, const frame *box, const palette *ink) {
  text_buffer tets;
  const int digits = measures[shown->measure].digits;
  const double regular = place_x(box, shown, measures[shown->measure].regular);
  fprintf(file, "<path d=\"M%.1f %.1fV%.1f\" stroke=\"%s\" stroke-dasharray=\"4 3\" opacity=\"0.6\"/>\n", regular, box->top,
          box->bottom, ink->ink);
  draw_mark(file, place_x(box, shown, shown->min), box, ink);
  draw_mark(file, place_x(box, shown, shown->max), box, ink);
  fprintf(file, "<text x=\"%.1f\" y=\"%.1f\" font-size=\"14\">%s</text>\n", box->left, box->top - 27,
          measures[shown->measure].title);
  fprintf(file, "<text x=\"%.1f\" y=\"%.1f\">min %.*f, mean %.*f, max %.*f; %s</text>\n", box->left, box->top - 10, digits,
          shown->min, digits, shown->mean, digits, shown->max, text_plural(&tets, shown->tets, "tet"));
}

static bool draw_all(FILE *file, const histogram *shown, int count, const plot_style *style) {
  const palette *ink = style->dark ? &dark_palette : &light_palette;
  fprintf(file, "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" viewBox=\"0 0 %d %d\" role=\"img\">\n",
          style->width, style->height, style->width, style->height);
  fputs("<title>", file);
  for (int i = 0; i < count; ++i) fprintf(file, "%s%s", i ? "; " : "Shares of ", measures[shown[i].measure].title);
  fputs("</title>\n", file);
  if (!style->transparent) fprintf(file, "<rect width=\"100%%\" height=\"100%%\" fill=\"%s\"/>\n", ink->paper);
  fprintf(file, "<g font-family=\"sans-serif\" font-size=\"12\" fill=\"%s\">\n", ink->ink);
  const double panel = (double)style->width / count;
  for (int i = 0; i < count; ++i) {
    frame box = {.left = i * panel + 52, .right = (i + 1) * panel - 18, .top = 52, .bottom = style->height - 36};
    draw_grid(file, &shown[i], &box, ink);
    draw_bars(file, &shown[i], &box, ink);
    draw_words(file, &shown[i], &box, ink);
  }
  fputs("</g>\n</svg>\n", file);
  return !ferror(file) && !interrupt_asked();
}

bool plot_write(const char *path, const histogram *shown, int count, const plot_style *style) {
  whole_file out;
  return whole_file_open(&out, path) && whole_file_close(&out, draw_all(out.file, shown, count, style));
}
