-- One of the two labyrinths of a gyroid within a ball, its rims rounded.
return smooth_intersection(gyroid{period = 0.9, level = -0.15}, sphere(1), 0.2)
