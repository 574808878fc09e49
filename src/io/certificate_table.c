/* The members of a certificate, group by group, as they stand in the file; docs/certificate.md tells what they mean. */
#include "io/certificate_table.h"

const char *const laves__align_names[] = {"none", "pca", "rotation", NULL};
const char *const laves__method_names[] = {"auto", "snap", "stuff", NULL};

#define FLAG_AT(member) offsetof(laves_certificate, member)

const laves__member_group laves__certificate_groups[] = {
    {"mesh", 0, false},
    {"validity", 0, false},
    {"topology", 0, false},
    {"measures", 0, false},
    {"min_dihedral", 0, false},
    {"max_dihedral", 0, false},
    {"radius_ratio", 0, false},
    {"radius_edge", 0, false},
    {"volume_length", 0, false},
    {"tiles", 0, false},
    {"window", 0, false},
    {"promise", FLAG_AT(has_promise), false},
    {"asked", 0, false},
    {"distance", FLAG_AT(check.has_distance), false},
    {"features", FLAG_AT(has_features), true},
    {"input", FLAG_AT(has_input), false},
    {"making", FLAG_AT(has_options), false},
};
const size_t laves__certificate_group_count = LAVES__COUNT_OF(laves__certificate_groups);

#define ROW(group, name, kind, proof, member, count) \
  { group, name, LAVES__MEMBER_##kind, LAVES__PROOF_##proof, offsetof(laves_certificate, member), count }
#define TEXT(group, name, proof, member) ROW(group, name, TEXT, proof, member, sizeof((laves_certificate *)0)->member)
#define COUNT(group, name, member) ROW(group, name, COUNT, EXACT, check.member, 1)
/* A quality: its worst value, the tet and place of it, and the statistic over all tets. */
#define QUALITY(name, worst, tet_member, place_member, best)                                                             \
  ROW(#name, "worst", NUMBER, CLOSE, check.name.worst, 1), ROW(#name, "tet", INTEGER, EXACT, check.tet_member, 1),       \
      ROW(#name, "place", NUMBER, LENGTH, check.place_member, 3), ROW(#name, "best", NUMBER, CLOSE, check.name.best, 1), \
      ROW(#name, "mean", NUMBER, CLOSE, check.name.mean, 1), ROW(#name, "deviation", NUMBER, NONE, check.name.deviation, 1)

/* Pairs are two members that stand side by side. */
_Static_assert(
    offsetof(laves_certificate, attained_max_dihedral) == offsetof(laves_certificate, attained_min_dihedral) + sizeof(double) &&
        offsetof(laves_certificate, promised_max_dihedral) ==
            offsetof(laves_certificate, promised_min_dihedral) + sizeof(double) &&
        offsetof(laves_certificate, features.away_max_dihedral) ==
            offsetof(laves_certificate, features.away_min_dihedral) + sizeof(double) &&
        offsetof(laves_certificate, features.free_max_dihedral) ==
            offsetof(laves_certificate, features.free_min_dihedral) + sizeof(double) &&
        offsetof(laves_certificate, asked_max_dihedral) == offsetof(laves_certificate, asked_min_dihedral) + sizeof(double) &&
        offsetof(laves_certificate, options.max_dihedral) == offsetof(laves_certificate, options.min_dihedral) + sizeof(double),
    "windows are pairs");

const laves__member laves__certificate_members[] = {
    TEXT("mesh", "sha256", EXACT, mesh_hash),
    COUNT("mesh", "vertices", vertices),
    COUNT("mesh", "tets", tets),
    COUNT("mesh", "faces", faces),

    ROW("validity", "valid", FLAG, EXACT, check.valid, 1),
    COUNT("validity", "bad_indices", bad_indices),
    COUNT("validity", "inverted_tets", inverted_tets),
    COUNT("validity", "nonconforming_faces", nonconforming_faces),
    COUNT("validity", "nonmanifold_edges", nonmanifold_edges),
    COUNT("validity", "nonmanifold_vertices", nonmanifold_vertices),
    COUNT("validity", "unused_vertices", unused_vertices),

    COUNT("topology", "components", components),
    COUNT("topology", "boundary_components", boundary_components),
    ROW("topology", "genus", INTEGER, EXACT, check.genus, 1),

    ROW("measures", "volume", NUMBER, CLOSE, check.volume, 1),
    ROW("measures", "area", NUMBER, CLOSE, check.area, 1),
    ROW("measures", "edge_min", NUMBER, CLOSE, check.edge_min, 1),
    ROW("measures", "edge_max", NUMBER, CLOSE, check.edge_max, 1),
    ROW("measures", "edge_mean", NUMBER, CLOSE, check.edge_mean, 1),

    QUALITY(min_dihedral, min, min_dihedral_tet, min_dihedral_place, max),
    QUALITY(max_dihedral, max, max_dihedral_tet, max_dihedral_place, min),
    QUALITY(radius_ratio, min, radius_ratio_tet, radius_ratio_place, max),
    QUALITY(radius_edge, max, radius_edge_tet, radius_edge_place, min),
    QUALITY(volume_length, min, volume_length_tet, volume_length_place, max),

    ROW("tiles", "exact_tets", COUNT, EXACT, lattice_tets, 1),
    ROW("tiles", "bcc_tets", LATER, EXACT, bcc_tets, 1),
    ROW("tiles", "size", NUMBER, CLOSE, lattice_size, 1),
    ROW("tiles", "tolerance", NUMBER, CLOSE, lattice_tolerance, 1),

    ROW("window", "attained", NUMBER, CLOSE, attained_min_dihedral, 2),
    ROW("window", "margin", NUMBER, CLOSE, angle_margin, 1),
    ROW("window", "histogram", COUNT, EXACT, check.histogram, LAVES_HISTOGRAM_BINS),

    ROW("promise", "window", NUMBER, NONE, promised_min_dihedral, 2),
    ROW("promise", "holds", FLAG, EXACT, promise_holds, 1),

    ROW("asked", "window", NUMBER, NONE, asked_min_dihedral, 2),
    ROW("asked", "volume_length", NUMBER, NONE, asked_volume_length, 1),

    ROW("distance", "domain_volume", NUMBER, NONE, check.domain_volume, 1),
    ROW("distance", "to_surface_max", NUMBER, SURFACE, check.to_surface_max, 1),
    ROW("distance", "to_surface_place", NUMBER, NONE, check.to_surface_place, 3),
    ROW("distance", "to_surface_mean", NUMBER, SURFACE, check.to_surface_mean, 1),
    ROW("distance", "to_surface_cover", NUMBER, SURFACE, check.to_surface_cover, 1),
    ROW("distance", "to_surface_at_most", NUMBER, SURFACE, check.to_surface_at_most, 1),
    TEXT("distance", "to_surface_reason", NONE, to_surface_reason),
    ROW("distance", "from_surface_max", NUMBER, SURFACE, check.from_surface_max, 1),
    ROW("distance", "from_surface_place", NUMBER, NONE, check.from_surface_place, 3),
    ROW("distance", "from_surface_mean", NUMBER, SURFACE, check.from_surface_mean, 1),
    ROW("distance", "from_surface_cover", NUMBER, SURFACE, check.from_surface_cover, 1),
    ROW("distance", "from_surface_at_most", NUMBER, SURFACE, check.from_surface_at_most, 1),
    TEXT("distance", "from_surface_reason", NONE, from_surface_reason),
    ROW("distance", "distant_from", NUMBER, SURFACE, distance_asked, 1),
    ROW("distance", "off_surface_from", NUMBER, SURFACE, off_surface_asked, 1),

    ROW("features", "angle", NUMBER, NONE, features.angle, 1),
    ROW("features", "tags", FLAG, NONE, features_tags, 1),
    ROW("features", "drawn", FLAG, NONE, features_drawn, 1),
    ROW("features", "size", NUMBER, NONE, features.size, 1),
    ROW("features", "tolerance", NUMBER, FEATURE, features.tolerance, 1),
    ROW("features", "creases", COUNT, FEATURE, features.creases, 1),
    ROW("features", "short_creases", COUNT, FEATURE, features.short_creases, 1),
    ROW("features", "creases_kept", COUNT, FEATURE, features.creases_kept, 1),
    ROW("features", "length", NUMBER, FEATURE, features.length, 1),
    ROW("features", "kept_share", NUMBER, FEATURE, features.kept_share, 1),
    ROW("features", "to_mesh_max", NUMBER, FEATURE, features.to_mesh_max, 1),
    ROW("features", "to_mesh_place", NUMBER, NONE, features.to_mesh_place, 3),
    ROW("features", "corners", COUNT, FEATURE, features.corners, 1),
    ROW("features", "short_corners", COUNT, FEATURE, features.short_corners, 1),
    ROW("features", "corners_kept", COUNT, FEATURE, features.corners_kept, 1),
    ROW("features", "from_mesh_max", NUMBER, FEATURE, features.from_mesh_max, 1),
    ROW("features", "from_mesh_place", NUMBER, NONE, features.from_mesh_place, 3),
    ROW("features", "spurious_edges", COUNT, FEATURE, features.spurious, 1),
    ROW("features", "straddling_faces", COUNT, FEATURE, features.straddling, 1),
    ROW("features", "sharpest", NUMBER, FEATURE, features.sharpest, 1),
    ROW("features", "window_away", NUMBER, FEATURE, features.away_min_dihedral, 2),
    ROW("features", "window_free", NUMBER, FEATURE, features.free_min_dihedral, 2),

    TEXT("input", "name", NONE, input_name),
    TEXT("input", "kind", INPUT, input_kind),
    TEXT("input", "format", INPUT, input_format),
    TEXT("input", "sha256", INPUT, input_hash),

    ROW("making", "size", NUMBER, NONE, size, 1),
    ROW("making", "asked_size", NUMBER, NONE, options.size, 1),
    ROW("making", "asked_relative_size", NUMBER, NONE, options.relative_size, 1),
    ROW("making", "asked_tets", INTEGER, NONE, options.tet_target, 1),
    ROW("making", "asked_vertices", INTEGER, NONE, options.vertex_target, 1),
    ROW("making", "align", ALIGN, NONE, options.align, 1),
    ROW("making", "rotation", NUMBER, NONE, options.rotation, 9),
    ROW("making", "method", METHOD, NONE, options.method, 1),
    ROW("making", "guarantee", NUMBER, NONE, options.guarantee, 1),
    ROW("making", "improve", FLAG, NONE, options.improve, 1),
    ROW("making", "window", NUMBER, NONE, options.min_dihedral, 2),
    ROW("making", "volume_length", NUMBER, NONE, options.volume_length, 1),
    ROW("making", "feature_angle", LATER_NUMBER, NONE, options.feature_angle, 1),
    ROW("making", "feature_tags", LATER_FLAG, NONE, options.feature_tags, 1),
    ROW("making", "keep_thin", LATER_FLAG, NONE, options.keep_thin, 1),
    ROW("making", "pinches", COUNT, NONE, pinches, 1),
    ROW("making", "stuffed_vertices", COUNT, NONE, stuffed_vertices, 1),
    ROW("making", "relaxed_vertices", COUNT, NONE, relaxed_vertices, 1),
    ROW("making", "relaxed_max", NUMBER, NONE, relaxed_max, 1),
};
const size_t laves__certificate_member_count = LAVES__COUNT_OF(laves__certificate_members);
