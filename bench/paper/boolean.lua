-- The paper's Boolean: a truncated cylinder less a sphere.
return cylinder{r = 1, h = 1.7} - sphere(0.75):move(0, 0, 0.85)
