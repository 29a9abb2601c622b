// Surfaces from what shapes are made of (shapes.py): one tube with outward normals, curvatures and the critical perturbation.
// Lengths are in radii; H is 1/2 on the unit cylinder.

/** A surface of a point: {at, normal, H, K, u, index, length}; at, normal: x, y, z of each vertex; u: null where unknown. */
function surface(point) {
  const shape = point.shape, found = { outline, section, modes, mesh, grid }[shape.kind](shape, point.wave);
  found.length = shape.length;
  const largest = found.u && found.u.reduce((most, value) => Math.max(most, Math.abs(value)), 0);
  if (largest) for (let i = 0; i < found.u.length; i++) found.u[i] /= largest;
  return found;
}

/** Empty lists for a grid of rows along and columns around, both ends among them, and its triangles. */
function empty(rows, columns, wave) {
  const count = rows * columns, index = new Uint32Array(6 * (rows - 1) * (columns - 1));
  for (let i = 0, k = 0; i < rows - 1; i++) for (let j = 0; j < columns - 1; j++) {
    const a = i * columns + j;
    index.set([a, a + 1, a + columns, a + 1, a + columns + 1, a + columns], k);
    k += 6;
  }
  const list = () => new Float32Array(count);
  return { at: new Float32Array(3 * count), normal: new Float32Array(3 * count), H: list(), K: list(), u: wave ? list() : null, index };
}

/** An axisymmetric shape: its profile turned about the axis. */
function outline(shape, wave) {
  const [x, r, psi, H] = ["x", "r", "psi", "H"].map((name) => floats(shape[name])), columns = 65, rows = x.length;
  const found = empty(rows, columns, wave), period = (rows - 1) / shape.periods;
  const re = wave && floats(wave.re), im = wave && floats(wave.im);
  for (let i = 0, k = 0; i < rows; i++) {
    const cell = Math.floor(i / period), along = wave && i - cell * period, turn = wave ? wave.theta * cell : 0;
    const size = wave ? re[along] * Math.cos(turn) - im[along] * Math.sin(turn) : 0, around = Math.cos(psi[i]) / r[i];
    for (let j = 0; j < columns; j++, k++) {
      const phi = 2 * Math.PI * j / (columns - 1), c = Math.cos(phi), s = Math.sin(phi);
      found.at.set([x[i], r[i] * c, r[i] * s], 3 * k);
      found.normal.set([-Math.sin(psi[i]), Math.cos(psi[i]) * c, Math.cos(psi[i]) * s], 3 * k);
      found.H[k] = H[i];
      found.K[k] = (2 * H[i] - around) * around;
      if (wave) found.u[k] = size * Math.cos(wave.n * phi);
    }
  }
  return found;
}

/** A cylinder over a closed curve; psi is the angle of its outward normal. */
function section(shape, wave) {
  const [y, z, psi, H] = ["y", "z", "psi", "H"].map((name) => floats(shape[name])), columns = y.length;
  const rows = wave && wave.k ? Math.min(161, Math.max(33, Math.ceil(8 * shape.length))) : 2, found = empty(rows, columns, wave);
  const size = wave && floats(wave.re);
  for (let i = 0, k = 0; i < rows; i++) for (let j = 0; j < columns; j++, k++) {
    const x = shape.length * i / (rows - 1);
    found.at.set([x, y[j], z[j]], 3 * k);
    found.normal.set([0, Math.cos(psi[j]), Math.sin(psi[j])], 3 * k);
    found.H[k] = H[j];
    if (wave) found.u[k] = size[j] * Math.cos(wave.k * x);
  }
  return found;
}

/** Points P = y + iz of a sum of modes (tube/modes.py) on a grid, row by row: e^{i kappa x} (d(x) + sigma(x, phi) e^{i phi}). */
function plane(numbers, values, length, kappa, rows, columns) {
  const found = new Float64Array(2 * rows * columns), most = numbers.reduce((b, n, i) => i % 5 === 3 ? Math.max(b, n) : b, 0);
  for (let i = 0; i < rows; i++) {
    const x = length * i / (rows - 1), cosines = new Float64Array(most + 1), sines = new Float64Array(most + 1), d = [0, 0];
    for (let m = 0; m < values.length; m++) {
      const [part, p, odd, b, turned] = numbers.slice(5 * m, 5 * m + 5), angle = 2 * Math.PI * p * x / length;
      const value = values[m] * (odd ? Math.sin(angle) : Math.cos(angle));
      if (part) d[part - 1] += value; else (turned ? sines : cosines)[b] += value;
    }
    const turn = kappa * x, ct = Math.cos(turn), st = Math.sin(turn);
    for (let j = 0; j < columns; j++) {
      const phi = 2 * Math.PI * j / (columns - 1);
      let sigma = 0;
      for (let b = 0; b <= most; b++) sigma += cosines[b] * Math.cos(b * phi) + sines[b] * Math.sin(b * phi);
      const y = d[0] + sigma * Math.cos(phi), z = d[1] + sigma * Math.sin(phi), k = 2 * (i * columns + j);
      found[k] = y * ct - z * st;
      found[k + 1] = y * st + z * ct;
    }
  }
  return found;
}

/** A tube in reduced modes. */
function modes(shape, wave) {
  const numbers = data.shared[shape.modes], most = numbers.reduce((p, n, i) => i % 5 === 1 ? Math.max(p, n) : p, 0);
  const rows = 1 + Math.min(320, Math.max(96, Math.ceil(10 * shape.length), 6 * most)), columns = 65;
  const points = plane(numbers, floats(shape.values), shape.length, shape.kappa, rows, columns), found = empty(rows, columns, wave);
  for (let k = 0; k < rows * columns; k++)
    found.at.set([shape.length * Math.floor(k / columns) / (rows - 1), points[2 * k], points[2 * k + 1]], 3 * k);
  curved(found, rows, columns, shape.length);
  if (!wave) return found;
  const moved = plane(data.shared[wave.modes], floats(wave.values), shape.length, shape.kappa, rows, columns);
  for (let k = 0; k < rows * columns; k++)
    found.u[k] = moved[2 * k] * found.normal[3 * k + 1] + moved[2 * k + 1] * found.normal[3 * k + 2];
  return found;
}

/** Points of any tube, rows along and columns around, closed. */
function grid(shape) {
  const at = floats(shape.points), rows = shape.rows, columns = at.length / (3 * rows), found = empty(rows, columns, null);
  found.at.set(at);
  curved(found, rows, columns, shape.length);
  return found;
}

/** Normals and curvatures of a grid, by differences of fourth order of what is periodic both ways. */
function curved(found, rows, columns, length) {
  const R = rows - 1, C = columns - 1, at = found.at;
  const point = (i, j) => {
    const k = 3 * (((i % R) + R) % R * columns + ((j % C) + C) % C);
    return [at[k] + length * Math.floor(i / R), at[k + 1], at[k + 2]];
  };
  const sum = (weights, points) => [0, 1, 2].map((x) => weights.reduce((t, w, m) => t + w * points[m][x], 0));
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2], near = [-2, -1, 0, 1, 2];
  const first = [1, -8, 0, 8, -1].map((w) => w / 12), second = [-1, 16, -30, 16, -1].map((w) => w / 12);
  for (let i = 0; i < rows; i++) for (let j = 0; j < columns; j++) {
    const k = i * columns + j, along = near.map((m) => point(i + m, j)), about = near.map((m) => point(i, j + m));
    const a = sum(first, along), b = sum(first, about), aa = sum(second, along), bb = sum(second, about);
    const ab = sum(first, near.map((m) => m ? sum(first, near.map((n) => point(i + m, j + n))) : [0, 0, 0]));
    let n = [b[1] * a[2] - b[2] * a[1], b[2] * a[0] - b[0] * a[2], b[0] * a[1] - b[1] * a[0]];
    const size = Math.hypot(...n);
    n = n.map((part) => part / size);
    const E = dot(a, a), F = dot(a, b), G = dot(b, b), L = dot(aa, n), M = dot(ab, n), N = dot(bb, n), det = E * G - F * F;
    found.normal.set(n, 3 * k);
    found.H[k] = -(L * G - 2 * M * F + N * E) / (2 * det);
    found.K[k] = (L * N - M * M) / det;
  }
}

/** A triangulated tube; corners are vertices and the periods by which they are shifted. */
function mesh(shape, wave) {
  const corners = data.shared[shape.corners], vertices = floats(shape.vertices), size = wave && floats(wave.values);
  const [H, K] = [floats(shape.H), floats(shape.K)], known = new Map(), index = [], taken = [];
  for (let c = 0; c < corners.length; c += 2) {
    const key = corners[c] + ":" + corners[c + 1];
    if (!known.has(key)) { known.set(key, taken.length); taken.push([corners[c], corners[c + 1]]); }
    index.push(known.get(key));
  }
  const normals = new Float32Array(vertices.length), place = ([v, w]) => [vertices[3 * v] + w * shape.length, vertices[3 * v + 1], vertices[3 * v + 2]];
  for (let t = 0; t < index.length; t += 3) {
    const [p, q, r] = [0, 1, 2].map((i) => place(taken[index[t + i]])), a = q.map((x, i) => x - p[i]), b = r.map((x, i) => x - p[i]);
    const n = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    for (let i = 0; i < 3; i++) for (let x = 0; x < 3; x++) normals[3 * taken[index[t + i]][0] + x] += n[x];
  }
  const pick = (values) => Float32Array.from(taken, ([v]) => values[v]);
  const normal = Float32Array.from(taken.flatMap(([v]) => {
    const n = normals.slice(3 * v, 3 * v + 3), length = Math.hypot(...n);
    return [...n].map((part) => part / length);
  }));
  return { at: Float32Array.from(taken.flatMap(place)), normal, H: pick(H), K: pick(K), u: size && pick(size), index: Uint32Array.from(index) };
}
