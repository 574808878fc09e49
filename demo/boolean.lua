-- Sets of points: a cube rounded by a sphere, drilled along its three axes.
local drill = cylinder(0.52)
local drills = drill | drill:rotate(90, "x") | drill:rotate(90, "y")
return (box(1.6) & sphere(1.08)) - drills
