/* The progress line: phase, bar, per cent, and the time that the phase will still take.
 *
 *   improve   ━━━━━━━━━━━━━━━━━━━──────────  64 %  3.1 s left
 *
 * It is drawn after a short while only, ten times a second at most, and wiped when the call into the library returns. */
#include "progress.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

#include "interrupt.h"
#include "text.h"

enum { BAR_WIDTH = 30 };

static const double first_draw_seconds = 0.3; /* quicker phases never flash by */
static const double redraw_seconds = 0.1;
static const double foresight_seconds = 1.0; /* no guess at the time left before this much of a phase has passed */

double progress_now(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

progress progress_start(bool wanted) {
  progress bar = {.enabled = wanted && text_is_terminal(), .utf8 = text_is_utf8(), .colour = text_has_colour()};
  bar.drawn = progress_now() + first_draw_seconds - redraw_seconds;
  return bar;
}

static void draw_bar(const progress *bar, int filled) {
  if (bar->colour) fputs("\033[36m", stderr);
  for (int i = 0; i < filled; ++i) fputs(bar->utf8 ? "\u2501" : "#", stderr);
  if (bar->colour) fputs("\033[2m", stderr);
  for (int i = filled; i < BAR_WIDTH; ++i) fputs(bar->utf8 ? "\u2500" : ".", stderr);
  if (bar->colour) fputs("\033[0m", stderr);
}

static void draw(progress *bar, double now) {
  const double fraction = bar->fraction;
  fprintf(stderr, "\r%-12.12s ", bar->phase);
  draw_bar(bar, (int)(fraction * BAR_WIDTH));
  fprintf(stderr, " %3d %%", (int)(fraction * 100));
  const double spent = now - bar->phase_start;
  if (spent > foresight_seconds && fraction > 0.02) {
    text_buffer left;
    fprintf(stderr, "  %s left", text_seconds(&left, spent * (1 - fraction) / fraction));
  }
  fputs("\033[K", stderr);
  bar->shown = true;
  bar->drawn = now;
}

bool progress_report(void *user, const char *phase, double fraction) {
  progress *bar = user;
  const bool new_phase = !bar->phase || strcmp(bar->phase, phase) != 0;
  bar->phase = phase;
  bar->fraction = fraction > 0 ? (fraction < 1 ? fraction : 1) : 0;
  if (!bar->enabled) return !interrupt_asked();
  const double now = progress_now();
  if (new_phase) bar->phase_start = now;
  if (now - bar->drawn >= redraw_seconds) draw(bar, now);
  return !interrupt_asked();
}

void progress_clear(progress *bar) {
  if (!bar->shown) return;
  fputs("\r\033[K", stderr);
  bar->shown = false;
}
