"""The declarations of laves.h for ctypes. Made by tools/make_python_header.py; do not edit."""
from ctypes import (CFUNCTYPE, POINTER, Structure, c_bool, c_char, c_char_p, c_double, c_int, c_int32, c_int64, c_size_t,
                    c_uint32, c_void_p)

# Members of the enums, in order, without what they have in common.
ENUMS = {
    "laves_result": [
        "OK",
        "TARGET_MISSED",
        "ERROR_OPTION",
        "ERROR_INPUT",
        "ERROR_MEMORY",
        "ERROR_WRITE",
        "ERROR_CANCELLED",
        "ERROR_TIMEOUT",
        "ERROR_INTERNAL",
    ],
    "laves_overlap": [
        "DIRECTION",
        "UNION",
        "NESTED",
    ],
    "laves_domain_kind": [
        "SURFACE",
        "IMPLICIT",
        "FUNCTION",
    ],
    "laves_defect": [
        "OPEN_EDGE",
        "NONMANIFOLD_EDGE",
        "DIRECTION",
        "NONMANIFOLD_VERTEX",
        "DUPLICATE_FACE",
        "DEGENERATE_FACE",
        "CROSSING",
        "REPEATED_POINT",
        "UNUSED_POINT",
    ],
    "laves_thin_kind": [
        "WALL",
        "GAP",
    ],
    "laves_method": [
        "AUTO",
        "SNAP",
        "STUFF",
    ],
    "laves_align": [
        "NONE",
        "PCA",
        "ROTATION",
    ],
    "laves_regions": [
        "NONE",
        "PARTS",
    ],
    "laves_feature_fault": [
        "CREASE",
        "CORNER",
        "SPURIOUS",
        "STRADDLING",
        "SHARP",
    ],
    "laves_exception_kind": [
        "INVERTED_TET",
        "NONMANIFOLD_EDGE",
        "NONMANIFOLD_VERTEX",
        "OUTSIDE_PROMISED",
        "OUTSIDE_ASKED",
        "DISTANT",
        "OFF_SURFACE",
        "THIN",
        "CREASE_LOST",
        "CORNER_LOST",
        "SHARP_INPUT",
    ],
    "laves_cause": [
        "UNKNOWN",
        "THIN",
        "CREASE",
        "CURVED",
    ],
    "laves_format": [
        "AUTO",
        "VTU",
        "GMSH22",
        "GMSH41",
        "MEDIT",
        "TETGEN",
        "VTKHDF",
        "VTK",
        "XDMF",
        "EXODUS",
        "ABAQUS",
        "NASTRAN",
        "NPZ",
        "DMTET",
        "STL",
        "OBJ",
        "PLY",
        "OFF",
    ],
}

CONSTANTS = {
    "LAVES_STAGE_CAPACITY": 16,
    "LAVES_WARNING_CAPACITY": 16,
    "LAVES_LOST_CAPACITY": 16,
    "LAVES_HISTOGRAM_BINS": 36,
    "LAVES_PLACE_CAPACITY": 16,
    "LAVES_HASH_CAPACITY": 65,
    "LAVES_NAME_CAPACITY": 256,
    "LAVES_EXCEPTION_CAPACITY": 192,
    "LAVES_COMMAND_CAPACITY": 8192,
    "LAVES_COMMAND_WORDS": 500,
    "LAVES_OK": 0,
    "LAVES_TARGET_MISSED": 1,
    "LAVES_ERROR_OPTION": 2,
    "LAVES_ERROR_INPUT": 3,
    "LAVES_ERROR_MEMORY": 4,
    "LAVES_ERROR_WRITE": 5,
    "LAVES_ERROR_CANCELLED": 6,
    "LAVES_ERROR_TIMEOUT": 7,
    "LAVES_ERROR_INTERNAL": 8,
    "LAVES_OVERLAP_DIRECTION": 0,
    "LAVES_OVERLAP_UNION": 1,
    "LAVES_OVERLAP_NESTED": 2,
    "LAVES_DOMAIN_SURFACE": 0,
    "LAVES_DOMAIN_IMPLICIT": 1,
    "LAVES_DOMAIN_FUNCTION": 2,
    "LAVES_DEFECT_OPEN_EDGE": 0,
    "LAVES_DEFECT_NONMANIFOLD_EDGE": 1,
    "LAVES_DEFECT_DIRECTION": 2,
    "LAVES_DEFECT_NONMANIFOLD_VERTEX": 3,
    "LAVES_DEFECT_DUPLICATE_FACE": 4,
    "LAVES_DEFECT_DEGENERATE_FACE": 5,
    "LAVES_DEFECT_CROSSING": 6,
    "LAVES_DEFECT_REPEATED_POINT": 7,
    "LAVES_DEFECT_UNUSED_POINT": 8,
    "LAVES_DEFECT_COUNT": 9,
    "LAVES_THIN_WALL": 0,
    "LAVES_THIN_GAP": 1,
    "LAVES_METHOD_AUTO": 0,
    "LAVES_METHOD_SNAP": 1,
    "LAVES_METHOD_STUFF": 2,
    "LAVES_ALIGN_NONE": 0,
    "LAVES_ALIGN_PCA": 1,
    "LAVES_ALIGN_ROTATION": 2,
    "LAVES_REGIONS_NONE": 0,
    "LAVES_REGIONS_PARTS": 1,
    "LAVES_FEATURE_FAULT_CREASE": 0,
    "LAVES_FEATURE_FAULT_CORNER": 1,
    "LAVES_FEATURE_FAULT_SPURIOUS": 2,
    "LAVES_FEATURE_FAULT_STRADDLING": 3,
    "LAVES_FEATURE_FAULT_SHARP": 4,
    "LAVES_FEATURE_FAULT_COUNT": 5,
    "LAVES_EXCEPTION_INVERTED_TET": 0,
    "LAVES_EXCEPTION_NONMANIFOLD_EDGE": 1,
    "LAVES_EXCEPTION_NONMANIFOLD_VERTEX": 2,
    "LAVES_EXCEPTION_OUTSIDE_PROMISED": 3,
    "LAVES_EXCEPTION_OUTSIDE_ASKED": 4,
    "LAVES_EXCEPTION_DISTANT": 5,
    "LAVES_EXCEPTION_OFF_SURFACE": 6,
    "LAVES_EXCEPTION_THIN": 7,
    "LAVES_EXCEPTION_CREASE_LOST": 8,
    "LAVES_EXCEPTION_CORNER_LOST": 9,
    "LAVES_EXCEPTION_SHARP_INPUT": 10,
    "LAVES_EXCEPTION_COUNT": 11,
    "LAVES_CAUSE_UNKNOWN": 0,
    "LAVES_CAUSE_THIN": 1,
    "LAVES_CAUSE_CREASE": 2,
    "LAVES_CAUSE_CURVED": 3,
    "LAVES_CAUSE_COUNT": 4,
    "LAVES_FORMAT_AUTO": 0,
    "LAVES_FORMAT_VTU": 1,
    "LAVES_FORMAT_GMSH22": 2,
    "LAVES_FORMAT_GMSH41": 3,
    "LAVES_FORMAT_MEDIT": 4,
    "LAVES_FORMAT_TETGEN": 5,
    "LAVES_FORMAT_VTKHDF": 6,
    "LAVES_FORMAT_VTK": 7,
    "LAVES_FORMAT_XDMF": 8,
    "LAVES_FORMAT_EXODUS": 9,
    "LAVES_FORMAT_ABAQUS": 10,
    "LAVES_FORMAT_NASTRAN": 11,
    "LAVES_FORMAT_NPZ": 12,
    "LAVES_FORMAT_DMTET": 13,
    "LAVES_FORMAT_STL": 14,
    "LAVES_FORMAT_OBJ": 15,
    "LAVES_FORMAT_PLY": 16,
    "LAVES_FORMAT_OFF": 17,
    "LAVES_FORMAT_COUNT": 18,
}

laves_reallocate_fn = CFUNCTYPE(c_void_p, c_void_p, c_void_p, c_size_t, c_size_t)
laves_progress_fn = CFUNCTYPE(c_bool, c_void_p, c_char_p, c_double)


class laves_error(Structure):
    _fields_ = [
        ("result", c_int),
        ("text", c_char * 500),
    ]
    _enums_ = {"result": "laves_result"}


class laves_context_options(Structure):
    _fields_ = [
        ("thread_count", c_int),
        ("memory_limit", c_size_t),
        ("reallocate", laves_reallocate_fn),
        ("reallocate_user", c_void_p),
        ("progress", laves_progress_fn),
        ("progress_user", c_void_p),
        ("progress_interval", c_double),
        ("cookie", c_uint32),
    ]


class laves_surface_options(Structure):
    _fields_ = [
        ("winding", c_double),
        ("close_holes", c_bool),
        ("overlap", c_int),
        ("defects", c_void_p),
        ("cookie", c_uint32),
    ]
    _enums_ = {"overlap": "laves_overlap"}


class laves_function(Structure):
    _fields_ = [
        ("evaluate", CFUNCTYPE(None, c_void_p, POINTER(c_double), c_size_t, POINTER(c_double))),
        ("user", c_void_p),
        ("lower", c_double * 3),
        ("upper", c_double * 3),
        ("lipschitz", c_double),
    ]


class laves_domain_info(Structure):
    _fields_ = [
        ("kind", c_int),
        ("format", c_char_p),
        ("lower", c_double * 3),
        ("upper", c_double * 3),
        ("volume", c_double),
        ("area", c_double),
        ("point_count", c_size_t),
        ("triangle_count", c_size_t),
        ("component_count", c_size_t),
        ("topology_known", c_bool),
        ("genus", c_int64),
        ("closed", c_bool),
        ("turned", c_bool),
        ("winding", c_bool),
        ("winding_level", c_double),
        ("overlap", c_int),
        ("open_edges_left", c_size_t),
        ("crossing_parts", c_size_t),
        ("nested_parts", c_size_t),
        ("hollow_parts", c_size_t),
        ("defects", c_size_t * 9),
        ("defect_place", (c_double * 3) * 9),
        ("tag_count", c_int),
    ]
    _enums_ = {"kind": "laves_domain_kind", "overlap": "laves_overlap"}


class laves_defect_place(Structure):
    _fields_ = [
        ("kind", c_int),
        ("corner_count", c_int),
        ("corners", c_double * 3 * 3),
    ]
    _enums_ = {"kind": "laves_defect"}


class laves_thin_place(Structure):
    _fields_ = [
        ("place", c_double * 3),
        ("thickness", c_double),
        ("kind", c_int),
    ]
    _enums_ = {"kind": "laves_thin_kind"}


class laves_options(Structure):
    _fields_ = [
        ("size", c_double),
        ("relative_size", c_double),
        ("tet_target", c_int64),
        ("vertex_target", c_int64),
        ("align", c_int),
        ("rotation", c_double * 9),
        ("method", c_int),
        ("guarantee", c_double),
        ("improve", c_bool),
        ("min_dihedral", c_double),
        ("max_dihedral", c_double),
        ("volume_length", c_double),
        ("sizing", c_void_p),
        ("grading", c_double),
        ("min_size", c_double),
        ("curvature_elements", c_double),
        ("thickness_elements", c_double),
        ("feature_elements", c_double),
        ("max_distance", c_double),
        ("interior_growth", c_double),
        ("max_size", c_double),
        ("feature_angle", c_double),
        ("feature_tags", c_bool),
        ("features", c_void_p),
        ("keep_thin", c_bool),
        ("face_sources", c_bool),
        ("regions", c_int),
        ("streamed", c_bool),
        ("cookie", c_uint32),
    ]
    _enums_ = {"align": "laves_align", "method": "laves_method", "regions": "laves_regions"}


class laves_report_stages(Structure):
    _fields_ = [
        ("name", c_char_p),
        ("wall_seconds", c_double),
        ("cpu_seconds", c_double),
    ]


class laves_report(Structure):
    _fields_ = [
        ("size", c_double),
        ("volume", c_double),
        ("stage_count", c_int),
        ("stages", laves_report_stages * 16),
        ("peak_bytes", c_size_t),
        ("lattice_tets", c_size_t),
        ("snapped_vertices", c_size_t),
        ("pinches", c_size_t),
        ("off_surface", c_size_t),
        ("outside_window", c_size_t),
        ("promised_min_dihedral", c_double),
        ("promised_max_dihedral", c_double),
        ("stuffed_vertices", c_size_t),
        ("relaxed_vertices", c_size_t),
        ("relaxed_max", c_double),
        ("forced_tets", c_size_t),
        ("feature_size", c_double),
        ("creases", c_size_t),
        ("corners", c_size_t),
        ("corners_kept", c_size_t),
        ("crease_length", c_double),
        ("crease_kept", c_double),
        ("features_released", c_size_t),
        ("creases_dropped", c_size_t),
        ("creases_joined", c_size_t),
        ("topology_known", c_bool),
        ("domain_pieces", c_size_t),
        ("pieces", c_size_t),
        ("domain_genus", c_int64),
        ("genus", c_int64),
        ("lost_count", c_size_t),
        ("lost", laves_thin_place * 16),
        ("warning_count", c_int),
        ("warnings", (c_char * 240) * 16),
    ]


class laves_expectation(Structure):
    _fields_ = [
        ("size", c_double),
        ("tets", c_double),
        ("vertices", c_double),
        ("peak_bytes", c_double),
        ("certify_bytes", c_double),
        ("creases", c_size_t),
    ]


class laves_curve_options(Structure):
    _fields_ = [
        ("min_jacobian", c_double),
        ("distances", c_bool),
        ("feature_angle", c_double),
        ("feature_tags", c_bool),
        ("features", c_void_p),
        ("feature_size", c_double),
        ("cookie", c_uint32),
    ]


class laves_curve_report(Structure):
    _fields_ = [
        ("nodes", c_size_t),
        ("edges", c_size_t),
        ("boundary_edges", c_size_t),
        ("on_surface", c_size_t),
        ("moved_back", c_size_t),
        ("straightened", c_size_t),
        ("unreached", c_size_t),
        ("on_crease", c_size_t),
        ("least_jacobian", c_double),
        ("least_tet", c_int64),
        ("has_distance", c_bool),
        ("straight_max", c_double),
        ("straight_mean", c_double),
        ("curved_max", c_double),
        ("curved_mean", c_double),
    ]


class laves_statistic(Structure):
    _fields_ = [
        ("min", c_double),
        ("max", c_double),
        ("mean", c_double),
        ("deviation", c_double),
    ]


class laves_check(Structure):
    _fields_ = [
        ("vertices", c_size_t),
        ("tets", c_size_t),
        ("faces", c_size_t),
        ("valid", c_bool),
        ("bad_indices", c_size_t),
        ("inverted_tets", c_size_t),
        ("nonconforming_faces", c_size_t),
        ("nonmanifold_edges", c_size_t),
        ("nonmanifold_vertices", c_size_t),
        ("unused_vertices", c_size_t),
        ("components", c_size_t),
        ("boundary_components", c_size_t),
        ("genus", c_int64),
        ("volume", c_double),
        ("area", c_double),
        ("edge_min", c_double),
        ("edge_max", c_double),
        ("edge_mean", c_double),
        ("min_dihedral", laves_statistic),
        ("max_dihedral", laves_statistic),
        ("radius_ratio", laves_statistic),
        ("radius_edge", laves_statistic),
        ("volume_length", laves_statistic),
        ("histogram", c_size_t * 36),
        ("min_dihedral_place", c_double * 3),
        ("max_dihedral_place", c_double * 3),
        ("radius_ratio_place", c_double * 3),
        ("radius_edge_place", c_double * 3),
        ("volume_length_place", c_double * 3),
        ("min_dihedral_tet", c_int64),
        ("max_dihedral_tet", c_int64),
        ("radius_ratio_tet", c_int64),
        ("radius_edge_tet", c_int64),
        ("volume_length_tet", c_int64),
        ("has_distance", c_bool),
        ("to_surface_max", c_double),
        ("to_surface_mean", c_double),
        ("from_surface_max", c_double),
        ("from_surface_mean", c_double),
        ("to_surface_place", c_double * 3),
        ("from_surface_place", c_double * 3),
        ("to_surface_cover", c_double),
        ("from_surface_cover", c_double),
        ("to_surface_at_most", c_double),
        ("from_surface_at_most", c_double),
        ("domain_volume", c_double),
    ]


class laves_place(Structure):
    _fields_ = [
        ("place", c_double * 3),
        ("value", c_double),
        ("tet", c_int64),
        ("curvature_radius", c_double),
    ]


class laves_file_check_options(Structure):
    _fields_ = [
        ("domain", c_void_p),
        ("min_dihedral", c_double),
        ("max_dihedral", c_double),
        ("volume_length", c_double),
        ("places", POINTER(laves_place)),
        ("place_capacity", c_size_t),
        ("cache_bytes", c_size_t),
        ("cookie", c_uint32),
    ]


class laves_file_check(Structure):
    _fields_ = [
        ("check", laves_check),
        ("outside_window", c_size_t),
        ("file_faces", c_size_t),
        ("file_faces_elsewhere", c_size_t),
        ("file_faces_turned", c_size_t),
        ("file_faces_missing", c_size_t),
    ]


class laves_feature_place(Structure):
    _fields_ = [
        ("fault", c_int),
        ("place", c_double * 3),
        ("distance", c_double),
        ("length", c_double),
        ("angle", c_double),
        ("dihedral", c_double),
        ("index", c_int64),
    ]
    _enums_ = {"fault": "laves_feature_fault"}


class laves_feature_options(Structure):
    _fields_ = [
        ("angle", c_double),
        ("tags", c_bool),
        ("features", c_void_p),
        ("size", c_double),
        ("tolerance", c_double),
        ("cookie", c_uint32),
    ]


class laves_feature_check(Structure):
    _fields_ = [
        ("angle", c_double),
        ("size", c_double),
        ("tolerance", c_double),
        ("diagonal", c_double),
        ("edge_mean", c_double),
        ("creases", c_size_t),
        ("short_creases", c_size_t),
        ("length", c_double),
        ("short_length", c_double),
        ("creases_kept", c_size_t),
        ("kept_share", c_double),
        ("to_mesh_max", c_double),
        ("to_mesh_mean", c_double),
        ("to_mesh_place", c_double * 3),
        ("corners", c_size_t),
        ("short_corners", c_size_t),
        ("corners_kept", c_size_t),
        ("corners_near", c_size_t),
        ("mesh_creases", c_size_t),
        ("mesh_bent", c_size_t),
        ("from_mesh_max", c_double),
        ("from_mesh_place", c_double * 3),
        ("spurious", c_size_t),
        ("straddling", c_size_t),
        ("sharp", c_size_t),
        ("sharpest", c_double),
        ("away_min_dihedral", c_double),
        ("away_max_dihedral", c_double),
        ("free_min_dihedral", c_double),
        ("free_max_dihedral", c_double),
    ]


class laves_improve_options(Structure):
    _fields_ = [
        ("min_dihedral", c_double),
        ("max_dihedral", c_double),
        ("volume_length", c_double),
        ("tolerance", c_double),
        ("fixed_boundary", c_bool),
        ("passes", c_size_t),
        ("seconds", c_double),
        ("cookie", c_uint32),
    ]


class laves_improve_report(Structure):
    _fields_ = [
        ("before", laves_check),
        ("after", laves_check),
        ("outside_before", c_size_t),
        ("outside_after", c_size_t),
        ("patches", c_size_t),
        ("fixed_vertices", c_size_t),
        ("crease_vertices", c_size_t),
        ("flat_vertices", c_size_t),
        ("sharpest", c_double),
        ("out_of_time", c_bool),
        ("kept_as_it_was", c_bool),
        ("wall_seconds", c_double),
        ("cpu_seconds", c_double),
        ("peak_bytes", c_size_t),
    ]


class laves_exception(Structure):
    _fields_ = [
        ("kind", c_int),
        ("cause", c_int),
        ("place", c_double * 3),
        ("value", c_double),
        ("limit", c_double),
        ("index", c_int64),
        ("curvature_radius", c_double),
        ("crease_angle", c_double),
    ]
    _enums_ = {"kind": "laves_exception_kind", "cause": "laves_cause"}


class laves_certificate(Structure):
    _fields_ = [
        ("version", c_char * 32),
        ("mesh_hash", c_char * 65),
        ("check", laves_check),
        ("has_input", c_bool),
        ("input_name", c_char * 256),
        ("input_kind", c_char * 16),
        ("input_format", c_char * 48),
        ("input_hash", c_char * 65),
        ("command_count", c_int),
        ("command", c_char * 8192),
        ("has_options", c_bool),
        ("options", laves_options),
        ("size", c_double),
        ("stuffed_vertices", c_size_t),
        ("relaxed_vertices", c_size_t),
        ("pinches", c_size_t),
        ("relaxed_max", c_double),
        ("lattice_tets", c_size_t),
        ("bcc_tets", c_size_t),
        ("lattice_size", c_double),
        ("lattice_tolerance", c_double),
        ("angle_margin", c_double),
        ("attained_min_dihedral", c_double),
        ("attained_max_dihedral", c_double),
        ("has_promise", c_bool),
        ("promised_min_dihedral", c_double),
        ("promised_max_dihedral", c_double),
        ("promise_holds", c_bool),
        ("asked_min_dihedral", c_double),
        ("asked_max_dihedral", c_double),
        ("asked_volume_length", c_double),
        ("distance_asked", c_double),
        ("off_surface_asked", c_double),
        ("has_features", c_bool),
        ("features_tags", c_bool),
        ("features_drawn", c_bool),
        ("features", laves_feature_check),
        ("to_surface_reason", c_char * 96),
        ("from_surface_reason", c_char * 96),
        ("exception_counts", c_size_t * 11),
        ("exception_count", c_size_t),
        ("exceptions", laves_exception * 192),
    ]


class laves_certify_options(Structure):
    _fields_ = [
        ("domain", c_void_p),
        ("distances", c_bool),
        ("input", c_char_p),
        ("options", POINTER(laves_options)),
        ("report", POINTER(laves_report)),
        ("promised_min_dihedral", c_double),
        ("promised_max_dihedral", c_double),
        ("min_dihedral", c_double),
        ("max_dihedral", c_double),
        ("volume_length", c_double),
        ("feature_angle", c_double),
        ("feature_tags", c_bool),
        ("feature_size", c_double),
        ("command", POINTER(c_char_p)),
        ("command_count", c_int),
        ("cookie", c_uint32),
    ]


class laves_difference(Structure):
    _fields_ = [
        ("text", c_char * 240),
    ]


class laves_write_options(Structure):
    _fields_ = [
        ("format", c_int),
        ("ascii", c_bool),
        ("compression", c_int),
        ("cookie", c_uint32),
    ]
    _enums_ = {"format": "laves_format"}


# name: (type of the result, types of the arguments)
FUNCTIONS = {
    "laves_version": (c_char_p, []),
    "laves_result_name": (c_char_p, [c_int]),
    "laves_result_text": (c_char_p, [c_int]),
    "laves_result_exit_code": (c_int, [c_int]),
    "laves_context_options_default": (laves_context_options, []),
    "laves_context_create": (c_void_p, [POINTER(laves_context_options)]),
    "laves_context_free": (None, [c_void_p]),
    "laves_context_bytes": (c_size_t, [c_void_p]),
    "laves_context_peak_bytes": (c_size_t, [c_void_p]),
    "laves_domain_from_file": (c_int, [c_void_p, c_char_p, POINTER(c_void_p), POINTER(laves_error)]),
    "laves_surface_options_default": (laves_surface_options, []),
    "laves_domain_from_file_with": (c_int, [c_void_p, c_char_p, POINTER(laves_surface_options), POINTER(c_void_p), POINTER(laves_error)]),
    "laves_domain_from_expression": (c_int, [c_void_p, c_char_p, POINTER(c_void_p), POINTER(laves_error)]),
    "laves_domain_from_triangles": (c_int, [c_void_p, POINTER(c_double), c_size_t, POINTER(c_uint32), c_size_t, POINTER(c_int32), POINTER(c_void_p), POINTER(laves_error)]),
    "laves_domain_from_triangles_with": (c_int, [c_void_p, POINTER(c_double), c_size_t, POINTER(c_uint32), c_size_t, POINTER(c_int32), POINTER(laves_surface_options), POINTER(c_void_p), POINTER(laves_error)]),
    "laves_domain_from_function": (c_int, [c_void_p, POINTER(laves_function), POINTER(c_void_p), POINTER(laves_error)]),
    "laves_domain_free": (None, [c_void_p]),
    "laves_domain_evaluate": (None, [c_void_p, POINTER(c_double), c_size_t, POINTER(c_double)]),
    "laves_defect_text": (c_char_p, [c_int]),
    "laves_domain_get_info": (None, [c_void_p, POINTER(laves_domain_info)]),
    "laves_domain_tag_name": (c_char_p, [c_void_p, c_int]),
    "laves_defects_create": (c_int, [c_void_p, POINTER(c_void_p), POINTER(laves_error)]),
    "laves_defects_free": (None, [c_void_p]),
    "laves_defects_count": (c_size_t, [c_void_p]),
    "laves_defects_get": (None, [c_void_p, c_size_t, POINTER(laves_defect_place)]),
    "laves_defects_write": (c_int, [c_void_p, c_void_p, c_char_p, POINTER(laves_error)]),
    "laves_domain_thin_places": (c_size_t, [c_void_p, POINTER(laves_thin_place), c_size_t]),
    "laves_domain_gap_places": (c_size_t, [c_void_p, POINTER(laves_thin_place), c_size_t]),
    "laves_sizing_create": (c_int, [c_void_p, POINTER(c_void_p), POINTER(laves_error)]),
    "laves_sizing_free": (None, [c_void_p]),
    "laves_sizing_add_expression": (c_int, [c_void_p, c_char_p, POINTER(laves_error)]),
    "laves_sizing_add_script": (c_int, [c_void_p, c_char_p, POINTER(laves_error)]),
    "laves_sizing_add_background": (c_int, [c_void_p, c_char_p, c_char_p, POINTER(laves_error)]),
    "laves_sizing_add_points": (c_int, [c_void_p, POINTER(c_double), c_size_t, c_double, c_double, POINTER(laves_error)]),
    "laves_sizing_add_curve": (c_int, [c_void_p, POINTER(c_double), c_size_t, c_double, c_double, POINTER(laves_error)]),
    "laves_sizing_add_curve_file": (c_int, [c_void_p, c_char_p, c_double, c_double, POINTER(laves_error)]),
    "laves_sizing_add_tag": (c_int, [c_void_p, c_char_p, c_double, c_double, POINTER(laves_error)]),
    "laves_features_create": (c_int, [c_void_p, POINTER(c_void_p), POINTER(laves_error)]),
    "laves_features_free": (None, [c_void_p]),
    "laves_features_add_points": (c_int, [c_void_p, POINTER(c_double), c_size_t, POINTER(laves_error)]),
    "laves_features_add_line": (c_int, [c_void_p, POINTER(c_double), c_size_t, POINTER(laves_error)]),
    "laves_features_add_file": (c_int, [c_void_p, c_char_p, POINTER(laves_error)]),
    "laves_options_default": (laves_options, []),
    "laves_generate": (c_int, [c_void_p, c_void_p, POINTER(laves_options), POINTER(c_void_p), POINTER(laves_report), POINTER(laves_error)]),
    "laves_estimate": (c_int, [c_void_p, c_void_p, POINTER(laves_options), POINTER(laves_expectation), POINTER(laves_error)]),
    "laves_generate_tiling": (c_int, [c_void_p, POINTER(c_int), c_double, POINTER(c_void_p), POINTER(laves_error)]),
    "laves_mesh_free": (None, [c_void_p]),
    "laves_mesh_from_arrays": (c_int, [c_void_p, POINTER(c_double), c_size_t, POINTER(c_int32), c_size_t, POINTER(c_int32), POINTER(c_void_p), POINTER(laves_error)]),
    "laves_mesh_vertex_count": (c_size_t, [c_void_p]),
    "laves_mesh_tet_count": (c_size_t, [c_void_p]),
    "laves_mesh_face_count": (c_size_t, [c_void_p]),
    "laves_mesh_points": (POINTER(c_double), [c_void_p]),
    "laves_mesh_tets": (POINTER(c_int32), [c_void_p]),
    "laves_mesh_faces": (POINTER(c_int32), [c_void_p]),
    "laves_mesh_regions": (POINTER(c_int32), [c_void_p]),
    "laves_mesh_face_tags": (POINTER(c_int32), [c_void_p]),
    "laves_mesh_read_points": (c_int, [c_void_p, c_size_t, c_size_t, POINTER(c_double), POINTER(laves_error)]),
    "laves_mesh_read_tets": (c_int, [c_void_p, c_size_t, c_size_t, POINTER(c_int32), POINTER(laves_error)]),
    "laves_mesh_is_streamed": (c_bool, [c_void_p]),
    "laves_mesh_face_sources": (POINTER(c_int32), [c_void_p]),
    "laves_mesh_lattice_tet_count": (c_size_t, [c_void_p]),
    "laves_mesh_group_name": (c_char_p, [c_void_p, c_int, c_int32]),
    "laves_mesh_hash": (None, [c_void_p, c_char_p]),
    "laves_curve_options_default": (laves_curve_options, []),
    "laves_mesh_curve": (c_int, [c_void_p, c_void_p, c_void_p, POINTER(laves_curve_options), POINTER(laves_curve_report), POINTER(laves_error)]),
    "laves_mesh_order": (c_int, [c_void_p]),
    "laves_mesh_node_count": (c_size_t, [c_void_p]),
    "laves_mesh_node_points": (POINTER(c_double), [c_void_p]),
    "laves_mesh_tet_nodes": (POINTER(c_int32), [c_void_p]),
    "laves_mesh_face_nodes": (POINTER(c_int32), [c_void_p]),
    "laves_check_mesh": (c_int, [c_void_p, c_void_p, c_void_p, POINTER(laves_check), POINTER(laves_error)]),
    "laves_check_window": (c_int, [c_void_p, c_void_p, c_void_p, c_double, c_double, c_double, POINTER(laves_place), c_size_t, POINTER(c_size_t), POINTER(laves_error)]),
    "laves_check_distance": (c_int, [c_void_p, c_void_p, c_void_p, c_double, POINTER(laves_place), c_size_t, POINTER(c_size_t), POINTER(laves_error)]),
    "laves_file_check_options_default": (laves_file_check_options, []),
    "laves_check_file": (c_int, [c_void_p, c_char_p, POINTER(laves_file_check_options), POINTER(laves_file_check), POINTER(laves_error)]),
    "laves_feature_fault_key": (c_char_p, [c_int]),
    "laves_feature_fault_text": (c_char_p, [c_int]),
    "laves_feature_options_default": (laves_feature_options, []),
    "laves_check_features": (c_int, [c_void_p, c_void_p, c_void_p, POINTER(laves_feature_options), POINTER(laves_feature_check), POINTER(laves_feature_place), c_size_t, POINTER(c_size_t), POINTER(laves_error)]),
    "laves_improve_options_default": (laves_improve_options, []),
    "laves_improve": (c_int, [c_void_p, c_void_p, POINTER(laves_improve_options), POINTER(c_void_p), POINTER(laves_improve_report), POINTER(laves_error)]),
    "laves_exception_key": (c_char_p, [c_int]),
    "laves_exception_text": (c_char_p, [c_int]),
    "laves_cause_key": (c_char_p, [c_int]),
    "laves_cause_text": (c_char_p, [c_int]),
    "laves_certify_options_default": (laves_certify_options, []),
    "laves_certify": (c_int, [c_void_p, c_void_p, POINTER(laves_certify_options), POINTER(laves_certificate), POINTER(laves_error)]),
    "laves_certificate_write": (c_int, [c_void_p, POINTER(laves_certificate), c_char_p, POINTER(laves_error)]),
    "laves_certificate_read": (c_int, [c_void_p, c_char_p, POINTER(laves_certificate), POINTER(laves_error)]),
    "laves_certificate_verify": (c_int, [c_void_p, c_void_p, c_void_p, c_char_p, POINTER(laves_certificate), POINTER(laves_difference), c_size_t, POINTER(c_size_t), POINTER(laves_error)]),
    "laves_write_options_default": (laves_write_options, []),
    "laves_format_name": (c_char_p, [c_int]),
    "laves_format_from_name": (c_int, [c_char_p]),
    "laves_format_from_path": (c_int, [c_char_p]),
    "laves_format_streams": (c_bool, [c_int]),
    "laves_format_is_quadratic": (c_bool, [c_int]),
    "laves_mesh_write": (c_int, [c_void_p, c_void_p, c_char_p, POINTER(laves_write_options), POINTER(laves_error)]),
    "laves_mesh_read": (c_int, [c_void_p, c_char_p, POINTER(c_void_p), POINTER(laves_error)]),
}
