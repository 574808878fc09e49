-- A block with three fins whose edges are 30, 45 and 60 degrees wide.
local function fin(width, at)
  local half, tip = width / 2 * math.pi / 180, 2.2
  local function flank(side) return halfspace({side * math.cos(half), 0, math.sin(half)}, tip * math.sin(half)) end
  return (box(3, 2, 3):move(0, 0, 1.5) & flank(1) & flank(-1)):move(at, 0, 0)
end
return box(7, 2, 1) | fin(30, -2.4) | fin(45, -0.5) | fin(60, 1.9)
