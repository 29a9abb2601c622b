// What is chosen, and what is shown of it.
const $ = (id) => document.getElementById(id);
const state = { series: 0, point: 0, beside: null, timer: 0 };
const views = [new View($("shape"))];
const now = () => series[state.series], chosen = () => now().points[state.point];
const cache = new Map();

/** A point's surface, kept for the last few. */
function surfaceOf(point) {
  if (!cache.has(point)) {
    if (cache.size > 40) cache.delete(cache.keys().next().value);
    cache.set(point, surface(point));
  }
  return cache.get(point);
}

const colours = (i) => data.colours[i % data.colours.length];

/** Fill the choices of columns. */
function choices() {
  const names = [...new Set(series.flatMap((each) => Object.keys(each.labels)))];
  for (const [id, first] of [["x", data.x], ["y", data.y]]) {
    $(id).replaceChildren(...names.map((name) => new Option(name, name, false, name === first)));
    $(id).value = names.includes(first) ? first : names[id === "x" ? 0 : 1];
    $(id).addEventListener("change", diagram);
  }
  $("note").textContent = data.note;
  $("legend").replaceChildren(...series.map((each, i) => {
    const button = document.createElement("button");
    button.textContent = each.name === each.family ? each.name : `${each.name} (${each.family})`;
    button.title = each.end ? `ends: ${each.end}` : "";
    button.className = "tone";
    button.style.setProperty("--tone", colours(i));
    button.addEventListener("click", () => choose(i, 0));
    return button;
  }));
}

let places = [];

/** The diagram of all series, and where their points are in it. */
function diagram() {
  const svg = $("diagram"), x = $("x").value, y = $("y").value;
  const values = (each, name) => (each.columns[name] || []).map((value) => typeof value === "number" ? value : NaN);
  const label = (name) => (series.find((each) => each.labels[name]) || now()).labels[name] || name;
  const plot = axes(svg, series.flatMap((each) => values(each, x)), series.flatMap((each) => values(each, y)), label(x), label(y));
  places = series.map((each) => {
    const ys = values(each, y);
    return values(each, x).map((value, k) => [plot.x(value), plot.y(ys[k])]);
  });
  series.forEach((each, i) => {
    const group = draw(svg, "g", { class: "tone", style: `--tone:${colours(i)}` }), points = places[i], special = each.columns.special || [];
    const stable = points.map((_, k) => each.kind === "flow" || each.columns.n_unstable[k] === 0), parts = { true: "", false: "" };
    let run = [];
    for (let k = 0; k <= points.length; k++) {
      if (k < points.length && points[k].every(Number.isFinite)) { run.push(k); continue; }
      const between = (k) => hermite(each, k, x, y).map(([a, b]) => [plot.x(a), plot.y(b)]);
      (each.leaving ? run.slice(0, -1).map(between) : smooth(run.map((m) => points[m]))).forEach((side, m) => {
        const kind = stable[run[m]] && stable[run[m + 1]], same = m && kind === (stable[run[m - 1]] && stable[run[m]]);
        parts[kind] += same ? path(side).replace("M", "L") : path(side);
      });
      run = [];
    }
    if (parts.true) draw(group, "path", { class: "curve", d: parts.true });
    if (parts.false) draw(group, "path", { class: "curve unstable", d: parts.false });
    points.forEach(([px, py], k) => {
      if (!Number.isFinite(px + py)) return;
      if (/\bbp\b/.test(special[k])) draw(group, "circle", { class: "special", cx: px, cy: py, r: 4.5 });
      else if (/fold/.test(special[k])) draw(group, "path", { class: "cross", d: `M${px - 4} ${py - 4}l8 8m0 -8l-8 8` });
      else draw(group, "circle", { class: "dot", cx: px, cy: py, r: 2.2 });
    });
  });
  draw(svg, "circle", { id: "there", class: "there", r: 7, visibility: "hidden" });
  draw(draw(svg, "g", { id: "tone", class: "tone" }), "circle", { id: "here", class: "here", r: 7 });
  mark();
}

/** Mark the chosen points in the diagram. */
function mark() {
  const put = (id, place) => {
    const shown = place && place.every(Number.isFinite);
    $(id).setAttribute("visibility", shown ? "visible" : "hidden");
    if (shown) { $(id).setAttribute("cx", place[0]); $(id).setAttribute("cy", place[1]); }
  };
  $("tone").style.setProperty("--tone", colours(state.series));
  put("here", places[state.series][state.point]);
  put("there", state.beside && places[state.beside.series][state.beside.point]);
}

/** What a point is called: its series, number and place. */
function called(i, k) {
  const { columns, kind, name } = series[i], special = columns.special && columns.special[k];
  const at = kind === "flow" ? `t = ${written(columns.t[k])}` : `v = ${written(columns.v[k])}`;
  return `${name}, ${kind === "flow" ? "frame" : "point"} ${k}: ${at}${special ? `, ${special}` : ""}`;
}

/** Choose a point; numbers beyond the ends are those of the ends. */
function choose(i, k) {
  state.series = (i + series.length) % series.length;
  state.point = Math.min(Math.max(k, 0), now().points.length - 1);
  $("place").max = now().points.length - 1;
  $("place").value = state.point;
  $("which").textContent = called(state.series, state.point);
  [...$("legend").children].forEach((button, n) => button.classList.toggle("current", n === state.series));
  mark();
  shapes();
  profile();
  const unit = now().labels.mu_crit ? now().labels.mu_crit.replace("mu_crit", "growth rate") : "growth rate";
  $("rates-card").hidden = !chosen().rates.length;
  if (chosen().rates.length) drawRates($("rates"), chosen().rates, unit);
  $("row").replaceChildren(...Object.entries(now().columns).map(([name, values]) => {
    const box = document.createElement("div"), term = document.createElement("dt"), value = document.createElement("dd");
    term.textContent = now().headings[name] || name;
    value.textContent = written(values[state.point]);
    value.dataset.column = name;
    box.append(term, value);
    return box;
  }));
}

/** The chosen surfaces, to one scale of length and of colour. */
function shapes() {
  const points = [chosen()], name = $("colour").value;
  if (state.beside) points.push(series[state.beside.series].points[state.beside.point]);
  const found = points.map(surfaceOf), fields = found.map((each) => each[name]).filter(Boolean);
  const ends = name !== "plain" && fields.length ? scaleOf(name, fields) : [0, 1], tubes = Number($("tubes").value);
  const extent = Math.max(...found.map((each) => each.at.reduce((most, value, i) => i % 3 ? Math.max(most, Math.abs(value)) : most, 0)));
  const half = tubes * Math.max(...found.map((each) => each.length)) / 2;
  found.forEach((each, i) => views[i].show(each, tubes, name, ends, [half, extent]));
  const lacking = name === "plain" || found[0][name] ? "" : name === "u" ? "; no critical perturbation is known" : `; ${name} is not known`;
  $("caption").textContent = called(state.series, state.point) + lacking;
  $("caption2").textContent = state.beside ? called(state.beside.series, state.beside.point) : "";
  $("scale").hidden = name === "plain" || !fields.length;
  if (!$("scale").hidden) {
    const power = { H: 1, K: 2, u: 0 }[name], unit = data.curvature && power ? ` ${data.curvature}${power === 2 ? "²" : ""}` : "";
    $("scale-name").textContent = { H: "mean curvature H", K: "Gaussian curvature K", u: "critical perturbation u" }[name];
    $("low").textContent = short(Number((ends[0] / data.radius ** power).toPrecision(4)));
    $("high").textContent = short(Number((ends[1] / data.radius ** power).toPrecision(4))) + unit;
    const ramp = $("ramp").getContext("2d");
    for (let i = 0; i < 160; i++) {
      ramp.fillStyle = `rgb(${shade(RAMPS[name], i / 159).map((part) => 255 * part).join(" ")})`;
      ramp.fillRect(i, 0, 1, 10);
    }
  }
  const known = found.some((each) => each.u);
  $("colour").querySelector("[value=u]").disabled = !series.some((each) => each.points.some((point) => point.wave));
  $("wave-label").hidden = $("animate").parentElement.hidden = !known;
  if (known) moved();
}

const LARGEST = 0.3;

/** Move surfaces along the critical perturbation, by as much as the slider says, swinging where that is wanted. */
function moved(swing = 1) {
  for (const view of views) view.move(LARGEST * Number($("wave").value) * swing);
}

/** The profile of the chosen point: its outline along the axis, or its sections. */
function profile() {
  const { at, length, index } = surfaceOf(chosen()), svg = $("profile"), kind = chosen().shape.kind, unit = data.unit ? ` (${data.unit})` : "";
  const radius = data.radius, lines = [];
  let equal = false, labels = [`axial position x${unit}`, `distance from the axis${unit}`];
  $("profile-title").textContent = { section: "Section", mesh: "Silhouette: vertices" }[kind] || "Profile at φ = 0 and π";
  if (kind === "section" || (kind === "modes" && chosen().shape.kappa)) {
    $("profile-title").textContent = kind === "modes" ? "Section at x = 0, which turns along the tube" : "Section";
    const [y, z] = kind === "section" ? ["y", "z"].map((name) => floats(chosen().shape[name])) : [1, 2].map((x) => Array.from({ length: 65 }, (_, j) => at[3 * j + x]));
    lines.push(Array.from(y, (value, j) => [radius * value, radius * z[j]]));
    equal = true;
    labels = [`y${unit}`, `z${unit}`];
  } else if (kind === "mesh") {
    const taken = new Set(index);
    lines.push([...taken].map((k) => [radius * at[3 * k], radius * at[3 * k + 1]]));
    labels[1] = `y${unit}`;
  } else {
    const columns = kind === "grid" ? at.length / 3 / chosen().shape.rows : 65, rows = at.length / 3 / columns;
    for (const j of [0, (columns - 1) / 2]) lines.push(Array.from({ length: rows }, (_, i) => [radius * at[3 * (i * columns + Math.floor(j))], radius * at[3 * (i * columns + Math.floor(j)) + 1]]));
    labels[1] = `y${unit}`;
  }
  const plot = axes(svg, lines.flatMap((line) => line.map((p) => p[0])), lines.flatMap((line) => line.map((p) => p[1])), ...labels, { equal });
  const group = draw(svg, "g", { class: "tone", style: `--tone:${colours(state.series)}` });
  for (const line of lines) {
    const points = line.map(([x, y]) => [plot.x(x), plot.y(y)]);
    if (kind === "mesh") points.forEach(([x, y]) => draw(group, "circle", { class: "dot", cx: x, cy: y, r: 1.4 }));
    else draw(group, "path", { class: "curve", d: path(points) });
  }
}

/** Set the chosen point beside, or take away what is there. */
function beside() {
  state.beside = state.beside ? null : { series: state.series, point: state.point };
  $("beside").setAttribute("aria-pressed", String(Boolean(state.beside)));
  $("other").hidden = !state.beside;
  if (state.beside && views.length < 2) {
    views.push(new View($("shape2")));
    for (const [one, two] of [[views[0], views[1]], [views[1], views[0]]]) one.controls.addEventListener("change", () => {
      if (two.camera.position.equals(one.camera.position) && two.camera.zoom === one.camera.zoom && two.controls.target.equals(one.controls.target)) return;
      two.camera.position.copy(one.camera.position);
      two.camera.zoom = one.camera.zoom;
      two.controls.target.copy(one.controls.target);
      two.camera.updateProjectionMatrix();
      two.controls.update();
    });
  }
  mark();
  shapes();
}

/** Play all points of the series, or stop. */
function play() {
  if (state.timer) { clearInterval(state.timer); state.timer = 0; }
  else {
    if (state.point === now().points.length - 1) choose(state.series, 0);
    state.timer = setInterval(() => state.point < now().points.length - 1 ? choose(state.series, state.point + 1) : play(), 120);
  }
  $("play").textContent = state.timer ? "■ stop" : "▶ play";
  $("play").setAttribute("aria-pressed", String(Boolean(state.timer)));
}

/** Swing along the critical perturbation while that is wanted. */
function swing(time) {
  if (!$("animate").checked) { moved(); return; }
  moved(Math.sin(time / 350));
  requestAnimationFrame(swing);
}

/** The next way to colour that can be had. */
function recolour() {
  const names = [...$("colour").options].filter((option) => !option.disabled).map((option) => option.value);
  $("colour").value = names[(names.indexOf($("colour").value) + 1) % names.length];
  shapes();
}

const KEYS = {
  ArrowRight: () => choose(state.series, state.point + 1), ArrowLeft: () => choose(state.series, state.point - 1),
  ArrowUp: () => choose(state.series - 1, 0), ArrowDown: () => choose(state.series + 1, 0),
  Home: () => choose(state.series, 0), End: () => choose(state.series, Infinity), " ": play, c: recolour, p: beside,
};
document.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || /SELECT|INPUT/.test(event.target.tagName) || (event.key === " " && event.target.tagName === "BUTTON")) return;
  const act = KEYS[event.key];
  if (act) { event.preventDefault(); act(); }
});
$("diagram").addEventListener("click", (event) => {
  const box = $("diagram").getBoundingClientRect(), x = event.clientX - box.left, y = event.clientY - box.top;
  let best = [Infinity, 0, 0];
  places.forEach((points, i) => points.forEach((p, k) => {
    const distance = Math.hypot(p[0] - x, p[1] - y);
    if (distance < best[0]) best = [distance, i, k];
  }));
  choose(best[1], best[2]);
});
$("place").addEventListener("input", () => choose(state.series, Number($("place").value)));
$("play").addEventListener("click", play);
$("beside").addEventListener("click", beside);
$("home").addEventListener("click", () => views.forEach((view) => view.home()));
$("wave").addEventListener("input", () => { if (!$("animate").checked) moved(); });
$("animate").addEventListener("change", () => {
  if ($("animate").checked && !Number($("wave").value)) $("wave").value = 0.5;
  requestAnimationFrame(swing);
});
for (const id of ["colour", "tubes"]) $(id).addEventListener("change", shapes);
new ResizeObserver(() => { diagram(); profile(); }).observe($("diagram"));
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", shapes);
choices();
diagram();
choose(0, Infinity);
