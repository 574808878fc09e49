/* The different numbers among labels of tetrahedra or faces, and how many have each. */
#include "report_groups.h"

#include <stdlib.h>
#include <string.h>

static size_t find_place(const report_groups *groups, int32_t number) {
  size_t low = 0, high = groups->count;
  while (low < high) {
    const size_t middle = low + (high - low) / 2;
    if (groups->numbers[middle] < number)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

static bool grow(report_groups *groups) {
  const size_t capacity = 2 * groups->capacity + 16;
  int32_t *numbers = realloc(groups->numbers, capacity * sizeof *numbers);
  if (!numbers) return false;
  groups->numbers = numbers;
  size_t *counts = realloc(groups->counts, capacity * sizeof *counts);
  if (!counts) return false;
  groups->counts = counts;
  groups->capacity = capacity;
  return true;
}

static bool insert(report_groups *groups, size_t place, int32_t number) {
  if (groups->count == groups->capacity && !grow(groups)) return false;
  memmove(groups->numbers + place + 1, groups->numbers + place, (groups->count - place) * sizeof *groups->numbers);
  memmove(groups->counts + place + 1, groups->counts + place, (groups->count - place) * sizeof *groups->counts);
  groups->numbers[place] = number;
  groups->counts[place] = 0;
  ++groups->count;
  return true;
}

bool report_groups_find(const int32_t *labels, size_t label_count, report_groups *groups) {
  *groups = (report_groups){0};
  if (!labels) {
    if (!insert(groups, 0, 1)) return false;
    groups->counts[0] = label_count;
    return true;
  }
  size_t place = 0;
  for (size_t i = 0; i < label_count; ++i) {
    if (place >= groups->count || groups->numbers[place] != labels[i]) {
      place = find_place(groups, labels[i]);
      const bool known = place < groups->count && groups->numbers[place] == labels[i];
      if (!known && !insert(groups, place, labels[i])) return false;
    }
    ++groups->counts[place];
  }
  return true;
}

void report_groups_free(report_groups *groups) {
  free(groups->numbers);
  free(groups->counts);
  *groups = (report_groups){0};
}

uint16_t report_groups_index(const report_groups *groups, int32_t number) {
  const size_t place = find_place(groups, number);
  return place < UINT16_MAX ? (uint16_t)place : UINT16_MAX;
}
