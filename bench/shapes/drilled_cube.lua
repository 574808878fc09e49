-- A cube drilled through along its three axes, by drills of different widths that meet in the middle.
return box(2) - cylinder(0.4) - cylinder(0.5):rotate(90, "x") - cylinder(0.6):rotate(90, "y")
