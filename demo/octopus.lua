-- Something alive: a head, eyes, and eight arms, each a row of balls that flow together.
local balls = {}
local function ball(x, y, z, r) balls[#balls + 1] = sphere(r):move(x, y, z) end

local arms, steps = 8, 26
for k = 0, arms - 1 do
  local sway = k % 2 == 0 and 1 or 0.6
  for i = 0, steps do
    local t = math.sqrt(i / steps) -- closer to one another where they are small
    local turn = 2 * math.pi * (k + 0.5) / arms + 0.75 * sway * t * t * math.sin(3.4 * t)
    local reach = 0.40 + 1.30 * t
    ball(reach * math.cos(turn), reach * math.sin(turn), 0.18 + 0.26 * sway * math.sin(6.0 * t + k) * t, 0.20 - 0.11 * t)
  end
end

local head = ellipsoid(0.56, 0.52, 0.70):rotate(-16, "y"):move(-0.16, 0, 0.92)
local eyes = sphere(0.14):move(0.33, 0.30, 0.74) | sphere(0.14):move(0.33, -0.30, 0.74)
local body = smooth_union(ellipsoid(0.50, 0.50, 0.30):move(0, 0, 0.28), head, eyes, 0.12)
return smooth_union(body, smooth_union(balls, 0.05), 0.16)
