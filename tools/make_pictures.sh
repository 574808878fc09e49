#!/bin/sh
# Draws docs/images anew: tools/make_pictures.sh [PROGRAM]
set -eu
cd "$(dirname "$0")/.."
program=${1:-build/laves}
meshes=$(mktemp -d)
trap 'rm -rf "$meshes"' EXIT

# draw PICTURE INPUT TETS OPTIONS...: meshes a bundled input and draws it.
draw() {
  picture=$1 input=$2 tets=$3
  shift 3
  mesh=$meshes/${input%.*}-$tets.vtu
  [ -e "$mesh" ] || "$program" mesh "demo/$input" --tets "$tets" -q -o "$mesh"
  "$program" view "$mesh" "$@" -o "docs/images/$picture.png"
}

draw octopus octopus.lua 30k --view -55,25 --size 640x440
draw octopus-cut octopus.lua 30k --view -55,25 --size 640x440 --cut y
draw knot knot.ply 12k --view 20,50 --size 560x420
draw socket-cut socket.lua 60k --view -50,35 --size 640x440 --cut y
draw gyroid gyroid.lua 40k --view 30,25 --size 560x420
draw angles octopus.lua 30k --view -80,15 --size 760x480 --cut y --color dihedral

# sized PICTURE 'VIEW OPTIONS' INPUT OPTIONS...: meshes with sizes that vary and draws them.
sized() {
  picture=$1 how=$2 input=$3
  shift 3
  "$program" mesh "$input" "$@" -q --certificate none -o "$meshes/$picture.vtu"
  "$program" view "$meshes/$picture.vtu" $how -o "docs/images/$picture.png"
}

# For docs/sizing.md: a picture for each source of sizes.
block='rounded_box{x=2, y=1.4, z=1.4, r=0.2}'
inside='--cut y --view -80,12 --size 400x280 --color size'
bracket='--view -45,35 --size 400x320 --color size'
sized size-field "$inside" "$block" --size 0.3 --size-field 'min(0.3, 0.05 + 0.3*abs(field(sphere(0.5))))'
cat > "$meshes/bands.nrrd" <<'end'
NRRD0004
type: float
dimension: 3
sizes: 5 2 2
space dimension: 3
space directions: (0.5,0,0) (0,2,0) (0,0,2)
space origin: (-1,-1,-1)
encoding: ascii

0.2 0.04 0.2 0.08 0.2
0.2 0.04 0.2 0.08 0.2
0.2 0.04 0.2 0.08 0.2
0.2 0.04 0.2 0.08 0.2
end
sized size-background "$inside" "$block" --size 0.3 --size-field "$meshes/bands.nrrd"
printf '0.4 0 0.2\n1.8 0 0.2\n' > "$meshes/weld.txt"
sized size-refine "$bracket" demo/bracket.obj --size 0.1 --refine tag:step=0.02,0.02 --refine point:0.05,0.6,1.5=0.01 \
  --refine "curve:$meshes/weld.txt=0.015"
sized size-curvature '--view -50,35 --size 400x300 --color size' demo/socket.lua --size 10 --curvature-elements 12
sized size-distance '--view -60,20 --size 400x280 --color size' 'smooth_union(sphere(1), sphere(0.3):move(1.2, 0, 0), 0.2)' \
  --size 0.3 --max-distance 0.018
sized size-thickness "$bracket" demo/bracket.obj --size 0.2 --thickness-elements 2
sized size-features "$bracket" demo/bracket.obj --size 0.1 --feature-elements 2
sized size-growth '--cut y --view -80,12 --size 400x300 --color size' \
  'metaballs{{0, 0, 0, 1}, {1, 0, 0, 0.6}, {-0.5, 0, 0.9, 0.7}}' --size 0.05 --interior-growth 0.3
for grading in 0.1 0.5; do
  sized "grading-$grading" '--cut y --view -80,12 --size 320x220 --color size' "$block" --size 0.3 --refine point:0,-0.1,0=0.02 \
    --grading "$grading"
done

# For docs/graded.md.
sized ramp '--cut y --view -80,12 --size 480x320 --color dihedral' "$block" --size 0.4 --size-field '0.02 + 0.2*abs(x)'

# For docs/features.md: parts of bench/shapes, with their creases in bold.
part() {
  picture=$1 script=$2 tets=$3
  shift 3
  [ -e "$meshes/$script.vtu" ] || "$program" mesh "bench/shapes/$script.lua" --tets "$tets" -q --certificate none -o "$meshes/$script.vtu"
  "$program" view "$meshes/$script.vtu" --creases 2.6 --size 480x340 "$@" -o "docs/images/$picture.png"
}
part features-part gear 30k --view -60,40
part features-part-cut gear 30k --view -60,40 --cut y
part features-wedge wedge 20k --view 35,25
part features-cylinders crossed_cylinders 20k --view -40,25
part features-drilled drilled_cube 25k --view -50,30
sized features-close '--view -45,35 --size 480x340 --creases 2.4' demo/bracket.obj --size 0.12 --feature-elements 2

# For docs/dirty.md: three balls within one another, the middle one facing inwards; and a box without its lid.
balls() {
  awk 'BEGIN { n = 0; for (k = 0; k < 3; k++) { r = 1 - 0.32 * k; pi = 3.14159265; print "o ball" k
    for (i = 0; i <= 16; i++) for (j = 0; j < 32; j++) print "v", r*sin(pi*i/16)*cos(pi*j/16), r*sin(pi*i/16)*sin(pi*j/16), -r*cos(pi*i/16)
    for (i = 0; i < 16; i++) for (j = 0; j < 32; j++) { a = n+32*i+j+1; b = n+32*i+(j+1)%32+1; c = b+32; d = a+32
      if (k == 1) print "f", d, c, b, a; else print "f", a, b, c, d }
    n += 17*32 } }' > "$meshes/balls.obj"
}
balls
for how in direction union; do
  sized "dirty-$how" '--cut y --view -75,15 --size 320x300 --color class' "$meshes/balls.obj" --size 0.08 \
    $([ $how = direction ] || echo --$how)
done
printf 'OFF\n8 5 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n4 3 2 1 0\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n' > "$meshes/box.off"
for level in 0.3 0.5 0.7; do
  sized "dirty-$level" '--cut y --view -85,10 --size 320x300 --color class' "$meshes/box.off" --size 0.05 --winding $level
done

# The worst configurations, for docs/proof.md; the test that proves the bounds writes them.
"${program%/*}/tests/proof" --draw "$meshes" > "$meshes/worst.txt"
"$program" view "$meshes/smallest-angle.vtu" --color dihedral --view=-135,-10 --size 400x240 -o docs/images/proof-smallest.png
"$program" view "$meshes/largest-angle.vtu" --color dihedral --view=-135,20 --size 400x240 -o docs/images/proof-largest.png

# For docs/first-mesh.md, and the gallery from its own page.
"$program" mesh demo/bracket.obj --size 0.06 -q --certificate none -o "$meshes/bracket.vtu"
"$program" view "$meshes/bracket.vtu" --size 420x330 --view=-45,35 -o docs/images/first-whole.png
"$program" view "$meshes/bracket.vtu" --size 420x330 --view=-45,35 --cut y -o docs/images/first-cut.png
"$program" view "$meshes/bracket.vtu" --size 420x300 --plot dihedral -o docs/images/first-angles.svg
tools/make_gallery.py "$program"
