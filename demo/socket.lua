-- A machine part: a flange with a boss, a hexagonal socket in the boss, four screw holes and four ribs. Millimetres.
local flat = 22 -- of the socket, across its flats

local slab = box(flat, 100, 30)
local hexagon = slab & slab:rotate(60, "z") & slab:rotate(120, "z")

local plate = rounded_box{x = 80, y = 80, z = 12, r = 4}
local boss = cylinder{r = 21, h = 40}:move(0, 0, 20)
local rib = box(3, 66, 30):rotate(45, "z"):move(0, 0, 10) & cone{r = 46, h = 46, r2 = 8}:move(0, 0, 20)
local body = smooth_union(plate, boss, 6) | rib:repeat_polar(2, "z")

local hole = cylinder{r = 4.5, h = 40}:move(30, 0, 0):repeat_polar(4, "z")
return body - hexagon:move(0, 0, 36) - cylinder{r = 7, h = 200} - hole
