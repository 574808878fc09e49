// Numbers and tables for people.

export const count = (n) => n.toLocaleString("en");

// Four significant digits, powers of ten only for very small and large ones.
export function number(x, digits = 4) {
  if (x === null || !Number.isFinite(x)) return "not known";
  const size = Math.abs(x);
  return size !== 0 && (size < 1e-4 || size >= 1e7) ? x.toExponential(digits - 1) : String(+x.toPrecision(digits));
}

export const degrees = (x, digits = 2) => (x === null || !Number.isFinite(x) ? "not known" : `${x.toFixed(digits)}°`);

// Coordinates are told to a ten thousandth of the mesh's diagonal, however far from zero they are.
let decimals = 4;

export function setDiagonal(diagonal) {
  decimals = Math.ceil(4 - Math.log10(diagonal || 1));
}

export const coordinate = (x) => (decimals <= 9 && decimals >= -6 ? String(+x.toFixed(Math.max(0, decimals))) : number(x, 5));

export const place = (p) => p.map(coordinate).join(", ");

// An element with properties and children.
export function make(name, properties = {}, ...children) {
  const element = Object.assign(document.createElement(name), properties);
  element.append(...children);
  return element;
}
