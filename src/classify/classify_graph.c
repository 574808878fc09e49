/* Classification of a graded background: runs of vertices, halved while the oracle can't decide.
 *
 * Vertices that follow one another in the graph lie near one another. So a run of them lies in a ball, which is widened by
 * the longest edges at the vertices; when the oracle says that the ball lies on one side (where phi is a distance, one value
 * in the middle does), all of them do, and no edge at them crosses. Else each half of the run is looked at, and in the end
 * each vertex is asked for. */
#include "classify/classify_graph.h"

#include "background/site.h"

enum {
  BLOCK_RECORDS = 64, /* first runs; each has one writer */
  BLOCK = BLOCK_RECORDS * LAVES__C15_SITES,
  ASKED_DISTANCE = 6, /* runs of this many vertices are asked one by one: where phi is a distance, */
  ASKED = 24,         /* and where it is dearer to bound phi than to ask for it */
};

typedef struct labelling {
  const laves__frame *frame;
  laves__lattice *lattice;
} labelling;

/* A run of vertices. */
typedef struct run {
  size_t first, count;
  const double *reach; /* [count] the longest edge at each, and a little */
} run;

static void set_site(laves__lattice *lattice, size_t vertex, double phi, uint32_t hint) {
  const laves__site s = laves__site_of((uint32_t)vertex);
  laves__record *r = &lattice->record[s.cell];
  const bool outside = isnan(phi) || laves__is_hull(lattice, s); /* what has no value is not inside */
  r->phi[s.site] = outside ? HUGE_VAL : phi;
  r->sign[s.site] = r->label[s.site] = r->phi[s.site] < 0 ? -1 : 1;
  r->hint[s.site] = hint;
}

static double longest_edge(const laves__graph *g, size_t vertex) {
  double longest2 = 0;
  for (uint32_t i = g->link_first[vertex]; i < g->link_first[vertex + 1]; i++)
    longest2 = fmax(longest2, v3_norm2(v3_sub(g->position[g->link[i]], g->position[vertex])));
  return sqrt(longest2);
}

/* The side on which all vertices of a run and all edges at them lie. */
static laves__side side_of(const labelling *l, const run *r) {
  const laves__vec3 *at = l->lattice->graph->position + r->first;
  laves__box3 box = box3_empty();
  for (size_t i = 0; i < r->count; i++) box = box3_add(box, at[i]);
  const laves__vec3 centre = box3_centre(box);
  if (l->frame->oracle->is_distance) {
    double phi, radius = 0;
    for (size_t i = 0; i < r->count; i++) radius = fmax(radius, v3_distance(centre, at[i]) + r->reach[i]);
    laves__frame_evaluate(l->frame, 1, &centre, &phi, NULL);
    return !(fabs(phi) > radius) ? LAVES__UNDECIDED : phi < 0 ? LAVES__INSIDE : LAVES__OUTSIDE;
  }
  double half = 0;
  for (size_t i = 0; i < r->count; i++) {
    const laves__vec3 d = v3_sub(at[i], centre);
    half = fmax(half, fmax(fabs(d.x), fmax(fabs(d.y), fabs(d.z))) + r->reach[i]);
  }
  return laves__frame_side(l->frame, centre, half);
}

static void ask(const labelling *l, const run *r) {
  double phi[ASKED];
  uint32_t hint[ASKED] = {LAVES__NO_HINT};
  laves__frame_evaluate(l->frame, r->count, l->lattice->graph->position + r->first, phi, hint);
  for (size_t i = 0; i < r->count; i++) set_site(l->lattice, r->first + i, phi[i], hint[i]);
}

static void label_run(const labelling *l, const run *whole) {
  if (whole->count <= (l->frame->oracle->is_distance ? ASKED_DISTANCE : ASKED)) {
    ask(l, whole);
    return;
  }
  const laves__side side = side_of(l, whole);
  if (side != LAVES__UNDECIDED) {
    for (size_t i = 0; i < whole->count; i++) set_site(l->lattice, whole->first + i, side * HUGE_VAL, LAVES__NO_HINT);
    return;
  }
  const size_t half = whole->count / 2;
  label_run(l, &(run){whole->first, half, whole->reach});
  label_run(l, &(run){whole->first + half, whole->count - half, whole->reach + half});
}

static void label_blocks(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const labelling *l = user;
  const laves__graph *g = l->lattice->graph;
  static const double widen = 1 + 1e-6; /* covers the rounding of distances */
  for (size_t block = begin; block < end; block++) {
    double reach[BLOCK];
    const size_t first = block * BLOCK, rest = g->vertex_count - first, count = rest < BLOCK ? rest : BLOCK;
    for (size_t i = 0; i < count; i++) reach[i] = longest_edge(g, first + i) * widen;
    label_run(l, &(run){first, count, reach});
  }
}

laves_result laves__classify_graph(const laves__frame *frame, laves__lattice *lattice, laves_error *error) {
  labelling l = {frame, lattice};
  const size_t blocks = (lattice->graph->vertex_count + BLOCK - 1) / BLOCK;
  if (!laves__parallel_for(lattice->context, "classify", blocks, 1, label_blocks, &l)) return laves__fail_cancelled(error);
  return LAVES_OK;
}
