-- A machine part with sharp edges, in place of the paper's socket: a flange with a boss, a hexagonal socket and four holes.
local flat = 25 -- of the socket, across its flats
local slab = box(flat, 100, 50)
local hexagon = slab & slab:rotate(60, "z") & slab:rotate(120, "z")
local plate = box(80, 80, 16)
local boss = cylinder{r = 24, h = 42}:move(0, 0, 21)
local screws = cylinder{r = 6, h = 40}:move(28, 28, 0):repeat_polar(4, "z")
return (plate | boss) - hexagon:move(0, 0, 37) - cylinder{r = 8, h = 60} - screws
