/**
 * Which way is up in a model, 0 … 2: y, unless all held nodes are at the low end of z and not at that of y, as where an
 * object stands on the plane z = 0.
 */
export function upAxisOf({about: {fixed, low, high}, rest}) {
  const lies = (axis) => fixed.length > 0 &&
    fixed.every((v) => rest[3 * v + axis] <= low[axis] + 0.2 * (high[axis] - low[axis]));
  return lies(2) && !lies(1) ? 2 : 1;
}
