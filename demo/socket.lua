-- A machine part: a flange with a boss, a hexagonal socket in the boss, four screw holes and two ribs. Millimetres.
-- Its edges are rounded, as those of a casting are.
local flat = 25 -- of the socket, across its flats
local round = 5

local slab = box(flat, 100, 40)
local hexagon = smooth_intersection(slab, slab:rotate(60, "z"), slab:rotate(120, "z"), round)

local plate = rounded_box{x = 80, y = 80, z = 12, r = 4}
local boss = smooth_intersection(cylinder(22), halfspace("z", 40), round)
boss = smooth_intersection(boss, halfspace({0, 0, -1}, 0), round)
local rib = rounded_box{x = 11, y = 68, z = 40, r = 4}:rotate(45, "z"):move(0, 0, 10)
rib = smooth_intersection(rib, cone{r = 46, h = 60, r2 = 0}:move(0, 0, 24), round)
local ribs = rib:repeat_polar(2, "z")
local body = smooth_union(plate, boss, ribs, 5)

local screw = cylinder(5):move(29, 0, 0):repeat_polar(4, "z")
local holes = hexagon:move(0, 0, 40) | cylinder(8)
return smooth_difference(body, holes | screw, round)
