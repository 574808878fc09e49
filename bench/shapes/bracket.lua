-- An angle bracket: two plates at a right angle with a rib between them, bolt holes through both.
local foot = box(60, 40, 8):move(0, 0, 4)
local wall = box(8, 40, 50):move(-26, 0, 25)
local rib = box(50, 6, 48):move(-3, 0, 28) & halfspace({1, 0, 1}, 3.5)
local hole = cylinder{r = 4, h = 30}
local holes = hole:move(14, 12, 4) | hole:move(14, -12, 4)
local bore = cylinder{r = 7, h = 30}:rotate(90, "y"):move(-26, 0, 36)
return (foot | wall | rib) - holes - bore
