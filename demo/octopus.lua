-- Something alive: a head, eyes, and eight arms, each a row of balls that flow together.
local balls = {}
local function ball(x, y, z, r) balls[#balls + 1] = sphere(r):move(x, y, z) end

local arms, steps = 8, 13
for k = 0, arms - 1 do
  local lift = 0.20 + 0.10 * (k % 2)
  for i = 0, steps do
    local t = i / steps
    local turn = 2 * math.pi * (k + 0.5) / arms + 1.1 * t * t * (k % 2 == 0 and 1 or -1)
    local reach = 0.42 + 1.25 * t
    ball(reach * math.cos(turn), reach * math.sin(turn), 0.16 + lift * math.sin(5.2 * t) * t, 0.19 - 0.125 * t)
  end
end

local arms_and_skirt = smooth_union(balls, 0.10)
local head = ellipsoid(0.60, 0.55, 0.72):rotate(14, "y"):move(-0.12, 0, 0.86)
local eyes = sphere(0.15):move(0.40, 0.27, 0.72) | sphere(0.15):move(0.40, -0.27, 0.72)
local body = smooth_union(ellipsoid(0.56, 0.56, 0.30):move(0, 0, 0.26), head, eyes, 0.14)
return smooth_union(body, arms_and_skirt, 0.16)
