-- A pipe flange: a disc with a hub, a bore, and six bolt holes on a circle.
local disc = cylinder{r = 40, h = 10}
local hub = cylinder{r = 20, h = 30}:move(0, 0, 15)
local bolts = cylinder{r = 4, h = 30}:move(30, 0, 0):repeat_polar(6, "z")
return (disc | hub) - cylinder(12) - bolts
