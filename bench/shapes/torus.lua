return torus(0.7, 0.3)
