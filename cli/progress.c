/* The progress line: phase, bar, per cent, and the time that the phase will still take.
 *
 *   improve   ━━━━━━━━━━━━━━━━━━━──────────  64 %  3.1 s left
 *
 * It is drawn after a short while only, ten times a second at most, and wiped when the call into the library returns. On a narrow
 * terminal the bar shrinks, then the time goes, then the bar, so that the line never wraps. */
#include "progress.h"

#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

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

static void draw_bar(const progress *bar, int width) {
  const int filled = (int)(bar->fraction * width);
  if (bar->colour) fputs("\033[36m", stderr);
  for (int i = 0; i < filled; ++i) fputs(bar->utf8 ? "\u2501" : "#", stderr);
  if (bar->colour) fputs("\033[2m", stderr);
  for (int i = filled; i < width; ++i) fputs(bar->utf8 ? "\u2500" : ".", stderr);
  if (bar->colour) fputs("\033[0m", stderr);
}

/* Columns that a line may take without being wrapped, which could not be wiped. */
static int line_room(void) {
  enum { UNKNOWN = 80 };
  struct winsize window;
  const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &window) == 0 && window.ws_col > 0;
  return (known ? window.ws_col : UNKNOWN) - 1;
}

/* Per cent, and the time left where it can be guessed and there is room. */
static void draw_line(const progress *bar, double spent) {
  enum { NAME_WIDTH = 13, LEAST_BAR = 5 };
  char done[16], left[64] = "";
  const double fraction = bar->fraction;
  snprintf(done, sizeof done, " %3d %%", (int)(fraction * 100));
  if (spent > foresight_seconds && fraction > 0.02) {
    text_buffer seconds;
    snprintf(left, sizeof left, "  %s left", text_seconds(&seconds, spent * (1 - fraction) / fraction));
  }
  int room = line_room() - NAME_WIDTH - (int)strlen(done);
  if (room - (int)strlen(left) < LEAST_BAR) left[0] = '\0';
  room -= (int)strlen(left);
  const int name = room < 0 ? NAME_WIDTH + room : NAME_WIDTH;
  if (name > 0) fprintf(stderr, "%-*.*s", name, name - 1, bar->phase);
  if (room >= LEAST_BAR) draw_bar(bar, room < BAR_WIDTH ? room : BAR_WIDTH);
  fprintf(stderr, "%s%s", done, left);
}

static void draw(progress *bar, double now) {
  fputc('\r', stderr);
  draw_line(bar, now - bar->phase_start);
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
