/* Meshes of second order, from the command line: --order 2. */
#ifndef LAVES_CLI_SECOND_ORDER_H
#define LAVES_CLI_SECOND_ORDER_H

#include "json.h"
#include "session.h"

typedef struct second_order {
  bool made;
  laves_curve_report report;
  double seconds;
} second_order;

/* Whether --order goes with the other options, before any work is done. */
laves_result second_order_check(session *run);

/* Gives a mesh that was made with `options` its nodes of second order. */
laves_result second_order_make(session *run, laves_mesh *mesh, const laves_domain *domain, const laves_options *options,
                               const laves_report *report, second_order *out);

/* Two lines for people. */
void second_order_say(const second_order *curved);
/* The member "second_order". */
void second_order_write_json(json *out, const second_order *curved);

#endif
