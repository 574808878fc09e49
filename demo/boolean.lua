-- Sets of points: a cube rounded by a sphere, drilled along its three axes, all edges a little rounded.
local drill = cylinder(0.5)
local drills = smooth_union(drill, drill:rotate(90, "x"), drill:rotate(90, "y"), 0.22)
local body = smooth_intersection(box(1.6), sphere(1.08), 0.22)
return smooth_difference(body, drills, 0.22)
