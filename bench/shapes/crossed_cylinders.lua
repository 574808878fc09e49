-- Two cylinders of different width that cross at right angles: their creases fade from 90 degrees to nearly none.
return cylinder{r = 0.6, h = 3} | cylinder{r = 0.55, h = 3}:rotate(90, "x")
