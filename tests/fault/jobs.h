/* Small jobs that together go through the whole library, for tests in which something fails on the way. */
#ifndef LAVES_FAULT_JOBS_H
#define LAVES_FAULT_JOBS_H

#include "fixtures/folders.h"
#include "laves/laves.h"

/* Where a job finds its inputs, and where it may write. */
typedef struct job_place {
  char inputs[FIXTURE_FOLDER_MAX], outputs[FIXTURE_FOLDER_MAX];
} job_place;

/* What a job yields: equal digests mean the same meshes and figures. `text` is left by what failed. */
typedef struct job_outcome {
  laves_error error;
  uint64_t digest;
} job_outcome;

/* Frees whatever it makes but the context. */
typedef laves_result job_fn(laves_context *context, const job_place *place, const char *what, job_outcome *out);

typedef struct job {
  const char *name;
  job_fn *run;
  const char *what; /* a file, an expression, ...: up to the function */
} job;

extern const job jobs[];
extern const int job_count;

/* Makes both folders, and the files that jobs read; false when that cannot be done. And removes them. */
bool job_place_make(job_place *place);
void job_place_remove(const job_place *place);

#endif
