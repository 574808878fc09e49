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

# The worst configurations, for docs/proof.md; the test that proves the bounds writes them.
"${program%/*}/tests/proof" --draw "$meshes" > "$meshes/worst.txt"
"$program" view "$meshes/smallest-angle.vtu" --color dihedral --view=-135,-10 --size 400x240 -o docs/images/proof-smallest.png
"$program" view "$meshes/largest-angle.vtu" --color dihedral --view=-135,20 --size 400x240 -o docs/images/proof-largest.png
