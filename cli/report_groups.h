/* The different numbers among labels of tetrahedra or faces, and how many have each. */
#ifndef LAVES_CLI_REPORT_GROUPS_H
#define LAVES_CLI_REPORT_GROUPS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct report_groups {
  int32_t *numbers; /* ascending */
  size_t *counts;
  size_t count, capacity;
} report_groups;

/* @param labels  int32_t[label_count]; NULL: all 1
 * @return false when memory is short; free with report_groups_free() in any case */
bool report_groups_find(const int32_t *labels, size_t label_count, report_groups *groups);
void report_groups_free(report_groups *groups);
/* The place of a number in the list; UINT16_MAX stands for that and all further ones. */
uint16_t report_groups_index(const report_groups *groups, int32_t number);

#endif
