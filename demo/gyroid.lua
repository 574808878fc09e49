-- A gyroid sheet within a ball: no straight line anywhere, and far too many holes to draw by hand.
return gyroid{period = 0.9, thickness = 0.2} & sphere(1)
