// The page's data, numbers packed in it, and how they are written.
const data = JSON.parse(document.getElementById("data").textContent);
const series = data.series;

/** Base64 of 32-bit floats, little-endian. */
function floats(text) {
  const raw = atob(text), bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i++) bytes[i] = raw.charCodeAt(i);
  return new Float32Array(bytes.buffer);
}

/** A number of a table: eight digits, as `show` has at least. */
const written = (value) => typeof value === "number" ? String(Number(value.toPrecision(8))) : value === null ? "–" : value;

/** A number on an axis. */
const short = (value, digits = 6) => {
  const size = Math.abs(value), plain = Number(value.toPrecision(digits));
  return plain && (size < 1e-3 || size >= 1e6) ? plain.toExponential().replace("-", "−") : String(plain).replace("-", "−");
};

/** Round numbers in an interval, about so many. */
function ticks(low, high, count) {
  const step = 10 ** Math.floor(Math.log10((high - low) / count)), wanted = (high - low) / count / step;
  const by = step * (wanted > 5 ? 10 : wanted > 2 ? 5 : wanted > 1 ? 2 : 1), found = [];
  for (let i = Math.ceil(low / by - 1e-9); i * by <= high + 1e-9 * by; i++) found.push(i * by);
  return found;
}

/** Round numbers in an interval, and how they are written: each other than its neighbours. */
function labelled(low, high, count) {
  const found = ticks(low, high, count), step = found.length > 1 ? found[1] - found[0] : high - low;
  const digits = 1 + Math.ceil(Math.log10(Math.max(Math.abs(low), Math.abs(high)) / step));
  return found.map((tick) => [tick, short(Math.abs(tick) < step / 1e6 ? 0 : tick, Math.min(15, Math.max(6, digits)))]);
}

/** Smallest and largest of some numbers, those that are none left out. */
function range(values) {
  let low = Infinity, high = -Infinity;
  for (const value of values) if (Number.isFinite(value)) { low = Math.min(low, value); high = Math.max(high, value); }
  return [low, high];
}
