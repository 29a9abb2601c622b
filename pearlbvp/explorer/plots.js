// Curves, bars and axes as SVG.
const SVG = "http://www.w3.org/2000/svg";

/** An element in another, with attributes and perhaps a text. */
function draw(parent, name, attributes, text) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== undefined) element.textContent = text;
  return parent.appendChild(element);
}

/** Clear a picture and draw axes: {x, y}, from numbers to pixels. `equal`: one scale both ways. */
function axes(svg, xs, ys, xlabel, ylabel, { equal = false, left = 66 } = {}) {
  svg.replaceChildren();
  const width = svg.clientWidth || 600, height = svg.clientHeight || 300, box = { left, right: width - 12, top: 10, bottom: height - 40 };
  svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
  const wide = (ends) => { const size = ends[1] - ends[0], rounding = 1e-9 * Math.abs(ends[0]), gap = size > rounding ? size * 0.05 : Math.abs(ends[0]) * 0.05 || 0.05; return [ends[0] - gap, ends[1] + gap]; };
  let [x0, x1] = wide(range(xs)), [y0, y1] = wide(range(ys));
  if (equal) {
    const scale = Math.max((x1 - x0) / (box.right - box.left), (y1 - y0) / (box.bottom - box.top)), mx = (x0 + x1) / 2, my = (y0 + y1) / 2;
    const rx = scale * (box.right - box.left) / 2, ry = scale * (box.bottom - box.top) / 2;
    [x0, x1, y0, y1] = [mx - rx, mx + rx, my - ry, my + ry];
  }
  const x = (value) => box.left + (value - x0) / (x1 - x0) * (box.right - box.left), y = (value) => box.bottom - (value - y0) / (y1 - y0) * (box.bottom - box.top);
  const across = labelled(x0, x1, Math.max(2, width / 110)), up = labelled(y0, y1, Math.max(2, height / 60));
  const needed = 30 + 6.4 * Math.max(0, ...up.map(([, text]) => text.length));
  if (ylabel && needed > left + 1) return axes(svg, xs, ys, xlabel, ylabel, { equal, left: needed });
  for (const [tick, text] of across) {
    draw(svg, "line", { class: "grid", x1: x(tick), x2: x(tick), y1: box.top, y2: box.bottom });
    draw(svg, "text", { x: x(tick), y: box.bottom + 15, "text-anchor": "middle" }, text);
  }
  for (const [tick, text] of ylabel ? up : []) {
    draw(svg, "line", { class: "grid", x1: box.left, x2: box.right, y1: y(tick), y2: y(tick) });
    draw(svg, "text", { x: box.left - 6, y: y(tick) + 4, "text-anchor": "end" }, text);
  }
  draw(svg, "text", { class: "label", x: (box.left + box.right) / 2, y: height - 7, "text-anchor": "middle" }, xlabel);
  draw(svg, "text", { class: "label", transform: `translate(13 ${(box.top + box.bottom) / 2}) rotate(-90)`, "text-anchor": "middle" }, ylabel);
  return { x, y };
}

/** The path through points of a plane. */
const path = (points) => points.map(([x, y], i) => `${i ? "L" : "M"}${x.toFixed(2)} ${y.toFixed(2)}`).join("");

/** Slopes of a curve that is monotone between neighbours (F. N. Fritsch, J. Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300). */
function slopes(t, values) {
  const by = t.slice(1).map((end, i) => (values[i + 1] - values[i]) / (end - t[i]));
  return values.map((_, i) => {
    if (i === 0 || i === values.length - 1) return by[Math.min(i, by.length - 1)];
    const [a, b, h, g] = [by[i - 1], by[i], t[i] - t[i - 1], t[i + 1] - t[i]];
    return a * b <= 0 ? 0 : 3 * (h + g) / ((2 * g + h) / a + (g + 2 * h) / b);
  });
}

/** Points of a smooth curve between the points of a polygon: for each of its sides a list. */
function smooth(points) {
  const kept = points.filter((p, i) => i === 0 || Math.hypot(p[0] - points[i - 1][0], p[1] - points[i - 1][1]) > 1e-9);
  if (kept.length < 3) return points.slice(1).map((end, i) => [points[i], end]);
  const t = kept.reduce((found, p, i) => [...found, i ? found[i - 1] + Math.hypot(p[0] - kept[i - 1][0], p[1] - kept[i - 1][1]) : 0], []);
  const by = [0, 1].map((axis) => slopes(t, kept.map((p) => p[axis]))), sides = new Map();
  for (let i = 0; i + 1 < kept.length; i++) {
    const h = t[i + 1] - t[i];
    sides.set(kept[i], Array.from({ length: 9 }, (_, step) => [0, 1].map((axis) => {
      const s = step / 8, [p, q, m, n] = [kept[i][axis], kept[i + 1][axis], by[axis][i], by[axis][i + 1]];
      return (1 + 2 * s) * (1 - s) ** 2 * p + s * (1 - s) ** 2 * h * m + s * s * (3 - 2 * s) * q + s * s * (s - 1) * h * n;
    })));
  }
  let last = points[0];
  return points.slice(1).map((end) => {
    if (!kept.includes(end)) return [last, end];
    const side = sides.get(last) || [last, end];
    last = end;
    return side;
  });
}

/** Points of a branch from one of its points to the next: a cubic with the slopes of the branch (`continuation/curve.py`). */
function hermite(branch, k, x, y) {
  const number = (name, s) => {
    const [p, q] = [branch.columns[name][k], branch.columns[name][k + 1]], slope = (end) => branch[end][name]?.[k] ?? q - p;
    return (1 + 2 * s) * (1 - s) ** 2 * p + s * (1 - s) ** 2 * slope("leaving") + s * s * (3 - 2 * s) * q + s * s * (s - 1) * slope("arriving");
  };
  return Array.from({ length: 17 }, (_, step) => [number(x, step / 16), number(y, step / 16)]);
}

/** Growth rates as marks, a line for each symmetry block. */
function drawRates(svg, blocks, unit) {
  const fewest = Math.min(...blocks.map((block) => block.rates[0])), low = 1.5 * fewest;
  blocks = blocks.map((block) => ({ ...block, rates: block.rates.filter((rate, i) => i === 0 || rate >= low) }));
  const plot = axes(svg, [0, ...blocks.flatMap((block) => block.rates)], [0, blocks.length + 0.2], unit, "", { left: 130 });
  draw(svg, "line", { x1: plot.x(0), x2: plot.x(0), y1: 10, y2: svg.clientHeight - 40, stroke: "currentColor", opacity: 0.5 });
  blocks.forEach((block, i) => {
    const y = plot.y(blocks.length - i - 0.4);
    for (const rate of block.rates) {
      const mark = draw(svg, "line", { x1: plot.x(rate), x2: plot.x(rate), y1: y - 5, y2: y + 5, stroke: rate > 0 ? "#d94801" : "#2171b5", "stroke-width": 2.5 });
      draw(mark, "title", {}, `${block.block}: ${written(rate)}`);
    }
    draw(svg, "text", { x: 4, y: y + 4 }, block.block);
  });
}
