return torus(0.85, 0.15)
