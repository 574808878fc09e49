-- A horse, in place of the paper's: barrel, neck, head and four legs of rounded bones that flow together. It looks along x.
local function bone(from, to, r)
  local d = {to[1] - from[1], to[2] - from[2], to[3] - from[3]}
  local h = math.sqrt(d[1] ^ 2 + d[2] ^ 2 + d[3] ^ 2)
  local stick = capsule{r = r, h = h}
  local across = math.sqrt(d[1] ^ 2 + d[2] ^ 2)
  if across > 0 then
    stick = stick:rotate{angle = math.acos(d[3] / h) * 180 / pi, axis = {-d[2] / across, d[1] / across, 0}}
  end
  return stick:move((from[1] + to[1]) / 2, (from[2] + to[2]) / 2, (from[3] + to[3]) / 2)
end

local function chain(points, radii, width)
  local parts = {}
  for i = 1, #points - 1 do parts[i] = bone(points[i], points[i + 1], radii[i]) end
  return smooth_union(parts, width)
end

local function leg(side, front)
  local x = front and 0.78 or -0.82
  local knee = front and {x + 0.06, side * 0.24, -0.86} or {x - 0.16, side * 0.24, -0.82}
  local foot = front and {x, side * 0.24, -1.56} or {x - 0.04, side * 0.24, -1.56}
  return chain({{x, side * 0.2, -0.1}, knee, foot, {foot[1] + 0.13, foot[2], -1.62}}, {0.2, 0.105, 0.12}, 0.1)
end

local body = smooth_union(ellipsoid(1.05, 0.46, 0.5), ellipsoid(0.5, 0.46, 0.56):move(-0.68, 0, 0.06), ellipsoid(0.42, 0.4, 0.5):move(0.7, 0, 0.02), 0.2)
local legs = smooth_union(leg(1, true), leg(-1, true), leg(1, false), leg(-1, false), 0.05)
local neck = chain({{0.85, 0, 0.2}, {1.28, 0, 0.85}, {1.45, 0, 1.18}}, {0.3, 0.23}, 0.25)
local head = chain({{1.42, 0, 1.22}, {1.72, 0, 0.95}, {1.98, 0, 0.68}}, {0.21, 0.15}, 0.15)
local ears = bone({1.36, 0.12, 1.36}, {1.34, 0.17, 1.6}, 0.06) | bone({1.36, -0.12, 1.36}, {1.34, -0.17, 1.6}, 0.06)
local tail = chain({{-1.1, 0, 0.3}, {-1.42, 0, 0.0}, {-1.5, 0, -0.75}}, {0.12, 0.14}, 0.12)
return smooth_union(body, legs, neck, head, ears, tail, 0.16)
