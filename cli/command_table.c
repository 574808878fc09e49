/* The commands of the program and their options, as data.
 *
 * One row per option says everything: spelling, argument, kind, range, default, help, and the member of `settings` that it
 * fills.  From the rows come the parser (options.c), --help, docs/options.md and the dump for tests (help.c), so that none
 * of them can disagree. */
#include <math.h>
#include <string.h>

#include "command.h"
#include "options.h"

enum { MESH = 1, CHECK = 2, INFO = 4, TILING = 8, VIEW = 16, IMPROVE = 32, REPORT = 64, DATA = 111, ALL = 127 };

const command commands[] = {
    {"mesh", "INPUT", "fill a solid with nearly regular tetrahedra",
     "INPUT is a triangle surface (STL, OBJ, PLY, OFF, Gmsh; clean or dirty), a Lua script (.lua), or an expression in quotes.\n"
     "A name that exists as a file is a file. The mesh goes to every --output; without one, to INPUT's base name with .vtu\n"
     "in the current folder (mesh.vtu for an expression). Existing outputs are replaced once the new ones are complete.\n"
     "A certificate, which states and locates what the mesh is, goes beside the first output.",
     "laves mesh bunny.obj -o bunny.vtu\n"
     "laves mesh bunny.obj --tets 500k -o bunny.msh -o bunny.vtu\n"
     "laves mesh 'sphere(1) - cylinder{r=0.4}' --size 0.05 -o bead.mesh\n",
     MESH, command_mesh},
    {"check", "MESH", "say whether a mesh is valid and how good it is",
     "MESH is a tetrahedral mesh of any program (VTU, Gmsh 2.2 and 4.1, Medit, TetGen). Exit code 0: valid; 2: it cannot be\n"
     "read; 3: it is not valid, a window asked for with --window or --volume-length is missed, --features finds creases or\n"
     "corners lost, or --certificate does not belong to it.",
     "laves check bunny.vtu --surface bunny.obj\n"
     "laves check bunny.vtu --certificate bunny.certificate.json\n"
     "laves check other.msh --window 20,150 --list 10\n"
     "laves check part.msh --surface part.stl --features\n"
     "laves check huge.vtu --stream --memory 4G\n",
     CHECK, command_check},
    {"improve", "MESH", "better the angles of a tetrahedral mesh of any program",
     "MESH is what `laves check` takes. Its boundary keeps its shape, regions and tags stay, and the worst angles never get "
     "worse\n"
     "(docs/improve.md). Exit code 2: it cannot be read, or is not valid; 3: a window asked for with --window or\n"
     "--volume-length is missed.",
     "laves improve part.msh -o better.msh\n"
     "laves improve part.1.ele -o better.vtu --window 25,145\n"
     "laves improve scan.mesh -o better.mesh --tolerance 0.01 --budget 60\n",
     IMPROVE, command_improve},
    {"info", "INPUT", "say what an input is, what is wrong with it, and what meshing will cost",
     "INPUT is what `laves mesh` takes. Nothing is meshed and nothing is written.", "laves info bunny.obj --tets 1M\n", INFO,
     command_info},
    {"tiling", NULL, "show the tiling: Table 1 of the paper, and the mesh of a box",
     "Measures the tiling over whole periods and sets the figures beside those that the paper prints. With --output, writes\n"
     "the tiles as a mesh.",
     "laves tiling\n"
     "laves tiling --cells 8,8,2 --size 0.1 -o box.vtu\n",
     TILING, command_tiling},
    {"view", "MESH", "draw a mesh, whole or cut open, or histograms of its quality",
     "MESH is what `laves check` takes. With --cut, whole tetrahedra on one side of a plane are left out, never halves, so the\n"
     "picture shows the elements of the inside; their faces have a colour of their own. Pictures are PNG files, plots SVG.",
     "laves view bunny.vtu -o bunny.png --up y\n"
     "laves view bunny.vtu -o inside.png --cut x --color dihedral --size 1600x1200\n"
     "laves view bunny.vtu -o worst.png --worst 10\n"
     "laves view bunny.vtu -o angles.svg --plot dihedral\n",
     VIEW, command_view},
    {"report", "MESH", "show a mesh on a page that opens in any browser: turned, cut, coloured, with its certificate",
     "MESH is what `laves check` takes. The page is one HTML file that needs no network. Exit codes are those of `laves check`.",
     "laves report bunny.vtu --surface bunny.obj -o bunny.html\n"
     "laves mesh bunny.obj -o bunny.vtu --report bunny.html\n",
     REPORT, command_report},
};
const size_t command_count = sizeof commands / sizeof commands[0];

#define MEMBER(name) offsetof(settings, name)

#define IN_SIZE "Size (at most one; none: about 50 thousand tetrahedra)"
#define IN_SURFACE "Surfaces (docs/dirty.md)"
#define IN_SIZING "Sizes that vary (docs/sizing.md); the size above is the largest, and the least asked for counts"
#define IN_FEATURES "Features (docs/features.md)"
#define IN_TILING "Tiling"
#define IN_SHAPE "Shape"
#define IN_CHECK "Check"
#define IN_IMPROVE "Improvement"
#define IN_PICTURE "Picture"
#define IN_FILES "Files"
#define IN_RUN "Run"

const option option_rows[] = {
    {"size", 0, MESH | INFO, IN_SIZE, OPTION_REAL, "H", "units of the input", true, 0, INFINITY, NULL, MEMBER(size), 1,
     "target edge length: the mean edge of the tiling"},
    {"rel-size", 0, MESH | INFO, IN_SIZE, OPTION_REAL, "F", NULL, true, 0, 0.5, NULL, MEMBER(relative_size), 1,
     "the same as a fraction of the diagonal of the bounding box"},
    {"tets", 0, MESH | INFO, IN_SIZE, OPTION_COUNT, "N", NULL, false, 1, 4e9, NULL, MEMBER(tets), 1,
     "wished number of tetrahedra, met within 3 %; also 50k, 1.5M"},
    {"vertices", 0, MESH | INFO, IN_SIZE, OPTION_COUNT, "N", NULL, false, 1, 2e9, NULL, MEMBER(vertices), 1,
     "wished number of vertices, met within 3 %; also 50k, 1.5M"},
    {"size", 0, TILING, IN_TILING, OPTION_REAL, "H", NULL, true, 0, INFINITY, "1", MEMBER(size), 0,
     "mean edge length; a cubic cell has side 2.5118 H"},
    {"cells", 0, TILING, IN_TILING, OPTION_CELLS, "N[,N,N]", "cells", false, 1, 1000, "4", MEMBER(cells), 0,
     "periods along each axis, 136 tetrahedra in each cell"},

    {"surface", 0, CHECK | REPORT, IN_CHECK, OPTION_WORD, "INPUT", NULL, false, 0, 0, NULL, MEMBER(surface), 0,
     "the solid that the mesh should fill, as `laves mesh` takes it: distances are measured both ways"},
    {"window", 0, CHECK | REPORT, IN_CHECK, OPTION_WINDOW, "LO,HI", "degrees", false, 0, 180, "40,125", MEMBER(window), 0,
     "range for every dihedral angle (LO 0..60, HI 80..180); when given, exit code 3 if it or --volume-length is missed"},
    {"volume-length", 0, CHECK | REPORT, IN_CHECK, OPTION_REAL, "Q", NULL, false, 0, 0.8, "0.6", MEMBER(volume_length), 0,
     "lowest volume-length ratio; when given, exit code 3 if it is missed"},
    {"features", 0, CHECK, IN_CHECK, OPTION_FLAG, NULL, NULL, false, 0, 0, NULL, MEMBER(check_features), 0,
     "measure how well the mesh keeps the creases and corners of --surface; exit code 3 when a crease that is longer than the "
     "edges near by, or a corner, is lost"},
    {"feature-angle", 0, CHECK, IN_CHECK, OPTION_REAL, "DEG", "degrees", false, 1, 179, "40", MEMBER(feature_angle), 0,
     "with --features: what counts as a crease, edges of the surface where its normal turns by more"},
    {"stream", 0, CHECK, IN_CHECK, OPTION_FLAG, NULL, NULL, false, 0, 0, NULL, MEMBER(stream), 0,
     "leave the mesh in its file, which may be larger than memory: a VTU with raw appended data, as `laves mesh` writes it; "
     "without certificates, features and the mean edge"},
    {"list", 0, CHECK, IN_CHECK, OPTION_COUNT, "N", "places", false, 0, 100000, "5", MEMBER(list), 0,
     "how many of the worst places to list"},

    {"winding", 0, MESH | CHECK | INFO | REPORT, IN_SURFACE, OPTION_REAL, "N", NULL, false, 0.05, 100, "0.5", MEMBER(winding), 0,
     "inside is where a surface winds round a point more often than this: 1.5 for the overlap of closed parts; below 0.5 the "
     "caps "
     "of open surfaces stand further out, above it further in"},
    {"close-holes", 0, MESH | CHECK | INFO | REPORT, IN_SURFACE, OPTION_SWITCH, "yes|no", NULL, false, 0, 0, "yes",
     MEMBER(close_holes), 0, "no: refuse a surface that stays open once its cracks are mended, and say where"},
    {"union", 0, MESH | CHECK | INFO | REPORT, IN_SURFACE, OPTION_FLAG, NULL, NULL, false, 0, 0, NULL, MEMBER(unite), 3,
     "all that any closed part encloses is solid, whichever way its faces are directed; without it and --nested, a part within "
     "another is a hollow where its faces are directed inwards"},
    {"nested", 0, MESH | CHECK | INFO | REPORT, IN_SURFACE, OPTION_FLAG, NULL, NULL, false, 0, 0, NULL, MEMBER(nested), 3,
     "closed parts within an odd number of others are hollows, whichever way their faces are directed"},
    {"defects", 0, MESH | INFO, IN_SURFACE, OPTION_WORD, "FILE", NULL, false, 0, 0, NULL, MEMBER(defects), 0,
     "write where the surface's defects are, as coloured points, lines and faces (.ply, .obj, .vtp); also when it is refused"},

    {"size-field", 0, MESH | INFO, IN_SIZING, OPTION_WORDS, "FIELD", NULL, false, 0, TEXTS_CAPACITY, NULL, MEMBER(size_fields), 0,
     "sizes over space: a Lua expression of x, y, z and d, the depth below the surface; a script (.lua) that returns one; or a "
     "background mesh or image with sizes (.vtu, .msh, .pos, .nrrd), FILE or FILE:ARRAY; repeatable"},
    {"refine", 0, MESH | INFO, IN_SIZING, OPTION_WORDS, "PLACE=SIZE[,RADIUS]", NULL, false, 0, TEXTS_CAPACITY, NULL,
     MEMBER(refinements), 0,
     "that size within the radius of a place, growing beyond by the grading: tag:NAME, point:X,Y,Z, or curve:FILE with a point "
     "on each line, where an empty line ends a polyline; repeatable"},
    {"curvature-elements", 0, MESH | INFO, IN_SIZING, OPTION_REAL, "N", "elements", false, 3, 1000, NULL,
     MEMBER(curvature_elements), 0, "elements round a full circle, wherever the surface bends"},
    {"thickness-elements", 0, MESH | INFO, IN_SIZING, OPTION_REAL, "N", "elements", false, 0.5, 100, NULL,
     MEMBER(thickness_elements), 0, "elements across every wall and gap"},
    {"feature-elements", 0, MESH | INFO, IN_SIZING, OPTION_REAL, "N", "elements", false, 0.5, 100, NULL, MEMBER(feature_elements),
     0, "elements between creases that come close to one another (surfaces only)"},
    {"max-distance", 0, MESH | INFO, IN_SIZING, OPTION_REAL, "D", "units of the input", true, 0, INFINITY, NULL,
     MEMBER(max_distance), 2, "size the boundary so that it lies within this distance of the surface where that is smooth"},
    {"rel-distance", 0, MESH | INFO, IN_SIZING, OPTION_REAL, "F", NULL, true, 0, 0.5, NULL, MEMBER(relative_distance), 2,
     "the same distance as a fraction of the diagonal of the bounding box"},
    {"interior-growth", 0, MESH | INFO, IN_SIZING, OPTION_REAL, "G", "size per depth", true, 0, 1, NULL, MEMBER(interior_growth),
     0,
     "fine at the surface, coarse inside: the size grows by this per unit of depth, beyond the size above; no faster than "
     "the grading"},
    {"max-size", 0, MESH | INFO, IN_SIZING, OPTION_REAL, "H", "units of the input", true, 0, INFINITY, "16 sizes",
     MEMBER(max_size), 0, "where that growth ends"},
    {"min-size", 0, MESH | INFO, IN_SIZING, OPTION_REAL, "H", "units of the input", true, 0, INFINITY, "a 64th of the size",
     MEMBER(min_size), 0, "no element is asked to be smaller, whatever asks for it"},
    {"grading", 0, MESH | INFO, IN_SIZING, OPTION_REAL, "G", "size per distance", false, 0.05, 1, "0.3", MEMBER(grading), 0,
     "how fast the size may grow from place to place"},

    {"features", 0, MESH | INFO, IN_FEATURES, OPTION_WORDS, "auto|none|FILE", NULL, false, 0, TEXTS_CAPACITY, "auto",
     MEMBER(features), 0,
     "auto: sharp edges and corners of the solid are kept as edges and vertices of the mesh; none: they are not looked for; "
     "a file: "
     "its points and lines are kept, and what is found besides, unless none is given too (text, OBJ, Gmsh, VTK: "
     "docs/feature-files.md); repeatable"},
    {"feature-angle", 0, MESH | INFO, IN_FEATURES, OPTION_REAL, "DEG", "degrees", false, 1, 179, "40", MEMBER(feature_angle), 0,
     "how much the surface's normal must turn at an edge that is sharp"},
    {"feature-tags", 0, MESH | INFO, IN_FEATURES, OPTION_FLAG, NULL, NULL, false, 0, 0, NULL, MEMBER(feature_tags), 0,
     "keep edges between parts of the surface with different tags too, also with --features none"},
    {"no-keep-thin", 0, MESH | INFO, IN_FEATURES, OPTION_FLAG, NULL, NULL, false, 0, 0, NULL, MEMBER(no_keep_thin), 0,
     "let walls and gaps thinner than about the size go as they go; else those down to half the size are kept, or named"},

    {"align", 0, MESH, IN_SHAPE, OPTION_ALIGNMENT, "none|pca|NUMBERS", NULL, false, 0, 0, "none", MEMBER(alignment), 0,
     "how the lattice lies: none, pca (principal axes), an axis and an angle in degrees as x,y,z,angle, or a rotation matrix as "
     "9 numbers row by row"},
    {"method", 0, MESH, IN_SHAPE, OPTION_METHOD, "auto|snap|stuff", NULL, false, 0, 0, "auto", MEMBER(method), 0,
     "how the boundary is made: snap (no tetrahedron is cut), stuff (warped and cut, with proved angles), or auto: snapped, and "
     "stuffed where snapping leaves the guaranteed window"},
    {"guarantee", 0, MESH, IN_SHAPE, OPTION_REAL, "DEG", "degrees", false, 0, 28, "14.4", MEMBER(guarantee), 0,
     "smallest dihedral angle promised whatever the shape (docs/proof.md): 14.4 keeps boundary vertices on the surface, but "
     "where it would touch itself; 20, "
     "22.5, 24 and 28 may move some off it, where the surface is rougher than the size; between these the next higher; 0: no "
     "promise, as with --method snap"},
    {"no-improve", 0, MESH, IN_SHAPE, OPTION_FLAG, NULL, NULL, false, 0, 0, NULL, MEMBER(no_improve), 0,
     "leave the boundary layer as it was made"},
    {"window", 0, MESH, IN_SHAPE, OPTION_WINDOW, "LO,HI", "degrees", false, 0, 180, "40,125", MEMBER(window), 0,
     "asked range of every dihedral angle (LO 0..60, HI 80..180); exit code 3 when it or --volume-length is missed"},
    {"volume-length", 0, MESH, IN_SHAPE, OPTION_REAL, "Q", NULL, false, 0, 0.8, "0.6", MEMBER(volume_length), 0,
     "asked volume-length ratio of every tetrahedron; exit code 3 when it is missed"},
    {"window", 0, IMPROVE, IN_IMPROVE, OPTION_WINDOW, "LO,HI", "degrees", false, 0, 180, "30,140", MEMBER(window), 0,
     "what every dihedral angle is to be brought into (LO 0..60, HI 80..180); when given, exit code 3 if it is missed"},
    {"volume-length", 0, IMPROVE, IN_IMPROVE, OPTION_REAL, "Q", NULL, false, 0, 0.8, "not asked", MEMBER(volume_length), 0,
     "lowest volume-length ratio that is asked for besides; when given, exit code 3 if it is missed"},
    {"tolerance", 0, IMPROVE, IN_IMPROVE, OPTION_REAL, "D", "units of the mesh", false, 0, INFINITY, "0", MEMBER(tolerance), 0,
     "how far the boundary may come to be from where it was: what is flat within that counts as flat; 0: vertices move in flat "
     "parts and along straight edges only"},
    {"fixed-boundary", 0, IMPROVE, IN_IMPROVE, OPTION_FLAG, NULL, NULL, false, 0, 0, NULL, MEMBER(fixed_boundary), 0,
     "leave vertices and triangles of the boundary as they are"},
    {"passes", 0, IMPROVE, IN_IMPROVE, OPTION_COUNT, "N", "passes", false, 1, 1000, "as many as help", MEMBER(passes), 0,
     "most passes over what is outside the window; the mesh is the same on any machine"},
    {"budget", 0, IMPROVE, IN_IMPROVE, OPTION_REAL, "SECONDS", "seconds", true, 0, 1e9, "no limit", MEMBER(budget), 0,
     "when to stop improving and write what there is; with it the mesh depends on the machine"},
    {"cut", 0, VIEW, IN_PICTURE, OPTION_WORD, "x|y|z|A,B,C,D", NULL, false, 0, 0, NULL, MEMBER(cut), 0,
     "leave out what lies in front of a plane: x, y or z through the middle, or A,B,C,D for what has a corner with "
     "A x + B y + C z > D"},
    {"color", 0, VIEW, IN_PICTURE, OPTION_WORD, "class|dihedral|quality|size|distance", NULL, false, 0, 0, "class", MEMBER(color),
     0,
     "class: surface and inside; dihedral or quality: from blue (as the tiling's) through amber to red (flat), by the dihedral "
     "angle furthest from the tiling's or by the volume-length ratio; size: from purple (the shortest edges of the mesh) through "
     "green to yellow (the longest); distance: the boundary, from blue to red where it is furthest from --surface"},
    {"surface", 0, VIEW, IN_PICTURE, OPTION_WORD, "INPUT", NULL, false, 0, 0, NULL, MEMBER(surface), 0,
     "with --color distance: the solid that the mesh should fill, as `laves mesh` takes it; distances to solids that are no "
     "surface "
     "files are of first order"},
    {"worst", 0, VIEW, IN_PICTURE, OPTION_COUNT, "N", "tetrahedra", false, 0, 1000, "0", MEMBER(worst), 0,
     "draw the worst tetrahedra over the paled mesh, each in a ring, and list them: by volume-length ratio with --color quality, "
     "else "
     "by dihedral angle"},
    {"plot", 0, VIEW, IN_PICTURE, OPTION_WORD, "dihedral|radius-ratio|radius-edge|all", NULL, false, 0, 0, NULL, MEMBER(plot), 0,
     "no picture but a histogram (SVG) of all dihedral angles, of 3 r / R, or of R / shortest edge; all: the three side by side"},
    {"view", 0, VIEW, IN_PICTURE, OPTION_WORD, "AZ,EL", "degrees", false, 0, 0, "30,25", MEMBER(view), 0,
     "where the viewer stands: around the upward axis, and above the horizon"},
    {"up", 0, VIEW, IN_PICTURE, OPTION_WORD, "x|y|z", NULL, false, 0, 0, "z", MEMBER(up), 0, "upward axis"},
    {"size", 0, VIEW, IN_PICTURE, OPTION_WORD, "WxH", "pixels", false, 0, 0, "1200x900; plots 480x320", MEMBER(pixels), 0,
     "width and height, 16 to 16384 each"},
    {"background", 0, VIEW, IN_PICTURE, OPTION_WORD, "white|transparent|dark", NULL, false, 0, 0, "white", MEMBER(background), 0,
     "what is behind the mesh"},
    {"lines", 0, VIEW, IN_PICTURE, OPTION_REAL, "W", "pixels", false, 0, 20, "0.9", MEMBER(lines), 0,
     "width of the edges; 0: none"},
    {"creases", 0, VIEW, IN_PICTURE, OPTION_REAL, "W", "pixels", false, 0, 20, "0", MEMBER(creases), 0,
     "width of bold lines along the edges of the boundary where it turns by more than 40 degrees; 0: none"},

    {"output", 'o', MESH, IN_FILES, OPTION_WORDS, "FILE", NULL, false, 0, OUTPUT_CAPACITY, "INPUT's base name and .vtu, here",
     MEMBER(outputs), 0, "where the mesh goes; repeat it for several formats"},
    {"output", 'o', TILING, IN_FILES, OPTION_WORDS, "FILE", NULL, false, 0, OUTPUT_CAPACITY, NULL, MEMBER(outputs), 0,
     "write the tiling as a mesh; repeat it for several formats"},
    {"output", 'o', VIEW, IN_FILES, OPTION_WORDS, "FILE", NULL, false, 0, OUTPUT_CAPACITY, NULL, MEMBER(outputs), 0,
     "where the picture goes (PNG; with --plot SVG); needed"},
    {"output", 'o', IMPROVE, IN_FILES, OPTION_WORDS, "FILE", NULL, false, 0, OUTPUT_CAPACITY, NULL, MEMBER(outputs), 0,
     "where the improved mesh goes; needed; repeat it for several formats"},
    {"format", 0, MESH | TILING | IMPROVE, IN_FILES, OPTION_FORMAT, "NAME", NULL, false, 0, 0, "from the extension",
     MEMBER(format), 0, "format of the one output: "},
    {"ascii", 0, MESH | TILING | IMPROVE, IN_FILES, OPTION_FLAG, NULL, NULL, false, 0, 0, NULL, MEMBER(ascii), 0,
     "text instead of binary, where the format has both"},
    {"compress", 0, MESH | TILING | IMPROVE, IN_FILES, OPTION_COUNT, "N", NULL, false, 0, 9, "1", MEMBER(compress), 0,
     "compression of VTU, 0 none to 9 smallest"},
    {"boundary", 0, MESH | IMPROVE, IN_FILES, OPTION_WORD, "FILE", NULL, false, 0, 0, NULL, MEMBER(boundary), 0,
     "also write the boundary surface (.stl, .obj, .ply, .off)"},
    {"regions", 0, MESH, IN_FILES, OPTION_REGIONS, "none|parts", NULL, false, 0, 0, "none", MEMBER(regions), 0,
     "what tetrahedra are told apart by: none, or parts: the closed parts of the input surface that contain them, the innermost "
     "where parts are nested (docs/formats.md)"},
    {"face-sources", 0, MESH, IN_FILES, OPTION_FLAG, NULL, NULL, false, 0, 0, NULL, MEMBER(face_sources), 0,
     "write for each boundary triangle the nearest face of the input surface, from 0 (source_face in VTU)"},
    {"order", 0, MESH, IN_FILES, OPTION_COUNT, "1|2", NULL, false, 1, 2, "1", MEMBER(order), 0,
     "2: tetrahedra of ten nodes, those on edges of the boundary on the surface (docs/quadratic.md): VTU, Gmsh, Medit, Abaqus, "
     "Exodus, Nastran, VTKHDF, VTK, XDMF, NPZ"},
    {"stream", 0, MESH, IN_FILES, OPTION_FLAG, NULL, NULL, false, 0, 0, NULL, MEMBER(stream), 0,
     "make points and tetrahedra while they are written, for meshes larger than memory (docs/streaming.md): VTU, Gmsh, VTKHDF, "
     "VTK, XDMF, "
     "NPZ; one size and no regions, no certificate"},
    {"certificate", 0, MESH | IMPROVE, IN_FILES, OPTION_WORD, "FILE", NULL, false, 0, 0,
     "the first output's name with .certificate.json for its extension", MEMBER(certificate), 0,
     "where the certificate goes (docs/certificate.md); none: write none and leave the final check out"},
    {"certificate", 0, CHECK, IN_FILES, OPTION_WORD, "FILE", NULL, false, 0, 0, NULL, MEMBER(certificate), 0,
     "verify that mesh and certificate belong together, figure by figure"},
    {"write-certificate", 0, CHECK, IN_FILES, OPTION_WORD, "FILE", NULL, false, 0, 0, NULL, MEMBER(write_certificate), 0,
     "write a certificate of the mesh"},
    {"output", 'o', REPORT, IN_FILES, OPTION_WORDS, "FILE", NULL, false, 0, OUTPUT_CAPACITY, NULL, MEMBER(outputs), 0,
     "where the page goes (HTML); needed"},
    {"report", 0, MESH, IN_FILES, OPTION_AUTO, "auto|FILE", NULL, false, 0, 0, NULL, MEMBER(report), 0,
     "also write a page that shows the mesh in any browser (HTML; docs/report.md); auto, or no value: the first output's name "
     "with "
     ".html for its extension"},
    {"whole", 0, MESH | REPORT, IN_FILES, OPTION_COUNT, "N", "tetrahedra", false, 0, 2e7, "400k", MEMBER(whole), 0,
     "the page holds meshes of up to so many tetrahedra whole, and of larger ones the boundary, sections along the axes and the "
     "worst tetrahedra"},
    {"json", 0, DATA, IN_FILES, OPTION_WORD, "FILE", NULL, false, 0, 0, NULL, MEMBER(json), 0,
     "write all facts as JSON (docs/json.md); - is the standard output"},

    {"job", 0, ALL, IN_RUN, OPTION_WORD, "FILE", NULL, false, 0, 0, NULL, MEMBER(job_path), 0,
     "take the input and the options that are not given here from a file: TOML, JSON, or a certificate, whose mesh is then made "
     "again (docs/job.md)"},
    {"threads", 0, MESH | CHECK | INFO | IMPROVE | REPORT, IN_RUN, OPTION_COUNT, "N", NULL, false, 1, 4096, "one per core",
     MEMBER(threads), 0, "threads to use; the mesh never depends on it"},
    {"memory", 0, ALL, IN_RUN, OPTION_BYTES, "SIZE", "bytes", false, 1, 1e18, "what the machine has", MEMBER(memory), 0,
     "most memory to hold, such as 500M or 2G (powers of 1024); exit code 4 when it is not enough, before meshing begins where "
     "that can "
     "be foreseen"},
    {"timeout", 0, ALL, IN_RUN, OPTION_REAL, "SECONDS", "seconds", true, 0, 1e9, "no limit", MEMBER(timeout), 0,
     "most time to take; the run then ends as by Ctrl-C, with exit code 124 and nothing half-written"},
    {"quiet", 'q', ALL, IN_RUN, OPTION_FLAG, NULL, NULL, false, 0, 0, NULL, MEMBER(quiet), 0, "say nothing but errors"},
    {"verbose", 'v', ALL, IN_RUN, OPTION_FLAG, NULL, NULL, false, 0, 0, NULL, MEMBER(verbose), 0,
     "say more: time of each stage, all defects of the input"},
    {"help", 'h', ALL, IN_RUN, OPTION_FLAG, NULL, NULL, false, 0, 0, NULL, 0, 0, "this text"},
};

_Static_assert(sizeof option_rows / sizeof option_rows[0] <= OPTION_CAPACITY, "raise OPTION_CAPACITY");
const size_t option_count = sizeof option_rows / sizeof option_rows[0];

const command *command_find(const char *name) {
  for (size_t i = 0; i < command_count; ++i) {
    if (strcmp(commands[i].name, name) == 0) return &commands[i];
  }
  return NULL;
}
