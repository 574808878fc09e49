return ellipsoid(3, 1, 1)
