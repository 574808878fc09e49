/* Ctrl-C, SIGTERM and the alarm of --timeout set a flag, which the progress callback hands to the library as a wish to cancel.
 * The handler is taken away when it has run once, so that a second signal has its usual effect and ends the program at once;
 * meshes that are being written have no name yet then (src/io/output.c), so nothing of them is left. */
#include "interrupt.h"

#include <math.h>
#include <signal.h>
#include <stddef.h>
#include <sys/time.h>

static volatile sig_atomic_t asked; /* the first signal that came; the one thing that a signal handler may touch */

static void note_signal(int number) {
  if (!asked) asked = number;
}

static void catch_once(int number) {
  struct sigaction action = {.sa_handler = note_signal};
  sigemptyset(&action.sa_mask);
  action.sa_flags = (int)SA_RESETHAND | SA_RESTART;
  sigaction(number, &action, NULL);
}

static void watch(int number) {
  struct sigaction old;
  if (sigaction(number, NULL, &old) == 0 && old.sa_handler == SIG_IGN) return; /* as under nohup */
  catch_once(number);
}

void interrupt_watch(void) {
  watch(SIGINT);
  watch(SIGTERM);
}

void interrupt_after(double seconds) {
  const double whole = floor(seconds), rest = floor(1e6 * (seconds - whole));
  const struct itimerval once = {.it_value = {.tv_sec = (time_t)whole, .tv_usec = whole + rest > 0 ? (suseconds_t)rest : 1}};
  sigset_t alarms; /* may be blocked or ignored by whoever started the program */
  sigemptyset(&alarms);
  sigaddset(&alarms, SIGALRM);
  catch_once(SIGALRM);
  sigprocmask(SIG_UNBLOCK, &alarms, NULL);
  setitimer(ITIMER_REAL, &once, NULL);
}

bool interrupt_asked(void) { return asked != 0; }

bool interrupt_by_time(void) { return asked == SIGALRM; }
