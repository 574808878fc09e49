-- A hand, in place of the paper's: a palm, four fingers and a thumb of rounded bones that flow together.
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

-- Knuckles along x, fingers along z, bent a little towards y.
local function finger(x, z, lean, lengths, r)
  local parts, at, bend = {}, {x, 0, z}, 8
  for i, length in ipairs(lengths) do
    local turn = bend * pi / 180
    local to = {at[1] + lean * length, at[2] - math.sin(turn) * length, at[3] + math.cos(turn) * length}
    parts[i] = bone(at, to, r * (1.06 - 0.1 * i))
    at, bend = to, bend + 13
  end
  return smooth_union(parts, 0.1)
end

local fingers = smooth_union(
  finger(-0.62, 0.78, -0.16, {0.52, 0.36, 0.26}, 0.165),
  finger(-0.20, 0.92, -0.05, {0.62, 0.42, 0.28}, 0.18),
  finger(0.22, 0.88, 0.06, {0.58, 0.40, 0.27}, 0.175),
  finger(0.60, 0.70, 0.18, {0.44, 0.30, 0.23}, 0.15), 0.04)
local thumb = smooth_union(bone({-0.45, -0.1, -0.35}, {-0.98, -0.28, 0.12}, 0.26), bone({-0.98, -0.28, 0.12}, {-1.2, -0.4, 0.52}, 0.19),
  bone({-1.2, -0.4, 0.52}, {-1.28, -0.52, 0.82}, 0.16), 0.12)
local palm = smooth_union(rounded_box{x = 1.6, y = 0.46, z = 1.5, r = 0.22}:move(0, 0, 0.05), ellipsoid(0.62, 0.3, 0.7):move(0, -0.05, -0.3), 0.2)
local wrist = cone{r = 0.52, r2 = 0.46, h = 1.0}:scale(1, 0.72, 1):move(0, 0, -1.1)
wrist = smooth_intersection(wrist, halfspace({0, 0, -1}, 1.5), 0.2)
return smooth_union(palm, fingers, thumb, wrist, 0.2)
