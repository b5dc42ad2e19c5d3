// SPDX-License-Identifier: MIT
//
// tangent.js: angles in the frame of a face: the first edge is where they start, counter-clockwise seen from outside.

export const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const scaled = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
export const plus = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const unit = (a) => scaled(a, 1 / (Math.hypot(...a) || 1));

/** {x, y, normal} of a face. */
export function frame(surface, face) {
  const [a, b, c] = surface.corners(face);
  const x = unit(subtract(b, a)), normal = unit(cross(subtract(b, a), subtract(c, a)));
  return { x, y: cross(normal, x), normal };
}

export function pointIn(surface, face, barycentric) {
  const corners = surface.corners(face);
  return [0, 1, 2].map((c) => barycentric[0] * corners[0][c] + barycentric[1] * corners[1][c] + barycentric[2] * corners[2][c]);
}

/** The direction at an angle in degrees, from where the angle of a control starts. */
export function direction(surface, face, degrees, relativeTo) {
  const { x, y } = frame(surface, face);
  const angle = (degrees * Math.PI) / 180 + (relativeTo ? Math.atan2(dot(relativeTo, y), dot(relativeTo, x)) : 0);
  return plus(scaled(x, Math.cos(angle)), scaled(y, Math.sin(angle)));
}

/** The angle in degrees of a direction of space in the frame of a face. */
export function angleIn(surface, face, d) {
  const { x, y } = frame(surface, face);
  return (Math.atan2(dot(d, y), dot(d, x)) * 180) / Math.PI;
}

/** Barycentric coordinates of a point in the plane of a face. */
export function barycentricIn(surface, face, point) {
  const [a, b, c] = surface.corners(face);
  const normal = cross(subtract(b, a), subtract(c, a)), whole = dot(normal, normal);
  const part = (p, q) => dot(cross(subtract(p, point), subtract(q, point)), normal) / whole;
  return [part(b, c), part(c, a), part(a, b)];
}

/** Where a ray meets the plane of a face through a point, as an angle in degrees around that point. */
export function angleOfRay(surface, face, center, origin, ray) {
  const { x, y, normal } = frame(surface, face);
  const fall = dot(ray, normal);
  if (Math.abs(fall) < 1e-6) return null;
  const s = dot(subtract(center, origin), normal) / fall;
  const offset = subtract(plus(origin, scaled(ray, s)), center);
  return (Math.atan2(dot(offset, y), dot(offset, x)) * 180) / Math.PI;
}

/** A zero on an edge belongs to neither face: a little inside. */
export function inside(barycentric) {
  return barycentric.map((b) => 0.08 / 1.24 + Math.min(Math.max(b, 0), 1) / 1.24);
}
