/* laves info INPUT: what it is, what is wrong with it and where, its thinnest parts against the size, and what meshing it
 * will cost.  Nothing is meshed or written. */
#include <math.h>
#include <stdio.h>

#include "command.h"
#include "estimate.h"
#include "features.h"
#include "input.h"
#include "output.h"
#include "session.h"
#include "sizing.h"
#include "summary.h"
#include "text.h"

enum { THIN_CAPACITY = 64, SAID = 4 };

/* Walls and gaps thinner than this many sizes come out rough, those thinner than the second may be lost. */
static const double well_resolved = 2, kept_down_to = 0.5;

/* Thinnest first. */
typedef struct thin_list {
  laves_thin_place place[THIN_CAPACITY];
  size_t count;
} thin_list;

typedef struct info_run {
  input in;
  laves_sizing *sizing;     /* NULL: none */
  laves_features *features; /* NULL: none */
  estimate cost;
  bool has_cost;
  thin_list walls, gaps;
  double thin_seconds;
} info_run;

static void say_measures(const info_run *all) {
  const laves_domain_info *info = &all->in.info;
  text_buffer lower, upper;
  text_say("  box %s .. %s, diagonal %.6g", text_place(&lower, info->lower), text_place(&upper, info->upper),
           input_diagonal(info));
  text_say("  volume %.6g, area %.6g%s", all->cost.volume, all->cost.area, all->cost.sampled ? " (sampled)" : "");
}

static void say_tags(const info_run *all) {
  enum { MOST = 12 };
  const int count = all->in.info.tag_count;
  if (count == 0) return;
  fputs("  named parts:", stderr);
  for (int i = 0; i < count && i < MOST; ++i) fprintf(stderr, "%s %s", i ? "," : "", laves_domain_tag_name(all->in.domain, i));
  text_say("%s", count > MOST ? ", ..." : "");
}

/* Those listed that are below so many sizes. */
static size_t count_below(const thin_list *list, double limit) {
  size_t count = 0;
  while (count < list->count && list->place[count].thickness < limit) ++count;
  return count;
}

static void say_thin(const info_run *all, const thin_list *list, const char *name, const char *fate) {
  const double size = all->cost.size;
  text_buffer place;
  const size_t rough = count_below(list, well_resolved * size), lost = count_below(list, kept_down_to * size);
  if (list->count == 0) return;
  if (rough == 0) {
    text_say("  thinnest %s %.4g (%.1f sizes) at %s", name, list->place[0].thickness, list->place[0].thickness / size,
             text_place(&place, list->place[0].place));
    return;
  }
  for (size_t i = 0; i < rough && i < SAID; ++i) {
    const double share = list->place[i].thickness / size;
    text_say("  %s of %.4g (%.2f sizes) at %s%s%s", name, list->place[i].thickness, share,
             text_place(&place, list->place[i].place), share < kept_down_to ? ": may be " : "", share < kept_down_to ? fate : "");
  }
  if (lost > 0)
    text_say("  at size %.4g %s%zu %s%s below half a size may be %s; a size of %.4g keeps them", size,
             lost == THIN_CAPACITY ? "at least " : "", lost, name, lost == 1 ? "" : "s", fate,
             list->place[0].thickness / kept_down_to);
}

/* Three digits: an estimate has no more. */
static uint64_t about(double count) {
  const double step = count >= 1000 ? pow(10, floor(log10(count)) - 2) : 1;
  return (uint64_t)(step * round(count / step));
}

/* Two digits: times have hardly one. */
static double roughly(double seconds) {
  const double step = pow(10, floor(log10(seconds)) - 1);
  return step * round(seconds / step);
}

static void say_cost(const info_run *all) {
  text_buffer tets, vertices, bytes, seconds;
  text_say("at size %.4g: about %s, %s, %s, roughly %s of one core", all->cost.size,
           text_plural(&tets, about(all->cost.tets), "tet"), text_plural(&vertices, about(all->cost.vertices), "vertex"),
           text_bytes(&bytes, all->cost.bytes), text_seconds(&seconds, roughly(all->cost.cpu_seconds)));
}

/* The thinnest walls, or gaps. */
static laves_result find_thin(session *run, const info_run *all,
                              size_t (*find)(const laves_domain *domain, laves_thin_place *places, size_t capacity),
                              thin_list *list) {
  list->count = find(all->in.domain, list->place, THIN_CAPACITY);
  if (list->count > 0 || !isnan(list->place[0].thickness)) return LAVES_OK;
  return session_fail(run, LAVES_ERROR_MEMORY, "no memory to look for thin places");
}

static laves_result info_steps(session *run, info_run *all) {
  laves_result result = outputs_check_json(run, run->given->input);
  if (result == LAVES_OK) result = sizing_open(run, &all->sizing);
  if (result == LAVES_OK) result = features_open(run, &all->features);
  if (result == LAVES_OK) result = input_open(run, run->given->input, &all->in);
  if (result != LAVES_OK) return result;
  all->has_cost = estimate_make(run, &all->in, &all->cost);
  if (all->has_cost) result = estimate_expect(run, &all->in, all->sizing, all->features, &all->cost);
  if (result != LAVES_OK) return result;
  const double start = progress_now();
  result = find_thin(run, all, laves_domain_thin_places, &all->walls);
  if (result == LAVES_OK) result = find_thin(run, all, laves_domain_gap_places, &all->gaps);
  all->thin_seconds = progress_now() - start;
  result = session_settle(run, result);
  if (result != LAVES_OK) return result;
  if (session_speaks(run)) summary_input(&all->in, true);
  if (!all->has_cost) return session_fail(run, LAVES_ERROR_INPUT, "the input has no inside: its volume is zero");
  if (!session_speaks(run)) return LAVES_OK;
  say_measures(all);
  say_tags(all);
  say_thin(all, &all->walls, "wall", "lost");
  say_thin(all, &all->gaps, "gap", "closed");
  say_cost(all);
  return LAVES_OK;
}

static void write_places(json *out, const char *key, const thin_list *list) {
  json_open_array(out, key);
  for (size_t i = 0; i < list->count; ++i) {
    json_open_object(out, NULL);
    json_numbers(out, "place", list->place[i].place, 3);
    json_number(out, "thickness", list->place[i].thickness);
    json_close(out);
  }
  json_close(out);
}

static void info_json(json *out, const session *run, const void *facts) {
  const info_run *all = facts;
  if (all->in.text) input_write_json(out, "input", &all->in);
  if (all->has_cost) {
    json_open_object(out, "estimate");
    estimate_write_json(out, &all->cost);
    json_close(out);
  }
  write_places(out, "thin_places", &all->walls);
  write_places(out, "gap_places", &all->gaps);
  json_open_object(out, "seconds");
  json_number(out, "read", all->in.seconds);
  json_number(out, "thin_places", all->thin_seconds);
  json_number(out, "total", progress_now() - run->start);
  json_close(out);
}

int command_info(const settings *given) {
  session run;
  info_run all = {0};
  if (!session_open(&run, given)) return laves_result_exit_code(LAVES_ERROR_MEMORY);
  laves_result result = info_steps(&run, &all);
  session_write_json(&run, &result, info_json, &all);
  laves_sizing_free(all.sizing);
  laves_features_free(all.features);
  input_close(&all.in);
  return session_close(&run, result);
}
