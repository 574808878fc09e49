/* From a scene to an image.
 *
 * Input: coloured triangles in space. Output: an image in sRGB.
 *
 *   camera: perspective from a few radii away, then shifted and scaled in the plane so that the object fills the picture
 *   light:  flat shading by a key light over the viewer's left shoulder, a fill light from the right, and a sky brighter
 *           than the ground; all of them turn with the viewer, so that no side is ever black
 *   depth:  ambient occlusion in screen space darkens corners and hollows, which is what makes a section readable
 *
 * All light is added up in linear space and only turned into sRGB at the end.
 *
 * Source of the occlusion: [mittring2007], screen-space ambient occlusion, in the variant with normals and
 * a spiral of samples; the constants are ours. */
#include "picture.h"

#include <math.h>
#include <stdlib.h>

#include "interrupt.h"
#include "raster.h"

static const double pi = 3.14159265358979323846;

/* Distance of the viewer from the centre in radii of the scene: a mild perspective, as of a long lens. */
static const double viewer_distance = 5;
/* Free border, as a share of the picture. */
static const double margin = 0.04;

/* Directions to the lights in the viewer's frame (right, up, towards), and their strengths in linear light. */
static const double key_light[3] = {-0.48, 0.62, 0.62}, fill_light[3] = {0.80, 0.10, 0.59};
static const double key_strength = 0.92, fill_strength = 0.22, sky_strength = 0.40, ground_strength = 0.16;

/* Occlusion: samples per pixel, reach as a share of the picture's smaller side, and darkness where all is hidden. */
enum { occlusion_samples = 28 };
static const double occlusion_reach = 0.07, occlusion_darkness = 1.15;

typedef struct camera {
  double right[3], up[3], towards[3];
  double centre[3];
  double distance;                /* of the viewer from the centre */
  double scale, shift_x, shift_y; /* pixels = scale * (plane position) + shift; y downwards */
} camera;

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

void picture_direction(const picture_options *options, double direction[3]) {
  double azimuth = options->azimuth * pi / 180, elevation = options->elevation * pi / 180;
  direction[(options->up + 1) % 3] = cos(elevation) * cos(azimuth);
  direction[(options->up + 2) % 3] = cos(elevation) * sin(azimuth);
  direction[options->up] = sin(elevation);
}

static void set_axes(const picture_options *options, camera *out) {
  double azimuth = options->azimuth * pi / 180, elevation = options->elevation * pi / 180;
  int a = (options->up + 1) % 3, b = (options->up + 2) % 3, u = options->up;
  picture_direction(options, out->towards);
  out->right[a] = -sin(azimuth);
  out->right[b] = cos(azimuth);
  out->right[u] = 0;
  out->up[a] = -sin(elevation) * cos(azimuth);
  out->up[b] = -sin(elevation) * sin(azimuth);
  out->up[u] = cos(elevation);
}

/* Position in the viewer's frame relative to the centre. */
static void to_view(const camera *c, const double p[3], double view[3]) {
  double d[3] = {p[0] - c->centre[0], p[1] - c->centre[1], p[2] - c->centre[2]};
  view[0] = dot(c->right, d);
  view[1] = dot(c->up, d);
  view[2] = dot(c->towards, d);
}

/* Projects; returns 1 / distance along the view. */
static double project(const camera *c, const double p[3], double *x, double *y) {
  double view[3];
  to_view(c, p, view);
  double nearness = 1 / (c->distance - view[2]);
  *x = c->shift_x + c->scale * view[0] * nearness;
  *y = c->shift_y - c->scale * view[1] * nearness;
  return nearness;
}

/* Centre and distance from the bounding box, then scale and shift from the projected outline. */
static camera place_camera(const scene *subject, const picture_options *options) {
  camera c = {.scale = 1};
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, radius = 0;
  set_axes(options, &c);
  for (size_t i = 0; i < 9 * subject->face_count; i++) {
    double value = subject->faces[i / 9].points[i % 9 / 3][i % 3];
    low[i % 3] = fmin(low[i % 3], value);
    high[i % 3] = fmax(high[i % 3], value);
  }
  for (int i = 0; i < 3; i++) {
    c.centre[i] = 0.5 * (low[i] + high[i]);
    radius = hypot(radius, 0.5 * (high[i] - low[i]));
  }
  c.distance = viewer_distance * (radius > 0 ? radius : 1);
  double box[4] = {INFINITY, INFINITY, -INFINITY, -INFINITY};
  for (size_t i = 0; i < 3 * subject->face_count; i++) {
    double x, y;
    project(&c, subject->faces[i / 3].points[i % 3], &x, &y);
    box[0] = fmin(box[0], x);
    box[1] = fmin(box[1], y);
    box[2] = fmax(box[2], x);
    box[3] = fmax(box[3], y);
  }
  double border = margin * fmin(options->width, options->height);
  c.scale = fmin((options->width - 2 * border) / (box[2] - box[0]), (options->height - 2 * border) / (box[3] - box[1]));
  c.shift_x = 0.5 * (options->width - c.scale * (box[0] + box[2]));
  c.shift_y = 0.5 * (options->height - c.scale * (box[1] + box[3]));
  return c;
}

/* Light that a face throws to the viewer, 0..1 and a little more. */
static double shade(const camera *c, const double normal[3]) {
  double n[3] = {dot(c->right, normal), dot(c->up, normal), dot(c->towards, normal)};
  double sky = 0.5 + 0.5 * n[1];
  return key_strength * fmax(0, dot(n, key_light)) + fill_strength * fmax(0, dot(n, fill_light)) + ground_strength +
         (sky_strength - ground_strength) * sky;
}

/* Of bold lines, linear light: a dark red. */
static const float crease_colour[3] = {0.42f, 0.02f, 0.015f};

/* Screen triangles; shading and lines are settled here. */
static raster_triangle *make_triangles(const scene *subject, const camera *c, const picture_options *options) {
  raster_triangle *triangles = malloc((subject->face_count + 1) * sizeof *triangles);
  if (!triangles) {
    return NULL;
  }
  for (size_t i = 0; i < subject->face_count; i++) {
    const scene_face *face = &subject->faces[i];
    raster_triangle *t = &triangles[i];
    double light = shade(c, face->normal);
    for (int k = 0; k < 3; k++) {
      t->nearness[k] = project(c, face->points[k], &t->x[k], &t->y[k]);
      t->colour[k] = (float)fmin(1, light * face->colour[k]);
      t->edge_colour[k] = 0.22f * t->colour[k];
    }
    t->edge_width = (float)options->line_width;
    t->bold = face->creases;
    t->bold_width = (float)options->crease_width;
    for (int k = 0; k < 3; k++) {
      t->bold_colour[k] = crease_colour[k];
    }
  }
  return triangles;
}

/* Where a pixel's nearest triangle is, in the viewer's frame with the viewer at the origin. */
static void pixel_place(const camera *c, double x, double y, double nearness, double place[3]) {
  place[0] = (x - c->shift_x) / (c->scale * nearness);
  place[1] = (c->shift_y - y) / (c->scale * nearness);
  place[2] = -1 / nearness;
}

/* The share of the hemisphere over a pixel that near-by surfaces hide, 0..1. */
static double occlusion_at(const camera *c, const scene *subject, const raster_pixel *pixels, const picture_options *options,
                           int x, int y) {
  const raster_pixel *pixel = &pixels[(size_t)y * (size_t)options->width + (size_t)x];
  const double *world = subject->faces[pixel->nearest].normal;
  double normal[3] = {dot(c->right, world), dot(c->up, world), dot(c->towards, world)}, here[3];
  pixel_place(c, x + 0.5, y + 0.5, pixel->nearness, here);
  double reach_pixels = occlusion_reach * fmin(options->width, options->height);
  double reach = reach_pixels / (c->scale * pixel->nearness), hidden = 0;
  // The spiral is turned by a 4 by 4 pattern over the picture, which the blur afterwards averages.
  double turn = (double)((x % 4) * 4 + (y % 4) * 7 % 16) * (pi / 8);
  for (int i = 0; i < occlusion_samples; i++) {
    double radius = reach_pixels * (i + 0.5) / occlusion_samples, angle = turn + 2.39996323 * i;
    int px = x + (int)lround(radius * cos(angle)), py = y + (int)lround(radius * sin(angle));
    if (px < 0 || py < 0 || px >= options->width || py >= options->height) {
      continue;
    }
    const raster_pixel *other = &pixels[(size_t)py * (size_t)options->width + (size_t)px];
    if (other->nearest < 0) {
      continue;
    }
    double there[3], d[3];
    pixel_place(c, px + 0.5, py + 0.5, other->nearness, there);
    for (int k = 0; k < 3; k++) {
      d[k] = there[k] - here[k];
    }
    double length = sqrt(dot(d, d)) + 1e-30;
    hidden += fmax(0, dot(normal, d) / length - 0.12) * fmax(0, 1 - length / (1.8 * reach));
  }
  return hidden / occlusion_samples;
}

/* Occlusion of each pixel, smoothed over the 4 by 4 pattern among pixels at about the same depth. NULL: no memory, or to stop. */
static float *occlusion_map(const camera *c, const scene *subject, const raster_pixel *pixels, const picture_options *options) {
  int width = options->width, height = options->height;
  size_t count = (size_t)width * (size_t)height;
  float *raw = calloc(2, count * sizeof *raw);
  if (!raw) {
    return NULL;
  }
  float *smooth = raw + count;
  for (size_t i = 0; i < count && !interrupt_asked(); i++) {
    if (pixels[i].nearest >= 0) {
      raw[i] = (float)occlusion_at(c, subject, pixels, options, (int)(i % (size_t)width), (int)(i / (size_t)width));
    }
  }
  for (size_t i = 0; i < count && !interrupt_asked(); i++) {
    int x = (int)(i % (size_t)width), y = (int)(i / (size_t)width);
    double sum = 0, weight = 0;
    for (int k = 0; pixels[i].nearest >= 0 && k < 16; k++) {
      int px = x + k % 4 - 2, py = y + k / 4 - 2;
      if (px < 0 || py < 0 || px >= width || py >= height) {
        continue;
      }
      size_t j = (size_t)py * (size_t)width + (size_t)px;
      if (fabsf(pixels[j].nearness / pixels[i].nearness - 1) < 0.01) {
        sum += raw[j];
        weight += 1;
      }
    }
    smooth[i] = weight > 0 ? (float)(sum / weight) : 0;
  }
  return raw;
}

static uint8_t to_srgb(double linear) {
  double s = linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1 / 2.4) - 0.055;
  return (uint8_t)lround(255 * fmax(0, fmin(1, s)));
}

static double paper_light(const picture_options *options) { return options->background == PICTURE_DARK ? 0.012 : 1; }

/* What is left of a scene that something is drawn over. */
static const double pale_share = 0.45;

/* Lays the pixels over the background. `share` of their colour is kept, the rest is background. */
static void compose(const raster_pixel *pixels, const float *occlusion, double share, const picture_options *options,
                    uint8_t *rgba) {
  size_t count = (size_t)options->width * (size_t)options->height;
  double paper = paper_light(options);
  for (size_t i = 0; i < count && !interrupt_asked(); i++) {
    const raster_pixel *pixel = &pixels[i];
    double light = share * fmax(0.15, 1 - occlusion_darkness * 2.2 * occlusion[i]), cover = share * pixel->coverage;
    bool clear = options->background == PICTURE_TRANSPARENT;
    for (int k = 0; k < 3; k++) {
      double colour = light * pixel->colour[k];
      rgba[4 * i + (size_t)k] = to_srgb(clear ? (cover > 0 ? colour / cover : 0) : colour + (1 - cover) * paper);
    }
    rgba[4 * i + 3] = clear ? (uint8_t)lround(255 * fmin(1, cover)) : 255;
  }
}

/* ---- what is drawn over the scene ---- */

static double from_srgb(uint8_t value) {
  double s = value / 255.0;
  return s <= 0.04045 ? s / 12.92 : pow((s + 0.055) / 1.055, 2.4);
}

/* Lays a colour that covers a share of a pixel over what is there. */
static void lay_over(uint8_t *rgba, const float premultiplied[3], double cover) {
  double below = rgba[3] / 255.0 * (1 - cover), alpha = cover + below;
  for (int k = 0; alpha > 0 && k < 3; k++) {
    rgba[k] = to_srgb((premultiplied[k] + below * from_srgb(rgba[k])) / alpha);
  }
  rgba[3] = (uint8_t)lround(255 * fmin(1, alpha));
}

static void draw_ring(double x, double y, double radius, const picture_options *options, uint8_t *rgba) {
  static const float ring_colour[3] = {0.42f, 0.02f, 0.015f};
  static const double half_width = 0.9;
  int reach = (int)ceil(radius + 2);
  for (int py = (int)y - reach; py <= (int)y + reach; py++) {
    for (int px = (int)x - reach; px <= (int)x + reach; px++) {
      if (px < 0 || py < 0 || px >= options->width || py >= options->height) {
        continue;
      }
      double off = fabs(hypot(px + 0.5 - x, py + 0.5 - y) - radius);
      float cover = (float)fmax(0, fmin(1, half_width + 0.5 - off)), colour[3];
      for (int k = 0; k < 3; k++) {
        colour[k] = cover * ring_colour[k];
      }
      lay_over(&rgba[4 * ((size_t)py * (size_t)options->width + (size_t)px)], colour, cover);
    }
  }
}

/* A ring around the four triangles of a tetrahedron. */
static void ring_tet(const raster_triangle triangles[4], const picture_options *options, uint8_t *rgba) {
  static const double least_radius = 9, room = 1.5;
  double box[4] = {INFINITY, INFINITY, -INFINITY, -INFINITY};
  for (int i = 0; i < 12; i++) {
    box[0] = fmin(box[0], triangles[i / 3].x[i % 3]);
    box[1] = fmin(box[1], triangles[i / 3].y[i % 3]);
    box[2] = fmax(box[2], triangles[i / 3].x[i % 3]);
    box[3] = fmax(box[3], triangles[i / 3].y[i % 3]);
  }
  double radius = fmax(least_radius, room * 0.5 * fmax(box[2] - box[0], box[3] - box[1]));
  draw_ring(0.5 * (box[0] + box[2]), 0.5 * (box[1] + box[3]), radius, options, rgba);
}

static bool draw_over(const scene *over, const camera *c, const picture_options *options, raster_pixel *pixels, uint8_t *rgba) {
  raster_triangle *triangles = make_triangles(over, c, options);
  bool done = triangles && raster_draw(triangles, over->face_count, pixels, options->width, options->height);
  for (size_t i = 0; done && i < (size_t)options->width * (size_t)options->height; i++) {
    if (pixels[i].coverage > 0) {
      lay_over(&rgba[4 * i], pixels[i].colour, fmin(1, pixels[i].coverage));
    }
  }
  for (size_t i = 0; done && i < over->face_count / 4; i++) {
    ring_tet(&triangles[4 * i], options, rgba);
  }
  free(triangles);
  return done;
}

bool picture_draw(const scene *subject, const scene *over, const picture_options *options, uint8_t *rgba) {
  bool done = false;
  float *occlusion = NULL;
  camera c = place_camera(subject, options);
  raster_pixel *pixels = malloc((size_t)options->width * (size_t)options->height * sizeof *pixels);
  raster_triangle *triangles = make_triangles(subject, &c, options);
  if (!pixels || !triangles || !raster_draw(triangles, subject->face_count, pixels, options->width, options->height)) {
    goto done;
  }
  occlusion = occlusion_map(&c, subject, pixels, options);
  if (!occlusion) {
    goto done;
  }
  compose(pixels, occlusion + (size_t)options->width * (size_t)options->height, over ? pale_share : 1, options, rgba);
  done = (!over || draw_over(over, &c, options, pixels, rgba)) && !interrupt_asked();
done:
  free(pixels);
  free(triangles);
  free(occlusion);
  return done;
}
