/* Faces of tets that come one after the other: which have two tets, which one, and which do not fit.
 *
 * A face is remembered until nobody can ask for it again: until one of its vertices is closed, that is when every face seen so
 * far at that vertex has its two tets. In a mesh whose tets stand near their neighbours in the file this is the front between
 * what has been seen and what has not, and the boundary. A vertex that is used again after it was closed is told (it is no
 * mistake by itself, but faces there may have been forgotten too early), and the table can be told to keep the faces at such
 * vertices. */
#ifndef LAVES_CERTIFY_FACE_TABLE_H
#define LAVES_CERTIFY_FACE_TABLE_H

#include <stdatomic.h>

#include "base/base.h"

enum { LAVES__FACE_SHARDS = 32 }; /* parts of the table, each filled by one thread at a time */

/* What is known of a face. BAD: more than two tets have it, or two on the same side. */
typedef enum laves__face_state { LAVES__FACE_NONE, LAVES__FACE_OPEN, LAVES__FACE_MATCHED, LAVES__FACE_BAD } laves__face_state;

typedef struct laves__face_entry {
  uint32_t corners[3]; /* ascending */
  uint32_t label;      /* of the component of its tets */
  uint64_t tag;        /* state, the order in which the triangle outwards visits its corners, and the slot: 4 tet + face */
} laves__face_entry;

typedef struct laves__face_shard {
  laves__face_entry *entries; /* [capacity] */
  size_t capacity, count;
} laves__face_shard;

typedef struct laves__face_table {
  laves_context *context;
  double fraction; /* of the whole work, for progress; the caller's */
  size_t vertex_count;
  laves__face_shard shards[LAVES__FACE_SHARDS];
  /* Components: labels that were united point to lower ones. */
  _Atomic uint32_t *parents;
  uint32_t *renamed;
  size_t label_count, label_capacity;
  size_t finished; /* components of which no face is left in the table */
  /* Sets of vertices, one bit each. */
  _Atomic uint64_t *used, *closed, *reopened;
  bool keep_all;            /* forget nothing */
  atomic_bool was_reopened; /* a vertex was used again that was not in `reopened` before */
  atomic_bool failed;       /* memory is short */
} laves__face_table;

/* Free with laves__face_table_free(), also after a failure. */
laves_result laves__face_table_make(laves__face_table *table, laves_context *context, size_t vertex_count, laves_error *error);
void laves__face_table_free(laves__face_table *table);
/* Forgets all but which vertices were reopened: faces at these will be kept. */
void laves__face_table_restart(laves__face_table *table);

/* The face of a tet, as a triangle outwards, as a record for laves__face_table_insert(). Returns the shard where it belongs. */
size_t laves__face_record(const int32_t outwards[3], uint64_t slot, uint32_t label, laves__face_entry *record);
/* The triangle of an entry outwards, in its first order. */
void laves__face_outwards_of(const laves__face_entry *entry, int32_t outwards[3]);
static inline uint64_t laves__face_slot(const laves__face_entry *entry) { return entry->tag >> 6; }
static inline laves__face_state laves__face_state_of(const laves__face_entry *entry) {
  return (laves__face_state)(entry->tag & 3);
}

/* Makes room for so many more faces in every shard and for `labels` more tets, which get the labels from *label on.
 * Forgets faces if need be; false when memory is short (then `failed` is set) or after a cancel. */
bool laves__face_table_reserve(laves__face_table *table, const size_t counts[LAVES__FACE_SHARDS], size_t labels, uint32_t *label);
/* A tet without faces is no component. */
void laves__face_table_drop_label(laves__face_table *table, uint32_t label);
/* Notes that a tet uses a vertex; after laves__face_table_reserve() for its faces. Any number of threads. */
void laves__face_table_use(laves__face_table *table, int32_t vertex);
/* The records of a shard, for which there is room, by ascending slot; their labels count from `label`. Any number of threads,
 * each with a shard of its own. */
void laves__face_table_insert(laves__face_table *table, size_t shard, const laves__face_entry *records, size_t count,
                              uint32_t label);

size_t laves__face_table_components(const laves__face_table *table);
size_t laves__face_table_used(const laves__face_table *table);
/* How many entries are in a state. */
size_t laves__face_table_count(const laves__face_table *table, laves__face_state state);
/* Copies them, in no order. */
void laves__face_table_copy(const laves__face_table *table, laves__face_state state, laves__face_entry *entries);

#endif
