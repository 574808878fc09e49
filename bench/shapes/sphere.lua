return sphere(1)
