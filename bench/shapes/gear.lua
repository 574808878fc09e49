-- A gear-like part: twelve straight teeth with slanting flanks round a disc, a bore with a keyway.
local height = 12
local tooth = box(16, 12, height):move(32, 0, 0) & halfspace({0.3, 1, 0}, 14) & halfspace({0.3, -1, 0}, 14)
local bore = cylinder(9) | box(8, 6, 2 * height):move(8, 0, 0)
return (cylinder{r = 28, h = height} | tooth:repeat_polar(12, "z")) - bore
