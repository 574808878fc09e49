-- Six clouds of charge that flow together, with necks between them. The logarithm keeps the slope near one.
local centres = {{0, 0, 0}, {0.75, 0.1, 0}, {-0.6, 0.45, 0.1}, {-0.35, -0.65, 0.15}, {0.2, 0.35, 0.65}, {0.3, -0.4, -0.6}}
local charge = 0
for _, c in ipairs(centres) do
  charge = charge + exp(-9 * ((x - c[1]) ^ 2 + (y - c[2]) ^ 2 + (z - c[3]) ^ 2))
end
return solid(-log(charge) / 6 - 0.2)
