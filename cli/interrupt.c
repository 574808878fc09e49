/* Ctrl-C and SIGTERM set a flag, which the progress callback hands to the library as a wish to cancel.  The handler is
 * taken away when it has run once, so that a second signal has its usual effect and ends the program at once. */
#include "interrupt.h"

#include <signal.h>
#include <stddef.h>

static volatile sig_atomic_t asked; /* the one thing that a signal handler may touch */

static void note_signal(int number) {
  (void)number;
  asked = 1;
}

static void watch(int number) {
  struct sigaction old;
  if (sigaction(number, NULL, &old) == 0 && old.sa_handler == SIG_IGN) return; /* as under nohup */
  struct sigaction action = {.sa_handler = note_signal};
  sigemptyset(&action.sa_mask);
  action.sa_flags = (int)SA_RESETHAND | SA_RESTART;
  sigaction(number, &action, NULL);
}

void interrupt_watch(void) {
  watch(SIGINT);
  watch(SIGTERM);
}

bool interrupt_asked(void) { return asked != 0; }
